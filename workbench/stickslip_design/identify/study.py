"""What a record tells: `identify` recognises its kind and asks the estimator of that kind."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from ..axis import Axis
from .evened import evened
from .excitation import excitation
from .model import Identified, Number, Record
from .steady import LEAST_SPEEDS, SHARE, plateaus, steady_runs

_APART: Final = 0.05
"""Two speeds differ by more than this part."""
_MOST_MU, _LEAST_MU = 2.0, 1e-4
_FASTEST, _STRONGEST = 10.0, 200.0
"""What no feed axis has: coefficients of friction, speeds [m/s], accelerations [m/s2]."""
_OTHER: Final = 3.0
"""A mass so many times that of the axis, or its part, is none of it."""
_NEXT: Final = {
    "axis.mass": "accelerate twice as hard, or four times as often",
    "axis.c": "run at twice the speed, or four times as long",
    "c forward": "run forward at twice the speed, or four times as long",
    "c backward": "run backward at twice the speed, or four times as long",
    "friction.F_k": "run slowly, in both directions, four times as long",
    "axis.force_along": "run the same feeds in both directions four times as long",
}


def identify(record: Record, axis: Axis | None = None) -> Identified:
    """Return what a record tells; ValueError if it tells nothing, in a sentence.

    `axis` states the drive, what is known of the table, gravity; without it the drive is rigid.
    """
    if axis is not None and axis.turns:
        raise ValueError("a rotary table is not identified: records are of a slide, in m and N")
    found = _of_kind(record, axis)
    faults = (*found.residual.faults, *_implausible(found, record, axis))
    return replace(
        found,
        residual=replace(found.residual, faults=faults),
        notes=(*record.notes, *found.notes),
        following=found.following or _following(found),
    )


def _of_kind(record: Record, axis: Axis | None) -> Identified:
    runs = evened(record)
    steady, share = plateaus(runs, record.rounding.get("position", 0.0))
    if share >= SHARE and _count([each.speed for each in steady]) >= LEAST_SPEEDS:
        return steady_runs(record, steady, axis)
    return excitation(record, axis)


def _count(speeds: list[float]) -> int:
    """Return how many speeds differ, with their sign."""
    count, last = 0, -np.inf
    for speed in sorted(speeds):
        if speed - last > _APART * abs(speed):
            count, last = count + 1, speed
    return count


def _implausible(found: Identified, record: Record, axis: Axis | None) -> Iterator[str]:
    """Yield what no feed axis has: a unit is likely wrong."""
    known = {number.name: number for number in found.numbers if number.known}
    mass = known["axis.mass"].value if "axis.mass" in known else axis.m if axis else None
    load, g = (axis.load, axis.g) if axis else (0.0, 9.81)
    if mass is not None and "friction.F_k" in known:
        mu = known["friction.F_k"].value / (mass * g + load)
        if not _LEAST_MU < mu < _MOST_MU:
            yield f"a coefficient of friction of {mu:.2g}: is a unit wrong?"
    if axis and "axis.mass" in known:
        ratio = known["axis.mass"].value / axis.m
        if not 1.0 / _OTHER < ratio < _OTHER:
            yield f"a mass {ratio:.2g} times that of the axis file: is a unit wrong?"


def _following(found: Identified) -> str:
    """Return what to measure next, to halve the widest interval."""
    told = [number for number in found.numbers if number.name in _NEXT]
    if not told:
        return ""
    widest = max(told, key=_width)
    return f"The widest interval is that of {widest.meaning}; to halve it, {_NEXT[widest.name]}."


def _width(number: Number) -> float:
    # Of a constant force that may be none the width says nothing.
    return number.width if number.low * number.high > 0.0 else 0.0
