"""Files of columns that a plan names: points of a sweep, inputs over time. CSV or Parquet.

A CSV file has one header line of names, each with its unit if that is not the variable's own:

    k [N/mm], mu_s
    40, 0.2
    60, 0.2
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..curve_file import csv_lines
from ..datasets import need
from .refusal import SweepError

_HEADING: Final = re.compile(r"(?P<name>.*?)\s*(?:\[(?P<unit>[^\]]*[^\]\d][^\]]*)\])?")
"""A name, and a unit in square brackets; brackets around a number are an index of the name."""

_Rows: TypeAlias = Iterable[tuple[int, Sequence[Any]]]
"""Cells by the number of their line or row."""


class Columns(NamedTuple):
    """The finite numbers of a file by name, shape (n,), and the units that its header gives."""

    file: Path
    digest: str
    values: Mapping[str, NDArray[np.float64]]
    units: Mapping[str, str]


def read_columns(file: Path) -> Columns:
    """Read a file of columns.

    `SweepError`, with the line, if it cannot be read, has no rows, or a cell is no finite number.
    """
    of_parquet = file.suffix.lower() == ".parquet"
    try:
        content = file.read_bytes()
        headings, rows = _parquet(file) if of_parquet else _csv(content)
    except OSError as error:
        reason = (error.strerror or type(error).__name__).lower()
        raise SweepError(f"{file}: cannot be read: {reason}") from None
    except (ImportError, ValueError) as error:
        raise SweepError(f"{file}: {error}") from None
    names = [name for name, _ in headings]
    if len(set(names)) < len(names) or "" in names:
        what = "a column without a name" if "" in names else "a column twice"
        raise SweepError(f"{file}: the header has {what}")
    line = "row" if of_parquet else "line"
    table = [_numbers(names, cells, f"{file}: {line} {number}: ") for number, cells in rows]
    if not names or not table:
        raise SweepError(f"{file}: has no rows")
    values = dict(zip(names, np.array(table).T.copy(), strict=True))
    units = {name: unit.strip() for name, unit in headings if unit}
    return Columns(file, sha256(content).hexdigest(), values, units)


def _numbers(names: Sequence[str], cells: Sequence[Any], where: str) -> list[float]:
    if len(cells) != len(names):
        raise SweepError(f"{where}has {len(cells)} cells, and the header {len(names)}")
    numbers = []
    for name, cell in zip(names, cells, strict=True):
        try:
            number = float({"true": "1", "false": "0"}.get(str(cell).lower(), cell))
        except (TypeError, ValueError):
            raise SweepError(f"{where}{name} = {cell!r} is no number") from None
        if not np.isfinite(number):
            raise SweepError(f"{where}{name} = {cell} is not finite")
        numbers.append(number)
    return numbers


def _csv(content: bytes) -> tuple[list[tuple[str, str]], _Rows]:
    """Return names with their units, and the rows; `ValueError` for what has none."""
    try:
        lines = csv_lines(content.decode("utf-8-sig"))
        _, header = next(lines)
    except UnicodeDecodeError:
        raise ValueError("is no text in UTF-8") from None
    except StopIteration:
        raise ValueError("is empty") from None
    matches = [match for cell in header if (match := _HEADING.fullmatch(cell))]
    return [(match["name"], match["unit"]) for match in matches], lines


def _parquet(file: Path) -> tuple[list[tuple[str, str]], _Rows]:
    """As `_csv`, of a file that pandas reads."""
    need("pyarrow")
    read = need("pandas").read_parquet
    try:
        frame = read(file)
    except Exception as error:
        reason = " ".join(str(error).split())
        raise ValueError(f"cannot be read as Parquet: {reason}") from None
    units = frame.attrs.get("units", {})
    headings = [(str(name), str(units.get(name) or "")) for name in frame.columns]
    return headings, enumerate(frame.itertuples(index=False, name=None), 1)
