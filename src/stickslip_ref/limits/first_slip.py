"""Slips from rest of many blocks at once, up to their first stop or their first least speed.

The units are V = abs(v) for speeds, 1/w for times and m w V for forces. With the speed u along the
slip, the direction e of the pull along it (+1 or -1), and the net force a at standstill,

``u' = a - 2 zeta u - (R(u) - R(0))``,  ``a' = e - u``.

Below u = 0 the friction is taken as R(0): so the least speed of a slip that stops is a number below
0, and changes continuously with the pulling velocity through the stop that only touches 0. The
orbits of the extended system do not cross, so a slip from rest whose first least speed is above 0
has come inside of where it began, and no later one is less: docs/theory.md (30).

Where damping and the slope g of the friction are calm, ``2 zeta + g >= 2``, from the speed `low` to
`high` with 1 between, the speed does not fall below min(u, 1) any more once ``u >= low``,
``u' >= -max(u - 1, 0)`` and ``max(u, 1) + max(w, 0) <= high``, where ``w = u' + u - 1``: for
``w' = -w + (2 - 2 zeta - g) u'``. A slip that creeps up to the pull need not be followed further.

Each block has steps of its own, of the pair of orders 5 and 4 of Dormand and Prince (J. Comput.
Appl. Math. 6 (1980) 19, doi 10.1016/0771-050X(80)90013-3).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

Friction = Callable[[Floats, NDArray[np.intp]], Floats]
"""Friction R(u) - R(0) at speeds >= 0 of the blocks of these numbers, in the units above."""

TOLERANCE = 1e-8
_MOST_STEPS = 20_000
_SETTLED = 1e-6
"""A slip whose speed and rest are so near those of the pull goes on for ever."""

_STAGES = [
    [1 / 5],
    [3 / 40, 9 / 40],
    [44 / 45, -56 / 15, 32 / 9],
    [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
    [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
    [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
]
_ERRORS = [71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40]


class FirstSlip(NamedTuple):
    """The first slip of each block.

    Attributes
    ----------
    least : array
        Least speed after the highest one, below 0 where the mass comes to rest; over V.
    net : array
        Net force at standstill where the speed is 0 at the stop; NaN where it does not stop.
    """

    least: Floats
    net: Floats


class Calm(NamedTuple):
    """Speeds over V about 1 between which damping and friction are calm, one entry per block."""

    low: Floats
    high: Floats


def first_slips(
    net: Floats,
    pull: Floats,
    zeta: float,
    friction: Friction,
    calm: Calm,
    tolerance: float = TOLERANCE,
) -> FirstSlip:
    """Follow slips from rest.

    Parameters
    ----------
    net : array, shape (n,)
        Net force at the start, >= 0: spring and external force less R(0).
    pull : array, shape (n,)
        e, +1 or -1: whether the pull moves along the slip.
    zeta : float
        Damping ratio.
    friction : callable
        The friction in slip.
    calm : Calm
        Where the speed cannot turn.
    tolerance : float
        Relative error of a step.
    """
    n = net.size
    least, stop = np.full(n, np.nan), np.full(n, np.nan)
    number = np.arange(n)
    u, a = np.zeros(n), net.astype(np.float64)
    h = np.full(n, 1e-4 / (1.0 + zeta))
    rate = _rates(u, a, pull, number, zeta, friction)
    # A slip from equilibrium starts with the pull alone.
    falling = np.zeros(n, dtype=bool)
    for _ in range(_MOST_STEPS):
        if not number.size:
            break
        stages = [rate]
        for row in _STAGES:
            du = sum(weight * s[0] for weight, s in zip(row, stages, strict=True) if weight)
            da = sum(weight * s[1] for weight, s in zip(row, stages, strict=True) if weight)
            u_new, a_new = u + h * du, a + h * da
            stages.append(_rates(u_new, a_new, pull[number], number, zeta, friction))
        wrong = [
            h * sum(weight * s[part] for weight, s in zip(_ERRORS, stages, strict=True) if weight)
            for part in (0, 1)
        ]
        scale = tolerance * (1.0 + np.maximum(np.hypot(u, a), np.hypot(u_new, a_new)))
        error = np.hypot(*wrong) / scale
        taken = error <= 1.0
        after = stages[-1]
        # The speed has been falling and rises again: its least value lies in this step.
        turns = taken & falling & (after[0] >= 0.0)
        # Against the pull a slip of hardly any force ends within its first step.
        crosses = taken & (u_new <= 0.0) & ((u > 0.0) | (pull[number] < 0.0))
        if crosses.any():
            part = np.where(crosses, _zero(u, u_new, rate[0], after[0], h), 0.0)
            stop[number[crosses]] = _between(a, a_new, rate[1], after[1], h, part)[crosses]
        if turns.any():
            part = np.where(turns, _turn(rate[0], after[0]), 0.0)
            least[number[turns]] = _between(u, u_new, rate[0], after[0], h, part)[turns]
            # Within a step the least speed may be below 0, and the speed at neither end. The net
            # force of such a stop is 0 to the square root of that speed.
            stop[number[turns & np.isnan(stop[number])]] = 0.0
        follows = np.hypot(u_new - 1.0, after[0]) < _SETTLED
        follows |= follows_calmly(u_new, after[0], calm.low[number], calm.high[number])
        settled = taken & (pull[number] > 0.0) & follows
        least[number[settled & ~turns]] = 1.0
        falling |= taken & (after[0] < 0.0) & (u_new > 0.0)
        # Against the pull the stop is certain, and what follows it is not asked.
        done = turns | settled | (crosses & (pull[number] < 0.0))
        least[number[done & crosses & ~turns]] = -1.0
        growth = np.clip(0.9 * np.maximum(error, 1e-10) ** -0.2, 0.2, 5.0)
        u, a = np.where(taken, u_new, u), np.where(taken, a_new, a)
        rate = (np.where(taken, after[0], rate[0]), np.where(taken, after[1], rate[1]))
        h = np.minimum(h * growth, 0.25)
        keep = ~done
        number, u, a, h, falling = number[keep], u[keep], a[keep], h[keep], falling[keep]
        rate = (rate[0][keep], rate[1][keep])
    return FirstSlip(least, stop)


def follows_calmly(u: Floats, rate: Floats, low: Floats, high: Floats) -> NDArray[np.bool_]:
    """Tell whether a speed is calm from now on: it stays above min(u, 1)."""
    reach = np.maximum(u, 1.0) + np.maximum(rate + u - 1.0, 0.0)
    result: NDArray[np.bool_] = (u >= low) & (rate >= -np.maximum(u - 1.0, 0.0)) & (reach <= high)
    return result


def _rates(
    u: Floats,
    a: Floats,
    pull: Floats,
    number: NDArray[np.intp],
    zeta: float,
    friction: Friction,
) -> tuple[Floats, Floats]:
    return a - 2.0 * zeta * u - friction(np.maximum(u, 0.0), number), pull - u


def _between(y: Floats, end: Floats, rate: Floats, after: Floats, h: Floats, t: Floats) -> Floats:
    """Return the cubic through values and rates of both ends of a step, at the part t of it."""
    rest = 1.0 - t
    value: Floats = (
        y * rest * rest * (1.0 + 2.0 * t)
        + end * t * t * (3.0 - 2.0 * t)
        + h * t * rest * (rate * rest - after * t)
    )
    return value


def _turn(rate: Floats, after: Floats) -> Floats:
    """Return the part of a step at which a rate that rises through 0 is 0."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.clip(np.nan_to_num(rate / (rate - after)), 0.0, 1.0)


def _zero(y: Floats, end: Floats, rate: Floats, after: Floats, h: Floats) -> Floats:
    """Return the part of a step at which a value that falls through 0 is 0, by bisection."""
    low, high = np.zeros_like(y), np.ones_like(y)
    for _ in range(40):
        middle = 0.5 * (low + high)
        above = _between(y, end, rate, after, h, middle) > 0.0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return 0.5 * (low + high)
