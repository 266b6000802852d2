"""The answer for an axis in words, its numbers in units as engineers write them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from .axis import Axis
from .loop.stability import gain_limits
from .shown import EXACT, number, per_minute, told
from .verdict import WORTHWHILE, AxisCure, OperatingPoint, cheapest

_SLOW: Final = 1e-3
"""Feeds below this are given in mm/min [m/s]."""


def feed_in_words(feed: float) -> str:
    """Return a feed [m/s]: in mm/min where it is slow, else in mm/s."""
    if feed < _SLOW:
        return f"{per_minute(feed, EXACT)} mm/min"
    return told(feed, "m/s", EXACT)


def in_words(
    axis: Axis,
    critical: float,
    points: Sequence[OperatingPoint],
    cures: Sequence[AxisCure],
    *,
    stable: bool,
) -> str:
    """Return the answer for an axis in a few sentences.

    Parameters
    ----------
    axis
        The axis.
    critical
        Its critical feed [m/s].
    points
        Its operating points, the slowest feed first.
    cures
        The cures, the cheapest first.
    stable
        Whether its loop is stable.
    """
    if not stable:
        return _unstable(axis)
    if critical == 0.0:
        return "This axis does not jump at any feed."
    ends = f"from {told(critical, 'm/s')} on it cannot"
    if math.isinf(critical):
        ends = "without damping the jumps have no end at any feed"
        if axis.drive is None and axis.c == 0.0:
            ends += ": state c or zeta of the axis"
    if not points:
        return f"This axis can jump; {ends}."
    slowest = points[0]
    at = feed_in_words(slowest.feed)
    if not slowest.jumps:
        return (
            f"At {at}, the slowest feed, this axis cannot jump: its jumps end at "
            f"{told(critical, 'm/s')}, so the margin is {number(slowest.margin)}."
        )
    return " ".join([f"{_judder(slowest, at)}; {ends}.", *_start(axis, slowest), *_cheapest(cures)])


def _unstable(axis: Axis) -> str:
    gains = gain_limits(axis)
    cures = [
        f"{name} below {told(limit, '1/s')}"
        for name, limit in (("K_v", gains.K_v), ("a bandwidth", gains.bandwidth))
        if 0.0 < limit < math.inf
    ]
    bears = f" It bears {' or '.join(cures)}, all else held." if cures else ""
    return (
        "The loop of this axis is unstable: with these gains it swings by itself, whatever the "
        f"friction.{bears} Nothing else is answered before that is mended."
    )


def _judder(point: OperatingPoint, at: str) -> str:
    if point.jump is None or point.frequency is None:
        return f"At {at} this axis hunts along the way: the drive turns it back between two jumps"
    often = f"{number(point.frequency, 2)} times a second"
    return f"At {at} this axis jumps {told(point.jump, 'm')}, {often}"


def _start(axis: Axis, point: OperatingPoint) -> list[str]:
    if point.from_rest is not False:
        return []
    acceleration = axis.demand.acceleration or 0.0
    return [
        f"After a start from rest with {number(acceleration, EXACT)} m/s² it moves evenly there, "
        "but a shove or a slower start makes it jump."
    ]


def _cheapest(cures: Sequence[AxisCure]) -> list[str]:
    found = cheapest(cures)
    if not found:
        return [f"No number alone ends that, changed by a factor of {WORTHWHILE:g}."]
    best = found[0]
    assert best.then is not None
    now, then = told(best.now, best.unit, EXACT), told(best.then, best.unit, EXACT)
    held = f" ({best.held} held)" if best.held else ""
    return [f"Cheapest cure: {best.name}, {best.number} from {now} to {then}{held}."]
