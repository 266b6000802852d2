"""A plan for a model: its names found, its values in the model's units, its times laid out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ..quantity import QuantityError
from ..ranges import BETWEEN, parse_range
from .columns import Columns, read_columns
from .job import Job, Variable, column_of
from .model import Model, check_type
from .plan import PlanFile, Scalar, is_tabular
from .reductions import REDUCTIONS
from .refusal import SweepError, nearest
from .units import in_unit, read_as

MOST_STEPS: Final = 100_000_000
"""Communication steps of a run."""

_TIME: Final = "time"
_WHOLE: Final = 1e-9
"""Of a step: by how much the last one may be off and still count as whole."""


def resolve(
    plan: PlanFile, model: Model
) -> tuple[Job, tuple[NDArray[np.float64], ...], Mapping[str, str]]:
    """Find what a plan names in a model.

    Returns
    -------
    tuple
        What the runs have in common; the values of the swept variables in the order of the job,
        those of a grid's axes or of the points; SHA-256 of the files of columns by their names.

    Raises
    ------
    SweepError
        A name that the model does not have, a variable that cannot be set or read, a value that is
        none of it, a file of columns that cannot be used, times that do not go together.
    """
    files: dict[str, Columns] = {}

    def opened(key: str, name: str) -> Columns:
        if name not in files:
            try:
                files[name] = read_columns(plan.file(name))
            except SweepError as error:
                raise plan.refused(key, f"{name!r}: {error}") from None
        return files[name]

    fixed = dict(model.bound)
    axes: dict[str, NDArray[np.float64]] = {}
    by_table: dict[str, str] = {}
    for table, entries in (("parameters", plan.says.parameters), ("inputs", plan.says.inputs)):
        for name, written in entries.items():
            key = f"{table}.{name}"
            variable = _to_set(plan, model, key, name, is_input=table == "inputs")
            if is_tabular(written):
                if table == "parameters":
                    raise plan.refused(key, f"{written!r}: a file goes with [inputs] or points")
                by_table[name] = str(written)
                continue
            values = _values(plan, model, key, variable, written)
            if isinstance(written, list) or values.size > 1:
                axes[name] = values
            else:
                fixed[name] = float(values[0])
    if plan.says.points:
        if axes:
            raise plan.refused(
                "points", f"{plan.says.points!r} and the values of {next(iter(axes))} are two sets"
            )
        axes = dict(_points(plan, model, opened("points", plan.says.points)))
        both = [name for name in axes if name in {**plan.says.parameters, **plan.says.inputs}]
        if both:
            raise plan.refused("points", f"{plan.says.points!r} has {both[0]}, and so has the plan")
    fixed = {name: value for name, value in fixed.items() if name not in axes}
    times, steps, settled = _times(plan, model, varying=bool(by_table))
    tables = {
        name: _table(plan, model, name, opened(f"inputs.{name}", file), times)
        for name, file in by_table.items()
    }
    _outputs(plan, model, axes)
    used = {*fixed, *axes, *by_table, *plan.says.outputs}
    used |= {name for wire in model.wires for name in (wire.output, wire.input)}
    job = Job(
        model.components,
        {name: model.variables[name] for name in sorted(used)},
        model.wires,
        fixed,
        tuple(axes),
        tables,
        times,
        steps,
        settled,
        dict(plan.says.outputs),
        plan.says.reset is not False,
    )
    digests = {name: each.digest for name, each in files.items()}
    return job, tuple(axes.values()), digests


def _found(plan: PlanFile, model: Model, key: str, name: str) -> Variable:
    if name not in model.variables:
        of = model.path.name
        raise plan.refused(key, f"is no variable of {of}; {nearest(name, model.variables)}")
    variable = model.variables[name]
    if variable.obstacle:
        raise plan.refused(key, variable.obstacle)
    return variable


def _to_set(plan: PlanFile, model: Model, key: str, name: str, *, is_input: bool) -> Variable:
    variable = _found(plan, model, key, name)
    kind = f"{variable.variability} {variable.causality}"
    if is_input and not variable.changes:
        remedy = "; it goes below [parameters]" if variable.starts else ""
        raise plan.refused(key, f"is a {kind}, and cannot be set during a run{remedy}")
    if not variable.starts:
        raise plan.refused(key, f"is a {kind}, and cannot be set")
    for wire in model.wires:
        if wire.input == name:
            raise plan.refused(key, f"is driven by {wire.output}, and cannot be set")
    return variable


def _values(
    plan: PlanFile, model: Model, key: str, variable: Variable, written: Scalar | list[Scalar]
) -> NDArray[np.float64]:
    read = partial(read_as, model.units)
    each = written if isinstance(written, list) else [written]
    found: list[float] = []
    for value in each:
        try:
            if isinstance(value, str) and BETWEEN in value:
                if isinstance(written, list):
                    raise QuantityError("is a range in a list; write one or the other")
                numbers = parse_range(value, variable.unit, read=read).values().tolist()
            elif isinstance(value, str):
                numbers = [read(value, variable.unit)]
            else:
                numbers = [float(value)]
            for number in numbers:
                check_type(variable, number)
        except QuantityError as error:
            raise plan.refused(key, f"{value!r} {error}") from None
        found += numbers
    return np.array(found)


def _points(
    plan: PlanFile, model: Model, columns: Columns
) -> Iterator[tuple[str, NDArray[np.float64]]]:
    for name, numbers in columns.values.items():
        try:
            variable = _to_set(plan, model, "points", name, is_input=False)
        except SweepError as error:
            raise SweepError(f"{error} ({plan.says.points}: {name})") from None
        yield name, _of_column(plan, model, "points", variable, columns, numbers)


def _of_column(
    plan: PlanFile,
    model: Model,
    key: str,
    variable: Variable,
    columns: Columns,
    numbers: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the numbers of a column in the unit of the variable that it sets."""
    unit = columns.units.get(variable.name, "")
    try:
        if unit not in ("", variable.unit):
            numbers = np.array(
                [in_unit(model.units, repr(each), unit, variable.unit) for each in numbers.tolist()]
            )
        for each in np.unique(numbers).tolist():
            check_type(variable, each)
    except QuantityError as error:
        raise plan.refused(key, f"{columns.file.name!r}: {variable.name} {error}") from None
    return numbers


