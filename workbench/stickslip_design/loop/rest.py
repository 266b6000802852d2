"""A servo axis about rest: whether it still jumps after a start, whether it hunts about a target.

docs/feed-axis.md has the second.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from ..axis import Axis
from ..one_thread import one_thread
from .motion import Motion, Point, walk
from .system import TABLE, Mode, System

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
    motion = Motion(System(axis))
    low = high = highest
    for _ in range(_MOST):
        if low == 0.0 or _jumps(motion, acceleration, low):
            break
        high, low = low, _LOWER * low
    else:
        return 0.0
    while high - low > _CLOSE * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _jumps(motion, acceleration, middle) else (low, middle)
    return low


def _jumps(motion: Motion, acceleration: float, feed: float) -> bool:
    """Return whether the table rests again in the last of the periods at a feed [m/s]."""
    system = motion.system
    axis = system.axis
    held = system.held(axis.F_s / (axis.k * feed))
    relief = 2.0 * (held - axis.F_k) / axis.k
    period = relief / feed + 2.0 * math.pi * math.sqrt(axis.m / axis.k)
    state = system.at_rest()
    state[system.layout.acceleration] = acceleration
    mode = Mode(0, 0 if system.drive.dry > 0.0 else 1)
    *_, turn = walk(motion, mode, Point(state, 0.0), feed / acceleration)
    if turn.event != "time":
        return True
    mode, (state, offset) = turn.mode, turn.point
    state = state.copy()
    state[[system.layout.feed, system.layout.acceleration]] = feed, 0.0
    # The first break-away comes when the motor has loaded the spring.
    end = held / (axis.k * feed) + PERIODS * period
    rested = -math.inf
    for turn in walk(motion, mode, Point(state, offset), end):
        if turn.event == "stop" and turn.mode.table == 0:
            rested = turn.time
    return turn.mode.table == 0 or turn.event != "time" or rested > end - period


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
    system = System(axis)
    motion = Motion(system)
    state = system.at_rest()
    target = (axis.F_s - axis.F_k) / axis.k
    state[system.layout.command] = target
    broke: list[float] = []
    rests: list[float] = []
    mode = Mode(0, 0 if system.drive.dry > 0.0 else 1)
    point, passed = Point(state, 0.0), 0.0
    while len(rests) < _SLIPS:
        for turn in walk(motion, mode, point, _LONGEST):
            mode, point = turn.mode, turn.point
            if turn.event in ("forward", "backward"):
                broke.append(passed + turn.time)
            elif turn.event == "stop":
                rests.append(float(point.state[TABLE]))
                passed += turn.time
                break
        else:
            return None
    jump = abs(rests[-1] - rests[-2])
    left = max(abs(rest - target) for rest in rests[-2:])
    if not jump > _NOTHING * target:
        return None
    return Hunting(jump, broke[-1] - broke[-3], left)
