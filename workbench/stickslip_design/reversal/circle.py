"""The circular test of ISO 230-4 on two axes, and the reversal value of ISO 230-2.

docs/reversal.md says where the definitions are from, and what was not seen of them.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from stickslip_units import EXACT, number, told

from ..loop.follower import Follower, Matrix, Vector

POINTS: Final = 72_000
"""Points on a circle: a degree has two hundred."""
ANGLES: Final[Vector] = np.linspace(0.0, 2.0 * math.pi, POINTS, endpoint=False)
"""Their polar angles [rad]."""
_STEP: Final = 2.0 * math.pi / POINTS
_SETTLED: Final = 10.0
"""Time constants of the slowest motion after which a start is forgotten."""
_MOST_TURNS: Final = 20
_BEFORE, _AFTER = math.radians(5.0), math.radians(45.0)
"""Where the glitch of a reversal is looked for, in the direction of travel."""
ACCELERATION: Final = 0.1
"""With which a target is approached where the axis file states none [m/s2]."""
DWELL: Final = 2.0
"""Time at a target after which its position is read [s]."""


class Glitch(NamedTuple):
    """What the radius does where an axis reverses."""

    angle: float
    """Where on the circle it reverses [rad]."""
    height: float
    """From the radius 5 degrees before to the farthest one up to 45 degrees after [m], outward."""
    width: float
    """Length of the path over which it is more than half of that [m]."""


class Circle(NamedTuple):
    """A circular test in both directions; deviations [m] in the letters of ISO 230-4."""

    feed: float
    """Of the command [m/s]."""
    radius: float
    """Of the command [m]."""
    share: float
    """Part of Coulomb friction that is fed forward."""
    G_b: float
    """Bi-directional circular deviation G(b): width of the ring that holds both paths."""
    G: float
    """Circular deviation: that of one path, the larger one."""
    H: float
    """Circular hysteresis of the edition of 1996: between both paths at one angle."""
    D: float
    """Mean bi-directional radial deviation: mean radius less that of the command."""
    F_max: float
    """Radial deviation: the largest of both paths from the command, about the same centre."""
    F_min: float
    """The smallest."""
    glitches: tuple[Glitch, ...]
    """What the radius does at the four reversals, counterclockwise from 0 on."""

    @property
    def name(self) -> str:
        """Feed and radius in words."""
        return f"{number(60.0 * self.feed, EXACT)} m/min, R {told(self.radius, 'm', EXACT)}"

    @property
    def glitch(self) -> Glitch:
        """The highest of them."""
        return max(self.glitches, key=lambda each: abs(each.height))


def measured(feed: float, radius: float, share: float, paths: Matrix) -> Circle:
    """Return what a test comes to.

    `paths` are the deviations of the radius [m] over `ANGLES`, counterclockwise and clockwise. They
    mirror themselves at the centre of their least-squares circle, so that it is the centre of the
    narrowest ring as well.
    """
    both = paths.copy()
    for wave in (np.cos(ANGLES), np.sin(ANGLES)):
        both -= 2.0 * np.mean(both * wave) * wave
    return Circle(
        feed,
        radius,
        share,
        G_b=float(np.ptp(both)),
        G=float(np.ptp(both, axis=1).max()),
        H=float(np.abs(both[0] - both[1]).max()),
        D=float(both.mean()),
        F_max=float(both.max()),
        F_min=float(both.min()),
        glitches=tuple(_glitch(paths[0], 0.5 * math.pi * side, radius) for side in range(4)),
    )


def _glitch(path: Vector, angle: float, radius: float) -> Glitch:
    first, count = round((angle - _BEFORE) / _STEP), round((_BEFORE + _AFTER) / _STEP)
    rise = np.roll(path, -first)[:count]
    rise = rise - rise[0]
    peak = int(np.argmax(np.abs(rise)))
    below = np.flatnonzero(rise * np.sign(rise[peak]) <= 0.5 * abs(rise[peak]))
    start, end = below[below < peak].max(initial=0), below[below > peak].min(initial=count)
    return Glitch(angle, float(rise[peak]), float(max(end - start - 1, 0) * _STEP * radius))


def paths(one: Follower, other: Follower, feed: float, radius: float, share: float) -> Matrix:
    """Return the paths on a circle, for `measured`, a part of Coulomb friction fed forward.

    The axis `one` is that of the angle 0. The other direction mirrors the command of the second
    axis, and so its motion, as nothing in an axis knows directions.
    """
    first = _deviation(one, feed, radius, share)
    second = first if other is one else _deviation(other, feed, radius, share)
    angles = ANGLES + 0.5 * _STEP
    x = radius * np.cos(angles) + np.roll(first, -POINTS // 4)
    y = radius * np.sin(angles) + second
    away, angle, turn = np.hypot(x, y) - radius, np.arctan2(y, x), 2.0 * math.pi
    return np.array([np.interp(ANGLES, side * angle, away, period=turn) for side in (1.0, -1.0)])


def _deviation(axis: Follower, feed: float, radius: float, share: float) -> Vector:
    """Return the deviation from a command of radius sin(angle), midway between `ANGLES`."""
    w = feed / radius
    turn = 2.0 * math.pi / w
    turns = 1 + math.ceil(_SETTLED / max(axis.decay * turn, _SETTLED / _MOST_TURNS))
    return axis.follow(
        lambda t: feed * math.cos(w * t),
        lambda t: -feed * w * math.sin(w * t),
        (0.0, *(turn * (0.25 + 0.5 * half) for half in range(2 * turns)), turns * turn),
        turn * (turns - 1) + (ANGLES + 0.5 * _STEP) / w,
        share * sum(each.kinetic for each in axis.contacts),
    )


def reversal_value(axis: Follower, feed: float, acceleration: float | None) -> float:
    """Return the reversal value B of an axis [m]: where it rests from below, less from above.

    It comes at a feed [m/s], brakes with an acceleration [m/s2], and is read after `DWELL`. From
    above is the mirror of from below.
    """
    slows = feed / (acceleration or ACCELERATION)
    rests = axis.follow(
        lambda t: feed * max(1.0 - t / slows, 0.0),
        lambda t: -feed / slows if t < slows else 0.0,
        (0.0, slows, slows + 1.001 * DWELL),
        np.array([slows + DWELL]),
        0.0,
    )
    return 2.0 * float(rests[0])
