"""The map from our names to those of a foreign FMU, and the file it is read from."""

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator
from pydantic.dataclasses import dataclass as model

from stickslip_verification.model.data_file import WRITTEN, DataError, DataFile, Written
from stickslip_verification.model.quantities import OUTPUT_NAMES, QUANTITIES
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
    """What one of our variables is in the FMU.

    Attributes
    ----------
    name
        The FMU's name for it, or `NOT_THERE`.
    unit
        The unit of its numbers, against whatever the FMU declares; None believes the FMU.
    sign
        -1 if it counts the other way.
    """

    name: str
    unit: str | None = None
    sign: Literal[1, -1] = 1


@dataclass(frozen=True)
class NameMap:
    """Our names to those of the FMU; what is not in it is called as ours is.

    ``file`` is where it was read from, for messages and reports.
    """

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
