"""Our names and those of an FMU: the names file, and which variable is ours, in what unit."""

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator
from pydantic.dataclasses import dataclass as model

from stickslip_verification.drive.fmu.description import NUMBERS, Declared, Description, FmuError
from stickslip_verification.model.data_file import WRITTEN, DataError, DataFile, Written
from stickslip_verification.model.quantities import OUTPUT_NAMES, QUANTITIES
from stickslip_verification.model.units import Conversion, Unit, conversion, spelled
from stickslip_verification.truth.parameters import PARAMETERS, Parameter

INPUT_UNITS: Mapping[str, str] = {each.name: each.unit for each in PARAMETERS}
"""What the suite sets, parameters and inputs, with its unit."""
UNITS: Mapping[str, str] = {**INPUT_UNITS, **{name: QUANTITIES[name].unit for name in OUTPUT_NAMES}}
"""Every variable of the suite with its SI unit."""
NOT_THERE = ""
"""In place of the FMU's name: the FMU has no such variable, whatever its names look like."""


class NamesError(DataError):
    """A names file cannot be used."""


@model(frozen=True, config=WRITTEN)
class Target(Written):
    """What one of our variables is in the FMU: its name or `NOT_THERE`, unit of its numbers, sign.

    Without a unit that of the FMU's description counts; the sign is -1 if it counts the other way.
    """

    name: str
    unit: str | None = None
    sign: Literal[1, -1] = 1


@dataclass(frozen=True)
class NameMap:
    """Our names to those of the FMU, from a file; what is not in it is called as ours is."""

    targets: Mapping[str, Target] = field(default_factory=dict)
    file: Path | None = None


def load_names(file: Path, own: Iterable[Parameter] = ()) -> NameMap:
    """Read a names file: ``x = "mass.s"`` or ``x = { name = "mass.s", unit = "mm", sign = -1 }``.

    The entries stand at the top of the TOML file or in a table ``[names]``, those of the parameters
    of a friction law, `own`, too. `NamesError` if it cannot be read or holds something else.
    """
    source = DataFile(file, NamesError)
    place = ["names"] if isinstance(source.data.get("names"), dict) else []
    for key in source.data if place else ():
        if key != "names":
            raise source.refusal(f"{key!r} stands beside the table [names]", key)
    known = {*UNITS, *(each.name for each in own)}
    targets: dict[str, Target] = {}
    for key, target in source.read(_Targets, *place).items():
        if key not in known:
            reason = f"{key!r} is no variable of the suite; {_nearest(key)}"
            raise source.refusal(reason, *place, key)
        taken = [ours for ours, other in targets.items() if other.name == target.name != NOT_THERE]
        if taken:
            reason = f"{key} and {taken[0]} are both {target.name!r}"
            raise source.refusal(reason, *place, key)
        targets[key] = target
    if not targets:
        raise source.refusal("names no variable")
    return NameMap(targets, file)


def _named(entries: Any) -> Any:
    """Return entries as tables: a text is a name, and a table without one keeps ours."""
    if not isinstance(entries, dict):
        return entries
    return {
        ours: {"name": ours, **entry} if isinstance(entry, dict) else {"name": entry}
        for ours, entry in entries.items()
    }


_Targets = Annotated[Mapping[str, Target], BeforeValidator(_named)]


def _nearest(key: str) -> str:
    near = difflib.get_close_matches(key, UNITS, n=3, cutoff=0.5)
    # Names of one or two letters resemble nothing; the other case of a letter is the usual slip.
    near += [name for name in UNITS if name.lower() == key.lower() and name not in near]
    return f"near it: {', '.join(near)}" if near else f"there are {', '.join(UNITS)}"


SETTABLE = frozenset({"parameter", "input"})
READABLE = frozenset({"output", "local", "calculatedParameter"})


@dataclass(frozen=True)
class Variable:
    """A variable of the FMU that is one of ours.

    ``unit`` is that of its numbers, as the names file or else the FMU spells it, None where SI is
    assumed; ``start`` is in SI; ``conversion`` makes its numbers ours in SI.
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


def collect(
    label: str, description: Description, names: NameMap, wanted: Mapping[str, str]
) -> dict[str, Variable]:
    """Find variables of ours, `wanted` names with their units, in a model description.

    A name that the map leaves out is looked for as it is, and counts only if it `looks_like` ours.
    `FmuError`, beginning with `label`, for mapped names that the FMU does not have, a variable of
    the wrong sort, a unit that is unknown or of another dimension.
    """
    theirs, targets = description.declared, names.targets
    taken = {ours: each.name for ours, each in targets.items() if each.name != NOT_THERE}
    absent = {ours: name for ours, name in taken.items() if name not in theirs}
    if absent:
        lacking = ", ".join(f"{name!r} for {ours}" for ours, name in absent.items())
        has = description.listing(absent.values())
        raise FmuError(f"{label}: has no variable {lacking}; {has}")
    found = {}
    for ours, unit in wanted.items():
        guess = theirs.get(ours)
        if ours in taken:
            target = targets[ours]
        elif ours in targets or ours in taken.values() or not (guess and looks_like(ours, guess)):
            continue
        else:
            target = Target(ours)
        found[ours] = as_ours(label, ours, target, theirs[target.name], description.units, unit)
    return found


def looks_like(ours: str, variable: Declared) -> bool:
    """Whether a variable of an FMU is declared as what this one of ours is: set, or read."""
    causalities = {"output"} if ours in QUANTITIES else SETTABLE
    return variable.causality in causalities and variable.variability != "constant"


def as_ours(
    label: str, ours: str, target: Target, theirs: Declared, units: Mapping[str, Unit], unit: str
) -> Variable:
    """Return a variable of the FMU as one of ours in `unit`; `FmuError` if it cannot be that."""
    called = ours if ours == theirs.name else f"{ours} ({theirs.name!r})"
    to_set = ours not in QUANTITIES
    if theirs.causality not in (SETTABLE if to_set else READABLE) or (
        to_set and theirs.variability == "constant"
    ):
        must = "a parameter or an input" if to_set else "an output"
        declared = f"{theirs.variability} {theirs.causality}"
        raise FmuError(f"{label}: {called} must be {must}, not a {declared}")
    if theirs.type not in NUMBERS:
        raise FmuError(f"{label}: {called} is of type {theirs.type}, not a number")
    if theirs.dimensions:
        raise FmuError(f"{label}: {called} is an array; only scalars can be verified")
    name = theirs.unit if target.unit is None else target.unit
    # What a person wrote is meant as it is spelled; what the FMU declares, as it defines it.
    defined = None if name is None else units.get(name)
    meant = spelled(unit if name is None else name)
    theirs_in = (defined or meant) if target.unit is None else (meant or defined)
    expected = spelled(unit)
    if theirs_in is None:
        raise FmuError(
            f"{label}: the unit {name!r} of {called} is not known; give one in the names file: "
            f'{ours} = {{ name = "...", unit = "{unit}" }}'
        )
    if expected is None or theirs_in.dimension != expected.dimension:
        raise FmuError(
            f"{label}: {called} is in {name!r}, which is not a unit like {unit!r}; if it is "
            f'another quantity, leave it out in the names file: {ours} = ""'
        )
    change = conversion(theirs_in, target.sign)
    start = {"true": 1.0, "false": 0.0}.get(theirs.start, theirs.start)
    return Variable(
        name=ours,
        their_name=theirs.name,
        reference=theirs.valueReference,
        kind=theirs.type,
        unit=name,
        causality=theirs.causality,
        variability=theirs.variability,
        start=None if theirs.start is None else change.to_si(float(start)),
        conversion=change,
    )
