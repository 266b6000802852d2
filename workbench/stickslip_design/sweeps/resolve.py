"""A plan for a model: its names found, its values in the model's units, its times laid out.

A plan may name files of columns, points of a sweep or inputs over time, CSV or Parquet. A CSV file
has one header line of names, each with its unit if that is not the variable's own:

    k [N/mm], mu_s
    40, 0.2
    60, 0.2
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip_units import BETWEEN, QuantityError, in_unit, parse_range, typed_in

from ..curve_file import csv_lines
from ..datasets import need
from .model import Model, SweepError, Variable
from .plan import PlanFile, Scalar, is_tabular, nearest
from .runs import column_of, reduces

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


MOST_STEPS = 100_000_000
"""Communication steps of a run."""

_TIME = "time"
_WHOLE = 1e-9
"""Of a step: by how much the last one may be off and still count as whole."""


class Resolver(PlanFile):
    """A plan, a file or what its TOML says, for a model.

    Its methods raise a `SweepError` for a name that the model does not have, a variable that cannot
    be set or read, a value that is none of it, a file of columns that cannot be used, times that do
    not go together. `files` are the files of columns that were read, by name.
    """

    def __init__(self, plan: Path | str | Mapping[str, Any], model: Model) -> None:
        super().__init__(plan)
        self._model = model
        self.files: dict[str, Columns] = {}

    def values(
        self,
    ) -> tuple[dict[str, float], dict[str, NDArray[np.float64]], dict[str, str]]:
        """Return by name what all runs have, what each run sets, and the files of inputs.

        The second are the axes of a grid or the columns of points.
        """
        says, fixed, by_table = self.says, dict(self._model.bound), dict[str, str]()
        axes: dict[str, NDArray[np.float64]] = {}
        for table, entries in (("parameters", says.parameters), ("inputs", says.inputs)):
            for name, written in entries.items():
                key = f"{table}.{name}"
                variable = self._to_set(key, name, is_input=table == "inputs")
                if is_tabular(written):
                    if table == "parameters":
                        reason = f"{written!r}: a file goes with [inputs] or points"
                        raise self.refused(key, reason)
                    by_table[name] = written
                    continue
                values = self._values(key, variable, written)
                if isinstance(written, list) or values.size > 1:
                    axes[name] = values
                else:
                    fixed[name] = float(values[0])
        if says.points:
            axes = self._points(axes)
        fixed = {name: value for name, value in fixed.items() if name not in axes}
        return fixed, axes, by_table

    def _variable(self, key: str, name: str) -> Variable:
        variable = self._model.variables.get(name)
        if variable is None:
            near = nearest(name, self._model.variables)
            of = self._model.path.name
            raise self.refused(key, f"is no variable of {of}; {near}")
        if variable.obstacle:
            raise self.refused(key, variable.obstacle)
        return variable

    def _to_set(self, key: str, name: str, *, is_input: bool) -> Variable:
        variable = self._variable(key, name)
        reason = variable.hindrance
        if is_input and not variable.changes:
            remedy = "; it goes below [parameters]" if variable.starts else ""
            reason = f"is a {variable.sort}, and cannot be set during a run{remedy}"
        for wire in self._model.wires:
            if wire.input == name:
                reason = reason or f"is driven by {wire.output}, and cannot be set"
        if reason:
            raise self.refused(key, reason)
        return variable

    def _values(
        self, key: str, variable: Variable, written: Scalar | list[Scalar]
    ) -> NDArray[np.float64]:
        in_list = isinstance(written, list)
        numbers: list[float] = []
        for value in written if isinstance(written, list) else [written]:
            try:
                for number in self._numbers(variable, value, in_list=in_list):
                    variable.check(number)
                    numbers.append(number)
            except QuantityError as error:
                raise self.refused(key, f"{value!r} {error}") from None
        return np.array(numbers)

    def _numbers(self, variable: Variable, value: Scalar, *, in_list: bool) -> list[float]:
        read = partial(typed_in, known=self._model.units)
        if not isinstance(value, str):
            return [float(value)]
        if BETWEEN not in value:
            return [read(value, variable.unit)]
        if in_list:
            raise QuantityError("is a range in a list; write one or the other")
        spaced = parse_range(value, variable.unit, read=read)
        return [float(number) for number in spaced.values()]

    def _columns(self, key: str, name: str) -> Columns:
        if name not in self.files:
            try:
                self.files[name] = read_columns(self.file(name))
            except SweepError as error:
                raise self.refused(key, f"{name!r}: {error}") from None
        return self.files[name]

    def _points(self, axes: Mapping[str, object]) -> dict[str, NDArray[np.float64]]:
        """Return the columns of the file of points, which goes with no `axes`."""
        file = self.says.points
        if axes:
            reason = f"{file!r} and the values of {next(iter(axes))} are two sets"
            raise self.refused("points", reason)
        columns = self._columns("points", file)
        points = {}
        for name in columns.values:
            try:
                variable = self._to_set("points", name, is_input=False)
            except SweepError as error:
                raise SweepError(f"{error} ({file}: {name})") from None
            points[name] = self._column("points", variable, columns)
        for name in points:
            if name in {**self.says.parameters, **self.says.inputs}:
                raise self.refused("points", f"{file!r} has {name}, and so has the plan")
        return points

    def _column(self, key: str, variable: Variable, columns: Columns) -> NDArray[np.float64]:
        """Return the numbers of a column in the unit of the variable that it sets."""
        try:
            numbers = _converted(columns, variable.name, variable.unit, self._model)
            for number in np.unique(numbers).tolist():
                variable.check(number)
        except QuantityError as error:
            reason = f"{columns.file.name!r}: {variable.name} {error}"
            raise self.refused(key, reason) from None
        return numbers

    def times(self, *, varying: bool) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
        """Return communication points, their steps, and the first point that is looked at."""
        name = self._model.path.name
        stated = {**self._model.experiment, **self.says.times}
        start, stop = stated.get("start_time", 0.0), stated.get("stop_time")
        if stop is None:
            raise SweepError(f"{self.path}: has no stop_time, and {name} no default of it")
        duration = stop - start
        if not duration > 0.0:
            reason = f"{stop:g} s is not after start_time = {start:g} s"
            raise self.refused("stop_time", reason)
        samples = varying or self._model.wires or reduces(self.says.outputs)
        if "step" not in stated and samples:
            raise SweepError(
                f"{self.path}: has no step, and {name} no default of it; write such as "
                f'step = "{duration / 1000.0:g} s"'
            )
        step = min(stated.get("step", duration), duration)
        count = duration / step
        if count > MOST_STEPS:
            reason = f"{step:g} s makes {count:.3g} steps; at most {MOST_STEPS:g}"
            raise self.refused("step", reason)
        steps = max(1, math.ceil(count - _WHOLE))
        times: NDArray[np.float64] = start + step * np.arange(steps + 1, dtype=np.float64)
        times[-1] = stop
        lengths = np.full(steps, step)
        if abs(count - steps) > _WHOLE * steps:
            lengths[-1] = times[-1] - times[-2]
        settle = stated.get("settle", 0.0)
        if settle >= duration:
            raise self.refused("settle", f"{settle:g} s is the whole run of {duration:g} s or more")
        return times, lengths, int(np.searchsorted(times, start + settle - _WHOLE * step))

    def table(self, name: str, file: str, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values of an input at the beginnings of the communication steps."""
        key = f"inputs.{name}"
        columns = self._columns(key, file)
        for column in (_TIME, name):
            if column not in columns.values:
                has = f"no column {column}; it has {', '.join(columns.values)}"
                raise self.refused(key, f"{columns.file.name!r} has {has}")
        variable = self._model.variables[name]
        values = self._column(key, variable, columns)
        try:
            at = _converted(columns, _TIME, "s", None)
        except QuantityError as error:
            raise self.refused(key, f"{columns.file.name!r}: {_TIME} {error}") from None
        if np.any(np.diff(at) < 0.0):
            row = int(np.argmax(np.diff(at) < 0.0)) + 2
            raise self.refused(key, f"{columns.file.name!r}: time falls in row {row}")
        # Of rows of one time the last one counts from then on.
        before = np.searchsorted(at, times[:-1], side="right") - 1
        first = np.clip(before, 0, len(at) - 1)
        if not variable.is_continuous:
            return values[first]
        after = np.minimum(first + 1, len(at) - 1)
        inside = (before >= 0) & (at[after] > at[first])
        width = np.where(inside, at[after] - at[first], 1.0)
        share = np.where(inside, (times[:-1] - at[first]) / width, 0.0)
        found: NDArray[np.float64] = values[first] + share * (values[after] - values[first])
        return found

    def check_outputs(self, swept: Iterable[str]) -> None:
        """Refuse two columns of a name in the results, where those of what is swept stand too."""
        taken = dict.fromkeys((*swept, "failure"), "what is swept is")
        for name, reductions in self.says.outputs.items():
            key = f"outputs.{name}"
            self._variable(key, name)
            for column in (column_of(name, reduction) for reduction in reductions):
                if column in taken:
                    reason = f"would be {column} in the results, as {taken[column]}"
                    raise self.refused(key, reason)
                taken[column] = name


def _converted(columns: Columns, name: str, unit: str, model: Model | None) -> NDArray[np.float64]:
    """Return a column in a unit, as the model understands units."""
    stated, numbers = columns.units.get(name, ""), columns.values[name]
    if stated in ("", unit):
        return numbers
    units = model.units if model else {}
    return np.array([in_unit(repr(value), stated, unit, units) for value in numbers.tolist()])
