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
from ..datasets import ExtraMissingError, need
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

    Raises
    ------
    SweepError
        If it cannot be read, has no rows, or a cell is no finite number; with the line.
    """
    try:
        content = file.read_bytes()
    except OSError as error:
        reason = (error.strerror or type(error).__name__).lower()
        raise SweepError(f"{file}: cannot be read: {reason}") from None
    of_parquet = file.suffix.lower() == ".parquet"
    names, units, rows = _parquet(file) if of_parquet else _csv(file, content)
    if len(set(names)) < len(names) or "" in names:
        what = "a column without a name" if "" in names else "a column twice"
        raise SweepError(f"{file}: the header has {what}")
    line = "row" if of_parquet else "line"
    table = [_numbers(names, cells, f"{file}: {line} {number}: ") for number, cells in rows]
    if not names or not table:
        raise SweepError(f"{file}: has no rows")
    values = dict(zip(names, np.array(table).T.copy(), strict=True))
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


def _csv(file: Path, content: bytes) -> tuple[list[str], dict[str, str], _Rows]:
    try:
        lines = csv_lines(content.decode("utf-8-sig"))
        _, header = next(lines)
    except UnicodeDecodeError:
        raise SweepError(f"{file}: is no text in UTF-8") from None
    except StopIteration:
        raise SweepError(f"{file}: is empty") from None
    headings = [heading for cell in header if (heading := _HEADING.fullmatch(cell))]
    units = {each["name"]: each["unit"].strip() for each in headings if each["unit"]}
    return [each["name"] for each in headings], units, lines


def _parquet(file: Path) -> tuple[list[str], dict[str, str], _Rows]:
    try:
        need("pyarrow")
        frame = need("pandas").read_parquet(file)
    except ExtraMissingError as error:
        raise SweepError(f"{file}: {error}") from None
    except Exception as error:
        reason = " ".join(str(error).split())
        raise SweepError(f"{file}: cannot be read as Parquet: {reason}") from None
    units = {str(name): str(unit) for name, unit in frame.attrs.get("units", {}).items() if unit}
    rows = enumerate(frame.itertuples(index=False, name=None), 1)
    return [str(name) for name in frame.columns], units, rows
