"""Whether a servo axis hunts about a target that it holds: docs/feed-axis.md."""

from __future__ import annotations

from typing import Final, NamedTuple

from ..axis import Axis
from ..one_thread import one_thread
from .motion import Motion, Point, walk
from .system import TABLE, Mode, System

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
