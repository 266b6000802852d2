"""Probes of a model description: what it declares of each variable."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import INPUT_UNITS, UNITS
from stickslip_verification.drive.fmu.variables import Variable
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.truth.parameters import START_VALUES


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
