"""The circular test of ISO 230-4 on two axes, and the reversal value of ISO 230-2.

docs/reversal.md says where the definitions are from, and what was not seen of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from .follower import Command, Follower, Vector

POINTS: Final = 18_000
"""Points on a circle: a degree has fifty."""
_SETTLED: Final = 10.0
"""Time constants of the slowest motion after which a start is forgotten."""
_MOST_TURNS: Final = 20
_BEFORE, _AFTER = math.radians(5.0), math.radians(45.0)
"""Where the glitch of a reversal is looked for, in the direction of travel."""
_ACCELERATION: Final = 0.1
"""With which a target is approached where the axis file states none [m/s2]."""
DWELL: Final = 2.0
"""Time at a target after which its position is read [s]."""


class Glitch(NamedTuple):
    """What the radius does where an axis reverses."""

    angle: float
    """Where on the circle the axis reverses [rad]."""
    height: float
    """From the radius 5 degrees before to the farthest one up to 45 degrees after [m], outward."""
    width: float
    """Length of the path over which it is more than half of that [m]."""


@dataclass(frozen=True)
class Circle:
    """A circular test in both directions.

    Attributes
    ----------
    feed, radius
        Of the command [m/s, m].
    share
        Part of Coulomb friction that is fed forward.
    counterclockwise, clockwise
        Deviation of the radius [m] from that of the command, over `POINTS` equal steps of the
        polar angle from 0 on, each of shape (n,).
    """

    feed: float
    radius: float
    share: float
    counterclockwise: Vector
    clockwise: Vector

    @property
    def G_b(self) -> float:  # noqa: N802 - the symbol of ISO 230-4
        """Bi-directional circular deviation G(b) [m]: width of the ring that holds both paths."""
        both = self._centred
        return float(both.max() - both.min())

    @property
    def G(self) -> float:  # noqa: N802 - as G_b
        """Circular deviation G [m] of one path, the larger one."""
        return float(np.ptp(self._centred, axis=1).max())

    @property
    def D(self) -> float:  # noqa: N802 - as G_b
        """Mean bi-directional radial deviation D [m]: mean radius less that of the command."""
        return float(np.mean((self.counterclockwise, self.clockwise)))

    @property
    def F(self) -> tuple[float, float]:  # noqa: N802 - as G_b
        """Radial deviations F_max and F_min [m]: the largest and the smallest of both paths."""
        both = self._centred
        return float(both.max()), float(both.min())

    @property
    def H(self) -> float:  # noqa: N802 - as G_b
        """Circular hysteresis H of the edition of 1996 [m]: between the paths at one angle."""
        one, other = self._centred
        return float(np.abs(one - other).max())

    @property
    def glitches(self) -> tuple[Glitch, ...]:
        """What the radius does at the four reversals, counterclockwise from 0 on."""
        return tuple(self._glitch(0.5 * math.pi * quadrant) for quadrant in range(4))

    @property
    def glitch(self) -> Glitch:
        """The highest of them."""
        return max(self.glitches, key=lambda each: abs(each.height))

    @property
    def _centred(self) -> Vector:
        """Both paths about the centre of their least-squares circle, of shape (2, n).

        The paths mirror themselves at it, so that it is the centre of the narrowest ring as well.
        """
        both: Vector = np.array((self.counterclockwise, self.clockwise))
        for wave in (np.cos(ANGLES), np.sin(ANGLES)):
            both -= 2.0 * np.mean(both * wave) * wave
        return both

    def _glitch(self, angle: float) -> Glitch:
        step = 2.0 * math.pi / POINTS
        first = round((angle - _BEFORE) / step)
        seen = np.roll(self.counterclockwise, -first)[: round((_BEFORE + _AFTER) / step)]
        rise = seen - seen[0]
        peak = int(np.argmax(np.abs(rise)))
        below = np.flatnonzero(rise * np.sign(rise[peak]) <= 0.5 * abs(rise[peak]))
        start = below[below < peak].max(initial=0)
        end = below[below > peak].min(initial=rise.size)
        width = max(end - start - 1, 0) * step * self.radius
        return Glitch(angle, float(rise[peak]), width if rise[peak] else 0.0)


ANGLES: Final[Vector] = np.linspace(0.0, 2.0 * math.pi, POINTS, endpoint=False)
"""Polar angles of the points of a circle [rad]."""


def circle(one: Follower, other: Follower, feed: float, radius: float, share: float) -> Circle:
    """Run a circle with a part of Coulomb friction fed forward: [m/s], [m], `share` of 1.

    The axis `one` is that of the angle 0. The other direction mirrors the command of the second
    axis, and so its motion, as nothing in an axis knows directions.
    """
    first = _deviation(one, feed, radius, share)
    second = first if other is one else _deviation(other, feed, radius, share)
    x = radius * np.cos(ANGLES) + np.roll(first, -POINTS // 4)
    y = radius * np.sin(ANGLES) + second
    return Circle(feed, radius, share, _radial(x, y, radius), _radial(x, -y, radius))


def _radial(x: Vector, y: Vector, radius: float) -> Vector:
    """Return the deviation of the radius over `ANGLES`."""
    found: Vector = np.interp(
        ANGLES, np.arctan2(y, x), np.hypot(x, y) - radius, period=2.0 * math.pi
    )
    return found


def _deviation(axis: Follower, feed: float, radius: float, share: float) -> Vector:
    """Return the deviation from a command of radius sin(angle) over `ANGLES`, in a late turn."""
    w = feed / radius
    turn = 2.0 * math.pi / w
    rate = max(axis.decay * turn, _SETTLED / _MOST_TURNS)
    turns = 1 + math.ceil(_SETTLED / rate)
    command = Command(
        lambda t: feed * math.cos(w * t),
        lambda t: -feed * w * math.sin(w * t),
        (0.0, *(turn * (0.25 + 0.5 * half) for half in range(2 * turns)), turns * turn),
    )
    forward = share * sum(each.kinetic for each in axis.contacts)
    at = turn * (turns - 1) + ANGLES / w
    return axis.follow(command, axis.moving(feed, forward), at, forward)


def reversal_value(axis: Follower, feed: float, acceleration: float | None) -> float:
    """Return the reversal value B of an axis [m]: where it rests from below, less from above.

    It comes at a feed [m/s], brakes with an acceleration [m/s2], and is read after `DWELL`. From
    above is the mirror of from below.
    """
    slows = feed / (acceleration or _ACCELERATION)
    command = Command(
        lambda t: feed * max(1.0 - t / slows, 0.0),
        lambda t: -feed / slows if t < slows else 0.0,
        (0.0, slows, slows + 1.001 * DWELL),
    )
    found = axis.follow(command, axis.moving(feed), np.array([slows + DWELL]))
    return 2.0 * float(found[0])
