"""Samples, with the digits of their numbers, from arrays or a CSV file of any tool.

`read_columns` reads the quantities of a table, `read_curve` a curve in SI units.
"""

from __future__ import annotations

import csv
import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from decimal import Decimal
from fnmatch import fnmatchcase
from itertools import islice
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

LEAST_SAMPLES = 5  # fewer cannot show a stick on either side of a slip and a sample between
_DIGITS_OF = 500  # samples whose digits are counted; the longest of them has all digits
_RUNS, _RUN = 4, 500  # runs of neighbouring samples in which counts are sought, samples of each
_ROUNDINGS = 1024.0 * 2.0**-53  # of the largest number: moves below it are none
_ON_THE_GRID = 0.01  # of half a unit: times printed off their grid scatter by nearly all of it
_LONGEST = 400  # characters of a refusal
_SAME = 1e-9  # of a column's largest value: what rows of one time at an event may differ by
_PIECE = 2**23  # characters that are parsed at once
_MOST_ABOVE = 100  # lines of a header, and of notes and units between it and the numbers
_WITH_CELLS = re.compile(r"^[^\S\n]*[^#\s].*$", re.MULTILINE)
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")
_NO_THOUSANDS = re.compile(r"\d,(?!\d{3}(?!\d))\d|(?<![\d,])(?:0\d*|\d{4,}),\d")
_SAMPLE_TIME = re.compile(r"([\d.]+(?:e-?\d+)?)\s*(\w+)")
_OF_AN_AXIS = re.compile(r"\s*\[u(\d+)\s*[,;\s]\s*(\d+)\]")  # behind a signal of Sinumerik
_NO_UNIT = {"", "-", "1", "None"}
_NAME_AND_UNIT = (
    re.compile(r"(.*?)\s*\[([^\]]*)\]"),
    re.compile(r"(?!der\()([^()]*|.*?\s)\(([^)]*)\)"),
)

_FILE = tomllib.loads(Path(__file__).with_name("columns.toml").read_text(encoding="utf-8"))
UNITS: Final[Mapping[str, Mapping[str, float]]] = _FILE["units"]
"""Units of times, lengths, speeds and forces by name, with their sizes in SI."""


class Quantity(NamedTuple):
    """What a column may be, and how it may be called."""

    meaning: str
    units: Mapping[str, float]  # in SI; a column without a unit is in SI
    plain: str  # names in order of preference, in their case; else in any
    others: str = ""  # more names in any case
    words: str = ""  # patterns in order of preference, of small letters without blanks and marks
    of: str = ""  # what several may stand for: what a person names, else the first of the table
    jumps: bool = False  # whether it may differ in the two rows that tools write at an event
    needed: str = ""  # of what has the same text one must be there; refusals call it so
    named: str = ""  # the column that a person named


Quantities = Mapping[str, Quantity]
Rows = Mapping[str, Mapping[str, Any]]


def quantities_of(rows: Rows, units: Rows, names: Mapping[str, str]) -> Quantities:
    """Return quantities of a table, whose units are names of tables of `units`.

    `names` are those of columns by quantity, of a person.
    """
    found = {}
    for name, row in rows.items():
        sizes = {unit: size for of in row["units"] for unit, size in units[of].items()}
        found[name] = Quantity(**{**row, "units": sizes, "named": names.get(name, "")})
    return found


class CurveError(ValueError):
    """Samples cannot be read or judged; the message says where and why."""


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
        columns = {name: getattr(self, name) for name in _FILE["columns"]}
        check_samples({name: column for name, column in columns.items() if column is not None})

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
        return _curve(arrays, dict.fromkeys(arrays, 1.0))


def check_samples(columns: Mapping[str, Floats]) -> None:
    """Raise CurveError for columns that do not go together, by name; "t" is among them.

    For fewer than 5 samples, unequal lengths, NaN or infinity, time that does not increase.
    """
    t = columns["t"]
    if t.ndim != 1 or t.size < LEAST_SAMPLES:
        raise CurveError(f"{t.size} samples; at least {LEAST_SAMPLES} are needed")
    for name, column in columns.items():
        if column.shape != t.shape:
            raise CurveError(f"{name} has {column.size} samples and t {t.size}")
        if not np.all(np.isfinite(column)):
            where = int(np.argmin(np.isfinite(column)))
            raise CurveError(f"{name} is {column[where]} in sample {where + 1}")
    if not np.all(np.diff(t) > 0.0):
        where = int(np.argmin(np.diff(t) > 0.0)) + 1
        raise CurveError(f"time does not increase in sample {where + 1}: t = {t[where]} s")


