"""What a record tells: `identify` recognises its kind and asks the estimator of that kind."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from typing import Final

import numpy as np

from ..axis import Axis
from .excitation import driven
from .jumps import stick_slip
from .model import Identified, Record

_MOST_MU, _LEAST_MU, _HEAVIEST = 2.0, 1e-4, 1e5
"""Coefficients of friction that no guideway has, and more than any table [kg]."""
_SPIKE: Final = 20.0
"""The greatest force, over that of all but one in a thousand samples, that is a disturbance."""
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
    found = None
    with suppress(ArithmeticError, ValueError, np.linalg.LinAlgError):
        found = stick_slip(record, axis)
    found = found or driven(record, axis)
    # Of a constant force that may be none the width says nothing.
    widths = [
        (one.width if one.low * one.high > 0.0 else 0.0, one.meaning, _NEXT[one.name])
        for one in found.numbers
        if one.name in _NEXT
    ]
    advice = ""
    if widths:
        _, widest, remedy = max(widths, key=lambda one: one[0])
        advice = f"The widest interval is that of {widest}; to halve it, {remedy}."
    faults = (*found.residual.faults, *_implausible(found, record, axis))
    return replace(
        found,
        residual=replace(found.residual, faults=faults),
        notes=(*record.notes, *found.notes),
        next_measurement=found.next_measurement or advice,
    )


def _implausible(found: Identified, record: Record, axis: Axis | None) -> Iterator[str]:
    """Yield what no feed axis has: a unit is likely wrong."""
    known = {number.name: number for number in found.numbers if number.identified}
    ratios = []
    if record.command is not None and record.position is not None and np.ptp(record.command):
        ratio = float(np.ptp(record.position) / np.ptp(record.command))
        ratios.append(("the way is {:.3g} times the commanded one", ratio))
    mass, rubs = axis.m if axis else None, known.get("friction.F_k")
    if "axis.mass" in known:
        mass = known["axis.mass"].value
        if axis:
            ratios.append(("a mass {:.2g} times that of the axis file", mass / axis.m))
    for words, ratio in ratios:
        if not 1.0 / _OTHER < ratio < _OTHER:
            yield f"{words.format(ratio)} (is a unit wrong?)"
    load, g = (axis.load, axis.g) if axis else (0.0, 9.81)
    if mass is not None and rubs:
        mu = rubs.value / (mass * g + load)
        if not _LEAST_MU < mu < _MOST_MU:
            yield f"a coefficient of friction of {mu:.2g} (is a unit wrong?)"
    if any(known[name].high < 0.0 for name in ("axis.mass", "friction.F_k") if name in known):
        yield "mass or friction is negative (is a sign wrong?)"
    if record.force is not None:
        size = np.abs(record.force)
        worst, usual = int(np.argmax(size)), float(np.quantile(size, 0.999))
        if size[worst] > _SPIKE * usual:
            at = f"{size[worst]:.3g} N at {record.t[worst]:.6g} s"
            yield f"a force of {at}, beside {usual:.3g} N (is that sample disturbed?)"
    if mass is not None and mass > _HEAVIEST:
        yield f"a mass of {1e-3 * mass:.3g} t (is a unit wrong?)"
