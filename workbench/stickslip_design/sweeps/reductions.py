"""Numbers that samples of a run come to.

Jump and period are read off the sticks of a position, whose events lie between two samples, and
taken to means as the score takes those of a curve, `stickslip_score.figures.figures_of`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from stickslip_score.figures import Figures, Stick

Floats: TypeAlias = NDArray[np.float64]

LEAST_AT_REST: Final = 3
"""Samples of one place that are a rest: a smooth turn may have two alike."""
_INTEGRATED: Final = 1e-9
"""Of the range of a position: no tool that integrates promises more, so less is a rest."""


class Reduction(NamedTuple):
    """A number `of` times [s] and samples; without a unit it has that of the variable.

    One of the `whole` needs the samples on the way, and not the last one alone.
    """

    of: Callable[[Floats, Floats], float]
    meaning: str
    unit: str | None = None
    whole: bool = True


def _mean(times: Floats, samples: Floats) -> float:
    if times.size < 2:
        return float(samples[-1])
    return float(np.trapezoid(samples, times) / (times[-1] - times[0]))


def _jump(times: Floats, position: Floats) -> float:
    jumps = figures.jumps if (figures := _measured(times, position)) else [math.nan]
    return float(np.mean(np.abs(jumps))) if jumps else 0.0


def _period(times: Floats, position: Floats) -> float:
    figures = _measured(times, position)
    return figures.values.get("period", (math.nan,))[0] if figures else math.nan


def _measured(times: Floats, position: Floats) -> Figures | None:
    """Return the figures of a position; None where a sample is not finite."""
    # They bring SciPy, which takes a second; a process that reads last values goes without.
    from stickslip_score.figures import figures_of
    from stickslip_score.read import half_unit

    if not np.all(np.isfinite(position)):
        return None
    rounding = 4.0 * float(np.finfo(np.float64).eps) * float(np.max(np.abs(position)))
    digits = half_unit(position) + _INTEGRATED * float(np.ptp(position)) + rounding
    return figures_of(_sticks(times, position, digits), digits)


def _sticks(times: Floats, position: Floats, digits: float) -> list[Stick]:
    """Find the rests of a mass between its slips, in order of time.

    A rest is a longest run of at least `LEAST_AT_REST` samples within the `digits` of the position.
    Each of its events lies between the last sample that rests and the next one.
    """
    from stickslip_score.figures import VISIBLE, Event, Stick

    edges, begin = [0], position[0]
    # A run may drift within the band; of samples that move at once most begin a run of their own.
    for index, place in enumerate(position.tolist()):
        if abs(place - begin) > VISIBLE * digits:
            edges.append(index)
            begin = place
    found = []
    for first, stop in pairwise((*edges, position.size)):
        if stop - first < LEAST_AT_REST:
            continue
        begins = Event(float(times[first - 1]), float(times[first])) if first > 0 else None
        ends = Event(float(times[stop - 1]), float(times[stop])) if stop < position.size else None
        found.append(Stick(begins, ends, float(np.median(position[first:stop])), stop - first))
    return found


REDUCTIONS: Final[Mapping[str, Reduction]] = {
    "last": Reduction(lambda times, samples: float(samples[-1]), "at the end", whole=False),
    "max": Reduction(lambda times, samples: float(np.max(samples)), "greatest sample"),
    "min": Reduction(lambda times, samples: float(np.min(samples)), "least sample"),
    "mean": Reduction(_mean, "mean over time, the samples joined by straight lines"),
    "jump": Reduction(
        _jump, "mean length of the jumps between two rests, 0 where there is none; of a position"
    ),
    "period": Reduction(
        _period,
        "mean time from break-away to break-away, NaN where there is no whole cycle; of a position",
        "s",
    ),
}
"""The reductions by name."""


def reduces(outputs: Mapping[str, Sequence[str]]) -> bool:
    """Return whether a reduction of some by variable needs the samples on the way."""
    return any(REDUCTIONS[name].whole for names in outputs.values() for name in names)


def column_of(name: str, reduction: str) -> str:
    """Return the name of a result: the variable for its last value, else variable.reduction."""
    return name if reduction == "last" else f"{name}.{reduction}"
