"""Cycles and steady sliding under friction with a memory (LuGre, rate and state).

Sliding at the speed of the pull is stable where all eigenvalues of the exact Jacobian there are on
the left. A cycle is a fixed point of the map from one maximum of the spring to the next, found by
Broyden's method; it is followed over the pulling velocity from one that was found.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..laws import FrictionLaw, State
from ..parameters import Parameters
from ..ranges import Interval
from ..simulation.whole import Phase, integrate_whole
from ..trajectory import MeasuredCycle

Floats = NDArray[np.float64]

FOLD, GRAZING, NONE = "fold", "grazing", "none"

STUCK = 0.01
"""A mass whose least velocity is below this part of the pull's is said to stick."""


class Accuracy(NamedTuple):
    """Relative tolerance of a step, change over sizes at a fixed point, rounds that lead to it."""

    rtol: float
    change: float
    rounds: int


FINE, ROUGH = Accuracy(1e-13, 1e-10, 20), Accuracy(1e-8, 1e-6, 9)
"""Of a cycle that is asked for, and of one of which only the existence is."""

_FLAT = 1e-6
"""A relief of the spring below this part of its extension is no cycle."""
_ROUNDS = 3
"""Rounds from rest after which Broyden's method begins."""
_LONGEST = 3.0
"""Time for half a round, over a period of the spring and its load-up."""
_NARROW = 1e-2
"""An end of the cycles over the velocity is known to this, relative."""


class Round(NamedTuple):
    """A cycle, or what may become one, from a maximum of the spring to that at x (z [m], state).

    ``least`` is the velocity farthest behind the pull [m/s].
    """

    x: Floats
    cycle: MeasuredCycle
    least: float


def stability(p: Parameters, law: FrictionLaw, v: float) -> float:
    """Return what is < 0 where sliding at v [m/s] is unstable: Hurwitz's last determinant.

    Of ``l^2 + a_1 l + a_0`` that is a_1, of ``l^3 + a_2 l^2 + a_1 l + a_0`` it is a_2 a_1 - a_0,
    all a being positive else.
    """
    state = law.steady_state(p, v)
    force = law.slip_friction(p, v, state) + float(p.c) * v
    p = replace(p, v=v).with_own(p.own)
    inner = law.jacobian(p, force, law.coordinate(p, v, state), state)
    if inner is None:
        raise ValueError(f"{type(law).__name__} does not say its derivatives")
    (by_force, a, b), (_, c, d) = inner[1:]
    if not by_force:
        # Without inertia the balance of forces gives z.
        return float(-(a + d))
    # Multiplied out: what is left of neutral sliding is 0, and no rounding of a_2 a_1.
    turned = float(p.k) * by_force * (inner[0, 1] * a + inner[0, 2] * c)
    return float((a + d) * (b * c - a * d) - turned)


def limit_cycle(
    p: Parameters, law: FrictionLaw, guess: Floats | None = None, accuracy: Accuracy = FINE
) -> Round | None:
    """Return the cycle at ``p.v`` [m/s] > 0 from and to the same maximum; None: none was found.

    Parameters
    ----------
    p : Parameters
        Numbers only, completed by the friction law.
    law : FrictionLaw
        A law without a stick.
    guess : array, optional
        Extension of the spring [m] and own state at a maximum; else some rounds from rest lead to
        one.
    accuracy : Accuracy, optional
        `FINE` or `ROUGH`.

    Notes
    -----
    The slope of the map is taken as 0, and corrected in each step by Broyden's formula (Mathematics
    of Computation 19 (1965) 577): what a round forgets, as most cycles do, costs two rounds.
    """
    x = _from_rest(p, law, accuracy.rtol) if guess is None else guess
    if x is None:
        return None
    free = slice(0 if law.velocity_from(p, 0.0, float(p.v), law.state_start(p)) == p.v else 1, None)
    length = float(law.break_away_force(p)) / float(p.k) or abs(float(x[0]))
    sizes = np.array([length, *law.state_scale(p)])
    slopes, step = -np.eye(x[free].size), np.zeros(x[free].size)
    for _ in range(accuracy.rounds):
        here = _around(p, law, x, accuracy.rtol)
        if here is None or here.cycle.spring_drop < _FLAT * length:
            return None
        off = ((here.x - x) / sizes)[free]
        if np.max(np.abs(off)) < accuracy.change:
            return here
        if np.any(step):
            slopes += np.outer(off, step) / (step @ step)
        step = -np.linalg.lstsq(slopes, off)[0]
        x = x.copy()
        x[free] += step * sizes[free]
    return None