def roundings(columns: Mapping[str, Floats]) -> dict[str, float]:
    """Return half a unit in the last digit of columns as printed, by name; "t" is the time.

    Of times that are even to the last bit, as steps of 0.1 s are, it is their scatter.
    """
    halves = {name: half_unit(column) for name, column in columns.items()}
    even = np.linspace(columns["t"][0], columns["t"][-1], columns["t"].size)
    scatter = float(np.max(np.abs(columns["t"] - even)))
    return halves | ({"t": scatter} if scatter < _ON_THE_GRID * halves["t"] else {})


def _curve(columns: Mapping[str, Floats], sizes: Mapping[str, float]) -> Curve:
    """Make a curve of columns as printed, with the sizes of their units by quantity."""
    fields: dict[str, Any] = {}
    for name, half in roundings(columns).items():
        fields |= {name: columns[name] * sizes[name], f"{name}_rounding": half * sizes[name]}
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
    """Read a curve in SI units, of t, x, x_dot and F: see `read_columns`."""
    with refusing(path):
        quantities = quantities_of(_FILE["columns"], UNITS, names or {})
        printed, units = read_columns(Path(path), quantities)
        sizes = {name: quantities[name].units.get(unit, 1.0) for name, unit in units.items()}
        return _curve(printed, sizes)


@contextmanager
def refusing(path: Path | str) -> Iterator[None]:
    """Put the name of a file before refusals; CurveError where it cannot be read."""
    try:
        yield
    except FileNotFoundError:
        raise CurveError(f"{path}: no such file") from None
    except OSError as error:
        raise CurveError(f"{path}: cannot be read: {error.strerror or error}") from None
    except CurveError as error:
        # Of a file that is no text the cells are anything.
        text = "".join(sign if sign.isprintable() else "?" for sign in str(error))
        raise CurveError(f"{path}: {text[:_LONGEST]}") from None


def read_columns(file: Path, quantities: Quantities) -> tuple[dict[str, Floats], dict[str, str]]:
    """Read a text file: numbers as printed, shape (n,), and units, "" for none, by quantity.

    The header is the first line that names what is needed. Lines above it, lines of units and notes
    below it, lines that begin with # and blank lines are passed over. Cells stand between commas,
    semicolons or tabs. Commas in a cell are decimal where they can be nothing else; thousands
    separators are refused. A header may carry a unit, ``x [mm]`` or ``time (s)``, or have it below.
    Two rows of one time with the same position and force, as tools write them at an event, count as
    one.

    Columns that are not named are guessed. A name may carry the unit that the header lacks; that of
    t may be a sample time, ``0.25 ms``. `CurveError` gives line, column and reason.
    """
    text = _text(file)
    header_line = _WITH_CELLS.search(text)
    if header_line is None:
        raise CurveError("is empty")
    if "\0" in text[: header_line.end()]:
        raise CurveError("is no text file")
    sampled = _SAMPLE_TIME.fullmatch(quantities["t"].named)
    t_unit = _known(sampled[2], quantities["t"]) if sampled else ""
    if t_unit:
        quantities = {name: quantity for name, quantity in quantities.items() if name != "t"}
    layout, units = _layout(text, quantities)
    if not _WITH_CELLS.search(text, layout.start):
        raise CurveError("has no samples below its header")
    table = _table(text, layout)
    printed = {name: table[:, i].copy() for i, name in enumerate(units)}
    for index, column in zip(layout.needed, printed.values(), strict=True):
        _check_points(layout.header[index], column)
    if sampled and t_unit:
        t = np.arange(len(table), dtype=np.float64) * float(sampled[1])
        return {"t": t, **printed}, {"t": t_unit, **units}
    samples = _increasing(printed, quantities, text, layout.start)
    return {name: column[samples] for name, column in printed.items()}, units


