"""From the numbers of an axis file to the axis."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from stickslip_ref import Shape, friction_law

from ..curve_file import Curve, CurveError, read_curve
from .keys import BY_PATH, BY_SECTION, SECTIONS, Key
from .model import Assumed, Axis, Demand, Drive, Filter, Friction, low_pass, notch
from .refusal import AxisError
from .values import Number, Value, values_of

_AT_MOTOR: Final = {"N.m": 1, "kg.m2": 2, "N.m.s/rad": 2, "N.m.s": 2}
"""How often a turn over its way takes what is stated at the motor to the slide."""


class Builder:
    """The axis of a file.

    Parameters
    ----------
    name
        Name of the axis where the file gives none.
    values
        What the file states, by name.
    sections
        The sections that the file has; of an array of tables ``drive.filter[1]`` and so on.
    folder
        Where the file of a measured curve is looked for.
    """

    def __init__(
        self, name: str, values: Mapping[str, Value], sections: tuple[str, ...], folder: Path
    ) -> None:
        self._name, self._values, self._sections, self._folder = name, values, sections, folder
        self._assumed: list[Assumed] = []

    def axis(self, *, capped: bool = False) -> Axis:
        """Return the axis.

        Parameters
        ----------
        capped
            Whether a kinetic friction above the static one is taken as that, and not refused: the
            ± of two numbers may overlap.

        Raises
        ------
        AxisError
            If something is missing, or values do not go together.
        """
        self._assumed = list(self._unstated())
        stiffness = [self._number(path) for path in self._paths("axis.stiffness")]
        if len(stiffness) == 1:
            only = Assumed("axis.stiffness", "the same along the screw", "one value is stated")
            self._assumed.append(only)
        numbers = self._fields("axis", ("m", "g", "load", "along", "c"))
        k, m = _least(*stiffness), numbers["m"]
        if "axis.zeta" in self._values:
            numbers["c"] = 2.0 * self._number("axis.zeta") * _plain(np.sqrt(k * m))
        weight = m * numbers["g"]
        normal = weight + numbers["load"]
        holds = np.atleast_1d((normal > 0.0) & (normal < math.inf))
        if not holds.all():
            lifted = float(np.broadcast_to(weight, holds.shape)[int(np.argmin(holds))])
            raise AxisError(
                f"lifts the table off its guideway: mass times gravity is {lifted:.6g} N",
                key="axis.load",
                within=f"above {-lifted:.6g} N", remedy="correct load, mass or gravity",
            )  # fmt: skip
        axis = Axis(
            name=self._text("axis.name") or self._name, k=k, **numbers,
            friction=self._friction(normal, capped=capped), drive=self._drive(),
            demand=Demand(
                feeds=tuple(sorted(self._number(path) for path in self._paths("demand.feeds"))),
                **self._fields("demand", ("acceleration", "largest_jump", "largest_error")),
            ),
            stiffest=-_least(*(-each for each in stiffness)) if len(stiffness) > 1 else None,
            spread={
                path: value.spread
                for path, value in self._values.items()
                if isinstance(value, Number) and value.spread
            },
            assumed=tuple(self._assumed),
        )  # fmt: skip
        self._check(axis)
        return axis

    def _friction(self, normal: float, *, capped: bool) -> Friction:
        """Return the friction under a normal force [N]."""
        law, own, curve = self._law, self._own(), self._curve(normal)
        mu = {name: self._coefficient(name, normal) for name in ("s", "k")}
        if curve is not None:
            own |= curve.parameters
            mu["k"] = min(curve.coefficients)
            reason = "the least of the curve, for studies with a constant kinetic friction"
            self._assumed.append(Assumed("friction.mu_k", f"{mu['k']:.4g}", reason))
            if mu["s"] is None:
                mu["s"] = curve.coefficients[0]
                reason = "the friction of the curve at speed 0"
                self._assumed.append(Assumed("friction.mu_s", f"{mu['s']:.4g}", reason))
        mu_s, mu_k = mu["s"], mu["k"]
        assert mu_s is not None
        assert mu_k is not None
        above = mu_k > mu_s
        if not capped and curve is None and above:
            stated = "mu_k" if "friction.mu_k" in self._values else "F_k"
            most = f"{mu_s:g}" if stated == "mu_k" else f"{mu_s * normal:.6g} N at the slide"
            raise AxisError(
                "is above static friction", key=f"friction.{stated}", within=f"at most {most}",
                remedy="exchange the two if they are mixed up",
            )  # fmt: skip
        return Friction(
            mu_s=mu_s, mu_k=_least(mu_k, mu_s), law=law, own=own,
            in_newtons="friction.F_s" in self._values, capped=above,
        )  # fmt: skip

    def _coefficient(self, which: str, normal: float) -> float | None:
        if f"friction.mu_{which}" in self._values:
            return self._number(f"friction.mu_{which}")
        path = f"friction.F_{which}"
        if path not in self._values:
            return None
        return self._at_slide(path) / normal

    def _own(self) -> dict[str, float]:
        """Return what is stated of the friction law's own parameters."""
        names = friction_law(self._law).parameters
        own = {
            name: self._number(f"friction.{name}")
            for name in names
            if isinstance(self._values.get(f"friction.{name}"), Number)
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
        if "drive" not in self._sections or self._text("drive.kind") == "rigid":
            return None
        names = (
            "inertia d dry K_v bandwidth T_n T_s lag dead_time velocity_feedforward "
            "friction_feedforward dead_band F_max resolution_motor resolution_table pitch"
        )
        numbers = self._fields("drive", tuple(names.split()))
        if "bandwidth" not in numbers:
            numbers["bandwidth"] = self._at_slide("drive.velocity_gain") / numbers["inertia"]
        numbers.setdefault("T_n", 4.0 / numbers["bandwidth"])
        return Drive(
            **numbers, on_table=self._text("drive.position") != "motor",
            filters=tuple(self._filter(each, numbers["T_s"]) for each in self._sections
                          if each.startswith("drive.filter")),
        )  # fmt: skip

    def _filter(self, path: str, T_s: float) -> Filter:
        frequency = self._number(f"{path}.frequency")
        if not frequency < 0.5 / T_s:
            raise AxisError(
                "is out of range", key=f"{path}.frequency",
                within=f"below {0.5 / T_s:g} Hz, half the sampling frequency",
                remedy="leave the filter out, or shorten drive.sample_time",
            )  # fmt: skip
        has_damping = f"{path}.damping" in self._values
        if self._text(f"{path}.kind") == "low pass":
            if has_damping:
                return low_pass(frequency, self._number(f"{path}.damping"))
            self._assumed.append(Assumed(f"{path}.damping", "first order", "none is stated"))
            return low_pass(frequency)
        if not has_damping and f"{path}.width" not in self._values:
            raise _missing(
                BY_PATH["drive.filter.damping"], f"{path}.damping", ", or width in its place"
            )
        damping = (
            self._number(f"{path}.damping")
            if has_damping
            else self._number(f"{path}.width") / (2.0 * frequency)
        )
        return notch(frequency, damping, self._number(f"{path}.leaves"))

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

    def _fields(self, section: str, fields: tuple[str, ...]) -> dict[str, float]:
        """Return the numbers of fields of a section that are stated or have a default, by field."""
        names = {key.symbol: key for key in BY_SECTION[section].values()}
        return {
            name: self._at_slide(names[name].path)
            for name in fields
            if names[name].path in self._values or names[name].default
        }

    def _at_slide(self, path: str) -> float:
        """Return a number, of what is stated at the motor as it is seen at the slide."""
        number = self._at(path)
        value = number.value
        if BY_PATH[path].units[0] == number.unit:
            return value
        if number.unit == "1/turn":
            return self._number("drive.pitch") / value
        if number.unit == "1":
            # Not in place: the value may be an array, which is the caller's.
            value = value * self._needed("drive.rated_torque", path)
        if number.unit in {"1/s", "rad/s"}:
            return value
        per_metre = 2.0 * math.pi / self._needed("drive.pitch", path)
        for _ in range(_AT_MOTOR.get(number.unit, 1)):
            value = value * per_metre
        if not np.all(np.isfinite(value)):
            raise AxisError("is larger than a double can hold at the slide", key=path)
        return value

    def _needed(self, path: str, by: str) -> float:
        if path not in self._values:
            raise _missing(BY_PATH[path], path, f"; {by} is stated in terms of it")
        return self._number(path)

    def _number(self, path: str) -> float:
        return self._at(path).value

    def _at(self, path: str) -> Number:
        """Return a number, its default where it is not stated."""
        number = self._values.get(path)
        if number is None:
            key = key_of(path)
            number = values_of(key, path, json.loads(key.default))[path]
        assert isinstance(number, Number)
        return number

    def _text(self, path: str) -> str:
        text = self._values.get(path, "")
        assert isinstance(text, str)
        return text

    def _paths(self, path: str) -> list[str]:
        """Return the names of the values of a key that may be a list."""
        return [each for each in self._values if each.partition("[")[0] == path]

    @property
    def _law(self) -> str:
        default = "stribeck" if "friction.curve" in self._values else "coulomb"
        return self._text("friction.law") or default

    def _unstated(self) -> Iterator[Assumed]:
        """Yield what is not stated; raises AxisError where it must be, or must not."""
        for section in SECTIONS:
            here = [each for each in self._sections if each.partition("[")[0] == section.name]
            if not here and section.name == "drive.filter" and not self._is_servo:
                continue
            if not here:
                if section.required:
                    raise AxisError(
                        "is missing", key=section.name, remedy=f"write a section {section.header}"
                    )
                yield Assumed(section.name, section.otherwise, section.reason)
            elif section.name == "drive" and not self._is_servo:
                yield Assumed("drive", section.otherwise, 'drive.kind is "rigid"')
                yield from self._unstated_of("drive", ("pitch", "rated_torque"))
            for table in here if section.name != "drive" or self._is_servo else ():
                yield from self._unstated_of(table, tuple(BY_SECTION[section.name]))

    @property
    def _is_servo(self) -> bool:
        return "drive" in self._sections and self._text("drive.kind") != "rigid"

    def _unstated_of(self, table: str, names: tuple[str, ...]) -> Iterator[Assumed]:
        for name in names:
            key, path = BY_PATH[f"{table.partition('[')[0]}.{name}"], f"{table}.{name}"
            stated = {each for each in BY_SECTION[key.section] if self._paths_in(table, each)}
            goes = self._goes(key, table)
            if name in stated:
                if not goes:
                    remedy = f"state {key.needs}, or leave {name} out"
                    raise AxisError(f"goes with {key.needs} only", key=path, remedy=remedy)
                beside = [each for each in key.excludes if each in stated]
                if beside:
                    raise AxisError(
                        f"stands beside {beside[0]}, which says the same", key=path,
                        remedy=f"leave {name} or {beside[0]} out",
                    )  # fmt: skip
            elif goes and not stated & {*key.unless, *key.excludes}:
                if key.required:
                    others = " or ".join(key.unless)
                    raise _missing(key, path, f", or {others} in its place" if others else "")
                if key.reason:
                    yield Assumed(path, key.taken, key.reason)

    def _goes(self, key: Key, table: str) -> bool:
        """Return whether a key has what it goes with."""
        if not key.goes_with:
            return True
        name, *texts = key.goes_with
        if not texts:
            return bool(self._paths_in(table, name))
        path = f"{table}.{name}"
        return (self._law if path == "friction.law" else self._text(path)) in texts

    def _paths_in(self, table: str, name: str) -> bool:
        path = f"{table}.{name}"
        return path in self._values or f"{path}[1]" in self._values


def _least(first: Any, *others: Any) -> Any:
    """Return the least of some numbers; of arrays the least of each point."""
    for each in others:
        first = _plain(np.minimum(first, each))
    return first


def _plain(value: Any) -> Any:
    """Return a result of NumPy, as a plain float where it is one number."""
    return value if np.ndim(value) else float(value)


def key_of(path: str) -> Key:
    """Return the key of a name in a file; its places in lists are left out."""
    parts = [part.partition("[")[0] for part in path.split(".")]
    return BY_PATH[".".join(parts)]


def _missing(key: Key, path: str, others: str) -> AxisError:
    return AxisError(
        f"is missing{others}", key=path, within=key.expected,
        remedy=f"write such as {key.name} = {key.example}",
    )  # fmt: skip
