"""The variables of an FMU by our names: which of its variables is ours, in what unit."""

import difflib
import re
from collections.abc import Collection, Mapping
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


MOST_LISTED = 8
"""Variables of an FMU that a message lists; `stickslip names` lists all."""

MOST_LETTERS = 40
"""Letters of a description in such a list."""


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
    units = units_defined(description)
    absent = {
        ours: target.name
        for ours, target in names.targets.items()
        if target.name != NOT_THERE and target.name not in theirs
    }
    if absent:
        lacking = ", ".join(f"{name!r} for {ours}" for ours, name in absent.items())
        has = listing(description, absent.values())
        raise FmuError(f"{label}: has no variable {lacking}; {has}")
    taken = {target.name for target in names.targets.values()}
    found = {}
    for ours in UNITS:
        target = names.targets.get(ours)
        if target is None:
            guess = theirs.get(ours)
            if ours in taken or guess is None or not looks_like(ours, guess):
                continue
            target = Target(ours)
        elif target.name == NOT_THERE:
            continue
        found[ours] = as_ours(label, ours, target, theirs[target.name], units, UNITS[ours])
    return found


def collect_own(
    label: str, description: Any, names: NameMap, wanted: Mapping[str, str]
) -> dict[str, Variable]:
    """Find parameters of a friction law, by name and unit, in a model description of FMPy.

    One that the map leaves out is looked for by its own name, among parameters and inputs; raises
    as `collect` does.
    """
    theirs = {variable.name: variable for variable in description.modelVariables}
    units = units_defined(description)
    found = {}
    for name, unit in wanted.items():
        target = names.targets.get(name, Target(name))
        variable = theirs.get(target.name)
        if variable is not None and (name in names.targets or variable.causality in SETTABLE):
            found[name] = as_ours(label, name, target, variable, units, unit)
    return found


def extra_outputs(description: Any, variables: Mapping[str, Variable]) -> tuple[str, ...]:
    """Return the declared outputs of the FMU that are none of ours, by the FMU's names."""
    known = {variable.their_name for variable in variables.values()}
    return tuple(
        variable.name
        for variable in description.modelVariables
        if variable.causality == "output" and variable.name not in known
    )


def listing(description: Any, wanted: Collection[str]) -> str:
    """Tell on one line what an FMU has: those most like the wanted names first, and how many more.

    Parameters
    ----------
    description
        The model description of FMPy.
    wanted
        Names that are looked for, the FMU's or ours.
    """

    def likeness(variable: Any) -> float:
        last = re.split(r"[.\]]+", variable.name.rstrip("]."))[-1]
        return max(
            difflib.SequenceMatcher(None, name.lower(), part.lower()).ratio()
            for name in wanted
            for part in (variable.name, last)
        )

    variables = [each for each in description.modelVariables if each.type in NUMBERS]
    first = sorted(variables, key=likeness, reverse=True)[:MOST_LISTED]
    more = len(variables) - len(first)
    shown = ", ".join(map(told, first)) or "no number"
    return f"it has {shown}" + (f" and {more} more" if more else "")


def told(variable: Any) -> str:
    """Return name, unit and description of a variable of an FMU, for people."""
    unit = unit_of(variable)
    text = " ".join((variable.description or "").split())
    if len(text) > MOST_LETTERS:
        text = text[: MOST_LETTERS - 1].rstrip() + "\N{HORIZONTAL ELLIPSIS}"
    return f"{variable.name}{f' [{unit}]' if unit else ''}{f' ({text})' if text else ''}"


def unit_of(variable: Any) -> str | None:
    """Return the unit that an FMU declares for a variable or for its type; None without one."""
    declared: Any = variable.declaredType
    unit: str | None = variable.unit or (declared.unit if declared else None)
    return unit


def looks_like(ours: str, variable: Any) -> bool:
    """Whether a variable of an FMU is declared as what this one of ours is: set, or read."""
    wanted = SETTABLE if ours in INPUT_UNITS else {"output"}
    return variable.causality in wanted and variable.variability != "constant"


def as_ours(
    label: str, ours: str, target: Target, theirs: Any, units: Mapping[str, Unit], expected: str
) -> Variable:
    """Return a variable of the FMU as one of ours; `FmuError` if it cannot be that."""
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
    unit_name = unit_of(theirs) if target.unit is None else target.unit
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


def units_defined(description: Any) -> dict[str, Unit]:
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
