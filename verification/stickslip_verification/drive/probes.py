"""Probes of an FMU as a whole: its declarations, its refusals, its messages.

A probe returns its complaints, one line each; none if the FMU is sound.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.instance import FmuInstance
from stickslip_verification.drive.fmu.names import INPUT_UNITS, UNITS
from stickslip_verification.drive.fmu.variables import Variable
from stickslip_verification.drive.stepping import NotApplicableError
from stickslip_verification.model import formulas
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.truth.parameters import START_VALUES, complete

Probe = Callable[..., list[str]]
"""Takes the FMU and the probe's arguments. Raises `FmuError`, or `NotApplicableError`."""

_STEP = 0.001
"""An ordinary communication step [s]."""

_LONG = 1.0
"""A step that holds several cycles of the default block [s]."""


@dataclass(frozen=True)
class _Declared:
    """Declaration of a variable in the interface; the unit is "" where there is none."""

    kind: str
    unit: str
    causality: str
    variability: str


_DISCRETE = {"delta_x", "spring_drop", "t_stick", "t_slip", "T", "f", "x_dot_peak", "t_event"}
_INPUTS = ("v", "load", "F_ext")
_TUNABLE = ("k", "c", "mu_s", "mu_k")
_KINDS = {"Float64": "Real", "Int32": "Integer"}
"""Types of FMI 3.0 and the types of FMI 2.0 that hold the same numbers."""

_NO_REALS = {"sticking": "Boolean", "mode": "Integer", "n_slips": "Integer"}


def _interface() -> dict[str, _Declared]:
    """Return the interface as it is specified, apart from any table of the FMU's own."""
    table = {}
    for name, unit in INPUT_UNITS.items():
        if name in _INPUTS:
            table[name] = _Declared("Real", unit, "input", "continuous")
        else:
            varies = "tunable" if name in _TUNABLE else "fixed"
            table[name] = _Declared("Real", unit, "parameter", varies)
    for name in OUTPUT_NAMES:
        kind = _NO_REALS.get(name, "Real")
        discrete = kind != "Real" or name in _DISCRETE or name == "mu_k_used"
        varies = "discrete" if discrete else "continuous"
        table[name] = _Declared(kind, UNITS[name] if kind == "Real" else "", "output", varies)
    return table


INTERFACE: Mapping[str, _Declared] = _interface()


def declared_variables(fmu: FmuFile) -> list[str]:
    """Find variables that are missing and outputs that are not of the interface."""
    complaints = [f"no variable {name}" for name in INTERFACE if not fmu.has(name)]
    return complaints + [f"an output too many: {name}" for name in fmu.extra_outputs]


def declared_units(fmu: FmuFile) -> list[str]:
    """Find variables whose declared unit is not that of the interface."""
    return [
        f"{name} is declared in {variable.unit or 'no unit'}, not {INTERFACE[name].unit or 'none'}"
        for name, variable in _ours(fmu)
        if (variable.unit or "") != INTERFACE[name].unit
    ]


def _ours(fmu: FmuFile) -> list[tuple[str, Variable]]:
    """Return the variables of the interface, without a friction law's own parameters."""
    return [(name, fmu.variables[name]) for name in INTERFACE if fmu.has(name)]


def declared_types(fmu: FmuFile) -> list[str]:
    """Find variables of another type, causality or variability than the interface's."""
    complaints = []
    for name, variable in _ours(fmu):
        wanted = INTERFACE[name]
        if name == "mode" and fmu.fmi_version == "3.0":
            wanted = replace(wanted, kind="Enumeration")
        kind = _KINDS.get(variable.kind, variable.kind)
        found = (kind, variable.causality, variable.variability)
        right = (wanted.kind, wanted.causality, wanted.variability)
        if found != right:
            complaints.append(f"{name} is {' '.join(found)}, not {' '.join(right)}")
    return complaints


def declared_starts(fmu: FmuFile) -> list[str]:
    """Find parameters and inputs that declare another start than the default."""
    return [
        f"{name} starts at {fmu.variables[name].start!r}, not {start!r}"
        for name, start in START_VALUES.items()
        if fmu.has(name) and fmu.variables[name].start != start
    ]


def refuses(fmu: FmuFile, set: Mapping[str, float], running: bool = False) -> list[str]:  # noqa: A002
    """Complain if values are taken that must be refused, before the start or while it runs."""
    _need(fmu, set)
    with fmu.instantiate() as instance:
        if running:
            instance.start(_defaults(fmu))
            instance.step(0.0, _STEP)
        refused = _refusal(instance, set, running)
    if refused is None:
        return [f"{_text(set)} was taken"]
    return [] if _names(refused, set) else [f"{_text(set)} was refused without its name: {refused}"]


