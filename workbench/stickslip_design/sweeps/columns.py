"""Files of columns that a plan names: points of a sweep, inputs over time. CSV or Parquet.

A CSV file has one header line of names, each with its unit if that is not the variable's own:

    k [N/mm], mu_s
    40, 0.2
    60, 0.2
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..datasets import ExtraMissingError, need
from .refusal import SweepError

_HEADING: Final = re.compile(r"(?P<name>.*?)\s*(?:\[(?P<unit>[^\]]*[^\]\d][^\]]*)\])?")
"""A name, and a unit in square brackets; brackets around a number are an index of the name."""


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
    digest = sha256(content).hexdigest()
    of_parquet = file.suffix.lower() == ".parquet"
    values, units = _parquet(file) if of_parquet else _csv(file, content)
    if not values or not next(iter(values.values())).size:
        raise SweepError(f"{file}: has no rows")
    return Columns(file, digest, values, units)


def _csv(file: Path, content: bytes) -> tuple[dict[str, NDArray[np.float64]], dict[str, str]]:
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise SweepError(f"{file}: is no text in UTF-8") from None
    lines = list(_lines(text))
    if not lines:
        raise SweepError(f"{file}: is empty")
    (number, header), *rows = lines
    names, units = [], {}
    for cell in header:
        heading = _HEADING.fullmatch(cell)
        assert heading is not None
        names.append(heading["name"])
        if heading["unit"]:
            units[heading["name"]] = heading["unit"].strip()
    if len(set(names)) < len(names) or "" in names:
        what = "a column without a name" if "" in names else "a column twice"
        raise SweepError(f"{file}: line {number}: the header has {what}")
    table = np.empty((len(rows), len(names)))
    for index, (number, cells) in enumerate(rows):
        if len(cells) != len(names):
            raise SweepError(
                f"{file}: line {number}: has {len(cells)} cells, and the header {len(names)}"
            )
        for place, cell in enumerate(cells):
            table[index, place] = _number(cell, f"{file}: line {number}: {names[place]}")
    return {name: table[:, place].copy() for place, name in enumerate(names)}, units


def _number(cell: str, where: str) -> float:
    try:
        number = float({"true": "1", "false": "0"}.get(cell.lower(), cell))
    except ValueError:
        raise SweepError(f"{where} = {cell!r} is no number") from None
    if not np.isfinite(number):
        raise SweepError(f"{where} = {cell} is not finite")
    return number


def _lines(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the lines with their numbers, but for blank ones and those that begin with #."""
    separator = ""
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        separator = separator or next((mark for mark in ";\t" if mark in line), ",")
        (cells,) = csv.reader([line], delimiter=separator, skipinitialspace=True)
        yield number, [cell.strip() for cell in cells]


def _parquet(file: Path) -> tuple[dict[str, NDArray[np.float64]], dict[str, str]]:
    try:
        need("pyarrow")
        frame = need("pandas").read_parquet(file)
    except ExtraMissingError as error:
        raise SweepError(f"{file}: {error}") from None
    except Exception as error:
        reason = " ".join(str(error).split())
        raise SweepError(f"{file}: cannot be read as Parquet: {reason}") from None
    values = {}
    for name in frame.columns:
        try:
            column = frame[name].to_numpy(dtype=np.float64)
        except (TypeError, ValueError):
            raise SweepError(f"{file}: the column {name} has no numbers") from None
        wrong = np.flatnonzero(~np.isfinite(column))
        if wrong.size:
            row = int(wrong[0])
            raise SweepError(f"{file}: row {row + 1}: {name} = {column[row]} is not finite")
        values[str(name)] = column
    units = dict(frame.attrs.get("units", {}))
    return values, {str(name): str(unit) for name, unit in units.items() if unit}
