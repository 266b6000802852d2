"""A curve from a CSV file of any tool: separators, units and names as they come."""

import codecs
import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from stickslip_score.columns import Column, find_columns
from stickslip_score.curve import LEAST_SAMPLES, Curve, CurveError, Floats, with_rounding

_PIECE = 1 << 20
"""Bytes that are looked at together."""

_FIRST_ROWS = 1000
"""Rows in which a decimal comma may show itself before the whole file is searched for one."""

_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")
"""A number that a comma may divide into thousands."""

_SAME = 1e-9
"""Of a column's largest value: rows of one time that differ by less are two sides of an event."""


def read_curve(path: Path | str, names: Mapping[str, str] | None = None) -> Curve:
    """Read a curve from a text file with one header line.

    Cells stand between commas, semicolons or tabs. Commas in a cell are decimal where they can be
    nothing else; thousands separators are refused. A header may carry a unit, ``x [mm]`` or
    ``time (s)``. Lines that begin with # and blank lines are passed over. Two rows of one time
    with the same position and force, as tools write them at an event, count as one.

    Parameters
    ----------
    path
        The file.
    names
        Column names by quantity, of t, x, x_dot and F; those not given are guessed. A name may
        carry the unit that the header lacks.

    Returns
    -------
    Curve
        In SI units.

    Raises
    ------
    CurveError
        One line that names the file, the line where there is one, and the reason.
    """
    file = Path(path)
    encoding, header_number, header_line = _header(file)
    separator = next((mark for mark in ";\t" if mark in header_line), ",")
    header = next(csv.reader([header_line], delimiter=separator, skipinitialspace=True))
    try:
        columns = find_columns(header, names or {})
    except CurveError as error:
        raise CurveError(f"{file}: {error}") from None
    layout = _Layout(file, encoding, header_number, separator, len(header), columns)
    table = _plain_table(layout)
    numbers: Sequence[int] | None = None
    if table is None:
        table, numbers = _any_table(layout)
    read = {column.quantity: table[:, i].copy() for i, column in enumerate(columns)}
    del table
    for column in columns:
        _check_points(layout, column, read[column.quantity])
    kept = _increasing(layout, read, numbers)
    if not np.all(kept):
        read = {quantity: column[kept] for quantity, column in read.items()}
    return with_rounding(read, {column.quantity: column.unit for column in columns})


@dataclass(frozen=True)
class _Layout:
    """Where the cells of a file stand: its encoding, header, separator and wanted columns."""

    file: Path
    encoding: str
    header_number: int
    separator: str
    width: int
    columns: Sequence[Column]


def _header(file: Path) -> tuple[str, int, str]:
    """Return the encoding of a file, and the number and the text of its header line."""
    try:
        with file.open("rb") as content:
            encoding = _encoding(content)
        with file.open(encoding=encoding, errors="replace") as lines:
            for number, line in enumerate(lines, 1):
                if "\0" in line:
                    raise CurveError(f"{file}: is no text file")
                if not _is_empty(line):
                    return encoding, number, line.rstrip("\n")
    except FileNotFoundError:
        raise CurveError(f"{file}: no such file") from None
    except OSError as error:
        raise CurveError(f"{file}: cannot be read: {error.strerror or error}") from None
    raise CurveError(f"{file}: is empty")


def _encoding(content: BinaryIO) -> str:
    """Return how the text of a file is encoded; units such as µm come in the letters of Windows."""
    decoder = codecs.getincrementaldecoder("utf-8")()
    for piece in iter(lambda: content.read(_PIECE), b""):
        if content.tell() == len(piece) and piece.startswith((b"\xff\xfe", b"\xfe\xff")):
            return "utf-16"
        try:
            decoder.decode(piece)
        except UnicodeDecodeError:
            return "latin-1"
    return "utf-8-sig"


def _is_empty(line: str) -> bool:
    stripped = line.strip()
    return not stripped or stripped[0] == "#"


def _plain_table(layout: _Layout) -> Floats | None:
    """Read a table of plain numbers, shape (samples, columns); None where it is no such table.

    Every line has as many cells as the header, and no cell a quote or a comma of its own.
    """
    if layout.encoding == "utf-16":
        return None
    separators, commas, points = 0, False, False
    with layout.file.open("rb") as content:
        for _ in range(layout.header_number):
            content.readline()
        for piece in iter(lambda: content.read(_PIECE), b""):
            if b'"' in piece:
                return None
            separators += piece.count(layout.separator.encode())
            commas |= layout.separator != "," and b"," in piece
            points |= b"." in piece
    if commas and (points or not _begins_decimal(layout)):
        return None
    with layout.file.open(encoding=layout.encoding) as lines:
        try:
            table = np.loadtxt(
                (line.replace(",", ".") for line in lines) if commas else str(layout.file),
                delimiter=layout.separator,
                usecols=[column.index for column in layout.columns],
                skiprows=layout.header_number,
                encoding=layout.encoding,
                ndmin=2,
            )
        except (ValueError, IndexError):
            return None
    plain = separators == len(table) * (layout.width - 1)
    return table if plain and np.all(np.isfinite(table)) else None


def _begins_decimal(layout: _Layout) -> bool:
    """Tell whether the first rows show that commas are decimal."""
    with layout.file.open(encoding=layout.encoding) as content:
        lines = islice(content, layout.header_number, layout.header_number + _FIRST_ROWS)
        rows = [line for line in lines if not _is_empty(line)]
    numbers = range(len(rows))
    try:
        return _is_decimal(layout, _cells(layout, rows, numbers), numbers)
    except CurveError:
        return False


