"""Tolerances by rule: from what a case is, and what a check looks at, to a number and its reason.

docs/theory.md, "Tolerances of the suite", states the same rules for people.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, Decimal
from functools import cached_property
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass as model

from ..model.data_file import WRITTEN, Count, Written
from ..model.quantities import FORMULAS, QUANTITIES
from ..model.verdict import Measure
from ..truth import COULOMB, FrictionLaw, Run

ROUNDING = 1e-12
"""What the exact block may lose before conditioning, as a part of the value: some thousand
roundings of 1e-16 along its arcs, and another mathematical library."""
DISTURBED = 1e-10
"""What the exact block may lose under any sequence of inputs, as a part of the value: a change or a
reversal starts an arc from a rounded state, which a shallow re-stick amplifies, (17)."""
INTEGRATION = 1e-9  # what a careful integration may lose in a slip, before conditioning
NOTHING = 1e-30  # magnitude [SI] below which the exact motion, of 50 digits, is zero
ZERO = "zero throughout by the rules: nothing is computed"
"""Reason of an output that is zero in the exact motion."""


@model(frozen=True, config=WRITTEN)
class Facts(Written):
    """What the tolerances of a case take from its exact motion."""

    slips: Annotated[Count, Field(description="completed; one under way at the end may count")]
    reversals: Annotated[Count, Field(description="slips that turn into one the other way")] = 0
    zero: Annotated[frozenset[str], Field(description="outputs that stay zero")] = frozenset()


def facts_of(run: Run) -> Facts:
    """Take the facts from an exact motion."""
    sizes = {name: max(abs(sample[name]) for sample in run.samples) for name in run.initial}
    return Facts(
        slips=int(run.samples[-1]["n_slips"]),
        reversals=sum(event.kind == "reversal" for event in run.events),
        zero=frozenset(name for name, size in sizes.items() if size < NOTHING),
    )


@dataclass(frozen=True)
class Tolerance:
    """What a check allows each side, and why.

    ``measure`` is relative (of the expected value), of_scale (of the largest magnitude that the
    exact motion gives this quantity at any communication point) or absolute (in the unit).
    """

    measure: Measure
    tolerance: Mapping[str, float]
    because: Mapping[str, str]

    @staticmethod
    def of(measure: Measure, *sides: tuple[float, str]) -> "Tolerance":
        """Return that of numbers and reasons: the FMU's and the reference's, or one for both."""
        (fmu, fmu_reason), (reference, reason) = sides[0], sides[-1]
        allowed = {"fmu": fmu, "reference": reference}
        return Tolerance(measure, allowed, {"fmu": fmu_reason, "reference": reason})


_POINTS = "a count or a state: no communication point lies within the solver's error of an event"
_PRODUCT = Tolerance.of(
    Measure.OF_SCALE, (1e-15, "a product of two or three doubles, no integration: a few roundings")
)
_COURSES = {
    "F_s": _PRODUCT,
    "mu_k_used": _PRODUCT,
    "x_pull": Tolerance.of(Measure.OF_SCALE, (1e-12, "a sum of v h: one rounding of 1e-16 a step")),
}
"""Of outputs that are not integrated."""


@dataclass(frozen=True)
class Rules:
    """The rules, applied to one case."""

    values: tuple[Mapping[str, float], ...]  # all in force at the start, and after each change [SI]
    facts: Facts
    own_conditioning: float | None = None  # where it is not that of the narrowest gap
    own_fmu: tuple[float, str] | None = None  # tolerance of the exact block's courses, its reason
    law: FrictionLaw = COULOMB

    @cached_property
    def narrowest(self) -> float:
        """Conditioning of the narrowest gap, mu_s/(mu_s - least mu in slip); 1 without a gap.

        When both are known to a rounding, their difference is known to this times it.
        """
        gaps = ((value["mu_s"], self.law.spread(value)) for value in self.values)
        return max([1.0, *(mu_s / gap for mu_s, gap in gaps if gap > 0.0)])

    @property
    def conditioning(self) -> float:
        """The conditioning that enters."""
        return self.narrowest if self.own_conditioning is None else self.own_conditioning

    @property
    def grows(self) -> bool:
        """Whether static friction grows with the age of a stick, docs/theory.md (19)."""
        return any(value.get("tau_s") or value.get("B") for value in self.values)

    def course(self, quantity: str) -> Tolerance:
        """Return a quantity's tolerance against the exact motion at any communication point."""
        if QUANTITIES[quantity].discrete:
            return Tolerance.of(Measure.ABSOLUTE, (0.0, _POINTS))
        if quantity == "W_k" and len({value["k"] for value in self.values}) == 1:
            reason = "the stiffness never changes, so nothing is ever added"
            return Tolerance.of(Measure.ABSOLUTE, (0.0, reason))
        (start, *changed) = self.values
        no_gap = self.law.spread(start) == 0.0 or _normal_force(start) == 0.0
        undamped = self.law is COULOMB and start["c"] == 0.0 and not changed
        if quantity == "spring_drop" and no_gap and undamped:
            # A relief of 2 Delta = 0, (7), is held against the extension.
            w = math.sqrt(start["k"] / start["m"])
            extension = start["mu_s"] * _normal_force(start) / start["k"] + abs(start["v"]) / w
            of_it = f"of the extension of {1e3 * extension:.2g} mm"
            bounds = {part: rounded_up(part * extension) for part in (ROUNDING, INTEGRATION)}
            sides = [(b, f"without a gap no relief: {p:g} {of_it}") for p, b in bounds.items()]
            return Tolerance.of(Measure.ABSOLUTE, *sides)
        if quantity in self.facts.zero:
            return Tolerance.of(Measure.ABSOLUTE, (0.0, ZERO))
        if quantity in _COURSES and not (quantity == "F_s" and self.grows):
            return _COURSES[quantity]
        slips = max(self.facts.slips, 1)
        allowed = rounded_up(INTEGRATION * self.conditioning * slips)
        reason = f"integration, 1e-9, times slips ({slips}) and {self._amplified}"
        return Tolerance.of(Measure.OF_SCALE, self.own_fmu or self.fmu_course(), (allowed, reason))

    def fmu_course(self) -> tuple[float, str]:
        """Return the rule's tolerance of the exact block's courses, and its reason."""
        undisturbed = rounded_up(ROUNDING * self.conditioning)
        if (len(self.values) > 1 or self.facts.reversals) and undisturbed < DISTURBED:
            restart = "rounding of a restart at each change or reversal, 1e-15"
            reason = f"{restart}, times what a shallow re-stick may amplify it"
            return DISTURBED, f"the bound for any input sequence: {reason}"
        return undisturbed, f"rounding along undisturbed arcs, 1e-12, times {self._amplified}"

    def formula(self, name: str) -> Tolerance | None:
        """Return the tolerance of a value against a closed form; None if no rule gives one."""
        power = FORMULAS[name].sensitivity
        if name == "break_away_force":
            return replace(_PRODUCT, measure=Measure.RELATIVE)
        if power is None or (power and not self.lambda_):
            return None
        factor = 1.0 + self.lambda_**-power if power else 1.0
        fmu = f"rounding, 1e-12, times {self._amplified}; no step enters"
        integration = f"integration, 1e-9, times {self._amplified} and the sensitivity to an error"
        return Tolerance.of(
            Measure.RELATIVE,
            (rounded_up(ROUNDING * self.conditioning), fmu),
            (
                rounded_up(INTEGRATION * self.conditioning * factor),
                f"{integration} of state, {factor:.3g}",
            ),
        )

    @property
    def _amplified(self) -> str:
        of = "that the case states" if self.own_conditioning is not None else "of the narrowest gap"
        return f"the conditioning {of}, {self.conditioning:.3g}"

    @property
    def lambda_(self) -> float:
        """The number lambda at the start, docs/theory.md (2); 0 without a gap or a pull."""
        value = self.values[0]
        if value["v"] == 0.0:
            return 0.0
        w = math.sqrt(value["k"] / value["m"])
        return w * self.law.spread(value) * _normal_force(value) / (value["k"] * abs(value["v"]))


def rounded_up(value: float) -> float:
    """Round a tolerance up to two digits; what is beyond the ninth is rounding of its factors."""
    nearest = Decimal(f"{value:.8e}")
    return float(nearest.quantize(Decimal((0, (1,), nearest.adjusted() - 1)), ROUND_CEILING))


def _normal_force(value: Mapping[str, float]) -> float:
    return value["m"] * value["g"] + value["load"]
