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

`KEYS` and `TABLES` list what may stand in one; names of variables are those of the model.
"""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Final, TypeAlias

from ..axis.lines import Lines
from ..quantity import QuantityError, typed
from ..ranges import BETWEEN
from .reductions import REDUCTIONS
from .refusal import SweepError, nearest

KEYS: Final[Mapping[str, str]] = {
    "start_time": "first time [s]; default: that of the model's default experiment, else 0",
    "stop_time": "last time [s]; default: that of the model's default experiment",
    "step": "communication step [s]; default: that of the model's default experiment, else, where "
    "only last values are kept, the whole time",
    "settle": "time from the start that reductions leave out [s]; default 0",
    "time_limit": "time that a run may take on the clock [s]; default 60",
    "reset": "whether one instance does run after run, reset between; default: tried out first",
    "points": "file of points, CSV or Parquet, with a column for each variable, in place of a grid",
}
"""The keys of a plan, and what they mean."""

TABLES: Final[Mapping[str, str]] = {
    "parameters": "what is set before a run: a value, a list of values, or LOW..HIGH UNIT log N",
    "inputs": "what drives a run: as parameters, or a CSV or Parquet file of a column `time` and "
    "others",
    "outputs": f"what is kept, by variable: one or a list of {', '.join(REDUCTIONS)}",
}
"""The tables of a plan, and what they mean."""

TIMES: Final = ("start_time", "stop_time", "step", "settle", "time_limit")
TABULAR: Final = (".csv", ".parquet")
"""How the name of a file with columns ends."""

TIME_LIMIT: Final = 60.0
"""Seconds that a run may take where the plan says nothing."""

MOST_VALUES: Final = 10_000_000
"""Values of one variable, which stand in memory."""

MOST_RUNS: Final = 10**18
"""Runs of a plan: more do not fit into the integers that count them."""

Written: TypeAlias = float | int | bool | str
"""A value as TOML has it."""

_LONGEST: Final = 60
"""Characters of a value that a refusal shows."""
_COUNT: Final = re.compile(r"\d{1,18}", re.ASCII)
_DECIMAL_COMMA: Final = re.compile(r"=\s*-?\d+,\d")


@dataclass(frozen=True)
class Plan:
    """A plan as it is written, known to be well formed; its variables are not looked at yet.

    Attributes
    ----------
    name
        Name of the file, for refusals.
    folder
        Where its tables are looked for.
    times
        `TIMES` that it states [s].
    reset
        Whether instances are reset between runs; None: tried out.
    points
        File of points, empty for a grid.
    parameters, inputs
        What is set, by variable: one value, or a list of them.
    outputs
        Names of reductions by variable.
    """

    name: str
    folder: Path
    times: Mapping[str, float]
    reset: bool | None
    points: str
    parameters: Mapping[str, Written | list[Written]]
    inputs: Mapping[str, Written | list[Written]]
    outputs: Mapping[str, tuple[str, ...]]
    _lines: Lines | None = field(default=None, repr=False)

    def refused(self, key: str, reason: str) -> SweepError:
        """Return the refusal of what stands at a key, such as ``parameters.k``."""
        return _refused(self.name, self._lines, key, reason)

    def file(self, written: str) -> Path:
        """Return the path of a table that the plan names."""
        return self.folder / written

    @property
    def as_json(self) -> dict[str, Any]:
        """What the results depend on, without the contents of tables."""
        return {
            "times": dict(self.times),
            "reset": self.reset,
            "points": self.points,
            "parameters": dict(self.parameters),
            "inputs": dict(self.inputs),
            "outputs": {name: list(each) for name, each in self.outputs.items()},
        }


def read_plan(path: Path | str) -> Plan:
    """Read a plan.

    Raises
    ------
    SweepError
        If it cannot be read, is not TOML, or has a key or value that is none of a plan.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        reason = (error.strerror or type(error).__name__).lower()
        raise SweepError(f"{path}: cannot be read: {reason}") from None
    except UnicodeDecodeError:
        raise SweepError(f"{path}: is no text in UTF-8") from None
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _not_toml(str(error), str(path), text) from None
    return plan_of(data, str(path), path.parent, Lines(text))


