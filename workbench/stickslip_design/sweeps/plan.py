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
`template` writes one to begin with.
"""

from __future__ import annotations

import json
import math
import re
import textwrap
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Final, TypeAlias

from pydantic import AfterValidator, BeforeValidator, Field
from pydantic.dataclasses import dataclass

from stickslip_units import BETWEEN, QuantityError, typed
from stickslip_verification.model.data_file import WRITTEN, DataError, DataFile, Written

from .model import Model, SweepError, Variable
from .runs import REDUCTIONS

TIME_LIMIT: Final = 60.0
"""Seconds that a run may take where the plan says nothing."""
MOST_VALUES: Final = 10_000_000
"""Values of one variable, which stand in memory."""
MOST_RUNS: Final = 10**18
"""Runs of a plan: more do not fit into the integers that count them."""

_COUNT: Final = re.compile(r"\d{1,18}", re.ASCII)

MOST_SHOWN = 5
"""Nearest names that a refusal lists."""


Scalar: TypeAlias = float | int | bool | str
"""A value as TOML has it."""


class PlanError(DataError, SweepError):
    """A plan cannot be used."""


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the names most like one that is not known, as the end of a refusal."""
    names = list(known)
    folded = {other.lower(): other for other in names}
    near = [folded[match] for match in get_close_matches(name.lower(), folded, MOST_SHOWN, 0.5)]
    # The last part of a structured name may be all that a person remembers.
    last = name.rpartition(".")[2].lower()
    near += [other for other in names if other.rpartition(".")[2].lower() == last]
    if near:
        return f"nearest: {', '.join([*dict.fromkeys(near)][:MOST_SHOWN])}"
    listed = ", ".join(names[:MOST_SHOWN])
    more = len(names) - MOST_SHOWN
    return f"there is {listed or 'none'}{f' and {more} more' if more > 0 else ''}"


def is_tabular(written: Any) -> bool:
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


def _values(written: Any) -> Any:
    for value in written if isinstance(written, list) else [written]:
        is_number = isinstance(value, float | int) and math.isfinite(value)
        if not (is_number or isinstance(value, str)):
            raise ValueError(f"{value!r} is neither finite number nor text")
    if written == [] or _count(written) > MOST_VALUES:
        raise ValueError(f"has {_count(written)} values; expected 1 to {MOST_VALUES}")
    return written


def _count(written: Scalar | list[Scalar]) -> int:
    """Return how many values are written, without making them; a range ends with its number."""
    if isinstance(written, list):
        return len(written)
    words = str(written).split() if BETWEEN in str(written) else []
    return int(words[-1]) if words and _COUNT.fullmatch(words[-1]) else 1


def _reductions(written: Any) -> tuple[str, ...]:
    names = written if isinstance(written, list) else [written]
    for name in names:
        if name not in REDUCTIONS:
            raise ValueError(f"{name!r} is no reduction; {nearest(str(name), REDUCTIONS)}")
    if len(set(names)) != len(names) or not names:
        raise ValueError(f"{written!r} is not one reduction or several")
    return tuple(names)


def _file(written: str) -> str:
    if not is_tabular(written):
        raise ValueError(f"{written!r} is no file ending in .csv or .parquet")
    return written


_Time = Annotated[float, Field(strict=True), BeforeValidator(_seconds)]
_Table = Annotated[Mapping[str, Annotated[Any, AfterValidator(_values)]], BeforeValidator(_flat)]
_Outputs = Annotated[
    Mapping[str, Annotated[Any, AfterValidator(_reductions)]], BeforeValidator(_flat)
]


@dataclass(frozen=True, config=WRITTEN)
class Plan(Written):
    """What stands in a plan; its variables are not looked at yet. Times are in seconds."""

    start_time: _Time | None = Field(
        None,
        description="first time [s]; default: that of the model's default experiment, else 0",
    )
    stop_time: _Time | None = Field(
        None, description="last time [s]; default: that of the model's default experiment"
    )
    step: _Time | None = Field(
        None,
        gt=0.0,
        description="communication step [s]; default: that of the model's default experiment, "
        "else, where only last values are kept, the whole time",
    )
    settle: _Time | None = Field(
        None, ge=0.0, description="time from the start that reductions leave out [s]; default 0"
    )
    time_limit: _Time | None = Field(
        None, gt=0.0, description="time that a run may take on the clock [s]; default 60"
    )
    reset: Annotated[bool, Field(strict=True)] | None = Field(
        None,
        description="whether one instance does run after run, reset between; default: tried out "
        "first",
    )
    points: Annotated[str, AfterValidator(_file)] = Field(
        "",
        description="file of points, CSV or Parquet, with a column for each variable, in place of "
        "a grid",
    )
    parameters: _Table = Field(
        default_factory=dict,
        description="what is set before a run: a value, a list of values, or LOW..HIGH UNIT log N",
    )
    inputs: _Table = Field(
        default_factory=dict,
        description="what drives a run: as parameters, or a CSV or Parquet file of a column `time` "
        "and others",
    )
    outputs: _Outputs = Field(
        default_factory=dict,
        min_length=1,
        validate_default=True,
        description=f"what is kept, by variable: one or a list of {', '.join(REDUCTIONS)}",
    )

    @property
    def times(self) -> Mapping[str, float]:
        """Its times [s], as far as it states them."""
        names = ("start_time", "stop_time", "step", "settle", "time_limit")
        return {name: time for name in names if (time := getattr(self, name)) is not None}

    @property
    def as_json(self) -> dict[str, Any]:
        """What the results depend on, without the contents of tables."""
        return {
            "times": self.times,
            "reset": self.reset,
            "points": self.points,
            "parameters": dict(self.parameters),
            "inputs": dict(self.inputs),
            "outputs": {name: list(reductions) for name, reductions in self.outputs.items()},
        }