def _times(
    plan: PlanFile, model: Model, *, varying: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Return communication points, communication steps, and the first point that is looked at."""
    stated = {**model.experiment, **plan.says.times}
    start = stated.get("start_time", 0.0)
    if "stop_time" not in stated:
        raise SweepError(f"{plan.name}: has no stop_time, and {model.path.name} no default of it")
    duration = stated["stop_time"] - start
    if not duration > 0.0:
        raise plan.refused(
            "stop_time", f"{stated['stop_time']:g} s is not after start_time = {start:g} s"
        )
    whole = any(REDUCTIONS[each].whole for all_of in plan.says.outputs.values() for each in all_of)
    if "step" not in stated and (whole or varying or model.wires):
        raise SweepError(
            f"{plan.name}: has no step, and {model.path.name} no default of it; write such as "
            f'step = "{duration / 1000.0:g} s"'
        )
    step = min(stated.get("step", duration), duration)
    count = duration / step
    if count > MOST_STEPS:
        raise plan.refused("step", f"{step:g} s makes {count:.3g} steps; at most {MOST_STEPS:g}")
    steps = max(1, math.ceil(count - _WHOLE))
    times: NDArray[np.float64] = start + step * np.arange(steps + 1, dtype=np.float64)
    times[-1] = stated["stop_time"]
    lengths = np.full(steps, step)
    if abs(count - steps) > _WHOLE * steps:
        lengths[-1] = times[-1] - times[-2]
    settle = plan.says.times.get("settle", 0.0)
    if settle >= duration:
        raise plan.refused("settle", f"{settle:g} s is the whole run of {duration:g} s or more")
    settled = int(np.searchsorted(times, start + settle - _WHOLE * step))
    return times, lengths, settled


def _table(
    plan: PlanFile, model: Model, name: str, columns: Columns, times: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the values of an input at the beginnings of the communication steps."""
    key = f"inputs.{name}"
    absent = [each for each in (_TIME, name) if each not in columns.values]
    if absent:
        has = ", ".join(columns.values)
        raise plan.refused(key, f"{columns.file.name!r} has no column {absent[0]}; it has {has}")
    variable = model.variables[name]
    values = _of_column(plan, model, key, variable, columns, columns.values[name])
    at = columns.values[_TIME]
    if columns.units.get(_TIME, "s") != "s":
        at = np.array([in_unit({}, repr(t), columns.units[_TIME], "s") for t in at.tolist()])
    if np.any(np.diff(at) < 0.0):
        row = int(np.argmax(np.diff(at) < 0.0)) + 2
        raise plan.refused(key, f"{columns.file.name!r}: time falls in row {row}")
    # Of rows of one time the last one counts from then on.
    before = np.searchsorted(at, times[:-1], side="right") - 1
    first = np.clip(before, 0, len(at) - 1)
    found = values[first]
    if variable.is_continuous:
        after = np.minimum(first + 1, len(at) - 1)
        inside = (before >= 0) & (at[after] > at[first])
        width = np.where(inside, at[after] - at[first], 1.0)
        share = np.where(inside, (times[:-1] - at[first]) / width, 0.0)
        found = found + share * (values[after] - values[first])
    return found


def _outputs(plan: PlanFile, model: Model, swept: Mapping[str, Any]) -> None:
    taken: dict[str, str] = {}
    for name, reductions in plan.says.outputs.items():
        key = f"outputs.{name}"
        _found(plan, model, key, name)
        for reduction in reductions:
            column = column_of(name, reduction)
            if column in swept or column == "failure":
                raise plan.refused(key, f"would be {column} in the results, as what is swept is")
            if column in taken:
                raise plan.refused(key, f"would be {column} in the results, as {taken[column]}")
            taken[column] = name
