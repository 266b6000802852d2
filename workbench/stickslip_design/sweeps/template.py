"""A plan to begin with, made of the variables of a model."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from typing import Final

from .job import Variable
from .model import Model
from .plan import TIME_LIMIT, help_of
from .reductions import REDUCTIONS

_WIDE: Final = 100
"""Characters of a line."""
_BARE: Final = re.compile(r"[A-Za-z0-9_-]+(?:\.[A-Za-z0-9_-]+)*")


def template(model: Model) -> str:
    """Return the text of a plan in which every variable of a model stands, most as comments.

    It can be read at once: without changes it does one run and keeps the last values of the
    outputs.
    """
    driven = {wire.input for wire in model.wires}
    usable = [each for each in model.variables.values() if not each.obstacle]
    set_ = [each for each in usable if each.starts and each.name not in driven]
    inputs = [each for each in set_ if each.causality == "input"]
    outputs = [each for each in usable if each.causality == "output"]
    stop = model.experiment.get("stop_time", 1.0)
    step = model.experiment.get("step", stop / 1000.0)
    lines = [
        *_comment(f"Plan of stickslip sweep for {model.path.name}. A number is in the unit of its"
                  " variable, which stands behind it; a text may have another: \"40 N/um\"."),
        *_comment('Several values make a grid: [0.3, 0.4], "0.3..0.5 5", "1e3..1e5 N/m log 50".'),
        "",
        f"stop_time = {stop:g}  # s",
        f"step = {step:g}  # s; {help_of('step').partition(';')[0]}",
        "# settle = 0.0  # s; " + help_of("settle").partition(" [s]")[0],
        f"# time_limit = {TIME_LIMIT:g}  # s; " + help_of("time_limit").partition(" [s]")[0],
        "# points = \"points.csv\"  # " + help_of("points"),
        "",
        *_comment(help_of("parameters")),
        "[parameters]",
        *_entries((each for each in set_ if "parameter" in each.causality.lower()), model.bound),
        "",
        *_comment(help_of("inputs")),
        "[inputs]",
        *_entries(inputs, model.bound),
        "",
        *_comment("; ".join(f"{name}: {each.meaning}" for name, each in REDUCTIONS.items())),
        "[outputs]",
        *(f'{_quoted(each.name)} = "last"{_about(each)}' for each in outputs),
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _entries(variables: Iterable[Variable], bound: Mapping[str, float]) -> Iterator[str]:
    for each in variables:
        start = repr(bound[each.name]) if each.name in bound else each.start_text or "0.0"
        yield f"# {_quoted(each.name)} = {start}{_about(each)}"


def _about(variable: Variable) -> str:
    told = ", ".join(filter(None, (variable.unit, variable.description)))
    return f"  # {_plain(told)}" if told else ""


def _quoted(name: str) -> str:
    return name if _BARE.fullmatch(name) else json.dumps(name, ensure_ascii=False)


def _plain(text: str) -> str:
    return "".join(letter if letter.isprintable() else " " for letter in text)


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in textwrap.wrap(text, _WIDE - 2)]
