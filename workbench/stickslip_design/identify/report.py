"""What a record tells, as a page, in words, and as plain data; and what the axis then does."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from stickslip_units import scale_for, told

from ..axis import AxisError, Drive, axis_file_of
from ..report.page import drawn, plain, rendered
from ..report.tables import Grid
from ..study import design
from ..verdict import Robustness, feed_in_words, judder
from . import plots
from .axis_text import shown
from .model import Identified, Number

FORMAT: Final = 1
"""Rises where a key changes its meaning or goes."""


def scaled(found: Identified, spread: float, drive: Drive | None = None) -> Identified:
    """Return what a record tells with the ± of the scale of its force [-] in its forces and masses.

    It counts with what the motor itself took. Both parts of an interval are independent: their
    squares add up.
    """
    own = dict.fromkeys(("axis.c", "c forward", "c backward"), drive.d) if drive else {}
    own |= {"axis.mass": drive.inertia, "friction.F_k": drive.dry} if drive else {}

    def wider(number: Number) -> Number:
        part = spread * (abs(number.value) + own.get(number.name, 0.0))
        if not part or not number.scales:
            return number
        below, above = (math.hypot(end - number.value, part) for end in (number.low, number.high))
        why = [number.why] * bool(number.why) + [f"± {100.0 * spread:.2g} % of the force's scale"]
        low, high = number.value - below, number.value + above
        return replace(number, low=low, high=high, why="; ".join(why))

    return replace(found, numbers=tuple(map(wider, found.numbers)))


def numbers(found: Identified) -> Grid:
    """Return the numbers with their intervals; the last column says what these come from."""
    rows = []
    for each in found.numbers:
        half = 0.5 * (each.high - each.low)
        *ends, _, unit = shown(each.unit, half, each.value, each.low, each.high)
        value, *ends = (end.replace("-", "\N{MINUS SIGN}").replace("inf", "∞") for end in ends)
        width = f"{100.0 * each.width:.2g} %" if each.identified else "not identified"
        rows.append((each.name, each.meaning, f"{value} {unit}".strip(), *ends, width, each.why))
    head = ("number", "what it is", "value", "from", "to", "±", "why so wide")
    return Grid(head, rows, frozenset({2, 3, 4, 5}))


def explains(found: Identified) -> str:
    """Return whether the model explains the record, and what the fit leaves of it."""
    left = found.residual
    if left.faults:
        return f"The model does not explain the record: {'; '.join(left.faults)}."
    lag, correlation = left.at
    memory = f"its correlation is {correlation:.2f} at {told(lag, 's')}" if left.memory else "white"
    scale = scale_for(left.rms, left.unit)
    return f"The model explains the record: it leaves noise of {scale.told(left.rms)}, {memory}."


def sentence(text: str, name: str, folder: Path | None = None) -> str:
    """Return in a sentence what the axis of a file does, and what ends that; or what is missing.

    Shares are of 64 machines within the ± of the file, each value in it as likely as another.
    """
    try:
        verdict = design(axis_file_of(text, name, folder))
    except AxisError as error:
        return f"These numbers are not enough for a verdict: {error.key} {error.reason}."
    worst, usual = judder(verdict.points), verdict.varied_by_default
    if verdict.robustness is None or not verdict.stable:
        return verdict.sentence
    clean, within = _clean(verdict.robustness), "of what their ± allow"
    within += f" (of {', '.join(usual)} the usual ±)" if usual else ""
    if worst is None:
        return f"With these numbers the axis moves evenly at its feeds in {clean} % {within}."
    others = " or another of its feeds" * (len(verdict.points) > 1)
    enough = [one for one in verdict.measures if one.enough and one.effort != "program"]
    surest = sorted(enough, key=lambda one: -_clean(one.robustness))
    ends = [
        f"{one.name} ({one.effort}) ends that in {_clean(one.robustness)} %"
        for one in dict.fromkeys((*enough[:1], *surest[:1]))
    ]
    return (
        f"With these numbers the axis {'jumps' if worst.jumps else 'swings'} at "
        f"{feed_in_words(worst.feed)}{others} in {100 - clean} % {within}; "
        f"{', '.join(ends) or 'no measure of the catalogue ends that'}."
    )


def _clean(found: Robustness | None) -> int:
    return 100 * found.clean // found.machines if found else 0


def html(found: Identified, source: str, then: str) -> str:
    """Return the page of a record by its name: the first on paper (A4) for a meeting, the rest.

    `then` is the sentence on the axis. The same gives the same text.
    """
    table = numbers(found)
    return rendered(
        "identified.html.j2",
        found=found,
        source=source,
        then=then,
        explains=explains(found),
        numbers=table.of(*range(6)),
        widths=[row for row in table.rows if row[-1]],
        courses=drawn(plots.courses(found), "record", "The record, the fit, and what it leaves"),
        friction=drawn(plots.friction(found), "friction", "Friction over the speed"),
    )


def data(found: Identified, source: str, then: str) -> dict[str, Any]:
    """Return what a record tells as what JSON knows [SI]; without its samples."""
    return {
        "format": FORMAT,
        "record": source,
        "sentence": then,
        "explained": found.explained,
        **plain(replace(found, traces=())),
        "numbers": [
            plain(each) | {"width": plain(each.width), "identified": each.identified}
            for each in found.numbers
        ],
    }
