"""The motion under a friction law without a stick, integrated with SciPy.

Spring, velocity and the law's own state follow one system of equations between two changes of
input. It is stiff and has a corner at velocity 0, where the integration starts anew. A phase of the
motion ends where the mass is as fast as the pull: there the spring is at its maximum or minimum.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import LSODA, OdeSolution, Radau
from scipy.optimize import brentq, minimize_scalar

from ..laws import FrictionLaw, State
from ..parameters import Parameters
from .slip import Floats, Samples, Sampling

TOLERANCES = {"LSODA": 1e-13, "Radau": 1e-10}
"""Least tolerance of a step by method. At these a cycle is right to 2e-10 of its scale (measured
against the truth). LuGre takes 0.1 s a cycle by LSODA, 0.6 s and more by Radau; rate and state 0.3
s by Radau, while LSODA loses two digits and at times never finds to its implicit method."""

SWING = 1e-11
"""A velocity passes that of the pull, or 0, where it leaves it by more than this, relative to the
pull: less is rounding."""

MOST_CALLS = 60_000
"""Evaluations of a piece by LSODA; a longer one goes by Radau."""

MOST_PIECES = 1000
"""Pieces of the motion between two extremes of the spring."""


CREEPS = 0.1
"""Part of the pull's velocity below which the mass creeps, and the length of a step is bounded."""

RUNAWAY = 1e6
"""Velocity over all that the parameters set that no motion reaches."""

_METHODS = {"LSODA": LSODA, "Radau": Radau}
_EPS = 4.0 * 2.0**-52

MOST_STALLS = 20
"""Pieces whose steps are lost beside the time: each goes on at time 0, some for ever."""


class Phase(NamedTuple):
    """A part of the motion, up to an extreme of the spring or for a time.

    Attributes
    ----------
    duration : float
        Its length [s].
    ended : bool
        Whether an extreme of the spring ends it.
    settled : bool
        Whether the mass moves with the pull, as far as can be told.
    x_dot_peak : float
        Velocity farthest along the pull [m/s], where the spring grows the least along it.
    sample : callable
        The motion along it.
    """

    duration: float
    ended: bool
    settled: bool
    x_dot_peak: float
    sample: Sampling


class _StalledError(Exception):
    """LSODA does not get on."""


class _Problem:
    """The initial value problem: relief, coordinate, own state, integral of z, heat."""

    def __init__(
        self, p: Parameters, law: FrictionLaw, z: float, x_dot: float, state: State, rtol: float
    ) -> None:
        self.p, self.law, self.z, self.asked = p, law, z, rtol
        self.m, self.k, self.c, self.v, self.F_ext = (
            float(value) for value in (p.m, p.k, p.c, p.v, p.F_ext)
        )
        self.start = np.array([0.0, law.coordinate(p, x_dot, state), *state, 0.0, 0.0])
        w, hold = float(p.w), law.break_away_force(p, 0.0, state)
        length = max(abs(z), abs(self.v) / w, hold / self.k, abs(self.F_ext) / self.k)
        speed = max(abs(x_dot), abs(self.v), w * length) or 1.0
        self.speed = speed
        self.resolution = 0.0 if law.logarithmic(p) else law.resolution(p)
        self.swing = max(SWING * abs(self.v), self.resolution, np.finfo(float).tiny)
        followed = 1.0 if law.logarithmic(p) else speed
        energy = self.k * (speed / w) ** 2
        own = law.state_scale(p)
        self.sizes = np.array([speed / w, followed, *own, speed / w / w, energy])
        self.creeps = abs(x_dot) < CREEPS * abs(self.v)
        self.calls, self.method = 0, law.method(p)

    def state(self, y: Floats) -> State:
        return tuple(y[2:-2].tolist())

    def velocity(self, y: Floats) -> float:
        """Velocity of the mass [m/s]."""
        return self.law.velocity(self.p, float(y[1]), self.state(y))

    def rates(self, t: float, y: Floats) -> list[float]:
        self.calls += 1
        if self.calls > MOST_CALLS and self.method == "LSODA":
            raise _StalledError
        relief, coordinate, *own, _, _ = y.tolist()
        p, law, state = self.p, self.law, tuple(own)
        u = law.velocity(p, coordinate, state)
        extension = self.z - relief
        resistance = law.slip_friction(p, u, state) + self.c * u
        acceleration = (self.k * extension + self.F_ext - resistance) / self.m
        along = law.coordinate_rate(p, acceleration, u, coordinate, state)
        return [u - self.v, along, *law.rates(p, u, state), extension, resistance * u]

    def jacobian(self, t: float, y: Floats) -> Floats | None:
        """Return the derivatives of `rates`, without those of the heat: nothing needs them."""
        force = self.k * (self.z - float(y[0])) + self.F_ext
        inner = self.law.jacobian(self.p, force, float(y[1]), self.state(y))
        if inner is None:
            return None
        result = np.zeros((y.size, y.size))
        result[:-2, 1:-2] = inner[:, 1:]
        result[1:-2, 0] = -self.k * inner[1:, 0]
        result[-2, 0] = -1.0
        return result


