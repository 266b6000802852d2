"""The variables of an FMU by our names: which of its variables is ours, in what unit."""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.names import INPUT_UNITS, NOT_THERE, UNITS, NameMap, Target
from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.model.units import Conversion, Unit, conversion, defined, spelled

SETTABLE = frozenset({"parameter", "input"})
READABLE = frozenset({"output", "local", "calculatedParameter"})

NUMBERS = frozenset(
    {"Real", "Integer", "Enumeration", "Boolean", "Float64", "Float32"}
    | {f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)}
)
"""Kinds of variable whose value is a number, of FMI 2.0 and 3.0."""


@dataclass(frozen=True)
class Variable:
    """A variable of the FMU that is one of ours.

    Attributes
    ----------
    name, their_name
        Ours and the FMU's.
    reference
        The FMU's value reference.
    kind
        The FMU's type: Real, Integer, Boolean, Enumeration, Float64, Int32 and so on.
    unit
        The unit of its numbers, as the names file or else the FMU spells it; None if neither does,
        and SI is assumed.
    causality, variability
        As the FMU declares them.
    start
        Its start value in SI, None if the FMU gives none.
    conversion
        From its numbers to ours in SI.
    """

    name: str
    their_name: str
    reference: int
    kind: str
    unit: str | None
    causality: str
    variability: str
    start: float | None
    conversion: Conversion


def collect(label: str, description: Any, names: NameMap) -> dict[str, Variable]:
    """Find our variables in a model description of FMPy.

    A name of ours that the map leaves out is looked for as it is, and counts only if the FMU
    declares it as what it is to us: one that we set as parameter or input, one that we read as
    output.

    Raises
    ------
    FmuError
        Beginning with `label`: mapped names that the FMU does not have, a variable of the wrong
        sort, a unit that is unknown or of another dimension.
    """
    theirs = {variable.name: variable for variable in description.modelVariables}
    units = _units(description)
    absent = {
        ours: target.name
        for ours, target in names.targets.items()
        if target.name != NOT_THERE and target.name not in theirs
    }
    if absent:
        raise FmuError(f"{label}: has no variable {_absent(absent, theirs)}")
    taken = {target.name for target in names.targets.values()}
    found = {}
    for ours in UNITS:
        target = names.targets.get(ours)
        if target is None:
            guess = theirs.get(ours)
            if ours in taken or guess is None or not _looks_like(ours, guess):
                continue
            target = Target(ours)
        elif target.name == NOT_THERE:
            continue
        found[ours] = _variable(label, ours, target, theirs[target.name], units, UNITS[ours])
    return found


def collect_own(label: str, description: Any, wanted: Mapping[str, str]) -> dict[str, Variable]:
    """Find parameters of a friction law, by name and unit, in a model description of FMPy.

    They are looked for by their own names, among parameters and inputs; raises as `collect` does.
    """
    theirs = {variable.name: variable for variable in description.modelVariables}
    units = _units(description)
    return {
        name: _variable(label, name, Target(name), theirs[name], units, unit)
        for name, unit in wanted.items()
        if name in theirs and theirs[name].causality in SETTABLE
    }


def extra_outputs(description: Any, variables: Mapping[str, Variable]) -> tuple[str, ...]:
    """Return the declared outputs of the FMU that are none of ours, by the FMU's names."""
    known = {variable.their_name for variable in variables.values()}
    return tuple(
        variable.name
        for variable in description.modelVariables
        if variable.causality == "output" and variable.name not in known
    )


def _absent(absent: Mapping[str, str], theirs: Mapping[str, Any]) -> str:
    parts = []
    for ours, name in absent.items():
        near = difflib.get_close_matches(name, theirs, n=1)
        parts.append(f"{name!r} for {ours}" + (f" (near it: {near[0]!r})" if near else ""))
    return ", ".join(parts)


def _looks_like(ours: str, variable: Any) -> bool:
    wanted = SETTABLE if ours in INPUT_UNITS else {"output"}
    return variable.causality in wanted and variable.variability != "constant"


def _variable(
    label: str, ours: str, target: Target, theirs: Any, units: Mapping[str, Unit], expected: str
) -> Variable:
    called = ours if ours == theirs.name else f"{ours} ({theirs.name!r})"
    to_set = ours not in QUANTITIES
    if theirs.causality not in (SETTABLE if to_set else READABLE) or (
        to_set and theirs.variability == "constant"
    ):
        wanted = "a parameter or an input" if to_set else "an output"
        declared = f"{theirs.variability} {theirs.causality}"
        raise FmuError(f"{label}: {called} must be {wanted}, not a {declared}")
    if theirs.type not in NUMBERS:
        raise FmuError(f"{label}: {called} is of type {theirs.type}, not a number")
    if theirs.dimensions:
        raise FmuError(f"{label}: {called} is an array; only scalars can be verified")
    unit_name = target.unit
    if unit_name is None:
        declared_type = theirs.declaredType
        unit_name = theirs.unit or (declared_type.unit if declared_type else None)
    change = conversion(
        _unit(label, ours, called, unit_name, units, expected, given=target.unit is not None),
        target.sign,
    )
    return Variable(
        name=ours,
        their_name=theirs.name,
        reference=theirs.valueReference,
        kind=theirs.type,
        unit=unit_name,
        causality=theirs.causality,
        variability=theirs.variability,
        start=_start(theirs.start, change),
        conversion=change,
    )


def _unit(
    label: str,
    ours: str,
    called: str,
    name: str | None,
    units: Mapping[str, Unit],
    wanted: str,
    *,
    given: bool,
) -> Unit:
    expected = spelled(wanted)
    assert expected is not None
    if name is None:
        return expected
    # What a person wrote is meant as it is spelled; what the FMU declares, as it defines it.
    unit = spelled(name) or units.get(name) if given else units.get(name) or spelled(name)
    if unit is None:
        raise FmuError(
            f"{label}: the unit {name!r} of {called} is not known; give one in the names file: "
            f'{ours} = {{ name = "...", unit = "{wanted}" }}'
        )
    if unit.dimension != expected.dimension:
        raise FmuError(
            f"{label}: {called} is in {name!r}, which is not a unit like {wanted!r}; if it is "
            f'another quantity, leave it out in the names file: {ours} = ""'
        )
    return unit


def _units(description: Any) -> dict[str, Unit]:
    """Return the units that the FMU defines by SI base units, and only those."""
    units = {}
    for entry in description.unitDefinitions:
        base = entry.baseUnit
        if base is not None:
            dimension = (base.kg, base.m, base.s, base.A, base.K, base.mol, base.cd, base.rad)
            unit = defined(base.factor, base.offset, dimension)
            if unit is not None:
                units[entry.name] = unit
    return units


def _start(text: str | None, change: Conversion) -> float | None:
    if text is None:
        return None
    number = float(text) if text not in {"true", "false"} else float(text == "true")
    return number if change.leaves_alone else change.to_si(number)
