"""The answer for an axis in words, its numbers in units as engineers write them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from stickslip_ref import CriticalVelocity, Interval

from .axis import Axis
from .loop.stability import gain_limits
from .shown import EXACT, number, per_minute, shown_in, told
from .verdict import WORTHWHILE, AxisCure, OperatingPoint, judder, smallest

_SLOW: Final = 1e-3
"""Feeds below this are given in mm/min [m/s]."""


def feed_in_words(feed: float) -> str:
    """Return a feed [m/s]: in mm/min where it is slow, else in mm/s."""
    if feed < _SLOW:
        return f"{per_minute(feed, EXACT)} mm/min"
    return told(feed, "m/s", EXACT)


def in_words(
    axis: Axis,
    limits: CriticalVelocity,
    points: Sequence[OperatingPoint],
    cures: Sequence[AxisCure],
    *,
    stable: bool,
) -> str:
    """Return the answer for an axis in a few sentences; points and cures as of `Verdict`."""
    if not stable:
        return _unstable(axis)
    worst, ends = judder(points), _ends(axis, limits)
    if worst is not None:
        said = [f"{_judder(worst)}; {ends}.", _start(axis, worst), _smallest(cures)]
        return " ".join(filter(None, said))
    if not limits.cycle and not limits.unstable:
        return "This axis does not jump at any feed, and moves evenly at each."
    if not points:
        return f"This axis can judder; {ends}."
    least = min(points, key=lambda point: point.margin)
    return (
        f"At the feeds asked for this axis moves evenly; {_where(limits)}. "
        f"The least margin is {number(least.margin)}, at {feed_in_words(least.feed)}."
    )


def ranges_in_words(ranges: Sequence[Interval]) -> str:
    """Return ranges of the feed in words: up to 3.95 mm/s, from 4.26 to 56.6 mm/s."""
    return " and ".join(_range(interval) for interval in ranges)


def _where(limits: CriticalVelocity) -> str:
    """Return where an axis jumps and swings."""
    said = [f"it jumps {ranges_in_words(limits.cycle)}"] if limits.cycle else []
    if limits.unstable:
        said.append(f"even motion is unstable {ranges_in_words(limits.unstable)}")
    return "; ".join(said)


def _range(interval: Interval) -> str:
    endless = math.isinf(interval.high)
    if interval.low_end == "none":
        return "at every feed" if endless else f"up to {told(interval.high, 'm/s')}"
    if endless:
        return f"from {told(interval.low, 'm/s')} on"
    return f"from {shown_in(interval.low, 'm/s')} to {told(interval.high, 'm/s')}"


def _ends(axis: Axis, limits: CriticalVelocity) -> str:
    """Return where jumps and swings end."""
    said = []
    if limits.cycle:
        critical = limits.highest
        if math.isinf(critical):
            said.append("without damping the jumps have no end at any feed")
            if axis.drive is None and axis.c == 0.0:
                said[0] += ": state c or zeta of the axis"
        elif len(limits.cycle) == 1 and limits.cycle[0].low_end == "none":
            said.append(f"from {told(critical, 'm/s')} on it cannot")
        else:
            return _where(limits)
    said += [_where(limits._replace(cycle=()))] if limits.unstable else []
    return "; ".join(said)


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


def _judder(point: OperatingPoint) -> str:
    at = feed_in_words(point.feed)
    cycle, swings = point.regime.stick_slip, point.regime.swings
    if cycle is None and swings:
        swing = swings[0]
        return (
            f"At {at} this axis swings by ± {number(100.0 * swing.amplitude, 2)} % of the feed, "
            f"{number(swing.frequency)} times a second, and never stops"
        )
    if cycle is None:
        return f"At {at} even motion of this axis is unstable"
    if point.jump is None or point.frequency is None:
        return f"At {at} this axis hunts along the way: the drive turns it back between two jumps"
    often = f"{number(point.frequency, 2)} times a second"
    back = ", turning back between them" if cycle.reverses else ""
    return f"At {at} this axis jumps {told(point.jump, 'm')}, {often}{back}"


def _start(axis: Axis, point: OperatingPoint) -> str:
    if point.after_start is not False:
        return ""
    return (
        f"After a start from rest with {number(axis.demand.acceleration, EXACT)} m/s² it moves "
        "evenly there, but a shove or a slower start makes it jump."
    )


def _smallest(cures: Sequence[AxisCure]) -> str:
    found = smallest(cures)
    if not found:
        return f"No number alone ends that, changed by a factor of {WORTHWHILE:g}."
    best = found[0]
    now, then = told(best.now, best.unit, EXACT), told(best.then, best.unit, EXACT)
    held = f" ({best.held} held)" if best.held else ""
    return f"Smallest change: {best.name}, {best.number} from {now} to {then}{held}."
