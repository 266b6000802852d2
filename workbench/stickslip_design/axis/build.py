"""From what an axis file states, numbers with unit and ± and texts, to the axis."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from stickslip_ref import Shape, friction_law
from stickslip_units import QuantityError, parts_of

from .curve_file import Curve, CurveError, read_curve
from .keys import BY_SECTION, SECTIONS, UNITS, Key, key_of, place
from .kinds import stiffnesses, way
from .model import Assumed, Axis, AxisError, Demand, Drive, Filter, Friction


class Number(NamedTuple):
    """A number of an axis file: in which SI unit it is stated, and its ± in that unit."""

    value: float
    unit: str
    spread: float = 0.0


Value = Number | str

_LONGEST: Final = 80
"""Characters of a value that a refusal shows."""
_SPREAD: Final = re.compile(r"±|\+/-|\+-")


def values_of(key: Key, path: str, written: Any) -> dict[str, Value]:
    """Read what TOML says that stands at a path: by name the value.

    The values of a list are ``demand.feeds[1]`` and so on. AxisError if they are not allowed there.
    """
    if not (isinstance(written, list) and key.most > 1):
        return {path: _value(key, path, written)}
    if not 1 <= len(written) <= key.most:
        raise key.refusal(path, f"has {len(written)} values", as_written(written))
    places = {f"{path}[{place}]": each for place, each in enumerate(written, 1)}
    return {place: _value(key, place, each) for place, each in places.items()}


def as_written(value: Any) -> str:
    """Return a value of TOML as a person wrote it."""
    if isinstance(value, dict):
        return "{...}"
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _value(key: Key, path: str, written: Any) -> Value:
    shown, remedy = as_written(written), ""
    if key.units:
        return _number(key, path, written)
    if not isinstance(written, str) or not written.strip():
        raise key.refusal(path, "is not a text", shown)
    if written.lower() in key.refused:
        raise AxisError(key.refused[written.lower()], key=path, value=shown)
    if key.choices and written not in key.choices:
        for near in get_close_matches(written.lower(), key.choices, 1, 0.5):
            remedy = f'"{near}" is the nearest'
        raise key.refusal(path, "is none of the choices", shown, remedy)
    return written


def _number(key: Key, path: str, written: Any) -> Number:
    shown = as_written(written)
    if isinstance(written, bool) or not isinstance(written, int | float | str):
        raise key.refusal(path, "is not a number with a unit", shown)
    if not isinstance(written, str) and key.bare is None:
        unit = parts_of(key.example.split('"')[1])[1]
        remedy = f'write the unit, such as {key.name} = "{written} {unit}"'
        raise key.refusal(path, "has no unit", shown, remedy)
    try:
        number = _with_spread(key, written if isinstance(written, str) else repr(written))
    except QuantityError as error:
        raise key.refusal(path, str(error), shown) from None
    if number.value not in key.within:
        raise key.refusal(path, "is out of range", shown)
    if not all(number.value + side * number.spread in key.within for side in (-1.0, 1.0)):
        raise key.refusal(path, "is out of range with its ±", shown)
    return number


def _with_spread(key: Key, text: str) -> Number:
    parts = _SPREAD.split(text)
    if len(parts) == 1:
        value, kind = UNITS.read(text, key.kinds, key.bare)
        return Number(value, kind.unit)
    if not key.spread:
        raise QuantityError("has a ±, which is not allowed here")
    if len(parts) > 2:
        raise QuantityError("has more than one ±")
    (number, unit), (around, unit_around) = map(parts_of, parts)
    if unit_around == "%" != unit:
        value, kind = UNITS.read(parts[0], key.kinds, key.bare)
        spread = abs(value) * UNITS.read(around + "%", (UNITS.kinds["1"],), None)[0]
    else:
        value, kind = UNITS.read(f"{number} {unit or unit_around}", key.kinds, key.bare)
        spread, _ = UNITS.read(f"{around} {unit_around or unit}", (kind,), key.bare)
    if math.copysign(1.0, spread) < 0.0:
        raise QuantityError("has a negative ±")
    return Number(value, kind.unit, spread)


_AT_MOTOR: Final = {"N.m": 1, "kg.m2": 2, "N.m.s/rad": 2, "N.m.s": 2}
"""How often a turn over its way takes what is stated at the motor to the slide."""


class Builder:
    """The axis of a file, from its values by name and the places of its sections.

    Its name is `name` where it states none; a measured curve is looked for in `folder`.
    """

    def __init__(
        self, name: str, values: Mapping[str, Value], sections: tuple[str, ...], folder: Path
    ) -> None:
        self._name, self._sections, self._folder, self._stated = name, sections, folder, values
        self._keys = {re.sub(r"\[\d+\]$", "", path) for path in values}
        self._kind = str(values.get("drive.kind", "screw")) if "drive" in sections else "rigid"
        self._is_servo, self._turns = self._kind != "rigid", self._kind == "rotary"
        self._symbol = "T" if self._turns else "F"
        by_default = "stribeck" if "friction.curve" in values else "coulomb"
        self._law = str(values.get("friction.law", by_default))
        # What is stated, and defaults.
        self._values = dict(values)
        self._assumed: list[Assumed] = []

    def axis(self, *, capped: bool = False) -> Axis:
        """Return the axis; AxisError if something is missing, or values do not go together.

        If `capped`, a kinetic friction above the static one is taken as that, and not refused: the
        ± of two numbers may overlap.
        """
        self._complete()
        stiffness = self._stiffness()
        if len(stiffness) == 1:
            self._assume("axis.stiffness", "the same along the travel", "one value is stated")
        numbers = self._fields("axis") | {"k": _least(*stiffness)}
        if self._turns:
            numbers |= self._pressed(numbers["m"])
        if "axis.zeta" in self._values:
            critical = 2.0 * self._number("axis.zeta")
            numbers["c"] = critical * _plain(np.sqrt(numbers["k"] * numbers["m"]))
        weight = numbers["m"] * numbers["g"]
        normal = weight + numbers["load"]
        holds = np.atleast_1d((normal > 0.0) & (normal < math.inf))
        if not holds.all():
            lifted = float(np.broadcast_to(weight, holds.shape)[int(np.argmin(holds))])
            lifted /= self._number("friction.radius") if "friction.radius" in self._values else 1.0
            raise AxisError(
                f"lifts the table off its guideway: mass times gravity is {lifted:.6g} N",
                key="axis.load",
                within=f"above {-lifted:.6g} N", remedy="correct load, mass or gravity",
            )  # fmt: skip
        feeds = tuple(sorted(self._number(path) for path in self._paths("demand.feeds")))
        spread = {
            path: value.spread
            for path, value in self._stated.items()
            if isinstance(value, Number) and value.spread
        }
        axis = Axis(
            **numbers, name=self._text("axis.name") or self._name,
            friction=self._friction(normal, capped=capped), drive=self._drive(),
            demand=Demand(**self._fields("demand") | {"feeds": feeds}), spread=spread,
            stiffest=-_least(*(-k for k in stiffness)) if len(stiffness) > 1 else None,
            assumed=tuple(self._assumed), limits=dict(self._limits()),
            without=tuple(self._text(path) for path in self._paths("limits.without")),
        )  # fmt: skip
        self._check(axis)
        # The ± of a number may lead beyond.
        if not capped:
            for name, now in axis.beyond_limits():
                (key,) = (key for key in self._keys_of("limits") if key.symbol == name)
                present = f"the present value, {now:.6g} {key.units[0]}"
                reason = f"excludes {present}" if now == now else "limits a rigid drive"
                raise AxisError(reason, key=key.path, remedy="correct it, or leave it out")
        return axis

    def _stiffness(self) -> list[float]:
        """Return the stiffness that is stated, or that of screw or belt at places of the travel."""
        stated = [self._number(path) for path in self._paths("axis.stiffness")]
        name = "drive.strand" if self._kind == "belt" else "drive.free_length"
        lengths = [self._number(path) for path in self._paths(name)]
        return stated or stiffnesses(self._of_drive(), lengths, name)

    def _of_drive(self) -> dict[str, float]:
        """Return the numbers of the drive by the names of their keys."""
        numbers = ((each, self._values[each]) for each in self._values if each[:6] == "drive.")
        return {path[6:]: each.value for path, each in numbers if isinstance(each, Number)}

    def _pressed(self, inertia: float) -> dict[str, float]:
        """Return g and load of a table that turns, as m g + load is what mu_s is a part of [N.m].

        Where torques are stated that is 1 N m.
        """
        if "friction.radius" not in self._values:
            return {"g": 1.0 / inertia, "load": 0.0}
        radius, mass = self._number("friction.radius"), self._number("axis.mass")
        gravity, load = self._number("axis.gravity"), self._number("axis.load")
        return {"g": mass * gravity * radius / inertia, "load": load * radius}

    def _friction(self, normal: float, *, capped: bool) -> Friction:
        """Return the friction under a normal force [N]."""
        own, curve = self._own(), self._curve(normal)
        mu_s, mu_k = (self._coefficient(name, normal) for name in "sk")
        if curve is not None:
            own |= curve.parameters
            mu_k = min(curve.coefficients)
            reason = "the least of the curve, for studies with a constant kinetic friction"
            self._assume("friction.mu_k", f"{mu_k:.4g}", reason)
            if mu_s is None:
                mu_s, reason = curve.coefficients[0], "the friction of the curve at speed 0"
                self._assume("friction.mu_s", f"{mu_s:.4g}", reason)
        assert mu_s is not None
        assert mu_k is not None
        above, way = mu_k > mu_s, self._values.get("friction.presliding")
        if not capped and curve is None and above:
            stated = "mu_k" if "friction.mu_k" in self._values else f"{self._symbol}_k"
            unit = "N m at the table" if self._turns else "N at the slide"
            most = f"{mu_s:g}" if stated == "mu_k" else f"{mu_s * normal:.6g} {unit}"
            raise AxisError(
                "is above static friction", key=f"friction.{stated}", within=f"at most {most}",
                remedy="exchange the two if they are mixed up",
            )  # fmt: skip
        return Friction(
            mu_s=mu_s, mu_k=_least(mu_k, mu_s), law=self._law, own=own,
            in_newtons=f"friction.{self._symbol}_s" in self._values, capped=above,
            presliding=way.value if isinstance(way, Number) else 0.0,
        )  # fmt: skip

    def _coefficient(self, which: str, normal: float) -> float | None:
        if f"friction.mu_{which}" in self._values:
            return self._number(f"friction.mu_{which}")
        force = f"friction.{self._symbol}_{which}"
        return self._at_slide(force) / normal if force in self._values else None

    def _own(self) -> dict[str, float]:
        """Return what is stated of the friction law's own parameters."""
        own = {
            name: number.value
            for name in friction_law(self._law).parameters
            if isinstance(number := self._stated.get(f"friction.{name}"), Number)
        }
        if self._law == "stribeck":
            own["shape"] = float(Shape[(self._text("friction.shape") or "stribeck").upper()])
        return own

    def _curve(self, normal: float) -> Curve | None:
        file = self._text("friction.curve")
        if not file:
            return None
        try:
            return read_curve(self._folder / file, normal)
        except CurveError as error:
            raise AxisError(f"is no friction curve: {error}", key="friction.curve") from None

    def _drive(self) -> Drive | None:
        if not self._is_servo:
            return None
        numbers = self._fields("drive") | {"pitch": self._way("drive"), "kind": self._kind}
        if "bandwidth" not in numbers:
            numbers["bandwidth"] = self._at_slide("drive.velocity_gain") / numbers["inertia"]
        numbers.setdefault("T_n", 4.0 / numbers["bandwidth"])
        filters = [
            self._filter(section, numbers["T_s"])
            for section in self._sections
            if section.startswith("drive.filter")
        ]
        if "drive.rated_torque" in self._values:
            numbers["rated_torque"] = self._number("drive.rated_torque")
        on_table = self._text("drive.position") == "table"
        return Drive(**numbers, on_table=on_table, filters=tuple(filters))

    def _filter(self, path: str, T_s: float) -> Filter:
        frequency = self._number(f"{path}.frequency")
        if not frequency < 0.5 / T_s:
            raise AxisError(
                "is out of range", key=f"{path}.frequency",
                within=f"below {0.5 / T_s:g} Hz, half the sampling frequency",
                remedy="leave the filter out, or shorten drive.sample_time",
            )  # fmt: skip
        damping, kind = math.inf, self._text(f"{path}.kind")
        if f"{path}.damping" in self._values:
            damping = self._number(f"{path}.damping")
        elif f"{path}.width" in self._values:
            damping = self._number(f"{path}.width") / (2.0 * frequency)
        elif kind == "notch":
            path = f"{path}.damping"
            raise key_of(path).refusal(path, "is missing, or width in its place")
        else:
            self._assume(f"{path}.damping", "first order", "none is stated")
        depth = self._number(f"{path}.leaves") if kind == "notch" else 0.0
        return Filter(kind, frequency, damping, depth)

    def _check(self, axis: Axis) -> None:
        """Refuse what is beyond the numbers of a computer, or not for the friction law."""
        try:
            friction_law(axis.friction.law).complete(axis.block(1.0), axis.friction.own)
            drive = axis.drive
            if drive and not 0.0 < drive.inertia * drive.bandwidth < math.inf:
                raise ValueError("inertia and bandwidth are out of range together")
        except ValueError as error:
            if "friction.curve" in self._values:
                reason = f"does not go with the other numbers: {error}"
                raise AxisError(reason, key="friction.curve") from None
            raise AxisError(f"has numbers that do not go together: {error}", key="axis") from None

    def _limits(self) -> Iterator[tuple[str, tuple[float, float]]]:
        """Yield what the section of limits states."""
        for key in self._keys_of("limits"):
            ends = [self._number(path) for path in self._paths(key.path) if key.units]
            if len(ends) == 1 or ends != sorted(ends):
                within = "two values, the lowest and the highest"
                raise AxisError("is no range", key=key.path, within=within)
            if ends:
                yield key.symbol, (ends[0], ends[1])

    def _fields(self, section: str) -> dict[str, Any]:
        """Return the numbers of a section that are stated or have a default, by symbol."""
        return {
            key.symbol: self._at_slide(path)
            for key in self._keys_of(section)
            if key.symbol and isinstance(self._values.get(path := key.path), Number)
        }

    def _at_slide(self, path: str) -> float:
        """Return a number, of what is stated at the motor as it is seen at the slide."""
        value, unit, _ = self._stated_number(path)
        usual = key_of(path, self._kind).units[0]
        # Of a table that turns both sides of the gear have torques: the drive's are at the motor.
        at_motor = unit != usual or (self._turns and path.startswith("drive."))
        if unit == "1/turn":
            return self._way(path) / value
        if unit == "1" != usual:
            # Not in place: the value may be an array, which is the caller's.
            value = value * self._needed("drive.rated_torque", path)
        elif not (at_motor and unit in _AT_MOTOR):
            return value
        per_metre = 2.0 * math.pi / self._way(path)
        for _ in range(_AT_MOTOR.get(unit, 1)):
            value = value * per_metre
        if not np.all(np.isfinite(value)):
            raise AxisError("is larger than a double can hold at the slide", key=path)
        return value

    def _way(self, by: str) -> float:
        """Return the way of the table in a turn of the motor [m; rad]."""
        found = way(self._kind, self._of_drive())
        return self._needed("drive.pitch", by) if found is None else found

    def _needed(self, path: str, by: str) -> float:
        if path not in self._values:
            raise key_of(path).refusal(path, f"is missing; {by} is stated in terms of it")
        return self._number(path)

    def _keys_of(self, section: str) -> list[Key]:
        """Return the keys of a section, as they are with the kind of drive."""
        return [key.of(self._kind) for key in BY_SECTION[section].values()]

    def _stated_number(self, path: str) -> Number:
        number = self._values[path]
        assert isinstance(number, Number)
        return number

    def _number(self, path: str) -> float:
        return self._stated_number(path).value

    def _text(self, path: str) -> str:
        return str(self._values.get(path, ""))

    def _paths(self, path: str) -> list[str]:
        """Return the names of the values of a key that may be a list."""
        return [each for each in self._values if each.partition("[")[0] == path]

    def _assume(self, path: str, value: str, reason: str) -> None:
        self._assumed.append(Assumed(path, value, reason))

    def _complete(self) -> None:
        """Take what is not stated; raises AxisError where it must be, or must not."""
        for section in SECTIONS.values():
            tables = [each for each in self._sections if each.partition("[")[0] == section.name]
            keys = self._keys_of(section.name)
            if section.name == "drive" and tables and not self._is_servo:
                self._assume("drive", section.otherwise, 'drive.kind is "rigid"')
                keys = [key for key in keys if key.name in {"pitch", "rated_torque"}]
            elif not tables and not section.otherwise:
                remedy = f"write a section {section.header}"
                raise AxisError("is missing", key=section.name, remedy=remedy)
            elif not tables and (self._is_servo or not section.is_array):
                self._assume(section.name, section.otherwise, section.reason)
            for table in tables:
                # What must not be stated comes before what is missing.
                for key in sorted(keys, key=lambda each: f"{table}.{each.name}" not in self._keys):
                    self._complete_key(table, key)

    def _complete_key(self, table: str, key: Key) -> None:
        path = f"{table}.{key.name}"
        goes = self._goes(key, table)
        excludes, unless = (
            [each for each in names if key_of(place(table, each), self._kind).fits(self._kind)]
            for names in (key.excludes, key.unless)
        )
        beside = [each for each in excludes if place(table, each) in self._keys]
        others = [each for each in unless if place(table, each) in self._keys]
        if path in self._keys:
            if not goes:
                remedy = f"state {key.needs}, or leave {key.name} out"
                raise AxisError(f"goes with {key.needs} only", key=path, remedy=remedy)
            if beside:
                raise AxisError(
                    f"stands beside {beside[0]}, which says the same", key=path,
                    remedy=f"leave {key.name} or {beside[0]} out",
                )  # fmt: skip
        elif goes and not beside and not others:
            if key.required:
                instead = f", or {' or '.join(unless)} in its place" if unless else ""
                raise key.refusal(path, f"is missing{instead}")
            if key.default:
                self._values |= values_of(key, path, json.loads(key.default))
            if key.reason:
                self._assume(path, key.taken, key.reason)

    def _goes(self, key: Key, table: str) -> bool:
        """Return whether a key has what it goes with."""
        name, *texts = key.goes_with or ("",)
        path = place(table, name)
        if not texts:
            return not name or path in self._keys
        chosen = {"friction.law": self._law, "drive.kind": self._kind}
        return chosen.get(path, self._text(path)) in texts


def _least(first: Any, *others: Any) -> Any:
    """Return the least of some numbers; of arrays the least of each point."""
    for other in others:
        first = _plain(np.minimum(first, other))
    return first


def _plain(value: Any) -> Any:
    """Return a result of NumPy, as a plain float where it is one number."""
    return value if np.ndim(value) else float(value)
