"""The motion under a friction law without a stick, integrated with SciPy.

Spring, velocity and the law's own state follow one system of equations between two changes of
input. It is stiff and has a corner at velocity 0, where the integration starts anew. A phase of the
motion ends where the mass is as fast as the pull: there the spring is at its maximum or minimum.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

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
    s = -1.0 if problem.v < 0.0 else 1.0
    pieces: list[tuple[float, Any]] = []
    now, y, peak, swing = 0.0, problem.start, x_dot, 0.0
    still, ended, stalls = False, False, 0
    settled = settled or (x_dot == 0.0 == problem.v and problem.rates(0.0, y)[1] == 0.0)
    while now < duration and not ended:
        side = float(np.sign(y[1]) or np.sign(problem.rates(0.0, y)[1]) or np.sign(problem.v))
        still = still or side == 0.0
        solution = _solve(problem, y, duration - now, s, falls, settled, side, still)
        stalls += solution.status < 0
        if solution.t.size < 2 or len(pieces) > MOST_PIECES or stalls > MOST_STALLS:
            raise RuntimeError(
                f"the integration of the motion failed after {now + solution.t[-1]:g} s at "
                f"{problem.velocity(y):g} m/s: {solution.message}"
            )
        pieces.append((now, solution.sol))
        u = np.array([problem.velocity(each) for each in solution.y.T])
        swing = max(swing, float(np.max(np.abs(u - problem.v))))
        still = bool(np.max(np.abs(u)) <= problem.swing)
        outward = s if falls else -s
        peak = outward * max(outward * peak, outward * _peak(problem, solution, u, outward))
        y, ended = solution.y[:, -1].copy(), solution.t_events[0].size > 0
        now = duration if solution.status == 0 else now + float(solution.t[-1])
        if solution.t_events[1].size and not still:
            y[1] = 0.0
        if any(times.size for times in solution.t_events[2:]):
            problem.creeps = not problem.creeps
    return Phase(
        duration=now,
        ended=ended,
        settled=swing <= problem.swing if ended else settled,
        x_dot_peak=peak,
        sample=lambda times: _sample(problem, pieces, times),
    )


def _solve(
    problem: _Problem,
    y: Floats,
    duration: float,
    s: float,
    falls: bool,
    settled: bool,
    side: float,
    still: bool,
) -> Any:
    """Integrate until the spring is at an extreme, the velocity at 0, or for a time.

    ``side`` is the sign of the velocity. ``still`` says that it has not left 0, ``settled`` that it
    has not left the pull: then the end is where it does. A solution that gets no further, because
    its steps are lost beside the time, may go on from there at time 0.
    """
    ahead = 1.0 if falls else -1.0

    def extreme(t: float, y: Floats) -> float:
        off = problem.velocity(y) - problem.v
        if abs(off) > RUNAWAY * problem.speed:
            raise RuntimeError(
                f"the mass runs away, at {off:g} m/s: without inertia and damping nothing ends an "
                "instability"
            )
        if settled:
            return -1.0 if t == 0.0 else abs(off) - 2.0 * problem.swing
        return s * off if t > 0.0 else ahead

    def corner(t: float, y: Floats) -> float:
        if still:
            return -1.0 if t == 0.0 else abs(problem.velocity(y)) - 2.0 * problem.swing
        return float(y[1]) if t > 0.0 else side

    def pace(t: float, y: Floats) -> float:
        if t == 0.0:
            return -1.0 if problem.creeps else 1.0
        return abs(problem.velocity(y)) - CREEPS * abs(problem.v)

    # SciPy takes an event's options as attributes of the function, which typing has no word for.
    extreme.terminal = corner.terminal = pace.terminal = True  # type: ignore[attr-defined]  # as above
    extreme.direction = 1.0 if settled else -ahead  # type: ignore[attr-defined]  # as above
    pace.direction = 1.0 if problem.creeps else -1.0  # type: ignore[attr-defined]  # as above
    longest, radau = problem.law.longest_step(problem.p), problem.method == "Radau"
    rtol = max(problem.asked, TOLERANCES[problem.method])
    atol = rtol * problem.sizes
    if problem.resolution:
        atol[1] = problem.resolution
    problem.calls = 0
    try:
        solution = solve_ivp(
            problem.rates,
            (0.0, duration),
            y,
            method=problem.method,
            dense_output=True,
            events=(extreme, corner, pace) if longest < np.inf else (extreme, corner),
            jac=None if problem.jacobian(0.0, y) is None else problem.jacobian,
            max_step=longest if problem.creeps else np.inf,
            rtol=rtol,
            atol=atol,
        )
    except _StalledError:
        solution = None
    if not radau and (solution is None or solution.status < 0):
        problem.method = "Radau"
        return _solve(problem, y, duration, s, falls, settled, side, still)
    return solution


def _peak(problem: _Problem, solution: Any, u: Floats, s: float) -> float:
    """Return the velocity farthest along ``s`` in a piece [m/s], ``u`` at the ends of steps."""
    at = int(np.argmax(s * u))
    low, high = solution.t[max(at - 1, 0)], solution.t[min(at + 1, u.size - 1)]
    found = minimize_scalar(
        lambda time: -s * problem.velocity(solution.sol(time)),
        bounds=(low, high),
        method="bounded",
        options={"xatol": 1e-9 * float(high - low)},
    )
    return float(s * max(s * u[at], -found.fun))


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
