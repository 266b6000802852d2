"""The setting that an FMU is driven through, and what an FMU lacks for one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.errors import NotApplicableError as NotApplicableError
from stickslip_verification.suite.experiment import CommunicationStep as CommunicationStep
from stickslip_verification.suite.experiment import points
from stickslip_verification.truth.named import BUILT_IN, COULOMB_NAME
from stickslip_verification.truth.parameters import CHANGEABLE, START_VALUES, Parameter, changeable

if TYPE_CHECKING:
    from stickslip_verification.suite.cases import Case


@dataclass(frozen=True)
class Setting:
    """What an FMU is driven through: values set before the start (SI), steps, start time [s]."""

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
    set. `NotApplicableError` if it lacks a variable that the case gives another value than our
    default, or cannot change one on the way.
    """
    require_law(fmu, case)
    if fmu.own_starts:
        return Setting(case.parameters, case.steps)
    values = case.start
    changed = sorted({name for step in case.steps for name in step.changes})
    need(fmu, [*lacking(fmu, values, case.own), *changed])
    need_changeable(fmu, changed, case.own)
    return Setting({n: value for n, value in values.items() if fmu.has(n)}, case.steps)


def can_run(fmu: FmuFile, case: Case) -> bool:
    """Whether an FMU has what a case needs."""
    try:
        setting_of(fmu, case)
    except NotApplicableError:
        return False
    return True


def require_law(fmu: FmuFile, case: Case) -> None:
    """Raise `FmuError` if an FMU lacks a parameter of the friction law of a case, not Coulomb's."""
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


def law_of(fmu: FmuFile) -> str:
    """Return the name of the built-in friction law whose parameters an FMU has; else Coulomb's."""
    for name, law in BUILT_IN.items():
        if name != COULOMB_NAME:
            fmu.look_for(law.parameters, optional=True)
            if all(fmu.has(each.name) for each in law.parameters):
                return name
    return COULOMB_NAME


def fitting(fmu: FmuFile, cases: Sequence[Case]) -> list[Case]:
    """Return the cases of the friction law of an FMU, or from elsewhere; `FmuError` if none is."""
    law = law_of(fmu)
    fit = [case for case in cases if case.law == law or case.law not in BUILT_IN]
    if not fit:
        laws = " and ".join(dict.fromkeys(case.law for case in cases))
        raise FmuError(
            f"{fmu.path}: its friction law is {law}, and the cases are of the friction law {laws}; "
            f"choose cases of {law}, or build the FMU with stickslip build --law {cases[0].law}"
        )
    return fit


def lacking(fmu: FmuFile, values: Mapping[str, float], own: Sequence[Parameter] = ()) -> list[str]:
    """Return the names that an FMU has no variable for and whose value is not our default."""
    starts = {**START_VALUES, **{each.name: each.start for each in own}}
    return [n for n in values if not fmu.has(n) and values[n] != starts[n]]


def defaults(fmu: FmuFile) -> dict[str, float]:
    """Return our default of every parameter and input that the FMU has (SI)."""
    return {name: value for name, value in START_VALUES.items() if fmu.has(name)}


def may_change(fmu: FmuFile, name: str, own: Sequence[Parameter] = ()) -> bool:
    """Whether a variable, maybe one of a friction law's `own`, may be set between two steps."""
    variable = fmu.variables.get(name)
    return (
        variable is not None
        and name in CHANGEABLE | changeable(own)
        and (variable.causality == "input" or variable.variability == "tunable")
    )


def need(fmu: FmuFile, names: Iterable[str]) -> None:
    """Raise `NotApplicableError` with the names that the FMU lacks, if it lacks any."""
    absent = [name for name in dict.fromkeys(names) if not fmu.has(name)]
    if absent:
        raise NotApplicableError(f"it has no variable {', '.join(absent)}")


def need_changeable(fmu: FmuFile, names: Iterable[str], own: Sequence[Parameter] = ()) -> None:
    """Raise `NotApplicableError` with the variables that cannot be set between two steps."""
    fixed = [name for name in names if not may_change(fmu, name, own)]
    if fixed:
        raise NotApplicableError(f"it cannot change {', '.join(fixed)} on the way")


def need_instances(fmu: FmuFile) -> None:
    """Raise `NotApplicableError` if only one instance may be made in a process."""
    need_ability(not fmu.once_per_process, "be instantiated twice in a process")


def need_ability(able: bool, what: str) -> None:
    """Raise `NotApplicableError` with what an FMU says that it cannot do."""
    if not able:
        raise NotApplicableError(f"it cannot {what}, by its description")
