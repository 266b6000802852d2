"""Tolerances by rule: from what a case is, and what a check looks at, to a number and its reason.

docs/theory.md, "Tolerances of the suite", states the same rules for people.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import ROUND_CEILING, Decimal
from functools import cached_property

from pydantic.dataclasses import dataclass as model

from stickslip_verification.model.data_file import WRITTEN, Count, Written
from stickslip_verification.model.formulas import FORMULAS
from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.model.verdict import Measure
from stickslip_verification.truth import COULOMB, FrictionLaw, Run

ROUNDING = 1e-12
"""What the exact block may lose before conditioning, as a part of the value: some thousand
roundings of 1e-16 along its arcs, and another mathematical library."""

DISTURBED = 1e-10
"""What the exact block may lose under any sequence of inputs, as a part of the value: a change or a
reversal starts an arc from a rounded state, which a shallow re-stick amplifies,
docs/theory.md (17)."""

INTEGRATION = 1e-9
"""What a careful integration may lose in a slip, before conditioning."""

NOTHING = 1e-30
"""A magnitude [SI] below it is zero in the exact motion, which carries 50 digits."""

ZERO = "zero throughout by the rules: nothing is computed"
"""Reason of an output that is zero in the exact motion."""


@model(frozen=True, config=WRITTEN)
class Facts(Written):
    """What the tolerances of a case take from its exact motion.

    Attributes
    ----------
    slips
        Completed slips; one that is under way at the end may be counted too.
    reversals
        Slips that turn into a slip the other way.
    zero
        Outputs that are zero at every communication point.
    """

    slips: Count
    reversals: Count = 0
    zero: frozenset[str] = frozenset()


def facts_of(run: Run) -> Facts:
    """Take the facts from an exact motion."""
    return Facts(
        slips=int(run.samples[-1]["n_slips"]),
        reversals=sum(event.kind == "reversal" for event in run.events),
        zero=frozenset(
            name
            for name in run.initial
            if all(abs(sample[name]) < NOTHING for sample in run.samples)
        ),
    )


@dataclass(frozen=True)
class Tolerance:
    """What a check allows each side, by which measure, and why; see `cases.Check`."""

    measure: Measure
    allowed: Mapping[str, float]
    because: Mapping[str, str]

    @staticmethod
    def of(measure: Measure, *sides: tuple[float, str]) -> "Tolerance":
        """Return that of numbers and reasons: the FMU's and the reference's, or one for both."""
        both = {"fmu": sides[0], "reference": sides[-1]}
        return Tolerance(
            measure,
            {side: allowed for side, (allowed, _) in both.items()},
            {side: reason for side, (_, reason) in both.items()},
        )


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
    """The rules, applied to one case.

    Attributes
    ----------
    values
        All values in force: at the start, and after each change (SI).
    facts
        What happens in the exact motion.
    own_conditioning
        The conditioning, where it is not that of the narrowest gap.
    own_fmu
        Tolerance and reason of the exact block's courses, where they are not the rule's.
    law
        The friction law: what the relief of a slip comes from.
    """

    values: tuple[Mapping[str, float], ...]
    facts: Facts
    own_conditioning: float | None = None
    own_fmu: tuple[float, str] | None = None
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
            return Tolerance.of(
                Measure.ABSOLUTE,
                *(
                    (rounded_up(part * extension), f"without a gap no relief: {part:g} {of_it}")
                    for part in (ROUNDING, INTEGRATION)
                ),
            )
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
            return DISTURBED, (
                "the bound for any input sequence: rounding of a restart at each change or "
                "reversal, 1e-15, times what a shallow re-stick may amplify it"
            )
        return undisturbed, f"rounding along undisturbed arcs, 1e-12, times {self._amplified}"

    def formula(self, name: str) -> Tolerance | None:
        """Return the tolerance of a value against a closed form; None if no rule gives one."""
        power = FORMULAS[name].sensitivity
        if name == "break_away_force":
            return Tolerance(Measure.RELATIVE, _PRODUCT.allowed, _PRODUCT.because)
        if power is None or (power and not self.lambda_):
            return None
        factor = 1.0 + self.lambda_**-power if power else 1.0
        return Tolerance.of(
            Measure.RELATIVE,
            (
                rounded_up(ROUNDING * self.conditioning),
                f"rounding, 1e-12, times {self._amplified}; no step enters",
            ),
            (
                rounded_up(INTEGRATION * self.conditioning * factor),
                f"integration, 1e-9, times {self._amplified} and the sensitivity to an error of "
                f"state, {factor:.3g}",
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