class PlanFile(DataFile):
    """A plan, `says`, with its place for refusals: a file, or what its TOML says.

    `PlanError` if it cannot be read, is not TOML, or has a key or value that is none of a plan.
    """

    def __init__(self, plan: Path | str | Mapping[str, Any]) -> None:
        if isinstance(plan, Mapping):
            self.path, self.data, self._text, self._error = Path("plan"), {**plan}, "", PlanError
        else:
            super().__init__(Path(plan), PlanError)
        self.says: Plan = self.read(Plan)
        set_ = (self.says.parameters, self.says.inputs)
        if math.prod(_count(written) for table in set_ for written in table.values()) > MOST_RUNS:
            raise self.refusal(f"makes more than {MOST_RUNS:.0g} runs")
        for name in set_[0].keys() & set_[1].keys():
            raise self.refused(f"inputs.{name}", "stands in [parameters] too")

    def refused(self, key: str, reason: str) -> SweepError:
        """Return the refusal of what stands at a key, such as ``parameters.k``."""
        error = self.refusal(reason, *key.split(".", 1))
        assert isinstance(error, PlanError)
        return error

    def file(self, written: str) -> Path:
        """Return the path of a table that the plan names."""
        return self.path.parent / written


_WIDE: Final = 100
"""Characters of a line."""
_BARE: Final = re.compile(r"[A-Za-z0-9_-]+(?:\.[A-Za-z0-9_-]+)*")


def template(model: Model) -> str:
    """Return the text of a plan in which every variable of a model stands, most as comments.

    It can be read at once: without changes it does one run and keeps the last values of the
    outputs.
    """
    help_of = {name: str(one.description) for name, one in Plan.__pydantic_fields__.items()}  # type: ignore[attr-defined]
    driven = {wire.input for wire in model.wires}
    usable = [one for one in model.variables.values() if not one.obstacle]
    first = [one for one in usable if one.starts and one.name not in driven]
    stop = model.experiment.get("stop_time", 1.0)
    step = model.experiment.get("step", stop / 1000.0)

    def starts(kind: str) -> list[str]:
        variables = [one for one in first if kind in one.causality.lower()]
        bound = {name: repr(value) for name, value in model.bound.items()}
        return [
            "# " + _entry(one, bound.get(one.name, one.start_text or "0.0")) for one in variables
        ]

    lines = [
        *_comment(f"Plan of stickslip sweep for {model.path.name}. A number is in the unit of its"
                  " variable, which stands behind it; a text may have another: \"40 N/um\"."),
        *_comment('Several values make a grid: [0.3, 0.4], "0.3..0.5 5", "1e3..1e5 N/m log 50".'),
        "",
        f"stop_time = {stop:g}  # s",
        f"step = {step:g}  # s; {help_of['step'].partition(';')[0]}",
        "# settle = 0.0  # s; " + help_of["settle"].partition(" [s]")[0],
        f"# time_limit = {TIME_LIMIT:g}  # s; " + help_of["time_limit"].partition(" [s]")[0],
        "# points = \"points.csv\"  # " + help_of["points"],
        "", *_comment(help_of["parameters"]), "[parameters]", *starts("parameter"),
        "", *_comment(help_of["inputs"]), "[inputs]", *starts("input"),
        "", *_comment("; ".join(f"{name}: {one.meaning}" for name, one in REDUCTIONS.items())),
        "[outputs]", *(_entry(one, '"last"') for one in usable if one.causality == "output"),
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _entry(variable: Variable, value: str) -> str:
    name, about = variable.name, ", ".join(filter(None, (variable.unit, variable.description)))
    quoted = name if _BARE.fullmatch(name) else json.dumps(name, ensure_ascii=False)
    plain = "".join(letter if letter.isprintable() else " " for letter in about)
    return f"{quoted} = {value}" + (f"  # {plain}" if plain else "")


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in textwrap.wrap(text, _WIDE - 2)]