def _text(file: Path) -> str:
    with file.open("rb") as content:
        is_utf_16 = content.read(2) in (b"\xff\xfe", b"\xfe\xff")
    # Units such as µm may come in the letters of Windows.
    for encoding in ("utf-16",) if is_utf_16 else ("utf-8-sig", "latin-1"):
        with suppress(UnicodeError):
            # TwinCAT Scope ends its files with EOF.
            return file.read_text(encoding).removesuffix("\n").removesuffix("\nEOF")
    raise CurveError("is no text file")


class _Layout(NamedTuple):
    """How a file is written."""

    separator: str
    header: Sequence[str]
    needed: Sequence[int]  # places of the columns
    start: int  # where the rows begin
    comma: bool  # whether commas are decimal, as some cell shows


def _layout(text: str, quantities: Quantities) -> tuple[_Layout, dict[str, str]]:
    """Find the line that names the columns and where the rows begin; return the units, too."""
    refusals: list[tuple[int, CurveError]] = []
    for line in islice(_WITH_CELLS.finditer(text), _MOST_ABOVE):
        raw = _OF_AN_AXIS.sub(r" u\1-\2", line[0])
        separator = next((mark for mark in ";\t" if mark in raw), ",")
        header = [cell.strip().strip("'\"").strip() for cell in _cells(raw, separator)]
        if all(_is_number(cell) for cell in header if cell):
            break
        try:
            columns = _columns(header, quantities)
        except CurveError as error:
            refusals.append((sum(not _is_number(cell) for cell in header), error))
            continue
        needed, start, notes = [index for index, _ in columns.values()], line.end(), []
        for below in islice(_WITH_CELLS.finditer(text, start), _MOST_ABOVE):
            row = _cells(below[0], separator) + [""] * len(header)
            # A note has its name where the time stands, and may have numbers behind it.
            if any(_is_number(row[n]) for n in (needed[:1] if row[needed[0]].strip() else needed)):
                break
            notes.append(row)
            start = below.end()
        units = {
            name: _unit(heading, [row[index] for row in notes], quantities[name])
            for name, (index, heading) in columns.items()
        }
        comma = separator != "," and text.find(".", start) < 0 and _NO_THOUSANDS.search(text, start)
        return _Layout(separator, header, needed, start, bool(comma)), units
    if not refusals:
        raise CurveError("has no header line: its first line holds numbers only")
    raise max(refusals, key=lambda refusal: refusal[0])[1]


def _columns(header: Sequence[str], quantities: Quantities) -> dict[str, tuple[int, str]]:
    """Return by quantity the place of its column, and the text that has its unit."""
    columns, taken = {}, {each.of or symbol for symbol, each in quantities.items() if each.named}
    for symbol, quantity in quantities.items():
        of = quantity.of or symbol
        if quantity.named:
            columns[symbol] = _named(quantity.named, header)
        elif of not in taken and (guess := _guess(quantity, header)) is not None:
            columns[symbol] = guess, header[guess]
            taken.add(of)
    there = {"", *(quantities[symbol].needed for symbol in columns)}
    for quantity in quantities.values():
        if quantity.needed not in there:
            raise CurveError(f"no column of {quantity.needed}; the columns are {', '.join(header)}")
    return columns


def _is_number(text: str) -> bool:
    return not math.isnan(_number(text.replace(",", "."))) or text.strip().lower() == "nan"


def _cells(line: str, separator: str) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except csv.Error as error:
        raise CurveError(f"cannot be split into cells: {error}") from None


def _table(text: str, layout: _Layout) -> Floats:
    """Return the numbers of the needed columns, shape (n, columns)."""
    # Every line has as many cells as the header, and no cell a quote or a comma of its own.
    is_plain = text.find('"', layout.start) < 0 and (
        layout.separator == "," or layout.comma or text.find(",", layout.start) < 0
    )
    separator, needed, tables, start = layout.separator, layout.needed, [], layout.start
    while _WITH_CELLS.search(text, start):
        end = text.find("\n", start + _PIECE) + 1 or len(text)
        piece = text[start:end]
        rows = (piece.replace(",", ".") if layout.comma else piece).split("\n")
        table = np.empty((0, 0))
        with suppress(ValueError, IndexError):
            if is_plain:
                table = np.loadtxt(rows, delimiter=separator, usecols=needed, ndmin=2)
        alike = piece.count(separator) == len(table) * (len(layout.header) - 1)
        if not (table.size and alike and np.isfinite(table).all()):
            table = _split_table(piece, text.count("\n", 0, start) + 1, layout)
        tables.append(table)
        start = end
    return np.concatenate(tables)


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