def plan_of(
    data: Mapping[str, Any],
    name: str = "plan",
    folder: Path | None = None,
    lines: Lines | None = None,
) -> Plan:
    """Make a plan of what its TOML says.

    Parameters
    ----------
    data
        The keys and tables.
    name
        Name for refusals.
    folder
        Where tables are looked for; the working folder by default.
    lines
        Where the keys stand.

    Raises
    ------
    SweepError
        As `read_plan`.
    """
    refused = partial(_refused, name, lines)

    for key, value in data.items():
        if key in TABLES:
            if not isinstance(value, Mapping):
                raise refused(key, f"= {_shown(value)} is no table; write [{key}] and names below")
        elif key not in KEYS:
            raise refused(key, f"is an unknown key; {nearest(key, [*KEYS, *TABLES])}")
    try:
        times = {key: _time(key, data[key]) for key in TIMES if key in data}
        reset = data.get("reset")
        if not isinstance(reset, bool | None):
            raise _WrongError("reset", f"= {_shown(reset)} is neither true nor false")
        points = data.get("points", "")
        if not isinstance(points, str) or ("points" in data and not is_tabular(points)):
            raise _WrongError("points", f"= {_shown(points)} is no file ending in .csv or .parquet")
        plan = Plan(
            name,
            folder or Path(),
            times,
            reset,
            points,
            dict(_values("parameters", data.get("parameters", {}))),
            dict(_values("inputs", data.get("inputs", {}))),
            dict(_outputs(data.get("outputs", {}))),
            lines,
        )
    except _WrongError as error:
        raise refused(error.key, error.reason) from None
    runs = math.prod(map(_count, (*plan.parameters.values(), *plan.inputs.values())))
    if runs > MOST_RUNS:
        raise SweepError(f"{name}: makes more than {MOST_RUNS:.0g} runs")
    both = sorted(plan.parameters.keys() & plan.inputs.keys())
    if both:
        raise refused(f"inputs.{both[0]}", "stands in [parameters] too")
    if not plan.outputs:
        raise SweepError(f'{name}: has no [outputs]; write such as x = "max" below [outputs]')
    return plan


def _refused(name: str, lines: Lines | None, key: str, reason: str) -> SweepError:
    """Return the refusal of what stands at a key, with its line where the plan has lines."""
    place = f"line {lines.of(key)}: " if lines is not None else ""
    return SweepError(f"{name}: {place}{key} {reason}")


class _WrongError(Exception):
    """A value is wrong: its key and the reason."""

    def __init__(self, key: str, reason: str) -> None:
        self.key, self.reason = key, reason


def _time(key: str, written: Any) -> float:
    above = key in ("step", "time_limit")
    within = "above 0" if above else "at least 0" if key == "settle" else ""
    if isinstance(written, bool) or not isinstance(written, int | float | str):
        raise _WrongError(key, f"= {_shown(written)} is no time; write such as {key} = '3 s'")
    try:
        seconds = typed(written, "s", within) if isinstance(written, str) else float(written)
    except QuantityError as error:
        raise _WrongError(key, f"= {_shown(written)} {error}") from None
    if not math.isfinite(seconds) or (seconds < 0.0 and within) or (seconds == 0.0 and above):
        raise _WrongError(key, f"= {_shown(written)} is out of range: {within or 'finite'}")
    return seconds


def _values(table: str, entries: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, written in _flat(entries):
        key = f"{table}.{name}"
        each = written if isinstance(written, list) else [written]
        if not each:
            raise _WrongError(key, "= [] is empty")
        for value in each:
            if not isinstance(value, float | int | bool | str):
                raise _WrongError(key, f"= {_shown(value)} is neither number nor text")
            if isinstance(value, float) and not math.isfinite(value):
                raise _WrongError(key, f"= {value} is not finite")
        if _count(written) > MOST_VALUES:
            raise _WrongError(key, f"= {_shown(written)} has too many values: over {MOST_VALUES}")
        yield name, written


def _count(written: Written | list[Written]) -> int:
    """Return how many values are written, without making them; a range ends with its number."""
    if isinstance(written, list):
        return len(written)
    words = str(written).split() if BETWEEN in str(written) else []
    return int(words[-1]) if words and _COUNT.fullmatch(words[-1]) else 1


def _outputs(entries: Mapping[str, Any]) -> Iterator[tuple[str, tuple[str, ...]]]:
    for name, written in _flat(entries):
        key = f"outputs.{name}"
        each = written if isinstance(written, list) else [written]
        if not each:
            raise _WrongError(key, "= [] is empty")
        for reduction in each:
            if reduction not in REDUCTIONS:
                near = nearest(str(reduction), REDUCTIONS)
                raise _WrongError(key, f"= {_shown(reduction)} is no reduction; {near}")
        if len(set(each)) < len(each):
            raise _WrongError(key, f"= {_shown(written)} names a reduction twice")
        yield name, tuple(each)


def _flat(entries: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the names of a table with their values: TOML takes a point in a name for a table."""
    for name, value in entries.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def is_tabular(written: Any) -> bool:
    """Whether a value is the name of a file with columns."""
    return isinstance(written, str) and written.lower().endswith(TABULAR)


def _shown(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _not_toml(message: str, name: str, text: str) -> SweepError:
    place = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)$", message)
    line = int(place[1]) if place and place[1] else max(1, len(text.splitlines()))
    reason = message[: place.start()] if place else message
    remedy = "a name stands once, texts and ranges in quotes"
    if _DECIMAL_COMMA.search("".join(text.splitlines()[line - 1 : line])):
        remedy = "a number has a decimal point"
    return SweepError(
        f"{name}: line {line}: is not TOML: {reason[0].lower()}{reason[1:]}; {remedy}"
    )
