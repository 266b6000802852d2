"""What a record tells: `identify` recognises its kind and asks the estimator of that kind."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from typing import Final

import numpy as np

from ..axis import Axis
from .excitation import driven
from .jumps import is_stick_slip, stick_slip
from .model import Identified, Number, Record

_MOST_MU, _LEAST_MU = 2.0, 1e-4
"""What no guideway has."""
_HEAVIEST: Final = 1e5
"""More than any table [kg]."""
_OTHER: Final = 3.0
"""A mass, or a way, so many times what is stated, or its part, is in another unit."""
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
    found = _jumping(record, axis) or driven(record, axis)
    faults = (*found.residual.faults, *_implausible(found, record, axis))
    return replace(
        found,
        residual=replace(found.residual, faults=faults),
        notes=(*record.notes, *found.notes),
        following=found.following or _following(found),
    )


def _jumping(record: Record, axis: Axis | None) -> Identified | None:
    """Return what stick-slip tells; None where there is none, or none that can be followed."""
    with suppress(ArithmeticError, ValueError, np.linalg.LinAlgError):
        if is_stick_slip(record, axis):
            return stick_slip(record, axis)
    return None


def _implausible(found: Identified, record: Record, axis: Axis | None) -> Iterator[str]:
    """Yield what no feed axis has: a unit is likely wrong."""
    known = {number.name: number for number in found.numbers if number.known}
    if record.command is not None and record.position is not None and np.ptp(record.command):
        ratio = float(np.ptp(record.position) / np.ptp(record.command))
        if not 1.0 / _OTHER < ratio < _OTHER:
            yield f"the way is {ratio:.3g} times the commanded one (is a unit wrong?)"
    mass = known["axis.mass"].value if "axis.mass" in known else axis.m if axis else None
    load, g = (axis.load, axis.g) if axis else (0.0, 9.81)
    if mass is not None and "friction.F_k" in known:
        mu = known["friction.F_k"].value / (mass * g + load)
        if not _LEAST_MU < mu < _MOST_MU:
            yield f"a coefficient of friction of {mu:.2g} (is a unit wrong?)"
    if any(known[name].high < 0.0 for name in ("axis.mass", "friction.F_k") if name in known):
        yield "mass or friction is negative (is a sign wrong?)"
    if mass is not None and mass > _HEAVIEST:
        yield f"a mass of {1e-3 * mass:.3g} t (is a unit wrong?)"
    if axis and "axis.mass" in known:
        ratio = known["axis.mass"].value / axis.m
        if not 1.0 / _OTHER < ratio < _OTHER:
            yield f"a mass {ratio:.2g} times that of the axis file (is a unit wrong?)"


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
