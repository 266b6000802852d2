"""The motion of an axis over time, from the break-away of a table at rest."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip_ref import simulate

from .axis import Axis
from .loop.jumps import loaded
from .loop.motion import Motion, walk
from .loop.system import TABLE, Mode, System

Floats = NDArray[np.float64]

_POINTS: Final = 600


class Record(NamedTuple):
    """A motion: times [s] since the break-away, and how far the table is ahead of the feed [m]."""

    time: Floats
    ahead: Floats


def record(axis: Axis, feed: float, span: float) -> Record:
    """Return how the table moves after a break-away at a feed [m/s], above 0, over a span [s]."""
    time = np.linspace(0.0, span, _POINTS)
    place = _of_rigid(axis, feed, time) if axis.drive is None else _of_servo(axis, feed, time)
    return Record(time, place - feed * time)


def _of_rigid(axis: Axis, feed: float, time: Floats) -> Floats:
    p = axis.block(feed)
    load_up = max(axis.F_s - axis.along, 0.0) / (axis.k * feed)
    law, own = axis.friction.law, axis.friction.own
    run = simulate(p, load_up + float(time[-1]), times=load_up + time, law=law, own=own)
    place: Floats = run.x - run.x[0]
    return place


def _of_servo(axis: Axis, feed: float, time: Floats) -> Floats:
    motion = Motion(System(axis))
    mode, point = Mode(0, 1), loaded(motion.system, feed)
    place = np.empty_like(time)
    for number, step in enumerate(np.diff(time, prepend=0.0)):
        *_, turn = walk(motion, mode, point, float(step))
        mode, point = turn.mode, turn.point
        place[number] = point.state[TABLE]
    return place if math.isfinite(float(place[-1])) else np.full_like(time, math.nan)
