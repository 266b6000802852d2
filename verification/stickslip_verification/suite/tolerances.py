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

SUM = 1e-12
"""A sum of v h: one rounding of 1e-16 for each of some thousand steps."""

PRODUCT = 1e-15
"""A product of two or three doubles: a few roundings of 1e-16."""

PRODUCTS = frozenset({"F_s", "mu_k_used"})
"""Outputs that are such a product, or a parameter itself."""

NOTHING = 1e-30
"""A magnitude [SI] below it is zero in the exact motion, which carries 50 digits."""


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
        ratios = [1.0]
        for value in self.values:
            gap = self.law.spread(value)
            if gap > 0.0:
                ratios.append(value["mu_s"] / gap)
        return max(ratios)

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
            near = "a count or a state: no communication point lies within {} of an event"
            reasons = near.format("rounding"), near.format("the solver's error")
            return _tolerance(Measure.ABSOLUTE, (0.0, 0.0), reasons)
        if quantity == "W_k" and len({value["k"] for value in self.values}) == 1:
            return _alike(
                Measure.ABSOLUTE, 0.0, "the stiffness never changes, so nothing is ever added"
            )
        if quantity == "spring_drop" and self._relieves_nothing:
            return self._no_relief()
        if quantity in self.facts.zero:
            return _alike(Measure.ABSOLUTE, 0.0, ZERO)
        if quantity in PRODUCTS and not (quantity == "F_s" and self.grows):
            return _alike(Measure.OF_SCALE, PRODUCT, _PRODUCT)
        if quantity == "x_pull":
            once = "a sum of v h: rounding of one addition a {}"
            reasons = once.format("step"), once.format("phase")
            return _tolerance(Measure.OF_SCALE, (SUM, SUM), reasons)
        slips = max(self.facts.slips, 1)
        reference = (
            rounded_up(INTEGRATION * self.conditioning * slips),
            f"integration, 1e-9 a slip, times {self._conditioning_in_words()}, "
            f"times {slips} slip{'s' if slips > 1 else ''}",
        )
        fmu = self.own_fmu or self.fmu_course()
        return _tolerance(Measure.OF_SCALE, (fmu[0], reference[0]), (fmu[1], reference[1]))

    def fmu_course(self) -> tuple[float, str]:
        """Return the rule's tolerance of the exact block's courses, and its reason."""
        undisturbed = rounded_up(ROUNDING * self.conditioning)
        if (len(self.values) > 1 or self.facts.reversals) and undisturbed < DISTURBED:
            return DISTURBED, (
                "the bound for any input sequence: rounding of a restart at each change or "
                "reversal, 1e-15, times what a shallow re-stick may amplify it"
            )
        return undisturbed, (
            "rounding, 1e-12 of the largest value, as an undisturbed arc is moved along and not "
            f"rebuilt, times {self._conditioning_in_words()}"
        )

    def tighter(self, fmu: float) -> str:
        """Return the reason of a tolerance of the exact block's courses below the rule's."""
        rule, reason = self.fmu_course()
        return f"held to {fmu:g}, tighter than the rule's {rule:g}: {reason}"

    def formula(self, name: str) -> Tolerance | None:
        """Return the tolerance of a value against a closed form; None if no rule gives one."""
        power = FORMULAS[name].sensitivity
        if name == "break_away_force":
            return _alike(Measure.RELATIVE, PRODUCT, _PRODUCT)
        if power is None or (power and not self.lambda_):
            return None
        factor = 1.0 + self.lambda_**-power if power else 1.0
        enters = {
            0: "once",
            1: f"the slip time 1 + 1/lambda = {factor:.3g} times",
            2: f"1 + 1/lambda^2 = {factor:.3g} times",
        }[power]
        words = self._conditioning_in_words()
        return _tolerance(
            Measure.RELATIVE,
            (
                rounded_up(ROUNDING * self.conditioning),
                rounded_up(INTEGRATION * self.conditioning * factor),
            ),
            (
                f"rounding, 1e-12, times {words}; no step enters",
                f"integration, 1e-9, times {words}; an error of state enters {enters}",
            ),
        )

    def _conditioning_in_words(self) -> str:
        if self.own_conditioning is not None:
            return (
                f"the conditioning {self.own_conditioning:.3g} that the case states "
                f"(of the narrowest gap: {self.narrowest:.3g})"
            )
        if all(self.law.spread(value) <= 0.0 for value in self.values):
            return "the conditioning 1, as there is no gap"
        several = len({(value["mu_s"], value["mu_k"]) for value in self.values}) > 1
        least = "mu_k" if self.law is COULOMB else "the least mu in slip"
        return (
            f"the conditioning mu_s/(mu_s - {least}) = {self.narrowest:.3g}"
            f"{' of the narrowest gap' if several else ''}"
        )

    @property
    def lambda_(self) -> float:
        """The number lambda at the start, docs/theory.md (2); 0 without a gap or a pull."""
        value = self.values[0]
        if value["v"] == 0.0:
            return 0.0
        w = math.sqrt(value["k"] / value["m"])
        return w * self.law.spread(value) * _normal_force(value) / (value["k"] * abs(value["v"]))

    @property
    def _relieves_nothing(self) -> bool:
        (start, *changed) = self.values
        no_gap = self.law.spread(start) == 0.0 or _normal_force(start) == 0.0
        return self.law is COULOMB and no_gap and start["c"] == 0.0 and not changed

    def _no_relief(self) -> Tolerance:
        """Hold a relief of 2 Delta = 0 against the extension, (7): break-away and overshoot v/w."""
        value = self.values[0]
        load_up = value["mu_s"] * _normal_force(value) / value["k"]
        extension = load_up + abs(value["v"]) * math.sqrt(value["m"] / value["k"])
        of_it = f"of the extension of {1e3 * extension:.2g} mm"
        return _tolerance(
            Measure.ABSOLUTE,
            (rounded_up(ROUNDING * extension), rounded_up(INTEGRATION * extension)),
            (
                f"without a gap nothing is relieved: rounding, 1e-12, {of_it}",
                f"without a gap nothing is relieved: integration, 1e-9, {of_it}",
            ),
        )


ZERO = "zero throughout by the rules: nothing is computed"
"""Reason of an output that is zero in the exact motion."""

_PRODUCT = "a product of two or three doubles, no integration: a few roundings"


def rounded_up(value: float) -> float:
    """Round a tolerance up to two digits; what is beyond the ninth is rounding of its factors."""
    nearest = Decimal(f"{value:.8e}")
    return float(nearest.quantize(Decimal((0, (1,), nearest.adjusted() - 1)), ROUND_CEILING))


def _normal_force(value: Mapping[str, float]) -> float:
    return value["m"] * value["g"] + value["load"]


def _tolerance(
    measure: Measure, allowed: tuple[float, float], reasons: tuple[str, str]
) -> Tolerance:
    sides = ("fmu", "reference")
    return Tolerance(
        measure, dict(zip(sides, allowed, strict=True)), dict(zip(sides, reasons, strict=True))
    )


def _alike(measure: Measure, allowed: float, reason: str) -> Tolerance:
    return _tolerance(measure, (allowed, allowed), (reason, reason))
