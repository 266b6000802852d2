"""A servo axis about rest: whether it still jumps after a start, whether it hunts about a target.

docs/feed-axis.md has the second.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from ..axis import Axis
from ..one_thread import one_thread
from .motion import MOST_TURNS, Point, Turn, Watched, walk
from .stability import settling
from .system import Mode, System, system_of

PERIODS: Final = 20
"""Periods over which a start settles; the last of them decides."""

_CLOSE: Final = 2e-3
"""The feed is found to this, relative."""
_LOWER: Final = 0.9
_MOST: Final = 40


@one_thread
def limit_from_rest(axis: Axis, acceleration: float, highest: float) -> float:
    """Return the feed [m/s] above which a servo axis moves evenly after a start; 0 if always.

    It starts from rest, the spring relaxed, with an acceleration [m/s2] above 0. The feed is
    searched from the highest that is reached in jumps downwards.
    """
    system = system_of(axis)
    low = high = highest
    for _ in range(_MOST):
        if low == 0.0 or _jumps(system, acceleration, low):
            break
        high, low = low, _LOWER * low
    else:
        return 0.0
    while high - low > _CLOSE * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _jumps(system, acceleration, middle) else (low, middle)
    return low


def _jumps(system: System, acceleration: float, feed: float) -> bool:
    """Return whether the table rests again in the last of the periods at a feed [m/s]."""
    axis = system.axis
    held = system.held(axis.F_s / (axis.k * feed))
    relief = 2.0 * (held - axis.F_k) / axis.k
    period = relief / feed + 2.0 * math.pi * math.sqrt(axis.m / axis.k)
    state = system.at_rest()
    state[system.layout.acceleration] = acceleration
    ramp = feed / acceleration
    # The first break-away comes when the motor has loaded the spring.
    end = ramp + held / (axis.k * feed) + PERIODS * period
    mode = Mode(0, 0 if system.drive.dry > 0.0 else 1)
    watched = Watched(end, ramp=ramp, feed=feed, settles=settling(axis))
    following = walk(system, mode, Point(state, 0.0), watched)
    turns = following.turns(MOST_TURNS)
    rested = max((turn.time for turn in turns if turn.mode.table == 0), default=-math.inf)
    return following.mode.table == 0 or not following.over or rested > end - period


_SLIPS: Final = 24
"""Slips that are followed; the last two are the answer."""
_NOTHING: Final = 1e-3
"""A jump this short, relative to half the relief of the spring, is a swing that dies away."""
_LONGEST: Final = 100.0
"""An axis without a slip for this time [s] rests for good."""


class Hunting(NamedTuple):
    """The cycle of an axis about its target."""

    jump: float
    """Way of the table in a slip [m]."""
    period: float
    """Of a jump there and a jump back [s]."""
    dead_band: float
    """The smallest dead band that ends it [m]: the largest error at which the table rests."""


@one_thread
def hunting(axis: Axis) -> Hunting | None:
    """Return the cycle of a servo axis that holds a target, None where it comes to rest.

    The dead band is taken as 0. The table stands half the relief of the spring away from the
    target, drive and spring at rest.
    """
    system = system_of(axis)
    state = system.at_rest()
    target = (axis.F_s - axis.F_k) / axis.k
    state[system.layout.command] = target
    mode = Mode(0, 0 if system.drive.dry > 0.0 else 1)
    following = walk(system, mode, Point(state, 0.0), Watched(_LONGEST, _LONGEST, _LONGEST))
    turns: list[Turn] = []
    while (rests := [turn for turn in turns if turn.event == "stop"])[_SLIPS - 1 :] == []:
        found = following.turns(2 * _SLIPS - len(rests))
        if not found:
            return None
        turns += found
    broke = [turn.time for turn in turns if turn.event != "stop"]
    jump = abs(rests[-1].place - rests[-2].place)
    left = max(abs(rest.place - target) for rest in rests[-2:])
    if not jump > _NOTHING * target:
        return None
    return Hunting(jump, broke[-1] - broke[-3], left)
