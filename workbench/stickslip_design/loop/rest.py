"""What a servo axis does after a start from rest: whether it still jumps when it has settled."""

from __future__ import annotations

import math
from typing import Final

from ..axis import Axis
from ..one_thread import one_thread
from .jumps import limit_of_jumps
from .motion import Motion, Point, walk
from .system import Mode, System

PERIODS: Final = 20
"""Periods over which a start settles; the last of them decides."""

_CLOSE: Final = 2e-3
"""The feed is found to this, relative."""
_LOWER: Final = 0.9
_MOST: Final = 40


class Start:
    """Starts of a servo axis from rest, the spring relaxed, with an acceleration [m/s2] above 0."""

    def __init__(self, axis: Axis, acceleration: float) -> None:
        self._axis, self._acceleration = axis, acceleration
        self._motion = Motion(System(axis))

    @one_thread
    def jumps(self, feed: float) -> bool:
        """Return whether the table rests again in the last of the periods at a feed [m/s]."""
        axis, system = self._axis, self._motion.system
        held = system.held(axis.F_s / (axis.k * feed))
        relief = 2.0 * (held - axis.F_k) / axis.k
        period = relief / feed + 2.0 * math.pi * math.sqrt(axis.m / axis.k)
        state = system.at_rest()
        state[system.layout.acceleration] = self._acceleration
        mode = Mode(0, 0 if system.drive.dry > 0.0 else 1)
        ramp = feed / self._acceleration
        *_, reached = walk(self._motion, mode, Point(state, 0.0), ramp)
        if reached.event != "time":
            return True
        state = reached.point.state.copy()
        state[[system.layout.feed, system.layout.acceleration]] = feed, 0.0
        # The first break-away comes when the motor has loaded the spring.
        first = held / (axis.k * feed)
        end = first + PERIODS * period
        rested = -math.inf
        turn = reached
        for turn in walk(self._motion, reached.mode, Point(state, reached.point.offset), end):
            if turn.event == "stop" and turn.mode.table == 0:
                rested = turn.time
        return turn.mode.table == 0 or turn.event != "time" or rested > end - period

    @one_thread
    def limit(self, highest: float | None = None) -> float:
        """Return the feed [m/s] above which the axis moves evenly after a start; 0 if always.

        It is searched from the highest feed that is reached in jumps downwards.
        """
        high = limit_of_jumps(self._axis).feed if highest is None else highest
        low = high
        for _ in range(_MOST):
            if low == 0.0 or self.jumps(low):
                break
            high, low = low, _LOWER * low
        else:
            return 0.0
        while high - low > _CLOSE * high:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.jumps(middle) else (low, middle)
        return low
