"""The map from our names to those of a foreign FMU, and the file it is read from."""

import difflib
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stickslip_verification.model.data_file import DataError, read_text
from stickslip_verification.model.quantities import OUTPUT_NAMES, QUANTITIES
from stickslip_verification.truth.parameters import PARAMETERS, Parameter

INPUT_UNITS: Mapping[str, str] = {each.name: each.unit for each in PARAMETERS}
"""What the suite sets, parameters and inputs, with its unit."""

UNITS: Mapping[str, str] = {**INPUT_UNITS, **{name: QUANTITIES[name].unit for name in OUTPUT_NAMES}}
"""Every variable of the suite with its SI unit."""

NOT_THERE = ""
"""In place of the FMU's name: the FMU has no such variable, whatever its names look like."""


class NamesError(DataError):
    """A names file cannot be used; one line with the file, the place and the reason."""


@dataclass(frozen=True)
class Target:
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
    sign: int = 1


@dataclass(frozen=True)
class NameMap:
    """Our names to those of the FMU; what is not in it is called as ours is.

    ``file`` is where it was read from, for messages and reports.
    """

    targets: Mapping[str, Target] = field(default_factory=dict)
    file: Path | None = None


def load_names(file: Path, own: Iterable[Parameter] = ()) -> NameMap:
    """Read a names file: ``x = "mass.s"`` or ``x = { name = "mass.s", unit = "mm", sign = -1 }``.

    The entries stand at the top of the file or in a table ``[names]``. An empty name says that the
    FMU has no such variable.

    Parameters
    ----------
    file
        The TOML file.
    own
        Parameters of a friction law, which it may name beside the variables of the suite.

    Raises
    ------
    NamesError
        The file cannot be read, is not TOML, or holds something that is no entry.
    """
    text = read_text(file, NamesError)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise NamesError(file, *_place_and_reason(text, str(error))) from None
    entries = data
    if isinstance(data.get("names"), dict):
        entries = data["names"]
        for key in (key for key in data if key != "names"):
            raise NamesError(file, _line(text, key), f"{key!r} stands beside the table [names]")
    known = {*UNITS, *(each.name for each in own)}
    targets: dict[str, Target] = {}
    for key, value in entries.items():
        where = _line(text, key)
        if key not in known:
            raise NamesError(file, where, f"{key!r} is no variable of the suite; {_nearest(key)}")
        target = _target(file, where, key, value)
        taken = [ours for ours, other in targets.items() if other.name == target.name != NOT_THERE]
        if taken:
            reason = f"{key} and {taken[0]} are both {target.name!r}"
            raise NamesError(file, where, reason)
        targets[key] = target
    if not targets:
        raise NamesError(file, "", "names no variable")
    return NameMap(targets, file)


def _target(file: Path, where: str, key: str, value: Any) -> Target:
    if isinstance(value, str):
        return Target(value)
    if not isinstance(value, dict):
        reason = f"{key} is {value!r}; it takes a name or {{ name, unit, sign }}"
        raise NamesError(file, where, reason)
    for inner in value:
        if inner not in {"name", "unit", "sign"}:
            reason = f"{key} has an unknown key {inner!r}; there are name, unit, sign"
            raise NamesError(file, where, reason)
    name, unit, sign = value.get("name", key), value.get("unit"), value.get("sign", 1)
    if not isinstance(name, str):
        raise NamesError(file, where, f"{key}.name is {name!r}, not a text")
    if unit is not None and not isinstance(unit, str):
        raise NamesError(file, where, f"{key}.unit is {unit!r}, not a text")
    if isinstance(sign, bool) or sign not in (1, -1):
        raise NamesError(file, where, f"{key}.sign is {sign!r}, not 1 or -1")
    return Target(name, unit, int(sign))


def _nearest(key: str) -> str:
    near = difflib.get_close_matches(key, UNITS, n=3, cutoff=0.5)
    # Names of one or two letters resemble nothing; the other case of a letter is the usual slip.
    near += [name for name in UNITS if name.lower() == key.lower() and name not in near]
    return f"near it: {', '.join(near)}" if near else f"there are {', '.join(UNITS)}"


def _line(text: str, key: str) -> str:
    quoted = rf"[\"']?{re.escape(key)}[\"']?"
    place = re.search(rf"(?m)^[ \t]*(?:{quoted}[ \t]*[=.]|\[(?:names\.)?{quoted}[\].])", text)
    return f"line {text.count(chr(10), 0, place.start()) + 1}" if place else ""


def _place_and_reason(text: str, message: str) -> tuple[str, str]:
    place = re.search(r" \(at (?:(line \d+)[^)]*|end of document)\)$", message)
    if place is None:
        return "", message
    return place[1] or f"line {text.rstrip().count(chr(10)) + 1}", message[: place.start()]
