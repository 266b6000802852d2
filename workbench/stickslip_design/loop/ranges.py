"""The feeds at which a servo axis sticks and slips, as ranges with both ends."""

from __future__ import annotations

import math
from typing import Final

from stickslip_ref import STICKS, Interval, merged

from ..axis import Axis
from ..one_thread import one_thread
from .courses import jolted
from .jumps import beginnings, limit_of_jumps

_RUNG, _RUNGS = 1.25, 12
_CLOSE: Final = 2e-3
"""An end that is no fold of the cycle is found to this, relative."""


@one_thread
def jump_ranges(axis: Axis) -> tuple[Interval, ...]:
    """Return the feeds [m/s] at which a servo axis sticks and slips.

    With constant coefficients, and with growth at rest, there is one range from the slowest feed
    on. Beyond it, and where friction changes with the speed, motions out of a break-away and out of
    a blow are followed: at `_RUNGS` feeds apart by `_RUNG`, or at those of `beginnings`. The upper
    end of a range is that of `limit_of_jumps`, or found by halving as the lower end is. Narrower
    ranges than between two feeds may be missed.
    """
    if axis.friction.law != "coulomb":
        return merged(_scanned(axis, beginnings(axis)[::-1], 0.0))
    limit = limit_of_jumps(axis).feed
    slow = [Interval(0.0, limit, "none", "grazing")] if limit > 0.0 else []
    below = limit or beginnings(axis)[0]
    feeds = [below * _RUNG**number for number in range(1, _RUNGS + 1)] if below > 0.0 else []
    return merged([*slow, *_scanned(axis, feeds, below)])


def _scanned(axis: Axis, feeds: list[float], below: float) -> list[Interval]:
    """Return the ranges that a scan of rising feeds meets; a first one may begin at `below`."""
    forms = [_forms(axis, feed) for feed in feeds]
    found: list[Interval] = []
    for first in range(len(feeds)):
        if not forms[first] or (first and forms[first - 1]):
            continue
        last = next((n for n in range(first, len(feeds)) if not forms[n]), len(feeds)) - 1
        without = feeds[first - 1] if first else below
        low = _end(axis, feeds[first], without) if without > 0.0 else 0.0
        high = limit_of_jumps(axis, begin=feeds[last]).feed
        if high < feeds[last] and last + 1 < len(feeds):
            high = _end(axis, feeds[last], feeds[last + 1])
        high = max(high, feeds[last])
        found.append(Interval(low, high, "grazing" if low > 0.0 else "none", "grazing"))
    return found


def _forms(axis: Axis, feed: float) -> bool:
    """Return whether a motion out of a break-away or a blow at a feed goes on to stick and slip."""
    return any(kind == STICKS for kind in jolted(axis, feed))


def _end(axis: Axis, inside: float, outside: float) -> float:
    """Return the feed [m/s] at which a motion no longer sticks, between two."""
    while abs(outside / inside - 1.0) > _CLOSE:
        middle = math.sqrt(inside * outside)
        inside, outside = (middle, outside) if _forms(axis, middle) else (inside, middle)
    return inside
