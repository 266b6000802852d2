"""An FMU driven through a setting: values before the start, steps, changes between them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stickslip_verification.drive.fmu.archive import FmuFile, available
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.instance import FmuInstance
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.experiment import CommunicationStep as CommunicationStep
from stickslip_verification.suite.experiment import points
from stickslip_verification.truth.named import COULOMB_NAME
from stickslip_verification.truth.parameters import CHANGEABLE, START_VALUES, Parameter, changeable

Read = Callable[[], list[float]]

AfterStep = Callable[[float], bool]
"""Called with the time since the start [s] after each step; a true answer ends the run there."""


class NotApplicableError(Exception):
    """The FMU lacks what a case or an invariant needs; the text says what."""


@dataclass(frozen=True)
class Setting:
    """What an FMU is driven through (SI).

    Attributes
    ----------
    parameters
        Parameters and inputs set before the start, by the suite's names.
    steps
        Communication steps; the changes of each are set before it.
    start_time
        Time of the start [s].
    """

    parameters: Mapping[str, float]
    steps: Sequence[CommunicationStep]
    start_time: float = 0.0

    @cached_property
    def points(self) -> tuple[float, ...]:
        """Communication points after the start [s], from 0: the correctly rounded sums of steps."""
        return (0.0, *points(step.h for step in self.steps))


def setting_of(fmu: FmuFile, case: Case) -> Setting:
    """Return the setting of a case for this FMU.

    Where the FMU's own start values are tried (`FmuFile.own_starts`), only what the case names is
    set. Elsewhere all values are set, since the FMU's may differ.

    Raises
    ------
    NotApplicableError
        The FMU lacks a variable that the case gives another value than our default, or cannot
        change one on the way.
    """
    require_law(fmu, case)
    if fmu.own_starts:
        return Setting(case.parameters, case.steps)
    values = case.start
    absent = lacking(fmu, values, case.own)
    changed = {name for step in case.steps for name in step.changes}
    absent += sorted(name for name in changed if not fmu.has(name))
    if absent:
        raise NotApplicableError(f"it has no variable {', '.join(dict.fromkeys(absent))}")
    fixed = sorted(name for name in changed if not may_change(fmu, name, case.own))
    if fixed:
        raise NotApplicableError(f"it cannot change {', '.join(fixed)} on the way")
    return Setting({n: value for n, value in values.items() if fmu.has(n)}, case.steps)


def can_run(fmu: FmuFile, case: Case) -> bool:
    """Whether an FMU has what a case needs."""
    try:
        setting_of(fmu, case)
    except NotApplicableError:
        return False
    return True


def require_law(fmu: FmuFile, case: Case) -> None:
    """Raise `FmuError` if an FMU lacks a parameter of the friction law of a case.

    Coulomb's law counts without its own parameters too: a case that gives one of them another value
    than the start is then not applicable.
    """
    if case.law == COULOMB_NAME:
        fmu.look_for(case.own, optional=True)
        return
    fmu.look_for(case.own)
    absent = [each.name for each in case.own if not fmu.has(each.name)]
    if absent:
        raise FmuError(
            f"{fmu.path}: has no variable {', '.join(absent)}, which the friction law {case.law} "
            f"of the case {case.id} needs; build the FMU with this law, or name it with --names"
        )


def lacking(fmu: FmuFile, values: Mapping[str, float], own: Sequence[Parameter] = ()) -> list[str]:
    """Return the names that an FMU has no variable for and whose value is not our default.

    `own` are a friction law's parameters among them.
    """
    starts = {**START_VALUES, **{each.name: each.start for each in own}}
    return [n for n in values if not fmu.has(n) and values[n] != starts[n]]


def may_change(fmu: FmuFile, name: str, own: Sequence[Parameter] = ()) -> bool:
    """Whether a variable, maybe one of a friction law's `own`, may be set between two steps."""
    variable = fmu.variables[name]
    return name in CHANGEABLE | changeable(own) and (
        variable.causality == "input" or variable.variability == "tunable"
    )


@dataclass
class Driver:
    """One instance on its way through a setting; rows of outputs gather in `rows`."""

    instance: FmuInstance
    setting: Setting
    names: Sequence[str]
    after_step: AfterStep | None = None

    def __post_init__(self) -> None:
        self._read: Read | None = None
        self.initial: list[float] = []
        self.rows: list[list[float]] = []

    def begin(self) -> None:
        """Set the parameters and initialize."""
        self.instance.start(self.setting.parameters, self.setting.start_time)
        self.initial = self._reader()()

    def go(self, begin: int, end: int) -> None:
        """Take the steps from number `begin` up to `end` without it, one row each."""
        read, setting = self._reader(), self.setting
        for number in range(begin, end):
            step = setting.steps[number]
            self.instance.set(step.changes)
            self.instance.step(setting.start_time + setting.points[number], step.h)
            self.rows.append(read())
            if self.after_step is not None and self.after_step(setting.points[number + 1]):
                return

    def read_again(self, number: int) -> None:
        """Read the outputs where `number` steps are taken, as after a state that was set."""
        if number:
            self.rows[number - 1] = self._reader()()

    def whole(self) -> Run:
        """Go from the start to the end."""
        self.begin()
        self.go(0, len(self.setting.steps))
        return self.run()

    def run(self) -> Run:
        """Return what was read so far."""
        columns = np.array(self.rows, dtype=np.float64).reshape(len(self.rows), len(self.names))
        return Run(
            times=np.array(self.setting.points[1 : len(self.rows) + 1]),
            outputs={name: columns[:, i] for i, name in enumerate(self.names)},
            initial=dict(zip(self.names, self.initial, strict=True)),
            messages=tuple(self.instance.messages),
        )

    def _reader(self) -> Read:
        if self._read is None:
            self._read = self.instance.reader(self.names)
        return self._read


def run(fmu: FmuFile, setting: Setting, after_step: AfterStep | None = None) -> Run:
    """Drive a fresh instance of an FMU through a setting.

    Parameters
    ----------
    fmu
        The FMU. An output that it lacks is absent from the run.
    setting
        Values before the start, steps and changes.
    after_step
        For progress, and to end the run early.

    Raises
    ------
    FmuError
        With the FMU's own message, if it refuses a call.
    """
    with fmu.instantiate() as instance:
        return Driver(instance, setting, available(fmu, OUTPUT_NAMES), after_step).whole()


def run_case(fmu: FmuFile, case: Case) -> Run:
    """Drive a fresh instance of an FMU through a case; raises as `setting_of` and `run` do."""
    return run(fmu, setting_of(fmu, case))
