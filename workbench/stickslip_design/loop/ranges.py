"""The feeds at which a servo axis sticks and slips, as ranges with both ends."""

from __future__ import annotations

import math
from typing import Final

from stickslip_ref import Interval, merged

from ..axis import Axis
from ..one_thread import one_thread
from .courses import Courses
from .jumps import beginnings, limit_of_jumps

_CLOSE: Final = 2e-3
"""An end that is no fold of the cycle is found to this, relative."""


@one_thread
def jump_ranges(axis: Axis) -> tuple[Interval, ...]:
    """Return the feeds [m/s] at which a servo axis sticks and slips.

    Notes
    -----
    With constant coefficients, and with growth at rest, one range from the slowest feed on. Where
    friction changes with the speed, a motion out of a break-away is followed at the feeds of
    `beginnings`; the upper end of a range is that of `limit_of_jumps`, the lower end is halved.
    """
    if axis.friction.law == "coulomb":
        limit = limit_of_jumps(axis).feed
        return (Interval(0.0, limit, "none", "grazing"),) if limit > 0.0 else ()
    feeds = beginnings(axis)[::-1]
    forms = [_forms(axis, feed) for feed in feeds]
    found: list[Interval] = []
    for first in range(len(feeds)):
        if not forms[first] or (first and forms[first - 1]):
            continue
        last = next((n for n in range(first, len(feeds)) if not forms[n]), len(feeds)) - 1
        low = _end(axis, feeds[first], feeds[first - 1]) if first else 0.0
        high = limit_of_jumps(axis, begin=feeds[last]).feed
        if high < feeds[last] and last + 1 < len(feeds):
            high = _end(axis, feeds[last], feeds[last + 1])
        high = max(high, feeds[last])
        found.append(Interval(low, high, "grazing" if first else "none", "grazing"))
    return merged(found)


def _forms(axis: Axis, feed: float) -> bool:
    """Return whether a motion out of a break-away at a feed goes on to stick and slip."""
    return Courses(axis, feed).course("jumps").kind == "sticks"


def _end(axis: Axis, inside: float, outside: float) -> float:
    """Return the feed [m/s] at which a motion no longer sticks, between two."""
    while abs(outside / inside - 1.0) > _CLOSE:
        middle = math.sqrt(inside * outside)
        if _forms(axis, middle):
            inside = middle
        else:
            outside = middle
    return inside
