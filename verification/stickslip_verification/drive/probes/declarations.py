"""Probes of a model description: what it declares of each variable."""

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import UNITS
from stickslip_verification.drive.fmu.variables import Variable
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.truth.parameters import START_VALUES

# The interface as it is specified, apart from any table of the FMU's own.
_INPUTS = ("v", "load", "F_ext")
_TUNABLE = ("k", "c", "mu_s", "mu_k")
_NO_REALS = {"sticking": "Boolean", "mode": "Integer", "n_slips": "Integer"}
_DISCRETE = {
    *("delta_x", "spring_drop", "t_stick", "t_slip", "T", "f", "x_dot_peak", "t_event"),
    *("mu_k_used", *_NO_REALS),
}

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
    complaints = []
    for name, variable in _of_interface(fmu):
        kind, causality, variability = _NO_REALS.get(name, "Real"), "parameter", "fixed"
        if name == "mode" and fmu.fmi_version == "3.0":
            kind = "Enumeration"
        if name in OUTPUT_NAMES:
            causality, variability = "output", "discrete" if name in _DISCRETE else "continuous"
        elif name in _INPUTS:
            causality, variability = "input", "continuous"
        elif name in _TUNABLE:
            variability = "tunable"
        right = f"{kind} {causality} {variability}"
        declared = _KINDS.get(variable.kind, variable.kind)
        found = f"{declared} {variable.causality} {variable.variability}"
        if found != right:
            complaints.append(f"{name} is {found}, not {right}")
    return complaints


def declared_starts(fmu: FmuFile) -> list[str]:
    """Find parameters and inputs that declare another start than the default."""
    return [
        f"{name} starts at {fmu.variables[name].start!r}, not {start!r}"
        for name, start in START_VALUES.items()
        if fmu.has(name) and fmu.variables[name].start != start
    ]


def _of_interface(fmu: FmuFile) -> list[tuple[str, Variable]]:
    """Return the variables of the interface, without a friction law's own parameters."""
    return [(name, fmu.variables[name]) for name in UNITS if fmu.has(name)]
