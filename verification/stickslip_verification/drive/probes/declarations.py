"""Probes of a model description: what it declares of each variable."""

from collections.abc import Iterator

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import UNITS
from stickslip_verification.drive.fmu.variables import Variable
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
