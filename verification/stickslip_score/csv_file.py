"""A curve from a CSV file of any tool: separators, units and names as they come."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from stickslip_score.columns import Column, find_columns
from stickslip_score.curve import LEAST_SAMPLES, Curve, CurveError, Floats, with_rounding

_SAME = 1e-9
"""Of a column's largest value: rows of one time that differ by less are two sides of an event."""


def read_curve(path: Path | str, names: Mapping[str, str] | None = None) -> Curve:
    """Read a curve from a text file with one header line.

    Cells stand between commas, semicolons or tabs; decimal commas are read where the separator is
    no comma. A header may carry a unit, ``x [mm]`` or ``time (s)``. Lines that begin with # and
    blank lines are passed over. Two rows of one time with the same position and force, as tools
    write them at an event, count as one.

    Parameters
    ----------
    path
        The file.
    names
        Column names by quantity, of t, x, x_dot and F; those not given are guessed.

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
    lines = _lines(file)
    header_number, header_line = _header(file, lines)
    separator = _separator(header_line)
    header = next(csv.reader([header_line], delimiter=separator, skipinitialspace=True))
    try:
        columns = find_columns(header, names or {})
    except CurveError as error:
        raise CurveError(f"{file}: {error}") from None
    numbers, cells = _cells(file, lines, header_number, separator, columns)
    read = {
        column.quantity: _numbers(file, column, texts, numbers, separator != ",")
        for column, texts in zip(columns, cells, strict=True)
    }
    kept = _increasing(file, read, numbers)
    sizes = {column.quantity: column.unit for column in columns}
    return with_rounding({quantity: read[quantity][kept] for quantity in sizes}, sizes)


def _lines(file: Path) -> list[str]:
    try:
        content = file.read_bytes()
    except FileNotFoundError:
        raise CurveError(f"{file}: no such file") from None
    except OSError as error:
        raise CurveError(f"{file}: cannot be read: {error.strerror or error}") from None
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = content.decode("utf-16", errors="replace")
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            # Units such as µm and ° as tools under Windows write them.
            text = content.decode("latin-1")
    if "\0" in text:
        raise CurveError(f"{file}: is no text file")
    return text.splitlines()


def _header(file: Path, lines: Sequence[str]) -> tuple[int, str]:
    for number, line in enumerate(lines, 1):
        if not _is_empty(line):
            return number, line
    raise CurveError(f"{file}: is empty")


def _is_empty(line: str) -> bool:
    stripped = line.strip()
    return not stripped or stripped[0] == "#"


def _separator(header: str) -> str:
    return next((mark for mark in ";\t" if mark in header), ",")


def _cells(
    file: Path, lines: Sequence[str], header_number: int, separator: str, columns: Sequence[Column]
) -> tuple[list[int], list[list[str]]]:
    """Return the line numbers of the samples, and the texts of each wanted column."""
    numbers = [
        number
        for number, line in enumerate(lines[header_number:], header_number + 1)
        if not _is_empty(line)
    ]
    if not numbers:
        raise CurveError(f"{file}: has no samples below its header")
    wanted = [column.index for column in columns]
    cells: list[list[str]] = [[] for _ in wanted]
    rows = csv.reader((lines[number - 1] for number in numbers), delimiter=separator)
    try:
        for number, row in zip(numbers, rows, strict=True):  # noqa: B007 - the message wants it
            for texts, index in zip(cells, wanted, strict=True):
                texts.append(row[index])
    except IndexError:
        raise CurveError(
            f"{file}, line {number}: {len(row)} cells, but column {max(wanted) + 1} is needed"
        ) from None
    except csv.Error as error:
        raise CurveError(f"{file}: cannot be split into cells: {error}") from None
    except ValueError:
        # A quoted cell that goes on over lines leaves fewer rows than lines.
        raise CurveError(f"{file}: a quote is not closed on its line") from None
    return numbers, cells


def _numbers(
    file: Path, column: Column, texts: Sequence[str], numbers: Sequence[int], comma: bool
) -> Floats:
    if comma:
        texts = [text.replace(",", ".") for text in texts]
    try:
        found = np.array([float(text) for text in texts])
    except ValueError:
        for number, text in zip(numbers, texts, strict=True):
            try:
                float(text)
            except ValueError:
                raise CurveError(
                    f"{file}, line {number}: {column.name} is {text.strip()!r}, not a number"
                ) from None
        raise
    good = np.isfinite(found)
    if not np.all(good):
        where = int(np.argmin(good))
        raise CurveError(f"{file}, line {numbers[where]}: {column.name} is {found[where]}")
    return found


def _increasing(file: Path, read: Mapping[str, Floats], numbers: Sequence[int]) -> Floats:
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
        raise CurveError(
            f"{file}, line {numbers[where]}: time does not increase "
            f"({t[where]:.10g} after {t[where - 1]:.10g})"
        )
    kept = np.append(~repeated, True)
    if np.count_nonzero(kept) < LEAST_SAMPLES:
        raise CurveError(
            f"{file}: {np.count_nonzero(kept)} samples; at least {LEAST_SAMPLES} are needed"
        )
    return np.asarray(kept)
