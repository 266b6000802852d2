"""The keys of an axis file: names, units, ranges, defaults, examples and meanings.

They stand in `keys.toml` alone. The reader, its refusals, the template, the example and the table
of the documentation are made from it, as `SECTIONS` and `KEYS`.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

from stickslip_ref import COULOMB, STRIBECK
from stickslip_units import KINDS, Kind, Units, on_data_sheet

from .model import STANDARD_GRAVITY, AxisError

_OF_DRIVES: Final = (
    Kind("an inertia", "kg.m2", "60 kg cm2"),
    Kind("a torque", "N.m", "19 N m"),
    Kind("a damping at the motor", "N.m.s/rad", "2 mN m s/rad"),
    Kind("a damping at the motor", "N.m.s", "2 mN m s"),
    Kind("a rate", "1/s", "25 1/s"),
    Kind("an angular frequency or speed", "rad/s", "300 rad/s"),
    Kind("a frequency", "Hz", "400 Hz"),
    Kind("a torque constant", "N.m/A", "0.8 N m/A"),
    Kind("counts per turn", "1/turn", "1000000 counts/turn"),
    Kind("a modulus of elasticity", "N/m2", "206 kN/mm2"),
    Kind("an angle", "rad", "0.1 deg"),
    Kind("an angular acceleration", "rad/s2", "20 deg/s2"),
    Kind("a torsional stiffness", "N.m/rad", "4 MN m/rad"),
)
UNITS: Final = Units(on_data_sheet, KINDS | {kind.unit: kind for kind in _OF_DRIVES})
"""How quantities are written in an axis file."""


TURNING: Final = {
    "m": "rad", "m/s": "rad/s", "m/s2": "rad/s2", "kg": "kg.m2", "N": "N.m", "N/m": "N.m/rad",
    "N.s/m": "N.m.s/rad",
}  # fmt: skip
"""The SI unit in which a rotary table has what a slide has in another."""


@dataclass(frozen=True)
class Range:
    """The range of a number, in the SI unit in which it is stated; infinity and NaN are outside."""

    low: float = -math.inf
    strict: bool = False
    high: float = math.inf

    def __contains__(self, value: float) -> bool:
        low = value > self.low if self.strict else value >= self.low
        return low and value <= self.high and math.isfinite(value)

    def __str__(self) -> str:
        if self.high < math.inf:
            return f"from {self.low:g} to {self.high:g}"
        if self.low == -math.inf:
            return "any finite number"
        return f"{'above' if self.strict else 'at least'} {self.low:g}"


ANY: Final = Range()
ABOVE: Final = Range(0.0, strict=True)
LEAST: Final = Range(0.0)
PART: Final = Range(0.0, high=1.0)


@dataclass(frozen=True)
class Section:
    """A section of an axis file."""

    name: str
    """Its name; behind a point a table of an array, `[[drive.filter]]`."""
    meaning: str
    """What it says, in a line."""
    otherwise: str = ""
    """What is taken without it; empty: a file must have it."""
    reason: str = ""
    """Why that is taken."""

    @property
    def is_array(self) -> bool:
        """Whether there may be several."""
        return "." in self.name

    @property
    def header(self) -> str:
        """Its header in the file."""
        return f"[[{self.name}]]" if self.is_array else f"[{self.name}]"


@dataclass(frozen=True)
class Key:
    """A key of an axis file."""

    section: str
    name: str
    """Where it stands."""
    meaning: str
    """One line."""
    example: str
    """A value as it stands in a file."""
    symbol: str = ""
    """What it sets in `Axis`, by its own name there, as ``K_v``; empty: that is computed."""
    units: tuple[str, ...] = ()
    """SI units of what may be stated, the first that of the symbol; empty: it is a text."""
    within: Range = ANY
    """Range of its number."""
    spread: bool = False
    """Whether it may have a ±."""
    most: int = 1
    """How many values it may have; above 1 they are a list, or one value."""
    choices: tuple[str, ...] = ()
    """The texts that it may be; empty: any."""
    default: str = ""
    """What it is where it is not stated, as it would stand in a file; empty: see `otherwise`."""
    otherwise: str = ""
    """What is taken where it is not stated, in words."""
    reason: str = ""
    """Why that is taken; empty: nothing is assumed."""
    optional: bool = False
    """Whether it may be left out though nothing is taken in its place."""
    unless: tuple[str, ...] = ()
    """Keys that may stand in its place; those of another section with its name."""
    excludes: tuple[str, ...] = ()
    """Keys that must not stand beside it, as `unless`."""
    goes_with: tuple[str, ...] = ()
    """A key, as `unless`, and the texts of it, one of which it needs; no text: any value."""
    in_example: bool = False
    """Whether the axis of docs/feed-axis.md states it, and the template of another drive."""
    refused: Mapping[str, str] = field(default_factory=dict)
    """Texts that are no choice, and why, in words."""
    by_kind: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Fields that are others with a kind of drive, by that."""

    def of(self, kind: str) -> Key:
        """Return the key as it is with a kind of drive."""
        return replace(self, **self.by_kind[kind]) if kind in self.by_kind else self

    def fits(self, kind: str) -> bool:
        """Return whether it may be stated with a kind of drive."""
        name, *kinds = self.goes_with or ("",)
        if name == "drive.kind":
            return kind in kinds
        return not name or key_of(place(self.section, name), kind).fits(kind)

    @property
    def path(self) -> str:
        """Its name with that of its section: ``axis.mass``."""
        return f"{self.section}.{self.name}"

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The kinds of quantities that it may be."""
        return tuple(UNITS.kinds[unit] for unit in self.units)

    @property
    def bare(self) -> Kind | None:
        """What a number without a unit is."""
        return self.kinds[0] if self.units == ("1",) else None

    @property
    def required(self) -> bool:
        """Whether it must be stated, where its section and `goes_with` are."""
        return not (self.taken or self.optional)

    @property
    def expected(self) -> str:
        """What is expected, in words."""
        if self.choices:
            return f"one of {', '.join(self.marks())}"
        if not self.units:
            return "a text"
        many = {1: "", 2: "one or two values, each "}.get(self.most, "a list, each ")
        names = [kind.in_words for kind in self.kinds if kind.unit != "N.m.s"]
        if len(names) > 1 and self.units[-1] == "1":
            names[-1] = "percent of drive.rated_torque"
        within = "" if self.within == ANY else f", {self.within}"
        return f"{many}{' or '.join(names)}{within}"

    def marks(self, quote: str = "") -> list[str]:
        """Return its choices, each in quotes, or its range and ±."""
        marks = [f'{quote}"{choice}"{quote}' for choice in self.choices]
        return marks + [str(self.within)] * (self.within != ANY) + ["±"] * self.spread

    def refusal(self, path: str, reason: str, value: str = "", remedy: str = "") -> AxisError:
        """Return the refusal of what stands at a path, or of what is missing there."""
        remedy = remedy or f"write such as {self.name} = {self.example}"
        return AxisError(reason, key=path, value=value, within=self.expected, remedy=remedy)

    @property
    def needs(self) -> str:
        """What it goes with, as it stands in a file."""
        name, *texts = self.goes_with
        return " = ".join(filter(None, (name, " or ".join(f'"{text}"' for text in texts))))

    @property
    def taken(self) -> str:
        """What is taken where it is not stated, in words."""
        return self.default.strip('"') or self.otherwise


_OTHER_KINDS: Final[tuple[str, ...]] = ("belt", "rotary")
_RANGES: Final = {str(each): each for each in (ANY, ABOVE, LEAST, PART)}


def _key(path: str, row: Mapping[str, Any]) -> Key:
    section, _, name = path.rpartition(".")
    stated = _fields(row)
    kinds = {kind: _fields(stated.pop(kind)) for kind in _OTHER_KINDS if kind in stated}
    stated["within"] = _RANGES[row.get("within", str(ANY))]
    return Key(section, name, **stated | _from_code(path, row), by_kind=kinds)


def _fields(row: Mapping[str, Any]) -> dict[str, Any]:
    return {name: tuple(v) if isinstance(v, list) else v for name, v in row.items()}


def _from_code(path: str, row: Mapping[str, Any]) -> dict[str, Any]:
    """Return what of a key stands elsewhere: gravity, and the own parameters of friction laws."""
    if path == "axis.gravity":
        return {"default": f'"{STANDARD_GRAVITY} m/s2"'}
    section, _, name = path.rpartition(".")
    own = (COULOMB.parameters | STRIBECK.parameters).get(name)
    if section != "friction" or own is None or "choices" in row:
        return {}
    unit, within = own.bound.unit or "1", Range(own.bound.low, own.bound.strict)
    found = {"units": (unit,), "within": within, "spread": True}
    # Without a reason to take its default it must be stated.
    if "reason" in row:
        found["default"] = f"{own.start:g}" if unit == "1" else f'"{own.start:g} {unit}"'
    return found


_TABLES: Final = tomllib.loads(Path(__file__).with_name("keys.toml").read_text(encoding="utf-8"))
SECTIONS: Final = {name: Section(name, **row) for name, row in _TABLES["sections"].items()}
"""The sections by name, in the order of the template."""
KEYS: Final = {path: _key(path, row) for path, row in _TABLES["keys"].items()}
"""The keys by path, in the order of the template."""
BY_SECTION: Final = {
    name: {key.name: key for key in KEYS.values() if key.section == name} for name in SECTIONS
}


def place(table: str, name: str) -> str:
    """Return the path of a key in a table, or of one that is named with its section."""
    return name if "." in name else f"{table}.{name}"


def key_of(path: str, kind: str = "screw") -> Key:
    """Return the key of a name in a file, such as ``drive.filter[1].frequency``."""
    return KEYS[re.sub(r"\[\d+\]", "", path)].of(kind)