def _half(
    p: Parameters, law: FrictionLaw, z: float, u: float, state: State, falls: bool, rtol: float
) -> tuple[Phase, float, State] | None:
    """Follow one phase; return it, z and the state at its end, None if it dies or does not end."""
    load_up = law.break_away_force(p) / (float(p.k) * float(p.v))
    horizon = _LONGEST * (2.0 * math.pi / float(p.w) + load_up)
    phase = integrate_whole(p, law, z, u, state, falls, False, horizon, rtol)
    if not phase.ended or phase.settled:
        return None
    end = phase.sample(np.array([phase.duration]))
    return phase, z - float(end.relief[0]), tuple(end.state[:, 0].tolist())


def _around(p: Parameters, law: FrictionLaw, x: Floats, rtol: float) -> Round | None:
    """Follow the motion from a maximum of the spring to the next."""
    v, state = float(p.v), tuple(x[1:].tolist())
    z = float(x[0])
    if law.velocity_from(p, z, v, state) != v:
        z = (law.slip_friction(p, v, state) + float(p.c) * v - float(p.F_ext)) / float(p.k)
    slip = _half(p, law, z, v, state, True, rtol)
    stick = _half(p, law, slip[1], v, slip[2], False, rtol) if slip else None
    if slip is None or stick is None:
        return None
    t_slip, t_stick, relief = slip[0].duration, stick[0].duration, z - slip[1]
    cycle = MeasuredCycle(
        t_break_away=0.0,
        t_stick=t_stick,
        t_slip=t_slip,
        T=t_slip + t_stick,
        delta_x=v * t_slip + relief,
        spring_drop=relief,
        x_dot_peak=slip[0].x_dot_peak,
    )
    return Round(np.array([stick[1], *stick[2]]), cycle, stick[0].x_dot_peak)


def _from_rest(p: Parameters, law: FrictionLaw, rtol: float) -> Floats | None:
    """Return z and own state at a maximum some rounds after a start from rest."""
    state = law.state_start(p)
    first = _half(p, law, 0.0, law.velocity_from(p, 0.0, 0.0, state), state, False, rtol)
    x = None if first is None else np.array([first[1], *first[2]])
    for _ in range(_ROUNDS):
        found = None if x is None else _around(p, law, x, rtol)
        x = None if found is None else found.x
    return x


def cycle_ranges(
    p: Parameters, law: FrictionLaw, speeds: list[float], between: tuple[float, float]
) -> tuple[Interval, ...]:
    """Return the ranges [m/s] of cycles that stick which a start from rest at some speeds finds."""
    found: list[Interval] = []
    for v in speeds:
        if any(v in other for other in found):
            continue
        seed = limit_cycle(replace(p, v=v).with_own(p.own), law, accuracy=ROUGH)
        if seed is None or seed.least > STUCK * v:
            continue
        low, low_end = _followed(p, law, v, seed, between[0])
        high, high_end = _followed(p, law, v, seed, between[1])
        found.append(Interval(low, high, low_end, high_end))
    return tuple(found)


def _followed(
    p: Parameters, law: FrictionLaw, v: float, seed: Round, last: float
) -> tuple[float, str]:
    """Follow a cycle that sticks from v to the velocity ``last``; return where it ends, and how."""
    step, kind, follows = math.copysign(math.log(2.0), last - v), NONE, False
    x, slope = seed.x, np.zeros_like(seed.x)
    while abs(step) > _NARROW and v != last:
        ahead = v * math.exp(step)
        ahead = last if (ahead - last) * step >= 0.0 else ahead
        there, along = replace(p, v=ahead).with_own(p.own), x + slope * (ahead - v)
        # From farther out the motion leads to the cycle, from within perhaps to rest on the pull.
        for guess in (np.maximum(x, along), along)[: 1 + bool(np.any(along < x))]:
            found = limit_cycle(there, law, guess, ROUGH)
            if sticks := found is not None and found.least <= STUCK * ahead:
                break
        if found is not None and sticks:
            v, x, slope = ahead, found.x, (found.x - x) / (ahead - v)
            # The first one after an end or a miss may be luck.
            step, follows = 2.0 * step if follows else step, True
        else:
            step, kind, follows = 0.5 * step, FOLD if found is None else GRAZING, False
    return v, NONE if v == last else kind
