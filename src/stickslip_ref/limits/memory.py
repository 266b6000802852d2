"""Cycles and steady sliding under friction with a memory (LuGre, rate and state).

Sliding at the speed of the pull is stable where all eigenvalues of the exact Jacobian there are on
the left. A cycle is a fixed point of the map from one maximum of the spring to the next, found by
Newton's method; it is followed over the pulling velocity from one that was found.
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

_RTOL = 1e-13
_DIFFERENCE = 1e-5
"""Of a variable of the map, over its size: its error of some 1e-11 leaves five digits of the slope,
and so of each step of Newton's method."""
_CONVERGED, _STEPS = 1e-9, 8
"""Change of the variables over their sizes at the fixed point, and how many steps lead to it."""
_FLAT = 1e-6
"""A relief of the spring below this part of its extension is no cycle."""
_ROUNDS = 3
"""Rounds from rest after which Newton's method begins."""
_LONGEST = 3.0
"""Time for half a round, over a period of the spring and its load-up."""
_NARROW = 1e-2
"""An end of the cycles over the velocity is known to this, relative."""


class Round(NamedTuple):
    """The motion from a maximum of the spring at (z [m], state) to the next one at (z_end, ...)."""

    z_end: float
    state_end: State
    t_slip: float
    t_stick: float
    relief: float
    peak: float
    least: float


def sliding_jacobian(p: Parameters, law: FrictionLaw) -> Floats:
    """Return the Jacobian of (z, coordinate, own state) in sliding at ``p.v`` [m/s], not 0.

    Without inertia the balance of forces gives z, and the first row and column are not there.
    """
    v, state = float(p.v), law.steady_state(p, float(p.v))
    force = law.slip_friction(p, v, state) + float(p.c) * v
    inner = law.jacobian(p, force, law.coordinate(p, v, state), state)
    if inner is None:
        raise ValueError(f"{type(law).__name__} does not say its derivatives")
    if not inner[1, 0]:
        return inner[1:, 1:]
    result = np.zeros((len(state) + 2, len(state) + 2))
    result[0, 1:] = -inner[0, 1:]
    result[1:, 0] = float(p.k) * inner[1:, 0]
    result[1:, 1:] = inner[1:, 1:]
    return result


def stability(p: Parameters, law: FrictionLaw, v: float) -> float:
    """Return what is < 0 where sliding at v [m/s] is unstable: Hurwitz's last determinant.

    Of ``l^2 + a_1 l + a_0`` that is a_1, of ``l^3 + a_2 l^2 + a_1 l + a_0`` it is a_2 a_1 - a_0,
    all a being positive else.
    """
    A = sliding_jacobian(replace(p, v=v).with_own(p.own), law)
    if len(A) == 2:
        return float(-np.trace(A))
    minors = (np.trace(A) ** 2 - np.trace(A @ A)) / 2.0
    return float(np.linalg.det(A) - np.trace(A) * minors)