def _guess(quantity: Quantity, header: Sequence[str]) -> int | None:
    names = [_split(cell)[0] for cell in header]
    for name in quantity.plain.split():
        if names.count(name) == 1:
            return names.index(name)
    others = f"{quantity.plain} {quantity.others}".casefold().split()
    # ``mass.s`` is the s of a mass.
    matches = [i for i, name in enumerate(names) if name.casefold() in others] or [
        i for i, name in enumerate(names) if name.rpartition(".")[2].casefold() in others
    ]
    ends = [re.sub(r"[\W_]", "", re.split(r"[./:]", name)[-1]).casefold() for name in names]
    for pattern in quantity.words.split():
        matches = matches or [i for i, end in enumerate(ends) if fnmatchcase(end, pattern)]
    if len(matches) > 1:
        candidates = ", ".join(header[i] for i in matches)
        raise CurveError(f"{quantity.meaning} may be any of {candidates}: name the column")
    return matches[0] if matches else None


def _known(unit: str, quantity: Quantity) -> str:
    """Return a unit as it is called here; "" if the quantity has none such."""
    unit = unit.replace("μ", "µ").replace("·", ".").replace(" ", "")
    # The case of a letter tells milli from mega, and is else of no account.
    same = [name for name in quantity.units if name.lower() == unit.lower()]
    same = [unit] if unit in same else same
    return same[0] if len({quantity.units[name] for name in same}) == 1 else ""


def _unit(heading: str, notes: Sequence[str], quantity: Quantity) -> str:
    """Return the unit in a heading, else that in the notes below it: ``mm``, ``mm (Length)``."""
    name, stated = _split(heading)
    parts = [part for cell in notes for part in (cell.strip(" []()"), *_split(cell))]
    stated = stated or next((part for part in parts if _known(part, quantity)), "")
    if not stated and len(notes) == 1 and parts[0] not in _NO_UNIT:
        stated = parts[0]
    if stated and not _known(stated, quantity):
        of, units = quantity.meaning, ", ".join(quantity.units)
        raise CurveError(f"{name} [{stated}]: the unit of the {of} is none of {units}")
    return _known(stated, quantity)


def _split_table(piece: str, first: int, layout: _Layout) -> Floats:
    """Return the numbers of lines from `first` on; CurveError with its place if one is none."""
    header, needed = layout.header, layout.needed
    texts, numbers = [], []
    for number, line in enumerate(piece.split("\n"), first):
        if line.lstrip()[:1] in ("", "#"):
            continue
        row = _cells(line, layout.separator)
        if line.count('"') % 2:
            raise CurveError(f"line {number}: a quote is not closed on its line")
        if any(row[len(header) :]) or len(row) <= max(needed):
            many = "commas inside numbers? Write them without"
            why = many if len(row) > len(header) else "is the line cut off?"
            cells = f"{len(row)} cells under a header of {len(header)}"
            raise CurveError(f"line {number}: {cells}: {why}")
        texts.append([row[index].strip() for index in needed])
        numbers.append(number)
    comma = "," if layout.comma or _has_decimal_commas(texts, numbers) else "."
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


def _increasing(
    printed: Mapping[str, Floats], quantities: Quantities, text: str, start: int
) -> NDArray[np.bool_]:
    """Return where the samples are, without the first row of each event."""
    t = printed["t"]
    step = np.diff(t)
    repeated = step == 0.0
    for column in (printed[name] for name in printed if not quantities[name].jumps):
        repeated &= np.abs(np.diff(column)) <= _SAME * float(np.max(np.abs(column)))
    good = (step > 0.0) | repeated
    if not np.all(good):
        where = int(np.argmin(good)) + 1
        row = next(islice(_WITH_CELLS.finditer(text, start), where, None))
        line = text.count("\n", 0, row.start()) + 1
        raise CurveError(
            f"line {line}: time does not increase ({t[where]:.10g} after {t[where - 1]:.10g})"
        )
    return np.append(~repeated, True)
