"""What a record tells: `identify` recognises its kind and asks the estimator of that kind."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from ..axis import Axis
from .excitation import driven
from .jumps import stick_slip
from .model import Identified, Number, Record

_NEXT: Final = {
    "kg": "accelerate twice as hard, or four times as often",
    "N.s/m": "run at twice the speed, or four times as long",
    "N": "run slowly in both directions, four times as long",
}
"""What halves the interval of a number, by its unit."""


def identify(record: Record, axis: Axis | None = None) -> Identified:
    """Return what a record tells; ValueError if it tells nothing, in a sentence.

    `axis` states the drive, what is known of the table, gravity; without it the drive is rigid.
    """
    try:
        found = stick_slip(record, axis)
    except (ArithmeticError, ValueError) as still:
        try:
            found = driven(record, axis)
        except ValueError as reason:
            raise ValueError(f"{reason} (no stick-slip either: {still})") from None
    advice = found.next_measurement
    # Of a force that may be none the width says nothing.
    sure = [one for one in found.numbers if one.low * one.high > 0.0 and one.unit in _NEXT]
    if sure and not advice:
        widest = max(sure, key=lambda one: one.width)
        advice = f"To halve the widest interval, of {widest.name}, {_NEXT[widest.unit]}."
    return replace(
        found,
        numbers=tuple(_scaled(one, record.force_spread, axis) for one in found.numbers),
        faults=(*found.faults, *_implausible(found, record, axis)),
        notes=(*record.notes, *found.notes),
        next_measurement=advice,
    )


def _scaled(number: Number, spread: float, axis: Axis | None) -> Number:
    """Return a number with the ± of the scale of the force [-] in its interval.

    It counts with what the motor itself took. Both parts are independent: their squares add up.
    """
    drive = axis.drive if axis else None
    own = {"kg": drive.inertia, "N.s/m": drive.d, "N": drive.dry} if drive else {}
    part = spread * (abs(number.value) + own.get(number.unit, 0.0))
    if not (part and ("N" in number.unit or number.unit == "kg")):
        return number
    below, above = (math.hypot(end - number.value, part) for end in (number.low, number.high))
    return replace(number, low=number.value - below, high=number.value + above)


def _implausible(found: Identified, record: Record, axis: Axis | None) -> Iterator[str]:
    """Yield what no feed axis has: a unit is likely wrong."""
    known = {number.name: number.value for number in found.numbers if number.identified}
    stated, g, load = (axis.m, axis.g, axis.load) if axis else (math.nan, 9.81, 0.0)
    m, F_k = known.get("axis.mass", stated), known.get("friction.F_k", math.nan)
    rows = [
        ("a mass of {:.3g} kg", m, 0.0, 1e5),
        ("a mass {:.2g} times that of the axis file", m / stated, 1.0 / 3.0, 3.0),
        ("kinetic friction of {:.3g} N", F_k, 0.0, math.inf),
        ("a coefficient of friction of {:.2g}", F_k / (m * g + load), 1e-4, 2.0),
    ]
    if record.command is not None and record.position is not None and np.ptp(record.command):
        ratio = float(np.ptp(record.position) / np.ptp(record.command))
        rows.append(("the way is {:.3g} times the commanded one", ratio, 1.0 / 3.0, 3.0))
    if record.force is not None:
        size = np.abs(record.force)
        words = f"the force at {record.t[np.argmax(size)]:.6g} s is {{:.3g}} times that of 99.9 %"
        rows.append((words, float(size.max() / (np.quantile(size, 0.999) or 1e-300)), 0.0, 20.0))
    for words, value, low, high in rows:
        if value <= low or value >= high:
            yield f"{words.format(value)} (is a unit, a sign or a sample wrong?)"
