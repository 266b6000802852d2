"""What is said of a block whose static friction grows: its cycle, and where cycles exist."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..laws.coulomb import dwells
from ..parameters import Parameters
from ..ranges import Interval
from .attractors import Scan
from .family import LEAST_STICK, Family
from .sticks import Floats, Sticks

STEP = 0.01
"""Distance of the speeds at which slips that reverse are followed, relative."""

FORCES = 64
"""Forces at each of them with which sticks begin, equally spaced."""

FEW = 4
"""Sequences of sticks at one speed that are followed on after as many sticks as FORCES."""

MOST_CYCLES = 200
"""Sticks that follow each other, from which on they do for ever."""

PARTS, ROUNDS = 16, 4
"""An end is narrowed to a sixteenth four times: to 2e-7 of the speed."""

SETTLED = 1e-9
"""Sticks of one length, relative: a cycle."""

LEAST_RANGE = 1e-6
"""A range of speeds narrower than this part of them is one of rounding: the slack of the rest test
lets a slip that grazes hold up to its root, 4e-8, beside the limit."""


def dwell_cycle(p: Parameters) -> tuple[float | bool, ...]:
    """Return the fields of `Cycle`, in their order, where static friction grows at rest.

    Parameters
    ----------
    p : Parameters
        Numbers only, with the values of dwell in ``own``.

    Returns
    -------
    tuple
        Of the cycle that a start from rest leads to, with a relaxed spring and after
        ``age_start``. ``F_s``, ``Delta`` and ``lambda_`` are those of the break-away in the cycle;
        where there is none, those of a fresh stick. In a cycle with reversals ``t_slip`` and
        ``delta_x`` count from break-away to re-stick. ``exists`` is False also where the sticks do
        not settle to one length; docs/theory.md (23).
    """
    v, s = abs(float(p.v)), math.copysign(1.0, float(p.v))
    sticks = Sticks(p)
    if v == 0.0:
        lambda_ = math.inf if sticks.fresh > 0.0 else math.nan
        return (sticks.k * sticks.holds, sticks.fresh, lambda_, *[math.nan] * 7, False, 0)
    scan = Scan(p, v)
    found = scan.result()
    count, cycle = len(found.attractors), found.from_rest
    if cycle is None or len(cycle.t_stick) > 1:
        lambda_ = sticks.w * sticks.fresh / v
        return (sticks.k * sticks.holds, sticks.fresh, lambda_, *[math.nan] * 7, False, count)
    (t_stick,) = cycle.t_stick
    Delta = float(sticks.excess(t_stick))
    if cycle.reverses or scan.lambda_ is None:
        stops = sticks.settle(np.array([Delta]), v)
        t_slip, peak = float(stops.length[0]), float(stops.peak[0])
    else:
        slip = scan.family.slip(scan.lambda_)
        t_slip, peak = float(slip.length) / sticks.w, float(slip.peak)
    T = t_stick + t_slip
    return (
        *(sticks.k * (sticks.kinetic + Delta), Delta, sticks.w * Delta / v),
        *(s * v * t_stick, s * v * T, t_slip, t_stick, T, 1.0 / T, s * v * peak),
        *(True, count),
    )


def cycle_ranges(p: Parameters, between: tuple[float, float]) -> tuple[Interval, ...]:
    """Return the pulling speeds at which stick-slip goes on; docs/theory.md (20), (22), (23).

    Parameters
    ----------
    p : Parameters
        Numbers only, with the values of dwell in ``own``; ``v`` is of no influence.
    between : tuple of two floats
        The range of pulling speeds that is searched [m/s], > 0.

    Returns
    -------
    tuple of Interval
        Disjoint and in order. An end is "fold" or "grazing", or "none" at a bound of the search.
        Where a slip of the cycle reverses, sticks of 64 ages over all that can occur are followed
        at speeds 1 % apart: a gap or a range narrower than that is not looked for.

    Raises
    ------
    ValueError
        If the range is empty or not above 0, ``p`` has arrays, or static friction does not grow.
    """
    low, high = between
    if not 0.0 < low < high < math.inf:
        raise ValueError(f"between = {between!r} m/s is out of range; it must rise and be > 0")
    if p.shape or not dwells(p):
        raise ValueError("cycle_ranges takes numbers and a static friction that grows at rest")
    family = Family(Sticks(p))
    _, top, kind = family.fastest
    if not top > low:
        return ()
    full = Interval(low, min(top, high), "none", kind if top <= high else "none")
    return _without_gaps(family, full)


def critical_speed(p: Parameters) -> float:
    """Return the pulling speed [m/s] above which no cycle has a stick; docs/theory.md (20), (22).

    Parameters
    ----------
    p : Parameters
        Numbers only, with the values of dwell in ``own``; ``v`` is of no influence. Infinite where
        ``c = 0`` and a fresh stick holds more than kinetic friction.
    """
    return Family(Sticks(p)).fastest[1]


def _without_gaps(family: Family, full: Interval) -> tuple[Interval, ...]:
    """Take out the speeds at which slips that reverse do not lead to a stick again, (23)."""
    sticks = family.sticks
    if sticks.zeta == 0.0 and sticks.kinetic > 0.0:
        # Each slip ends, and each reversal takes of the force.
        return (full,)
    count = 2 + math.ceil(math.log(full.high / full.low) / STEP)
    speeds = np.geomspace(full.low, full.high, count)
    goes_on = ~family.may_reverse(speeds)
    goes_on[~goes_on] = lasting(sticks, speeds[~goes_on])
    ends = [
        _edge(sticks, float(speeds[n]), float(speeds[n + 1]), bool(goes_on[n]))
        for n in np.flatnonzero(goes_on[1:] != goes_on[:-1])
    ]
    marks = [full.low, *ends, full.high]
    kinds = [full.low_end, *["grazing"] * len(ends), full.high_end]
    if not ends:
        return (full,) if goes_on[0] else ()
    ranges = zip(pairwise(marks), pairwise(kinds), strict=True)
    return tuple(
        Interval(*mark, *kind)
        for n, (mark, kind) in enumerate(ranges)
        if goes_on[0] == (n % 2 == 0) and mark[1] - mark[0] > LEAST_RANGE * mark[1]
    )


def lasting(sticks: Sticks, speeds: Floats) -> NDArray[np.bool_]:
    """Tell at which speeds [m/s] some stick is followed by others for `MOST_CYCLES`."""
    result = np.zeros(speeds.size, dtype=bool)
    number = np.repeat(np.arange(speeds.size), FORCES)
    ages = sticks.ages(FORCES, speeds).ravel()
    before = ages
    for count in range(MOST_CYCLES):
        ages = sticks.follow(ages, speeds[number])[0]
        repeats = np.abs(ages - before) <= SETTLED * ages
        on = sticks.w * ages > LEAST_STICK
        result[number[on & repeats]] = True
        on &= ~result[number]
        if count == FORCES:
            order = np.cumsum(on)
            first = np.searchsorted(number, number)
            on &= order - order[first] + on[first] <= FEW
        ages, number, before = ages[on], number[on], before[on]
        if (count + 1).bit_count() == 1:
            before = ages
        if not number.size:
            break
    result[number] = True
    return result


def _edge(sticks: Sticks, low: float, high: float, before: bool) -> float:
    """Return the speed between two at which sticks cease to last, or begin to."""
    for _ in range(ROUNDS):
        parts = np.linspace(low, high, PARTS + 1)
        changed = np.flatnonzero(lasting(sticks, parts[1:-1]) != before)
        end = int(changed[0]) + 1 if changed.size else PARTS
        low, high = float(parts[end - 1]), float(parts[end])
    return 0.5 * (low + high)