def integrate_whole(
    p: Parameters,
    law: FrictionLaw,
    z: float,
    x_dot: float,
    state: State,
    falls: bool,
    settled: bool,
    duration: float,
    rtol: float,
) -> Phase:
    """Integrate the motion until the spring is at an extreme, or for a time.

    Parameters
    ----------
    p : Parameters
        Numbers only.
    law : FrictionLaw
        A law without a stick.
    z, x_dot : float
        Spring extension [m] and velocity [m/s] at the beginning.
    state : tuple of float
        The law's own state at the beginning.
    falls : bool
        Whether the spring falls: the mass is ahead of the pull, or about to be.
    settled : bool
        Whether the mass moves with the pull: then the phase ends where it leaves it.
    duration : float
        How long at most [s], >= 0.
    rtol : float
        Relative tolerance of a step; `TOLERANCES` are the least.

    Raises
    ------
    RuntimeError
        If the integration fails; the message gives SciPy's reason.
    """
    problem = _Problem(p, law, z, x_dot, state, rtol)
    outward = math.copysign(1.0, float(p.v) or 1.0) * (1.0 if falls else -1.0)
    pieces: list[tuple[float, Any]] = []
    now, y, peak, swing = 0.0, problem.start, x_dot, 0.0
    still, ended, stalls = False, False, 0
    settled = settled or (x_dot == 0.0 == problem.v and problem.rates(0.0, y)[1] == 0.0)
    while now < duration and not ended:
        side = float(np.sign(y[1]) or np.sign(problem.rates(0.0, y)[1]) or np.sign(problem.v))
        still = still or side == 0.0
        piece = _solve(problem, y, duration - now, outward, settled, side, still)
        stalls += piece.end is None
        if len(piece.t) < 2 or len(pieces) > MOST_PIECES or stalls > MOST_STALLS:
            raise RuntimeError(
                f"the integration of the motion failed after {now + piece.t[-1]:g} s at "
                f"{problem.velocity(y):g} m/s: {piece.message}"
            )
        pieces.append((now, piece.sol))
        swing = max(swing, float(np.max(np.abs(piece.u - problem.v))))
        still = bool(np.max(np.abs(piece.u)) <= problem.swing)
        peak = outward * max(outward * peak, outward * _peak(problem, piece, outward))
        y, ended = piece.y.copy(), piece.end == _EXTREME
        now = duration if piece.end == _TIME else now + piece.t[-1]
        if piece.end == _CORNER and not still:
            y[1] = 0.0
        if piece.end == _PACE:
            problem.creeps = not problem.creeps
    return Phase(
        duration=now,
        ended=ended,
        settled=swing <= problem.swing if ended else settled,
        x_dot_peak=peak,
        sample=lambda times: _sample(problem, pieces, times),
    )


_EXTREME, _CORNER, _PACE, _TIME = range(4)
"""What ends a piece."""


class _Piece(NamedTuple):
    """A piece of the motion: ends t of its steps [s], velocities u there [m/s], the last y."""

    t: list[float]
    u: Floats
    y: Floats
    sol: Any
    end: int | None
    message: str | None


