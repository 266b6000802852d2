"""A plan to begin with, made of the variables of a model."""

from __future__ import annotations

import json
import re
import textwrap
from typing import Final

from .model import Model, Variable
from .plan import TIME_LIMIT, Plan
from .reductions import REDUCTIONS

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
