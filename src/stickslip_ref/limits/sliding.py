"""Where steady sliding is unstable: the eigenvalues of the sliding mass on its spring.

At the pulling velocity v the mass slides at v, and ``m x'' + (c + R'(v)) x' + k x = 0`` rules small
deviations, R being the friction in slip. They grow where ``c + R'(v) < 0``. Under friction with a
memory the exact Jacobian rules them.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from ..laws import FrictionLaw
from ..parameters import Parameters
from ..ranges import Interval, merged
from .memory import stability

EIGENVALUE, NONE = "eigenvalue", "none"

_STEP = 0.01
"""Distance of the velocities looked at, relative."""

_BESIDE = 2e-5
"""Distance from a corner, relative: a slope that is a difference does not reach across it."""


def unstable_ranges(
    p: Parameters, law: FrictionLaw, between: tuple[float, float]
) -> tuple[Interval, ...]:
    """Return the pulling velocities at which steady sliding is unstable.

    Parameters
    ----------
    p : Parameters
        Numbers only, completed by the friction law.
    law : FrictionLaw
        A friction law without state of its own, or without a stick.
    between : tuple of two floats
        The range of velocities searched [m/s].
    """
    low, high = between
    edges = [low, *(u for u in law.knots(p) if low < u < high), high]
    found: list[Interval] = []
    for begin, end in pairwise(edges):
        found += _unstable_in_band(p, law, begin, end)
    return tuple(
        each._replace(
            low_end=NONE if each.low <= low else each.low_end,
            high_end=NONE if each.high >= high else each.high_end,
        )
        for each in merged(found)
    )


def _unstable_in_band(p: Parameters, law: FrictionLaw, begin: float, end: float) -> list[Interval]:
    """Return the unstable velocities between two corners of the friction."""

    def damping(v: float) -> float:
        return float(p.c) + law.slope(p, v) if law.sticks else stability(p, law, v)

    count = max(3, int(np.log(end / begin) / _STEP) + 2)
    # A corner belongs to neither side.
    grid = np.geomspace(begin, end, count)
    grid[0], grid[-1] = begin * (1.0 + _BESIDE), end * (1.0 - _BESIDE)
    values = [damping(float(v)) for v in grid]
    found: list[Interval] = []
    start = begin if values[0] < 0.0 else None
    for (v, here), (v_next, following) in pairwise(zip(grid, values, strict=True)):
        if (here < 0.0) == (following < 0.0):
            continue
        edge = float(brentq(damping, v, v_next, xtol=1e-300, rtol=1e-14))
        if start is None:
            start = edge
        else:
            found.append(Interval(start, edge, EIGENVALUE, EIGENVALUE))
            start = None
    if start is not None:
        found.append(Interval(start, end, EIGENVALUE, EIGENVALUE))
    return found
