"""Where a table runs steadily."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from .evened import Even, filtered, scatter

_STEADY: Final = 0.05
"""Of its speed: how far a steady run may be off its median."""
_ENDS: Final = 0.1
"""Of a steady run that is left out at each end, where it may still settle."""
_LEAST, _SHORTEST = 100, 0.1
"""Samples, and time [s], of a steady run at least."""
_STRIDE: Final = 10
"""Of the samples behind it, so many are one."""
_CORNER: Final = 0.02
"""Corner of the low pass behind which the speed is judged, of the sample rate."""
_MOVES: Final = 1e-3
"""Of the highest speed: below it the table rests."""
_BURIED: Final = 0.2
"""Of the speed: noise above it hides whether it is steady."""
_DEVIATIONS: Final = 4.0
"""Of the noise of the speed, within which it is steady."""


class Plateau(NamedTuple):
    """A steady run: its begin and end [s], and its speed [m/s]."""

    begin: float
    end: float
    speed: float


def plateaus(runs: Sequence[Even], rounding: float) -> tuple[list[Plateau], float]:
    """Return the steady runs, and their share of the time in which the table moves.

    `rounding` is half a unit in the last digit of the positions [m].
    """
    found, moving, steady = [], 0, 0
    corner = _CORNER / runs[0].step
    ways = [filtered(run, corner) for run in runs]
    highest = max(float(np.max(np.abs(way.v))) for way in ways)
    for run, way in zip(runs, ways, strict=True):
        noise = _DEVIATIONS * scatter(run, corner, rounding).v
        t, v = way.t[::_STRIDE], way.v[::_STRIDE]
        moves = np.abs(v) > max(_MOVES * highest, noise)
        moving += int(np.count_nonzero(moves))
        allowed = _STEADY * np.abs(v) + noise
        window = max(_LEAST, int(_SHORTEST / run.step)) // _STRIDE
        span = maximum_filter1d(v, window, origin=-(window // 2)) - minimum_filter1d(
            v, window, origin=-(window // 2)
        )
        starts = np.flatnonzero((span <= allowed) & moves & (noise <= _BURIED * np.abs(v)))
        end = 0
        for begin in starts[starts < t.size - window].tolist():
            if begin < end:
                continue
            speed = float(np.median(v[begin : begin + window]))
            off = np.flatnonzero(np.abs(v[begin:] - speed) > allowed[begin])
            length = int(off[0]) if off.size else t.size - begin
            if length >= window:
                inner = t[begin : begin + length][int(_ENDS * length) : -int(_ENDS * length) - 1]
                found.append(Plateau(float(inner[0]), float(inner[-1]), speed))
                end, steady = begin + length, steady + length
    return found, min(steady / max(moving, 1), 1.0)
