"""Plans of a sweep: TOML that says what to set, how long to run, and what to keep.

    stop_time = "3 s"
    step = "1 ms"

    [parameters]
    k = "1e3..1e5 N/m log 50"
    mu_s = [0.3, 0.4, 0.5]

    [inputs]
    v = "20 mm/s"

    [outputs]
    x = ["jump", "period"]

The fields of `Plan` are what may stand in one; names of variables are those of the model.
`template` writes one to begin with. A plan may name files of columns, points of a sweep or inputs
over time, CSV or Parquet. A CSV file has one header line of names, each with its unit if that is
not the variable's own:

    k [N/mm], mu_s
    40, 0.2
    60, 0.2
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, replace
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Any, Final, TypeAlias

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field
from pydantic.dataclasses import dataclass

from stickslip_units import QuantityError, in_unit, typed
from stickslip_verification.model.data_file import WRITTEN, DataError, DataFile, Written

from ..axis.curve_file import csv_lines
from ..datasets import need
from .model import Model, SweepError, Variable, nearest
from .runs import FAILURE, REDUCTIONS, Floats, Sweep, column_of, reduces

MOST_STEPS: Final = 100_000_000
"""Communication steps of a run."""
_WHOLE: Final = 1e-9
"""Of a step: by how much the last one may be off and still count as whole."""
_TIME: Final = "time"
_HEADING: Final = re.compile(r"(?P<name>.*?)\s*(?:\[(?P<unit>[^\]]*[^\]\d][^\]]*)\])?")
"""A name, and a unit in square brackets; brackets around a number are an index of the name."""

_Columns: TypeAlias = Mapping[str, tuple[Floats, str]]
"""The numbers of a file by name, shape (n,), and the unit that its header gives."""


class PlanError(DataError, SweepError):
    """A plan cannot be used."""


def _is_file(written: Any) -> bool:
    """Whether a value is the name of a file with columns."""
    return isinstance(written, str) and written.lower().endswith((".csv", ".parquet"))


def _seconds(written: Any) -> Any:
    try:
        return typed(written, "s") if isinstance(written, str) else written
    except QuantityError as error:
        raise ValueError(f"{written!r} {error}") from None


def _flat(entries: Any, before: str = "") -> Any:
    """Return a table with the whole names: TOML takes a point in a name for a table."""
    if not isinstance(entries, Mapping):
        return entries
    found: dict[str, Any] = {}
    for name, value in entries.items():
        inner = isinstance(value, Mapping)
        found |= _flat(value, f"{before}{name}.") if inner else {f"{before}{name}": value}
    return found


def _reductions(written: Any) -> tuple[str, ...]:
    names = tuple(written if isinstance(written, list) else [written])
    for name in names:
        if name not in REDUCTIONS:
            raise ValueError(f"{name!r} is no reduction; {nearest(str(name), [*REDUCTIONS])}")
    return names


_Time = Annotated[float, Field(strict=True), BeforeValidator(_seconds)]
_Table = Annotated[Mapping[str, Any], BeforeValidator(_flat)]
_Outputs = Annotated[
    Mapping[str, Annotated[Any, AfterValidator(_reductions)]], BeforeValidator(_flat)
]


@dataclass(frozen=True, config=WRITTEN)
class Plan(Written):
    """What stands in a plan; its variables are not looked at yet. Times are in seconds."""

    start_time: _Time | None = Field(None, description="first time [s]; default: the model's, or 0")
    stop_time: _Time | None = Field(None, description="last time [s]; default: the model's")
    step: _Time | None = Field(
        None, gt=0.0, description="communication step [s]; default: the model's, or the whole time"
    )
    settle: _Time = Field(0.0, ge=0.0, description="time before reductions begin [s]")
    time_limit: _Time = Field(60.0, gt=0.0, description="time of a run on the clock, at most [s]")
    points: str = Field("", description="CSV or Parquet file of points, in place of a grid")
    parameters: _Table = Field(
        default_factory=dict,
        description="what is set before a run: a value, a list of values, or LOW..HIGH UNIT log N",
    )
    inputs: _Table = Field(
        default_factory=dict,
        description="what drives a run: as parameters, or a file of a column `time` and others",
    )
    outputs: _Outputs = Field(
        default_factory=dict,
        min_length=1,
        validate_default=True,
        description="what is kept, one or a list: "
        + "; ".join(f"{name}, {one.meaning}" for name, one in REDUCTIONS.items()),
    )


class PlanFile(DataFile):
    """A plan for a model, a file or what its TOML says.

    A `PlanError` is raised for what is no plan, a name that the model does not have, a variable
    that cannot be set or read, a value that is none of it, a file of columns that cannot be used,
    times that do not go together.
    """

    def __init__(self, plan: Path | str | Mapping[str, Any], model: Model) -> None:
        if isinstance(plan, Mapping):
            self.path, self.data, self._text, self._error = Path("plan"), {**plan}, "", PlanError
        else:
            super().__init__(Path(plan), PlanError)
        self._model = model
        self._says: Plan = self.read(Plan)
        self._digests: dict[str, str] = {}

    @contextmanager
    def _at(self, *key: str) -> Iterator[None]:
        """Refuse what stands at a key, such as `parameters`, `k`, for a reason that is raised."""
        try:
            yield
        except QuantityError as error:
            raise self.refusal(str(error), *key) from None

    def sweep(self) -> Sweep:
        """Return the study that the plan asks for."""
        says, model = self._says, self._model
        fixed, axes, files = dict(model.bound), dict[str, Floats](), dict[str, str]()
        for table, entries in (("parameters", says.parameters), ("inputs", says.inputs)):
            for name, written in entries.items():
                with self._at(table, name):
                    variable = self._to_set(name, in_run=table == "inputs")
                    if name in says.inputs and table == "parameters":
                        raise QuantityError("stands in [inputs] too")
                    if table == "inputs" and _is_file(written):
                        files[name] = written
                        continue
                    listed = written if isinstance(written, list) else [written]
                    values = [one for each in listed for one in model.numbers(each, variable)]
                    if not values:
                        raise QuantityError("has no values")
                if isinstance(written, list) or len(values) > 1:
                    axes[name] = np.array(values)
                else:
                    fixed[name] = values[0]
        if says.points:
            with self._at("points"):
                if axes:
                    raise QuantityError(f"{says.points!r} goes with no values of {', '.join(axes)}")
                axes = self._points()
        fixed = {name: value for name, value in fixed.items() if name not in axes}
        times, steps, settled = self._times(needs_step=bool(files))
        tables = {}
        for name, file in files.items():
            with self._at("inputs", name):
                tables[name] = self._over_time(name, self._columns(file), times[:-1])
        taken = {*axes, FAILURE}
        for name, reductions in says.outputs.items():
            with self._at("outputs", name):
                model.variable(name)
                for column in (column_of(name, reduction) for reduction in reductions):
                    if column in taken:
                        raise QuantityError(f"would be {column} twice in the results")
                    taken.add(column)
        used = {*fixed, *axes, *files, *says.outputs}
        used |= {name for wire in model.wires for name in (wire.output, wire.input)}
        return Sweep(
            model=replace(model, variables={name: model.variables[name] for name in sorted(used)}),
            fixed=fixed,
            swept=tuple(axes),
            values=tuple(axes.values()),
            on_grid=not says.points,
            tables=tables,
            times=times,
            steps=steps,
            settled=settled,
            outputs=says.outputs,
            time_limit=says.time_limit,
            identity={
                "study": "sweep",
                "model": model.path.name,
                "model_digest": sha256(model.content).hexdigest(),
                "plan": asdict(says),
                # A digest does not see in which order a plan has them.
                "axes": list(axes),
                "tables": self._digests,
            },
        )

    def _to_set(self, name: str, *, in_run: bool = False) -> Variable:
        variable = self._model.variable(name, to_set=True)
        if in_run and not variable.changes:
            raise QuantityError(
                f"{name} is a {variable.sort}, and cannot be set during a run; see [parameters]"
            )
        for wire in self._model.wires:
            if wire.input == name:
                raise QuantityError(f"{name} is driven by {wire.output}, and cannot be set")
        return variable

    def _points(self) -> dict[str, Floats]:
        columns, points = self._columns(self._says.points), {}
        for name in columns:
            if name in {**self._says.parameters, **self._says.inputs}:
                raise QuantityError(f"{self._says.points!r} has {name}, and so has the plan")
            points[name] = self._converted(columns, name, self._to_set(name).unit)
        return points

    def _converted(self, columns: _Columns, name: str, unit: str) -> Floats:
        """Return a column in a unit."""
        (numbers, stated), known = columns[name], self._model.units
        if stated in ("", unit):
            return numbers
        try:
            return np.array([in_unit(repr(one), stated, unit, known) for one in numbers.tolist()])
        except QuantityError as error:
            raise QuantityError(f"{name} {error}") from None

    def _over_time(self, name: str, columns: _Columns, times: Floats) -> Floats:
        """Return the values of an input at times [s]."""
        if not {_TIME, name} <= columns.keys():
            raise QuantityError(f"needs the columns {_TIME} and {name}; {', '.join(columns)} given")
        variable = self._model.variables[name]
        values = self._converted(columns, name, variable.unit)
        at = self._converted(columns, _TIME, "s")
        if np.any(np.diff(at) < 0.0):
            raise QuantityError(f"time falls in row {int(np.argmax(np.diff(at) < 0.0)) + 2}")
        # Of rows of one time the last one counts from then on.
        if variable.is_continuous:
            return np.interp(times, at, values)
        return values[np.maximum(np.searchsorted(at, times, side="right") - 1, 0)]

    def _times(self, *, needs_step: bool) -> tuple[Floats, Floats, int]:
        """Return communication points, their steps, and the first point that is looked at."""
        says, model = self._says, self._model
        stated = {name: time for name, time in vars(says).items() if time is not None}
        stated = {"start_time": 0.0, **model.experiment, **stated}
        if "stop_time" not in stated:
            raise self.refusal(f"has no stop_time, and {model.path.name} no default of it")
        start, stop = stated["start_time"], stated["stop_time"]
        duration = stop - start
        if not duration > says.settle:
            why = f"{stop:g} s is not after start_time = {start:g} s and settle = {says.settle:g} s"
            raise self.refusal(why, "stop_time")
        if "step" not in stated and (needs_step or model.wires or reduces(says.outputs)):
            raise self.refusal(
                f"has no step, and {model.path.name} no default of it; write such as "
                f'step = "{duration / 1000.0:g} s"'
            )
        step = min(stated.get("step", duration), duration)
        count = duration / step
        if count > MOST_STEPS:
            reason = f"{step:g} s makes {count:.3g} steps; at most {MOST_STEPS:g}"
            raise self.refusal(reason, "step")
        steps = max(1, math.ceil(count - _WHOLE))
        times: Floats = start + step * np.arange(steps + 1, dtype=np.float64)
        times[-1] = stop
        lengths = np.full(steps, step)
        if abs(count - steps) > _WHOLE * steps:
            lengths[-1] = times[-1] - times[-2]
        settled = np.searchsorted(times, start + says.settle - _WHOLE * step)
        return times, lengths, int(settled)

    def _columns(self, name: str) -> _Columns:
        """Read a file of columns; a `QuantityError`, with the line, if it cannot be used."""
        file = self.path.parent / name
        try:
            self._digests[name] = sha256(file.read_bytes()).hexdigest()
            if file.suffix.lower() == ".parquet":
                need("pyarrow")
                frame = need("pandas").read_parquet(file)
                units = frame.attrs.get("units", {})
                header = [f"{column} [{units.get(column) or ''}]" for column in frame.columns]
                rows = [*enumerate(frame.itertuples(index=False, name=None), 1)]
            else:
                (_, header), *rows = csv_lines(file.read_text("utf-8-sig"))
        except Exception as error:
            reason = getattr(error, "strerror", None) or " ".join(str(error).split())
            raise QuantityError(f"{name!r} cannot be read: {reason}") from None
        table = np.full((len(rows), len(header)), math.nan)
        for row, (line, cells) in zip(table, rows, strict=True):
            with suppress(TypeError, ValueError):
                row[:] = [{"true": 1.0, "false": 0.0}.get(str(c).lower(), c) for c in cells]
            if len(cells) != len(header) or not np.isfinite(row).all():
                has = f"{', '.join(map(str, cells))}, and not {len(header)} finite numbers"
                raise QuantityError(f"{name!r}: line {line} has {has}")
        matches = [match for cell in header if (match := _HEADING.fullmatch(cell))]
        columns = {
            match["name"]: (column, (match["unit"] or "").strip())
            for match, column in zip(matches, table.T.copy(), strict=True)
        }
        if len(columns) < len(header) or "" in columns or not rows:
            raise QuantityError(f"{name!r} has no rows, a column twice, or one without a name")
        return columns


_BARE: Final = re.compile(r"[A-Za-z0-9_-]+(?:\.[A-Za-z0-9_-]+)*")


def template(model: Model) -> str:
    """Return the text of a plan in which every variable of a model stands, most as comments.

    It can be read at once: without changes it does one run and keeps the last values of the
    outputs.
    """
    help_of = {name: str(one.description) for name, one in Plan.__pydantic_fields__.items()}  # type: ignore[attr-defined]
    driven = {wire.input for wire in model.wires}
    usable = [one for one in model.variables.values() if not one.obstacle]
    stop = model.experiment.get("stop_time", 1.0)
    times = {"stop_time": stop, "step": stop / 1000.0, **model.experiment}
    lines = [
        f"# Plan of stickslip sweep for {model.path.name}. Numbers are in the units behind them; a",
        '# text may have another, "4 N/um". Grids: [0.3, 0.4], "0.3..0.5 5", "1e3..1e5 N/m log 5".',
        *(f"{name} = {value:g}  # {help_of[name]}" for name, value in times.items()),
        f"# settle = 0.0  # {help_of['settle']}",
        f"# time_limit = 60.0  # {help_of['time_limit']}",
        f'# points = "points.csv"  # {help_of["points"]}',
    ]
    for table in ("parameters", "inputs"):
        lines += ["", f"# {help_of[table]}", f"[{table}]"]
        for one in usable:
            if one.starts and one.name not in driven and one.causality.lower() in table:
                start = model.bound.get(one.name, one.start_text or "0.0")
                lines.append(f"# {_entry(one, start)}")
    lines += ["", f"# {help_of['outputs']}", "[outputs]"]
    lines += [_entry(one, '"last"') for one in usable if one.causality == "output"]
    return "\n".join(lines) + "\n"


def _entry(variable: Variable, value: float | str) -> str:
    name, about = variable.name, ", ".join(filter(None, (variable.unit, variable.description)))
    quoted = name if _BARE.fullmatch(name) else json.dumps(name, ensure_ascii=False)
    plain = "".join(letter if letter.isprintable() else " " for letter in about)
    return f"{quoted} = {value}" + (f"  # {plain}" if plain else "")