def _solve(
    problem: _Problem,
    y: Floats,
    duration: float,
    outward: float,
    settled: bool,
    side: float,
    still: bool,
) -> _Piece:
    """Integrate until the spring is at an extreme, the velocity at 0, or for a time.

    ``outward`` is the sign of the velocity beyond the pull, ``side`` that of the velocity.
    ``still`` says that it has not left 0, ``settled`` that it has not left the pull: then the end
    is where it does. A solution that gets no further, because its steps are lost beside the time,
    may go on from there at time 0.
    """
    start, way = y, 1.0 if problem.creeps else -1.0
    step: Any = None
    longest = problem.law.longest_step(problem.p)

    def marks(t: float, y: Floats) -> tuple[float, ...]:
        """Return what is < 0 up to an extreme, a corner, a change of the pace."""
        u = problem.velocity(y)
        if t == 0.0:
            return -1.0, -1.0, -1.0
        off = u - problem.v
        if abs(off) > RUNAWAY * problem.speed:
            raise RuntimeError(
                f"the mass runs away, at {off:g} m/s: without inertia and damping nothing ends an "
                "instability"
            )
        slack = 2.0 * problem.swing
        return (
            abs(off) - slack if settled else -outward * off,
            abs(u) - slack if still else -side * float(y[1]),
            way * (abs(u) - CREEPS * abs(problem.v)) if longest < np.inf else -1.0,
        )

    def mark(t: float, number: int) -> float:
        return marks(t, step(t))[number]

    rtol = max(problem.asked, TOLERANCES[problem.method])
    atol = rtol * problem.sizes
    if problem.resolution:
        atol[1] = problem.resolution
    problem.calls = 0
    solver = _METHODS[problem.method](
        problem.rates,
        0.0,
        y,
        duration,
        jac=None if problem.jacobian(0.0, y) is None else problem.jacobian,
        max_step=longest if problem.creeps else np.inf,
        rtol=rtol,
        atol=atol,
    )
    t, u, steps, end, message = [0.0], [problem.velocity(y)], [], None, None
    while end is None:
        try:
            message = solver.step()
        except _StalledError:
            solver.status = "failed"
        if solver.status == "failed":
            break
        step, last, y = solver.dense_output(), solver.t, solver.y
        ends = [
            (float(brentq(mark, solver.t_old, last, (n,), _EPS, _EPS)), n)
            for n, value in enumerate(marks(last, y))
            if value >= 0.0
        ]
        if ends:
            last, end = min(ends)
            y = step(last)
        elif solver.status == "finished":
            end = _TIME
        t.append(last)
        u.append(problem.velocity(y))
        steps.append(step)
    if end is None and problem.method == "LSODA":
        problem.method = "Radau"
        return _solve(problem, start, duration, outward, settled, side, still)
    sol = OdeSolution(t, steps, alt_segment=problem.method == "LSODA") if steps else None
    return _Piece(t, np.array(u), y, sol, end, message)


def _peak(problem: _Problem, piece: _Piece, s: float) -> float:
    """Return the velocity farthest along ``s`` in a piece [m/s]."""
    at = int(np.argmax(s * piece.u))
    low, high = piece.t[max(at - 1, 0)], piece.t[min(at + 1, piece.u.size - 1)]
    found = minimize_scalar(
        lambda time: -s * problem.velocity(piece.sol(time)),
        bounds=(low, high),
        method="bounded",
        options={"xatol": 1e-9 * (high - low)},
    )
    return float(s * max(s * piece.u[at], -found.fun))


def _sample(problem: _Problem, pieces: list[tuple[float, Any]], times: Floats) -> Samples:
    times = np.atleast_1d(times)
    begins = np.array([begin for begin, _ in pieces])
    which = np.maximum(np.searchsorted(begins, times, side="right") - 1, 0)
    y = np.repeat(problem.start[:, np.newaxis], times.size, axis=1)
    for number in np.unique(which) if pieces else ():
        here = which == number
        begin, sol = pieces[number]
        y[:, here] = sol(times[here] - begin)
    x_dot = np.array([problem.velocity(each) for each in y.T])
    law, p, state = problem.law, problem.p, y[2:-2]
    heat = y[-1] - law.stored(p, state) + law.stored(p, problem.start[2:-2, np.newaxis])
    return Samples(y[0], x_dot, y[-2], heat, state)
