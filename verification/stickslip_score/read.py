"""A curve, in SI units with the digits of its numbers, from arrays or a CSV file of any tool."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

LEAST_SAMPLES = 5  # fewer cannot show a stick on either side of a slip and a sample between
_DIGITS_OF = 500  # samples whose digits are counted; the longest of them has all digits
_RUNS, _RUN = 4, 500  # runs of neighbouring samples in which counts are sought, samples of each
_ROUNDINGS = 1024.0 * 2.0**-53  # of the largest number: moves below it are none
_ON_THE_GRID = 0.01  # of half a unit: times printed off their grid scatter by nearly all of it
_SAME = 1e-9  # of a column's largest value: what rows of one time at an event may differ by
_WITH_CELLS = re.compile(r"^[^\S\n]*[^#\s].*$", re.MULTILINE)
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")
_NAME_AND_UNIT = (
    re.compile(r"(.*?)\s*\[([^\]]*)\]"),
    re.compile(r"(?!der\()([^()]*|.*?\s)\(([^)]*)\)"),
)

_LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9}
_TIMES = {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0}
_SPEEDS = {f"{length}/s": size for length, size in _LENGTHS.items()}
_SPEEDS |= {"m.s-1": 1.0, "mm/min": 1e-3 / 60.0, "m/min": 1.0 / 60.0}
_FORCES = {"N": 1.0, "mN": 1e-3, "kN": 1e3, "MN": 1e6}


class _Quantity(NamedTuple):
    meaning: str
    units: Mapping[str, float]  # in SI; a column without a unit is in SI
    plain: str  # names in order of preference, in their case; else in any
    others: str  # more names in any case


_X_DOTS = "xdot dx dxdt v_mass v_m vel velocity speed der(s) mass.v"
_QUANTITIES = {
    "t": _Quantity("time", _TIMES, "time t Time", "zeit"),
    "x": _Quantity("position", _LENGTHS, "x X position", "s pos x_mass mass_x displacement weg"),
    "x_dot": _Quantity("velocity", _SPEEDS, "x_dot der(x)", _X_DOTS),
    "F": _Quantity("force", _FORCES, "F F_spring spring_force", "force springforce f_c kraft"),
}


class CurveError(ValueError):
    """A curve cannot be read or judged; the message says where and why."""


@dataclass(frozen=True)
class Curve:
    """Samples of a motion, at least t and x or F, shape (n,)."""

    t: Floats  # time [s], increasing
    x: Floats | None = None  # position of the mass [m]
    x_dot: Floats | None = None  # its velocity [m/s]
    F: Floats | None = None  # spring force [N]
    t_rounding: float = 0.0  # half a unit in the last digit of the numbers, at their largest, in SI
    x_rounding: float = 0.0
    x_dot_rounding: float = 0.0
    F_rounding: float = 0.0

    def __post_init__(self) -> None:
        if self.x is None and self.F is None:
            raise CurveError("neither x nor F is given; one of them is needed")
        if self.t.ndim != 1 or self.t.size < LEAST_SAMPLES:
            raise CurveError(f"{self.t.size} samples; at least {LEAST_SAMPLES} are needed")
        for name in _QUANTITIES:
            column = getattr(self, name)
            if column is None:
                continue
            if column.shape != self.t.shape:
                raise CurveError(f"{name} has {column.size} samples and t {self.t.size}")
            if not np.all(np.isfinite(column)):
                where = int(np.argmin(np.isfinite(column)))
                raise CurveError(f"{name} is {column[where]} in sample {where + 1}")
        if not np.all(np.diff(self.t) > 0.0):
            where = int(np.argmin(np.diff(self.t) > 0.0)) + 1
            raise CurveError(f"time does not increase in sample {where + 1}: t = {self.t[where]} s")

    @classmethod
    def of(
        cls,
        t: ArrayLike,
        x: ArrayLike | None = None,
        x_dot: ArrayLike | None = None,
        F: ArrayLike | None = None,
    ) -> Curve:
        """Make a curve of arrays in SI units; the digits of its numbers are counted.

        `CurveError` for neither x nor F, fewer than 5 samples, unequal lengths, NaN or infinity,
        time that does not increase.
        """
        columns = {"t": t, "x": x, "x_dot": x_dot, "F": F}
        arrays = {n: np.array(c, dtype=np.float64) for n, c in columns.items() if c is not None}
        return _with_rounding(arrays, dict.fromkeys(arrays, 1.0))


def _with_rounding(columns: Mapping[str, Floats], units: Mapping[str, float]) -> Curve:
    """Make a curve of columns as printed, with their units by quantity, and count their digits."""
    fields: dict[str, Any] = {}
    for name, column in columns.items():
        half = half_unit(column)
        if name == "t":
            # Steps of 0.1 s hit an even grid to the last bit.
            even = np.linspace(column[0], column[-1], column.size)
            scatter = float(np.max(np.abs(column - even)))
            half = scatter if scatter < _ON_THE_GRID * half else half
        fields |= {name: column * units[name], f"{name}_rounding": half * units[name]}
    return Curve(**fields)


def half_unit(column: Floats) -> float:
    """Return half a unit in the last digit of the numbers of a column, at their largest.

    The shortest text of each number shows digits and decimals; the coarser of the two is what was
    printed. Single precision carries no more than its 24 bits, counts of an encoder or converter no
    more than its step, whatever was printed.
    """
    numbers = column[np.isfinite(column) & (column != 0.0)]
    if not numbers.size:
        return 0.0
    largest = float(np.max(np.abs(numbers)))
    some = numbers[:: -(-numbers.size // _DIGITS_OF)]
    printed = [Decimal(repr(number)).normalize().as_tuple() for number in some.tolist()]
    digits = max(len(number.digits) for number in printed)
    last_place = min(int(number.exponent) for number in printed)
    unit = max(10.0**last_place, 10.0 ** (math.floor(math.log10(largest)) - digits + 1))
    with np.errstate(over="ignore"):
        in_single = some.size > 1 and np.all(some.astype(np.float32) == some) and digits > 9
    if in_single:
        unit = max(unit, largest * 2.0**-23)
    return 0.5 * max(float(unit), _count_step(column))


def _count_step(column: Floats) -> float:
    """Return the common divisor of all moves from sample to sample, by Euclid's division.

    0 for a column that never stays where it is: that of an even motion has one step as well.
    """
    starts = np.linspace(0, max(column.size - _RUN, 0), _RUNS).astype(np.int64)
    moves = np.concatenate([np.abs(np.diff(column[i : i + _RUN])) for i in starts])
    nothing = _ROUNDINGS * float(np.max(np.abs(column)))
    parts = np.unique(moves[moves > nothing])
    if parts.size == 0 or np.all(moves > nothing):
        return 0.0
    while parts.size > 1:
        least = parts[0]
        counts = np.round(parts / least)
        rest = np.abs(parts - least * counts)
        parts = np.unique(np.append(rest[rest > nothing * counts], least))
        if parts[0] == least:
            break
    return float(parts[0])


def read_curve(path: Path | str, names: Mapping[str, str] | None = None) -> Curve:
    """Read a curve from a text file with one header line, in SI units.

    Cells stand between commas, semicolons or tabs. Commas in a cell are decimal where they can be
    nothing else; thousands separators are refused. A header may carry a unit, ``x [mm]`` or ``time
    (s)``. Lines that begin with # and blank lines are passed over. Two rows of one time with the
    same position and force, as tools write them at an event, count as one.

    `names` are column names by quantity, of t, x, x_dot and F; the others are guessed. A name may
    carry the unit that the header lacks. `CurveError` names the file, the line and the reason.
    """
    try:
        return _read(Path(path), names or {})
    except FileNotFoundError:
        raise CurveError(f"{path}: no such file") from None
    except OSError as error:
        raise CurveError(f"{path}: cannot be read: {error.strerror or error}") from None
    except CurveError as error:
        raise CurveError(f"{path}: {error}") from None


def _read(file: Path, names: Mapping[str, str]) -> Curve:
    text = _text(file)
    header_line = _WITH_CELLS.search(text)
    if header_line is None:
        raise CurveError("is empty")
    if "\0" in text[: header_line.end()]:
        raise CurveError("is no text file")
    if not _WITH_CELLS.search(text, header_line.end()):
        raise CurveError("has no samples below its header")
    separator = next((mark for mark in ";\t" if mark in header_line[0]), ",")
    header = [cell.strip().strip("'\"").strip() for cell in _cells(header_line[0], separator)]
    columns = _columns(header, names)
    needed = [index for index, _ in columns.values()]
    table = None
    # Every line has as many cells as the header, and no cell a quote or a comma of its own.
    if '"' not in text and (separator == "," or "," not in text):
        with suppress(ValueError, IndexError):
            rows = text[header_line.end() :].split("\n")
            table = np.loadtxt(rows, delimiter=separator, usecols=needed, ndmin=2)
            cells = text.count(separator, header_line.end()) + len(table)
            if cells != len(table) * len(header) or not np.isfinite(table).all():
                table = None
    if table is None:
        table = _table(_rows(text), separator, header, needed)
    printed = {quantity: table[:, i].copy() for i, quantity in enumerate(columns)}
    for index, column in zip(needed, printed.values(), strict=True):
        _check_points(header[index], column)
    samples = _increasing(printed, text)
    printed = {quantity: column[samples] for quantity, column in printed.items()}
    return _with_rounding(printed, {quantity: unit for quantity, (_, unit) in columns.items()})


def _text(file: Path) -> str:
    with file.open("rb") as content:
        is_utf_16 = content.read(2) in (b"\xff\xfe", b"\xfe\xff")
    # Units such as µm may come in the letters of Windows.
    for encoding in ("utf-16",) if is_utf_16 else ("utf-8-sig", "latin-1"):
        with suppress(UnicodeError):
            return file.read_text(encoding)
    raise CurveError("is no text file")


def _rows(text: str) -> Rows:
    lines = enumerate(text.split("\n"), 1)
    return [(n, line) for n, line in lines if line.lstrip()[:1] not in ("", "#")][1:]


def _cells(line: str, separator: str) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except csv.Error as error:
        raise CurveError(f"cannot be split into cells: {error}") from None


Columns = Mapping[str, tuple[int, float]]  # place of the column of a quantity, its unit in SI
Rows = Sequence[tuple[int, str]]  # lines with their numbers in the file


def _columns(header: Sequence[str], names: Mapping[str, str]) -> Columns:
    if not any(math.isnan(_number(cell.replace(",", "."))) for cell in header if cell):
        raise CurveError("has no header line: its first line holds numbers only")
    columns = {}
    for symbol, quantity in _QUANTITIES.items():
        if symbol in names:
            index, text = _named(names[symbol], header)
        elif (guess := _guess(quantity, header)) is not None:
            index, text = guess, header[guess]
        else:
            continue
        columns[symbol] = index, _unit(text, quantity)
    for any_of, what in (("t", "time"), ("xF", "the position x nor of the spring force F")):
        if not columns.keys() & set(any_of):
            raise CurveError(f"no column of {what}; the columns are {', '.join(header)}")
    return columns


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def _split(cell: str) -> tuple[str, str]:
    for form in _NAME_AND_UNIT:
        if match := form.fullmatch(cell):
            return match[1].strip(), match[2].strip()
    return cell, ""


def _named(name: str, header: Sequence[str]) -> tuple[int, str]:
    """Return the column that a person named, and the text that has its unit.

    Whole text or name in its case, either in any case, or the name with the unit it lacks.
    """
    bare = [_split(cell)[0] for cell in header]
    ways = [(cells, name, fold, "") for fold in (str, str.casefold) for cells in (header, bare)]
    if _split(name)[1]:
        unitless = ["" if _split(cell)[1] else cell for cell in header]
        ways += [(unitless, _split(name)[0], fold, name) for fold in (str, str.casefold)]
    for cells, text, fold, with_unit in ways:
        matches = [index for index, cell in enumerate(cells) if fold(cell) == fold(text)]
        if len(matches) > 1:
            raise CurveError(f"{len(matches)} columns are called {name}")
        if matches:
            return matches[0], with_unit or header[matches[0]]
    raise CurveError(f"no column {name!r}; the columns are {', '.join(header)}")


def _guess(quantity: _Quantity, header: Sequence[str]) -> int | None:
    names = [_split(cell)[0] for cell in header]
    for name in quantity.plain.split():
        if names.count(name) == 1:
            return names.index(name)
    others = f"{quantity.plain} {quantity.others}".casefold().split()
    # ``mass.s`` is the s of a mass.
    matches = [i for i, name in enumerate(names) if name.casefold() in others] or [
        i for i, name in enumerate(names) if name.rpartition(".")[2].casefold() in others
    ]
    if len(matches) > 1:
        candidates = ", ".join(header[i] for i in matches)
        raise CurveError(f"{quantity.meaning} may be any of {candidates}: name the column")
    return matches[0] if matches else None


def _unit(cell: str, quantity: _Quantity) -> float:
    unit = _split(cell)[1].replace("μ", "µ").replace(" ", "")
    if not unit:
        return 1.0
    # The case of a letter tells milli from mega, and is else of no account.
    same = [name for name in quantity.units if name.lower() == unit.lower()]
    sizes = {quantity.units[name] for name in (same if unit not in same else [unit])}
    if len(sizes) != 1:
        units = ", ".join(quantity.units)
        raise CurveError(f"{cell}: the unit of the {quantity.meaning} is none of {units}")
    return sizes.pop()


def _table(rows: Rows, separator: str, header: Sequence[str], needed: Sequence[int]) -> Floats:
    texts = []
    for number, line in rows:
        row = _cells(line, separator)
        if line.count('"') % 2:
            raise CurveError(f"line {number}: a quote is not closed on its line")
        if any(row[len(header) :]) or len(row) <= max(needed):
            raise CurveError(
                f"line {number}: {len(row)} cells under a header of {len(header)}: commas inside "
                "numbers? Write them without"
            )
        texts.append([row[index].strip() for index in needed])
    numbers = [number for number, _ in rows]
    comma = "," if _has_decimal_commas(texts, numbers) else "."
    table = np.array([[_number(text.replace(comma, ".")) for text in row] for row in texts])
    for i, j in np.argwhere(~np.isfinite(table)):
        name, text = header[needed[j]], texts[i][j]
        raise CurveError(f"line {numbers[i]}: {name} is {text!r}, not a finite number")
    return table


def _has_decimal_commas(texts: Sequence[Sequence[str]], numbers: Sequence[int]) -> bool:
    """Tell whether commas in the cells are decimal; refuse where all may separate thousands."""
    cells = [(n, text) for n, row in zip(numbers, texts, strict=True) for text in row]
    commas = [(number, text) for number, text in cells if "," in text]
    if not commas:
        return False
    all_may = all(_THOUSANDS.fullmatch(text) for _, text in commas)
    doubtful = [cell for cell in commas if all_may or "." in cell[1] or cell[1].count(",") > 1]
    for number, text in [*doubtful, *(cell for cell in cells if "." in cell[1])]:
        raise CurveError(
            f"line {number}: {text!r} may have a separator of thousands; write numbers without"
        )
    return True


def _check_points(name: str, column: Floats) -> None:
    """Refuse a column that goes from 999 to 1.000: its points separate thousands."""
    size = np.abs(column)
    below, above = (size >= 900.0) & (size < 1000.0), (size >= 1.0) & (size < 1.1)
    wraps = (below[1:] & above[:-1]) | (below[:-1] & above[1:])
    if wraps.any() and np.all(np.abs(1e3 * column - np.round(1e3 * column)) < 1e-6):
        raise CurveError(
            f"{name} goes from 999 to 1.000 and back: its points may separate thousands; write "
            "numbers without"
        )


def _increasing(printed: Mapping[str, Floats], text: str) -> NDArray[np.bool_]:
    """Return where the samples are, without the first row of each event."""
    t = printed["t"]
    step = np.diff(t)
    repeated = step == 0.0
    for column in (printed[name] for name in ("x", "F") if name in printed):
        repeated &= np.abs(np.diff(column)) <= _SAME * float(np.max(np.abs(column)))
    good = (step > 0.0) | repeated
    if not np.all(good):
        where = int(np.argmin(good)) + 1
        raise CurveError(
            f"line {_rows(text)[where][0]}: time does not increase "
            f"({t[where]:.10g} after {t[where - 1]:.10g})"
        )
    return np.append(~repeated, True)
