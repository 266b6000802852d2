"""Probes of the contract: what an FMU declares of each variable, what it refuses and warns of."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.names import UNITS, Variable
from stickslip_verification.drive.probes.calls import Call, calling, played
from stickslip_verification.drive.stepping import defaults, need, need_instances
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.truth.parameters import START_VALUES

# The interface as it is specified, apart from any table of the FMU's own.
_NO_REALS = {"sticking": "Boolean", "mode": "Integer", "n_slips": "Integer"}
_DISCRETE = (
    *("delta_x", "spring_drop", "t_stick", "t_slip", "T", "f", "x_dot_peak", "t_event"),
    *("mu_k_used", *_NO_REALS),
)
_SORTS = {
    **dict.fromkeys(START_VALUES, "parameter fixed"),
    **dict.fromkeys(("k", "c", "mu_s", "mu_k"), "parameter tunable"),
    **dict.fromkeys(("v", "load", "F_ext"), "input continuous"),
    **dict.fromkeys(OUTPUT_NAMES, "output continuous"),
    **dict.fromkeys(_DISCRETE, "output discrete"),
}
"""Causality and variability."""

_KINDS = {"Float64": "Real", "Int32": "Integer"}
"""Types of FMI 3.0 and the types of FMI 2.0 that hold the same numbers."""

_STEP, _LONG = 0.001, 1.0
"""An ordinary communication step, and one that holds several cycles of the default block [s]."""


def declared_variables(fmu: FmuFile) -> list[str]:
    """Find variables that are missing and outputs that are not of the interface."""
    complaints = [f"no variable {name}" for name in UNITS if not fmu.has(name)]
    return complaints + [f"an output too many: {name}" for name in fmu.extra_outputs]


def declared_units(fmu: FmuFile) -> list[str]:
    """Find variables whose declared unit is not that of the interface."""
    units = {name: "" if name in _NO_REALS else unit for name, unit in UNITS.items()}
    return [
        f"{name} is declared in {variable.unit or 'no unit'}, not {units[name] or 'none'}"
        for name, variable in _of_interface(fmu)
        if (variable.unit or "") != units[name]
    ]


def declared_types(fmu: FmuFile) -> list[str]:
    """Find variables of another type, causality or variability than the interface's."""
    kinds = _NO_REALS | ({"mode": "Enumeration"} if fmu.fmi_version == "3.0" else {})
    complaints = []
    for name, variable in _of_interface(fmu):
        right = f"{kinds.get(name, 'Real')} {_SORTS[name]}"
        kind = _KINDS.get(variable.kind, variable.kind)
        declared = f"{kind} {variable.causality} {variable.variability}"
        if declared != right:
            complaints.append(f"{name} is {declared}, not {right}")
    return complaints


def declared_starts(fmu: FmuFile) -> list[str]:
    """Find parameters and inputs that declare another start than the default."""
    return [
        f"{name} starts at {variable.start!r}, not {START_VALUES[name]!r}"
        for name, variable in _of_interface(fmu)
        if name in START_VALUES and variable.start != START_VALUES[name]
    ]


def _of_interface(fmu: FmuFile) -> Iterator[tuple[str, Variable]]:
    """Yield the variables of the interface, without a friction law's own parameters."""
    return ((name, fmu.variables[name]) for name in UNITS if fmu.has(name))


def refuses(
    fmu: FmuFile,
    set: Mapping[str, float],  # noqa: A002
    running: bool = False,
    step: float = _STEP,
) -> list[str]:
    """Complain if values or a step [s] are not refused by name, before the start or `running`."""
    need(fmu, set)
    text = _text(set) or f"a step of {step!r} s"
    with fmu.instantiate() as instance:
        if running:
            instance.start(defaults(fmu))
            instance.step(0.0, _STEP)
        refusal = _refusal(
            lambda: instance.set(set),
            lambda: instance.step(_STEP, step) if running else instance.start({}),
        )
    if refusal is None:
        return [f"{text} was taken"]
    # The suite's own words, before those of the FMU, name every variable.
    said = refusal.partition("failed:")[2] or refusal
    if all(re.search(rf"\b{name}\b", said) for name in set):
        return []
    return [f"{text} was refused without its name: {refusal}"]


def warns(fmu: FmuFile, set: Mapping[str, float], says: Sequence[str]) -> list[str]:  # noqa: A002
    """Complain if the log of a run with these values lacks one of the texts."""
    need(fmu, set)
    with fmu.instantiate() as instance:
        instance.start({**defaults(fmu), **set})
        instance.step(0.0, _STEP)
        log = " ".join(instance.messages)
    return [
        f"the log does not say {text}: {log or 'it is empty'}" for text in says if text not in log
    ]


def fails_until_reset(fmu: FmuFile, set: Mapping[str, float]) -> list[str]:  # noqa: A002
    """Complain if an FMU goes on after a refusal, or does not recover by a reset."""
    need(fmu, set)
    need_instances(fmu)
    long: list[Call] = [{"set": defaults(fmu)}, {"start": 0.0}, {"step": _LONG}]
    _, (expected,) = played(fmu, (), long)
    with calling(fmu, long) as caller:
        instance = caller.instance
        if _refusal(lambda: instance.set(set), lambda: instance.step(_LONG, _STEP)) is None:
            return [f"{_text(set)} was taken"]
        calls = {"read outputs": caller.row, "step": lambda: instance.step(_STEP, _STEP)}
        complaints = [
            f"after a refusal it can still {what}"
            for what, call in calls.items()
            if _refusal(call) is None
        ]
        instance.reset()
        caller.steps.clear()
        (row,) = caller.play(long)
    differ = [name for name in row if row[name] != expected[name]]
    return complaints + [f"after reset {name} is not that of a fresh instance" for name in differ]


def _refusal(*calls: Callable[[], object]) -> str | None:
    """Return the message of the first call that is refused; None if all are taken."""
    try:
        for call in calls:
            call()
    except FmuError as error:
        return str(error)
    return None


def _text(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value!r}" for name, value in values.items())