def limit_cycle(p: Parameters, law: FrictionLaw, guess: Floats | None = None) -> Round | None:
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
    """
    x = _from_rest(p, law) if guess is None else guess
    if x is None:
        return None
    free = slice(0 if law.velocity_from(p, 0.0, float(p.v), law.state_start(p)) == p.v else 1, None)
    length = float(law.break_away_force(p)) / float(p.k) or abs(float(x[0]))
    sizes = np.array([length, *law.state_scale(p)])
    for _ in range(_STEPS):
        here = _around(p, law, x)
        if here is None or here.relief < _FLAT * length:
            return None
        off = _end(here) - x
        if np.max(np.abs(off / sizes)[free]) < _CONVERGED:
            return here
        columns = []
        for number in range(x.size)[free]:
            apart = np.zeros_like(x)
            apart[number] = _DIFFERENCE * sizes[number]
            beside = _around(p, law, x + apart)
            if beside is None:
                return None
            columns.append((_end(beside) - _end(here) - apart)[free] / apart[number])
        x = x.copy()
        x[free] -= np.linalg.solve(np.array(columns).T, off[free])
    return None


def _end(found: Round) -> Floats:
    return np.array([found.z_end, *found.state_end])


def _half(
    p: Parameters, law: FrictionLaw, z: float, u: float, state: State, falls: bool
) -> tuple[Phase, float, State] | None:
    """Follow one phase; return it, z and the state at its end, None if it does not end."""
    load_up = law.break_away_force(p) / (float(p.k) * float(p.v))
    horizon = _LONGEST * (2.0 * math.pi / float(p.w) + load_up)
    phase = integrate_whole(p, law, z, u, state, falls, False, horizon, _RTOL)
    if not phase.ended:
        return None
    end = phase.sample(np.array([phase.duration]))
    return phase, z - float(end.relief[0]), tuple(end.state[:, 0].tolist())


def _around(p: Parameters, law: FrictionLaw, x: Floats) -> Round | None:
    """Follow the motion from a maximum of the spring to the next."""
    v, state = float(p.v), tuple(x[1:].tolist())
    z = float(x[0])
    if law.velocity_from(p, z, v, state) != v:
        z = (law.slip_friction(p, v, state) + float(p.c) * v - float(p.F_ext)) / float(p.k)
    slip = _half(p, law, z, v, state, True)
    stick = _half(p, law, slip[1], v, slip[2], False) if slip else None
    if slip is None or stick is None:
        return None
    return Round(
        z_end=stick[1],
        state_end=stick[2],
        t_slip=slip[0].duration,
        t_stick=stick[0].duration,
        relief=z - slip[1],
        peak=slip[0].x_dot_peak,
        least=stick[0].x_dot_peak,
    )


def _from_rest(p: Parameters, law: FrictionLaw) -> Floats | None:
    """Return z and own state at a maximum some rounds after a start from rest."""
    state = law.state_start(p)
    first = _half(p, law, 0.0, law.velocity_from(p, 0.0, 0.0, state), state, False)
    x = None if first is None else np.array([first[1], *first[2]])
    for _ in range(_ROUNDS):
        found = None if x is None else _around(p, law, x)
        x = None if found is None else _end(found)
    return x


def measured(p: Parameters, found: Round) -> MeasuredCycle:
    """Return a cycle as the meter reads it, its break-away at the time 0."""
    T = found.t_slip + found.t_stick
    return MeasuredCycle(
        t_break_away=0.0,
        t_stick=found.t_stick,
        t_slip=found.t_slip,
        T=T,
        delta_x=abs(float(p.v)) * found.t_slip + found.relief,
        spring_drop=found.relief,
        x_dot_peak=found.peak,
    )


def cycle_ranges(
    p: Parameters, law: FrictionLaw, unstable: tuple[Interval, ...], between: tuple[float, float]
) -> tuple[Interval, ...]:
    """Return the velocities with a cycle that sticks, those about each unstable range [m/s]."""
    found: list[Interval] = []
    for each in unstable:
        middle = math.sqrt(each.low * each.high)
        if any(middle in other for other in found):
            continue
        seed = limit_cycle(replace(p, v=middle).with_own(p.own), law)
        if seed is None or seed.least > STUCK * middle:
            continue
        low, low_end = _followed(p, law, middle, seed, between[0])
        high, high_end = _followed(p, law, middle, seed, between[1])
        found.append(Interval(low, high, low_end, high_end))
    return tuple(found)


def _followed(
    p: Parameters, law: FrictionLaw, v: float, seed: Round, last: float
) -> tuple[float, str]:
    """Follow a cycle that sticks from v to the velocity ``last``; return where it ends, and how."""
    step, kind = math.copysign(math.log(2.0), last - v), NONE
    while abs(step) > _NARROW and v != last:
        ahead = v * math.exp(step)
        ahead = last if (ahead - last) * step >= 0.0 else ahead
        found = limit_cycle(replace(p, v=ahead).with_own(p.own), law, _end(seed))
        if found is not None and found.least <= STUCK * ahead:
            v, seed = ahead, found
        else:
            step, kind = 0.5 * step, FOLD if found is None else GRAZING
    return v, NONE if v == last else kind
