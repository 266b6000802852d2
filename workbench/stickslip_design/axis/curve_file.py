"""Measured friction curves: a CSV file of speed and friction, as parameters of the friction law.

The file has one header line that names its columns with their units, and 2 to 12 rows with rising
speeds, of one direction of motion:

    speed [mm/s], mu
    0, 0.42
    5, 0.31
    50, 0.27

In place of `mu` a column `force [N]` goes with the normal force under which it was measured. A
speed or force without a unit, in the header or behind the number, is refused.
"""

import csv
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

from stickslip_units import QuantityError, parts_of, typed

SPEEDS: Final = ("speed", "velocity", "v", "u", "x_dot")
COEFFICIENTS: Final = ("mu", "coefficient", "friction_coefficient", "cof")
FORCES: Final = ("force", "friction", "friction_force", "f")
"""Names of the columns, in small letters."""

MOST_POINTS: Final = 12
CURVE: Final = 3
"""The value of the parameter `shape` of the friction law under which it is a curve."""

_HEADING: Final = re.compile(r"(?P<name>.*?)\s*(?:[\[(](?P<unit>[^\])]*)[\])])?")
_DECIMAL_COMMA: Final = re.compile(r"^([+-]?\d+),(\d)")
_REMEDY: Final = (
    "one file holds one direction of motion: leave out the points of the other one, and turn the "
    "signs if all are negative"
)


class CurveError(ValueError):
    """A file holds no friction curve; one line with file, line, value and range, and the remedy."""


class Curve(NamedTuple):
    """A measured friction curve: speeds [m/s], rising from 0, and friction coefficients [1].

    `of_forces`: the file has forces, which were divided by the normal force.
    """

    speeds: tuple[float, ...]
    coefficients: tuple[float, ...]
    of_forces: bool = False

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters of the friction law that the curve sets, by name."""
        values: dict[str, float] = {"shape": CURVE, "n_points": len(self.speeds)}
        for number, (speed, mu) in enumerate(zip(self.speeds, self.coefficients, strict=True), 1):
            values |= {f"u_{number}": speed, f"mu_{number}": mu}
        # The first point lies at rest.
        del values["u_1"]
        return values


class _Column(NamedTuple):
    """Place of a column in the file, and the unit of its plain numbers."""

    place: int
    unit: str


def read_curve(file: Path, normal_force: float | None) -> Curve:
    """Read a measured friction curve; CurveError if the file holds none.

    Below its lowest speed the friction stays what it is there. Forces go with the normal force
    under which they were measured [N]; on coefficients it is of no effect.
    """
    lines = list(csv_lines(_text(file)))
    if not lines:
        raise CurveError(f"{file}: is empty")
    (number, header), *rows = lines
    speed, friction, is_force = _columns(file, number, header)
    if is_force and normal_force is None:
        raise CurveError(
            f"{file}: line {number}: has forces; name the normal force under which they "
            "were measured, such as --normal-force '200 N'"
        )
    of_friction = ("N", "force [N]") if is_force else ("1", "")
    points: list[tuple[float, float]] = []
    for number, cells in rows:
        where = f"{file}: line {number}:"
        if len(cells) != len(header):
            raise CurveError(f"{where} has {len(cells)} cells, and the header {len(header)}")
        u = _number(_typed(cells, speed), "m/s", "speed [mm/s]", where)
        mu = _number(_typed(cells, friction), *of_friction, where)
        if u < 0.0:
            raise CurveError(f"{where} speed = {u:g} m/s is out of range: at least 0; {_REMEDY}")
        if points and not u > points[-1][0]:
            raise CurveError(
                f"{where} speed = {u:g} m/s is out of range: above that of the line before, "
                f"{points[-1][0]:g} m/s"
            )
        if mu < 0.0:
            raise CurveError(f"{where} friction = {mu:g} is out of range: at least 0; {_REMEDY}")
        points.append((u, mu / normal_force if is_force and normal_force else mu))
    if points and points[0][0] > 0.0:
        points.insert(0, (0.0, points[0][1]))
    if not 2 <= len(points) <= MOST_POINTS:
        raise CurveError(
            f"{file}: has {len(points)} points, speed 0 among them, and must have 2 to "
            f"{MOST_POINTS}; keep those between which the curve is nearly straight"
        )
    speeds, coefficients = zip(*points, strict=True)
    return Curve(speeds, coefficients, is_force)


def _number(text: str, unit: str, heading: str, where: str) -> float:
    """Read a cell; `heading` shows how a column is headed whose numbers need a unit, 0 apart."""
    try:
        number = typed(text, unit)
    except QuantityError as error:
        raise CurveError(f"{where} {text!r} {error}") from None
    if heading and number != 0.0 and not parts_of(text)[1]:
        raise CurveError(
            f"{where} {text} has no unit; write it in the header, as {heading!r}, or behind the "
            "number"
        )
    return number


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise CurveError(f"{file}: no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text in UTF-8"
        raise CurveError(f"{file}: cannot be read: {reason}") from None


def csv_lines(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the lines of a CSV text with their numbers, but for blank ones and those behind #.

    The separator is a semicolon or a tab where the first line has one, and else a comma; beside
    them a number may have a decimal comma.
    """
    separator = ""
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        separator = separator or next((mark for mark in ";\t" if mark in line), ",")
        (cells,) = csv.reader([line], delimiter=separator, skipinitialspace=True)
        cells = [cell.strip() for cell in cells]
        if separator != ",":
            cells = [_DECIMAL_COMMA.sub(r"\1.\2", cell) for cell in cells]
        yield number, cells


def _columns(file: Path, number: int, header: list[str]) -> tuple[_Column, _Column, bool]:
    """Return the columns of speed and friction, and whether the latter is a force."""
    found: dict[str, _Column] = {}
    for index, cell in enumerate(header):
        heading = _HEADING.fullmatch(cell)
        assert heading is not None
        name = heading["name"].strip().lower().replace(" ", "_")
        for kind, names in (("speed", SPEEDS), ("mu", COEFFICIENTS), ("force", FORCES)):
            if name in names:
                found.setdefault(kind, _Column(index, (heading["unit"] or "").strip()))
    friction = found.get("mu") or found.get("force")
    if "speed" not in found or friction is None:
        raise CurveError(
            f"{file}: line {number}: the header names no column of "
            f"{'speed' if 'speed' not in found else 'friction'}; it is {', '.join(header)!r}, "
            "expected such as 'speed [mm/s],mu' or 'speed [mm/s],force [N]'"
        )
    return found["speed"], friction, "mu" not in found


def _typed(cells: list[str], column: _Column) -> str:
    """Return a cell with the unit of its column, if it has none."""
    cell = cells[column.place]
    return f"{cell} {column.unit}" if column.unit and cell[-1:].isdigit() else cell
