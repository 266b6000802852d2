"""What is read off a run: jumps and their period, following error, hunting."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .coupling import Run


@dataclass(frozen=True)
class Creep:
    """An axis at constant feed, in the second half of a run.

    Attributes
    ----------
    jumps : int
        Completed slips.
    jump, period : float
        Mean jump of the table [m] and mean time between two [s]; NaN where there are none.
    error, unevenness : float
        Mean following error of the table, and the root of the mean square of the rest [m].
    """

    jumps: int
    jump: float
    period: float
    error: float
    unevenness: float


@dataclass(frozen=True)
class Hunting:
    """An axis that holds a target, in the last half of a run.

    Attributes
    ----------
    stops : bool
        Whether the table has come to rest for good: no slip at all.
    jump : float
        Mean length of a jump, forward or backward [m]; NaN where there are none.
    period : float
        Mean time between two jumps in the same direction [s]; NaN where there are fewer than 3.
    offset : float
        Mean distance of the table from the target [m]; where it rests, this is the error left.
    """

    stops: bool
    jump: float
    period: float
    offset: float


def creep(run: Run) -> Creep:
    """Measure an axis at constant feed."""
    late = run["time"] >= 0.5 * run["time"][-1]
    error = (run["x_command"] - run["x"])[late]
    times, lengths = _jumps(run)
    mean = float(error.mean())
    return Creep(
        len(times),
        float(np.mean(lengths)) if len(times) else math.nan,
        float(np.mean(np.diff(times))) if len(times) > 1 else math.nan,
        mean,
        float(np.sqrt(np.mean((error - mean) ** 2))),
    )


def hunting(run: Run) -> Hunting:
    """Measure an axis that holds a target."""
    late = run["time"] >= 0.5 * run["time"][-1]
    away = (run["x"] - run["x_command"])[late]
    times, lengths = _jumps(run)
    forward = times[lengths > 0.0]
    return Hunting(
        len(times) == 0,
        float(np.mean(np.abs(lengths))) if len(times) else math.nan,
        float(np.mean(np.diff(forward))) if len(forward) > 1 else math.nan,
        float(away.mean()),
    )


def _jumps(run: Run) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the ends [s] and the lengths [m] of the slips in the second half."""
    ended = np.flatnonzero(np.diff(run["delta_x"])) + 1
    ended = ended[run["time"][ended] >= 0.5 * run["time"][-1]]
    return run["time"][ended], run["delta_x"][ended]
