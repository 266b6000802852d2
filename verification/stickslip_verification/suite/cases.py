"""Verification cases: an experiment, and what is checked on it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from stickslip_verification import truth
from stickslip_verification.model.verdict import CaseGroup, Kind, Klass, Measure
from stickslip_verification.suite.experiment import CommunicationStep, points
from stickslip_verification.suite.tolerances import Facts
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
class Truth:
    """Where the expected value comes from.

    ``kind`` is the class of truth, ``source`` the equation number in docs/theory.md, ``formula`` a
    name in `FORMULAS`, or None for the exact motion in high precision.
    """

    kind: Kind
    source: int
    formula: str | None


@dataclass(frozen=True)
class Check:
    """One comparison, judged on each side with that side's tolerance.

    ``measure`` is relative (of the expected value), of_scale (of the largest magnitude that the
    exact motion gives this quantity at any communication point) or absolute (in ``unit``).
    """

    id: str
    quantity: str
    unit: str
    truth: Truth
    at: At
    measure: Measure
    tolerance: Mapping[str, float]
    because: Mapping[str, str]


@dataclass(frozen=True)
class Case:
    """One motion and what is checked on it.

    ``parameters`` holds only what the case sets (SI); everything else stays at the default of
    each side, so that the defaults are verified too. ``klass`` is contract where what happens is
    our convention and not physics, such as the clamp. ``facts`` is what the file states of the
    exact motion, None where it leaves that to the loading. ``law`` is the name of the friction law,
    ``own`` its own parameters; those of Coulomb's law only in a case that names one of them, since
    an FMU need not have them.
    """

    id: str
    title: str
    about: str
    parameters: Mapping[str, float]
    steps: tuple[CommunicationStep, ...]
    checks: tuple[Check, ...]
    file: Path
    klass: Klass = Klass.PHYSICS
    facts: Facts | None = None
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
    steps: Iterable[CommunicationStep],
    law: str = COULOMB_NAME,
    *,
    in_doubles: bool = False,
) -> truth.Run:
    """Follow the exact motion under a friction law through communication steps.

    Quick and `in_doubles` where it is for planning alone.
    """
    taken = [truth.Step(step.h, dict(step.changes)) for step in steps]
    friction = truth.friction_law(law)
    digits = None if in_doubles else friction.digits
    return truth.run(parameters, taken, law=friction, digits=digits)