def refuses_step(fmu: FmuFile, h: float) -> list[str]:
    """Complain if a step of this length [s] is taken."""
    with fmu.instantiate() as instance:
        instance.start(_defaults(fmu))
        instance.step(0.0, _STEP)
        try:
            instance.step(_STEP, h)
        except FmuError:
            return []
    return [f"a step of {h!r} s was taken"]


def warns(fmu: FmuFile, set: Mapping[str, float], says: Sequence[str]) -> list[str]:  # noqa: A002
    """Complain if the log of a run with these values lacks one of the texts."""
    _need(fmu, set)
    with fmu.instantiate() as instance:
        instance.start({**_defaults(fmu), **set})
        instance.step(0.0, _STEP)
        log = " ".join(instance.messages)
    return [
        f"the log does not say {text}: {log or 'it is empty'}" for text in says if text not in log
    ]


def starts_at(fmu: FmuFile, time: float) -> list[str]:
    """Complain if `t_event` does not count from the start time [s]."""
    _need(fmu, ["t_event"])
    first = time + float(formulas.first_load_up(complete({})))
    with fmu.instantiate() as instance:
        instance.start(_defaults(fmu), time)
        read = instance.reader(["t_event"])
        begin = read()[0]
        for number in range(300):
            instance.step(time + number * _STEP, _STEP)
            if number == 0 and fmu.fmi_version == "3.0":
                # The interface promises it from the first step on: the wrapper tells it no sooner.
                begin = read()[0]
        dated = read()[0]
    complaints = [] if begin == time else [f"t_event begins with {begin!r}, not {time!r}"]
    # Rounding of absolute times, and of a few additions.
    if not abs(dated - first) <= 16.0 * math.ulp(first):
        complaints.append(f"the first break-away is dated {dated!r}, not {first!r}")
    return complaints


def fails_until_reset(fmu: FmuFile, set: Mapping[str, float]) -> list[str]:  # noqa: A002
    """Complain if an FMU goes on after a refusal, or does not recover by a reset."""
    _need(fmu, set)
    if fmu.once_per_process:
        raise NotApplicableError("it cannot be instantiated twice in a process, by its description")
    names = [name for name in OUTPUT_NAMES if fmu.has(name)]
    with fmu.instantiate() as fresh:
        fresh.start(_defaults(fmu))
        fresh.step(0.0, _LONG)
        expected = fresh.reader(names)()
    with fmu.instantiate() as instance:
        instance.start(_defaults(fmu))
        # Long enough that the meter has counted.
        instance.step(0.0, _LONG)
        read = instance.reader(names)
        try:
            instance.set(set)
            instance.step(_LONG, _STEP)
        except FmuError:
            complaints = _goes_on(instance, read)
        else:
            return [f"{_text(set)} was taken"]
        instance.reset()
        instance.start(_defaults(fmu))
        instance.step(0.0, _LONG)
        got = instance.reader(names)()
    differ = [name for name, a, b in zip(names, got, expected, strict=True) if a != b]
    return complaints + [f"after reset {name} is not that of a fresh instance" for name in differ]


PROBES: dict[str, Probe] = {
    "declared_variables": declared_variables,
    "declared_units": declared_units,
    "declared_types": declared_types,
    "declared_starts": declared_starts,
    "refuses": refuses,
    "refuses_step": refuses_step,
    "warns": warns,
    "starts_at": starts_at,
    "fails_until_reset": fails_until_reset,
}
"""What an invariant can name as ``probe``."""


def _goes_on(instance: FmuInstance, read: Callable[[], list[float]]) -> list[str]:
    complaints = []
    calls: tuple[tuple[str, Callable[[], object]], ...] = (
        ("read outputs", read),
        ("step", lambda: instance.step(_STEP, _STEP)),
    )
    for what, call in calls:
        try:
            call()
        except FmuError:
            continue
        complaints.append(f"after a refusal it can still {what}")
    return complaints


def _refusal(instance: FmuInstance, values: Mapping[str, float], running: bool) -> str | None:
    """Return what is said to the values, when they are set or when they act; None if nothing."""
    try:
        instance.set(values)
        if running:
            instance.step(_STEP, _STEP)
        else:
            instance.start({})
    except FmuError as error:
        return str(error)
    return None


def _names(refusal: str, values: Mapping[str, float]) -> bool:
    """Whether what the FMU itself said names every variable."""
    said = refusal.partition("failed:")[2] or refusal
    return all(re.search(rf"\b{name}\b", said) for name in values)


def _defaults(fmu: FmuFile) -> dict[str, float]:
    return {name: value for name, value in START_VALUES.items() if fmu.has(name)}


def _need(fmu: FmuFile, names: Mapping[str, float] | Sequence[str]) -> None:
    absent = [name for name in names if not fmu.has(name)]
    if absent:
        raise NotApplicableError(f"it has no variable {', '.join(absent)}")


def _text(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value!r}" for name, value in values.items())