def _any_table(layout: _Layout) -> tuple[Floats, list[int]]:
    """Read a table cell by cell, and return it with the line numbers of its rows."""
    with layout.file.open(encoding=layout.encoding, errors="replace", newline=None) as content:
        lines = content.read().splitlines()
    numbers = [
        number
        for number, line in enumerate(lines[layout.header_number :], layout.header_number + 1)
        if not _is_empty(line)
    ]
    if not numbers:
        raise CurveError(f"{layout.file}: has no samples below its header")
    cells = _cells(layout, [lines[number - 1] for number in numbers], numbers)
    comma = _is_decimal(layout, cells, numbers)
    columns = [
        _numbers(layout, column, texts, numbers, comma)
        for column, texts in zip(layout.columns, cells, strict=True)
    ]
    return np.stack(columns, axis=1), numbers


def _cells(layout: _Layout, lines: Sequence[str], numbers: Sequence[int]) -> list[list[str]]:
    """Return the texts of each wanted column."""
    wanted = [column.index for column in layout.columns]
    cells: list[list[str]] = [[] for _ in wanted]
    rows = csv.reader(lines, delimiter=layout.separator, skipinitialspace=True)
    try:
        for number, row in zip(numbers, rows, strict=True):
            if any(row[layout.width :]):
                raise CurveError(
                    f"{layout.file}, line {number}: {len(row)} cells under a header of "
                    f"{layout.width}: commas inside numbers? Write them without"
                )
            if len(row) <= max(wanted):
                raise CurveError(
                    f"{layout.file}, line {number}: {len(row)} cells, but column "
                    f"{max(wanted) + 1} is needed"
                )
            for texts, index in zip(cells, wanted, strict=True):
                texts.append(row[index].strip())
    except csv.Error as error:
        raise CurveError(f"{layout.file}: cannot be split into cells: {error}") from None
    except CurveError:
        raise
    except ValueError:
        # A quoted cell that goes on over lines leaves fewer rows than lines.
        raise CurveError(f"{layout.file}: a quote is not closed on its line") from None
    return cells


def _is_decimal(layout: _Layout, cells: Sequence[Sequence[str]], numbers: Sequence[int]) -> bool:
    """Tell whether commas in the cells are decimal; refuse where they may separate thousands.

    The first comma that cannot stand before three digits of a thousand tells for the whole file.
    """
    doubtful: tuple[int, str] | None = None
    decimal = False
    for texts in cells:
        for number, text in zip(numbers, texts, strict=True):
            if "," not in text:
                continue
            if "." in text or text.count(",") > 1:
                raise _thousands(layout, number, text)
            if not _THOUSANDS.fullmatch(text):
                decimal = True
            doubtful = doubtful or (number, text)
    if doubtful is None:
        return False
    if not decimal:
        raise _thousands(layout, *doubtful)
    for texts in cells:
        for number, text in zip(numbers, texts, strict=True):
            if "." in text:
                raise _thousands(layout, number, text)
    return True


def _thousands(layout: _Layout, number: int, text: str) -> CurveError:
    return CurveError(
        f"{layout.file}, line {number}: {text!r} may have a separator of thousands; write numbers "
        "without"
    )


def _check_points(layout: _Layout, column: Column, found: Floats) -> None:
    """Refuse a column that goes from 999 to 1.000: its points separate thousands."""
    size = np.abs(found)
    below, above = (size >= 900.0) & (size < 1000.0), (size >= 1.0) & (size < 1.1)
    wraps = (below[1:] & above[:-1]) | (below[:-1] & above[1:])
    if wraps.any() and np.all(np.abs(1e3 * found - np.round(1e3 * found)) < 1e-6):
        raise CurveError(
            f"{layout.file}: {column.name} goes from 999 to 1.000 and back: its points may "
            "separate thousands; write numbers without"
        )


def _numbers(
    layout: _Layout, column: Column, texts: Sequence[str], numbers: Sequence[int], comma: bool
) -> Floats:
    found = np.empty(len(texts))
    for index, (number, text) in enumerate(zip(numbers, texts, strict=True)):
        try:
            found[index] = float(text.replace(",", ".") if comma else text)
        except ValueError:
            raise CurveError(
                f"{layout.file}, line {number}: {column.name} is {text!r}, not a number"
            ) from None
        if not np.isfinite(found[index]):
            raise CurveError(f"{layout.file}, line {number}: {column.name} is {found[index]}")
    return found


def _increasing(
    layout: _Layout, read: Mapping[str, Floats], numbers: Sequence[int] | None
) -> NDArray[np.bool_]:
    """Return where the samples are, without the first row of each event."""
    t = read["t"]
    step = np.diff(t)
    repeated = step == 0.0
    for name in ("x", "F"):
        if name in read:
            column = read[name]
            repeated &= np.abs(np.diff(column)) <= _SAME * float(np.max(np.abs(column)))
    good = (step > 0.0) | repeated
    if not np.all(good):
        where = int(np.argmin(good)) + 1
        if numbers is None:
            numbers = _any_table(layout)[1]
        raise CurveError(
            f"{layout.file}, line {numbers[where]}: time does not increase "
            f"({t[where]:.10g} after {t[where - 1]:.10g})"
        )
    kept = np.append(~repeated, True)
    if np.count_nonzero(kept) < LEAST_SAMPLES:
        raise CurveError(
            f"{layout.file}: {np.count_nonzero(kept)} samples; at least {LEAST_SAMPLES} are needed"
        )
    return np.asarray(kept)
