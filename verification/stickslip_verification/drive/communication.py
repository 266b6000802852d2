"""Driving an FMU through a case: what it is set to, step by step, and what is read."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip_verification.drive.fmu.archive import FmuFile, available
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.instance import FmuInstance
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.record import Record
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.experiment import CommunicationStep, points
from stickslip_verification.truth.parameters import CHANGEABLE, START_VALUES, complete

OUR_IDENTIFIER = "StickSlip"

Read = Callable[[], list[float]]


class NotApplicableError(Exception):
    """The FMU lacks what a case or an invariant needs; the text says what."""


def is_ours(fmu: FmuFile) -> bool:
    """Whether an FMU says that it is our block: by its identifier, and by names as they are."""
    return fmu.model_identifier == OUR_IDENTIFIER and not fmu.names.targets


@dataclass(frozen=True)
class Plan:
    """What an FMU is set to (SI): `parameters` before the start, changes before their steps."""

    parameters: Mapping[str, float]
    steps: Sequence[CommunicationStep]

    @property
    def points(self) -> Sequence[float]:
        """Times at the beginning of the steps [s]."""
        return (0.0, *points(step.h for step in self.steps)[:-1])


def plan(fmu: FmuFile, case: Case) -> Plan:
    """Make the plan of a case for this FMU.

    Of ours only what the case sets is set, so that its defaults are tried too. Of any other all
    twelve values are, for its defaults are its own affair.

    Raises
    ------
    NotApplicableError
        The FMU lacks a variable that the case gives another value than our default, or cannot
        change one on the way.
    """
    if is_ours(fmu):
        return Plan(case.parameters, case.steps)
    values = complete(case.parameters)
    absent = [n for n in values if not fmu.has(n) and values[n] != START_VALUES[n]]
    changed = {name for step in case.steps for name in step.changes}
    absent += sorted(name for name in changed if not fmu.has(name))
    if absent:
        raise NotApplicableError(f"it has no variable {', '.join(dict.fromkeys(absent))}")
    fixed = sorted(name for name in changed if not may_change(fmu, name))
    if fixed:
        raise NotApplicableError(f"it cannot change {', '.join(fixed)} on the way")
    return Plan({n: value for n, value in values.items() if fmu.has(n)}, case.steps)


def may_change(fmu: FmuFile, name: str) -> bool:
    """Whether a variable may be set between two steps."""
    variable = fmu.variables[name]
    return name in CHANGEABLE and (
        variable.causality == "input" or variable.variability == "tunable"
    )


@dataclass
class Drive:
    """One instance on its way through a plan; rows of outputs gather in `rows`."""

    instance: FmuInstance
    plan: Plan
    names: Sequence[str]

    def __post_init__(self) -> None:
        self._points = self.plan.points
        self._read: Read | None = None
        self.initial: list[float] = []
        self.rows: list[list[float]] = []

    def begin(self, start_time: float = 0.0) -> None:
        """Set the parameters and initialize."""
        self.instance.start(self.plan.parameters, start_time)
        self.initial = self._reader()()

    def go(self, begin: int, end: int) -> None:
        """Take the steps from number `begin` up to `end` without it, one row each."""
        read = self._reader()
        for number in range(begin, end):
            step = self.plan.steps[number]
            self.instance.set(step.changes)
            self.instance.step(self._points[number], step.h)
            self.rows.append(read())

    def whole(self) -> None:
        """Go from the start to the end."""
        self.begin()
        self.go(0, len(self.plan.steps))

    def record(self, case: Case) -> Record:
        """Give what was read as the record of a case."""
        columns = np.array(self.rows, dtype=np.float64).reshape(len(self.rows), len(self.names))
        return Record(
            times=np.array(case.times),
            outputs={name: columns[:, i] for i, name in enumerate(self.names)},
            initial=dict(zip(self.names, self.initial, strict=True)),
            messages=tuple(self.instance.messages),
        )

    def _reader(self) -> Read:
        if self._read is None:
            self._read = self.instance.reader(self.names)
        return self._read


def run_case(fmu: FmuFile, case: Case) -> Record:
    """Run a case on a fresh instance; `FmuError` with the FMU's own message if it refuses.

    An output that the FMU lacks is absent from the record.
    """
    return run_plan(fmu, case, plan(fmu, case))


def run_plan(fmu: FmuFile, case: Case, planned: Plan) -> Record:
    """Run a plan on a fresh instance; `FmuError` if the FMU refuses."""
    with fmu.instantiate() as instance:
        drive = Drive(instance, planned, available(fmu, OUTPUT_NAMES))
        drive.whole()
        return drive.record(case)


__all__ = [
    "Drive",
    "FmuError",
    "NotApplicableError",
    "Plan",
    "is_ours",
    "may_change",
    "plan",
    "run_case",
    "run_plan",
]
