"""Verification cases: an experiment, and what is checked on it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from stickslip_verification import truth
from stickslip_verification.model.formulas import FORMULAS
from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.model.verdict import CaseGroup, Klass
from stickslip_verification.suite.experiment import CommunicationStep, points
from stickslip_verification.suite.tolerances import Facts, Tolerance
from stickslip_verification.truth.named import COULOMB_NAME
from stickslip_verification.truth.parameters import Parameter, complete


@dataclass(frozen=True)
class At:
    """Where a check looks: ``kind`` is end, every_point, cycle or event, the last two by number.

    cycle: the first communication point in the stick that follows slip number n; event: the first
    one after transition number n, counted from 1.
    """

    kind: str
    number: int = 0

    def __str__(self) -> str:
        return f"{self.kind} {self.number}" if self.number else self.kind


@dataclass(frozen=True)
class Check(Tolerance):
    """One comparison, judged on each side with that side's tolerance."""

    id: str
    quantity: str
    formula: str  # a name in `FORMULAS`, or "" for the exact motion in high precision
    at: At

    @property
    def unit(self) -> str:
        """The SI unit of the quantity."""
        return QUANTITIES[self.quantity].unit

    @property
    def source(self) -> int:
        """Number of the equation in docs/theory.md."""
        return (FORMULAS[self.formula] if self.formula else QUANTITIES[self.quantity]).equation


@dataclass(frozen=True)
class Case:
    """One motion and what is checked on it.

    ``own`` are the friction law's own parameters; those of Coulomb's law only in a case that names
    one of them, since an FMU need not have them.
    """

    id: str
    title: str
    about: str
    parameters: Mapping[str, float]  # set by the case [SI]; the others verify the defaults
    steps: tuple[CommunicationStep, ...]
    checks: tuple[Check, ...]
    file: Path
    klass: Klass = Klass.PHYSICS  # contract where what happens is a convention, as the clamp
    facts: Facts | None = None  # as the file states them; None: the exact motion is followed
    law: str = COULOMB_NAME
    own: tuple[Parameter, ...] = ()

    @property
    def start(self) -> Mapping[str, float]:
        """Every value at the start, the defaults included (SI)."""
        return complete(self.parameters, self.own)

    @property
    def group(self) -> CaseGroup:
        """The group of cases it belongs to, by what it sets."""
        if self.klass == Klass.CONTRACT:
            return CaseGroup.CONVENTIONS
        if self.law != COULOMB_NAME:
            return CaseGroup.LAWS
        if self.own:
            return CaseGroup.DWELL
        if any(step.changes for step in self.steps):
            return CaseGroup.CHANGES
        if any(name.endswith("_start") for name in self.parameters):
            return CaseGroup.STARTS
        if self.parameters.get("c"):
            return CaseGroup.DAMPING
        return CaseGroup.SETTINGS if self.parameters else CaseGroup.DEFAULT

    @property
    def times(self) -> tuple[float, ...]:
        """Communication points after the start [s]: each the correctly rounded sum of steps."""
        return points(step.h for step in self.steps)

    @property
    def stop_time(self) -> float:
        """The last communication point [s]."""
        return self.times[-1]


def follow(
    parameters: Mapping[str, float],
    steps: Sequence[CommunicationStep],
    law: str = COULOMB_NAME,
    *,
    in_doubles: bool = False,
) -> truth.Run:
    """Follow the exact motion through communication steps; in doubles for planning alone."""
    friction = truth.friction_law(law)
    digits = None if in_doubles else friction.digits
    return truth.run(parameters, steps, law=friction, digits=digits)
