"""The catalogue of measures, read from `catalogue.toml`.

A measure is a list of moves on the keys of the axis file, with conditions on keys.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any, Final

from ..axis import AxisError
from ..axis.build import Number, as_written, values_of
from ..axis.keys import KEYS
from ..verdict import EFFORTS, Effort

Value = float | str

FILE: Final = Path(__file__).with_name("catalogue.toml")
ESTIMATE: Final = "estimate"
"""The source of a number without a source."""
_HOW: Final = ("set", "scale", "add")
OF_VERDICT: Final = ("critical_feed", "hunting.dead_band")
"""What of the verdict on an axis as it is a move may be in terms of."""


@dataclass(frozen=True)
class Move:
    """One number of an axis that a measure moves."""

    key: str
    """The key of the axis file."""
    how: str
    """Whether its number is "set", or the value is its factor ("scale") or added ("add")."""
    values: tuple[Value, ...]
    """The value at each step, SI at the slide, the mildest first; the last holds beyond."""
    source: str
    """Name of a source of the catalogue, or "estimate"."""
    of: str = ""
    """Key, or number of the verdict, that a value to be set is a multiple of; empty: none."""
    most: str = ""
    """Key whose number it must not exceed, where that is stated; empty: none."""
    range: str = ""
    """The range in which the source has it, in words."""


@dataclass(frozen=True)
class Condition:
    """What must hold of a key for a measure to apply."""

    key: str
    above: float | None = None
    below: float | None = None
    text: str = ""
    """The text of the key."""
    none_of: Sequence[str] = ()
    """Texts of the key with which it does not hold."""


@dataclass(frozen=True)
class Measure:
    """A measure against juddering."""

    id: str
    name: str
    """What is ordered or set, in words."""
    kind: str
    """What it is done to; two measures of a kind exclude each other."""
    effort: Effort
    costs: str
    """What it costs elsewhere."""
    idle: str
    """What it does not help."""
    moves: tuple[Move, ...]
    when: tuple[Condition, ...] = ()
    """What must hold, so that it applies."""
    needs: str = ""
    """What must hold and no axis file says, in words."""
    creeps: bool = False
    """Whether the feed is reached from a faster one, so that stable even motion is enough."""

    @property
    def steps(self) -> int:
        """How many steps it has."""
        return max((len(move.values) for move in self.moves), default=1)


@cache
def catalogue() -> Mapping[str, Measure]:
    """Return the measures by name."""
    return read_catalogue(FILE.read_text(encoding="utf-8"))


def sources() -> dict[str, str]:
    """Return the sources by name."""
    return dict(tomllib.loads(FILE.read_text(encoding="utf-8"))["sources"])


def read_catalogue(text: str) -> dict[str, Measure]:
    """Read measures by name from TOML; AxisError if a measure lacks a key or has a wrong one."""
    data = tomllib.loads(text)
    known = {*data.get("sources", {}), ESTIMATE}
    return {name: _measure(name, row, known) for name, row in data["measures"].items()}


def _measure(name: str, row: Mapping[str, Any], known: set[str]) -> Measure:
    place = f"measures.{name}"
    stated = dict(row)
    stated["moves"] = tuple(_moves(place, row.get("moves"), known))
    stated["when"] = tuple(_conditions(f"{place}.when", row.get("when", ())))
    _check(Measure, place, {"id": name, **stated})
    if stated["effort"] not in EFFORTS:
        _refuse(f"{place}.effort", "is no kind of effort", stated["effort"], EFFORTS)
    measure = Measure(id=name, **stated)
    if not measure.moves and not measure.creeps:
        _refuse(f"{place}.moves", "is empty: a measure moves a number", [])
    return measure


def _moves(place: str, rows: Any, known: set[str]) -> Iterator[Move]:
    if rows is None:
        _refuse(f"{place}.moves", "is missing")
    for count, row in enumerate(rows, 1):
        at, stated = f"{place}.moves[{count}]", dict(row)
        how = [name for name in _HOW if name in row]
        if len(how) != 1:
            _refuse(at, f"needs one of {', '.join(_HOW)}")
        written = stated.pop(how[0])
        _check(Move, at, {**stated, "how": how[0], "values": written})
        key, of = stated["key"], stated.get("of", "")
        for path in filter(None, (key, stated.get("most"))):
            _known(at, path, ())
        if of:
            _known(at, of, OF_VERDICT)
        if stated["source"] not in known:
            _refuse(f"{at}.source", "is no source of the catalogue", stated["source"])
        factor = how[0] == "scale" or of
        many = written if isinstance(written, list) else [written]
        values = [float(each) if factor else _value(key, at, each) for each in many]
        yield Move(how=how[0], values=tuple(values), **stated)


def _value(key: str, place: str, written: Any) -> Value:
    (value,) = values_of(KEYS[key], place, written).values()
    if not isinstance(value, Number):
        return value
    if KEYS[key].units[0] != value.unit:
        _refuse(place, f"is to be stated at the slide, in {KEYS[key].units[0]}", written)
    return value.value


def _conditions(place: str, rows: Any) -> Iterator[Condition]:
    for row in rows:
        stated = {"text" if name == "is" else name: value for name, value in row.items()}
        _check(Condition, place, stated)
        _known(place, stated["key"], ())
        yield Condition(**stated)


def _check(what: type, place: str, stated: Mapping[str, Any]) -> None:
    """Refuse a table that has not all of its keys, or others."""
    names = {field.name: field.default is MISSING for field in fields(what)}
    for name in [name for name, required in names.items() if required and name not in stated]:
        _refuse(f"{place}.{name}", "is missing")
    for name in stated.keys() - names:
        _refuse(f"{place}.{name}", "is an unknown key", stated[name], names)


def _known(place: str, path: str, others: tuple[str, ...]) -> None:
    if path not in KEYS and path not in others:
        _refuse(place, "names no key of an axis file", path)


def _refuse(key: str, reason: str, value: Any = "", choices: Any = ()) -> None:
    remedy = f"there are {', '.join(choices)}" if choices else ""
    shown = as_written(value) if value != "" else ""
    raise AxisError(reason, key=key, value=shown, remedy=remedy, name=FILE.name)
