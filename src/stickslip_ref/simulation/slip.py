"""One slip between two changes of input, integrated with SciPy; docs/theory.md (3), (5).

The slip is integrated in the deviation from steady sliding, in units of its own size L and of
1 / w, so that the tolerances mean the same at any scale:

    y0 = (z - z_inf) / L             y0' = -y1
    y1 = (x_dot - v) / (w L)         y1' = y0 - 2 zeta y1 - s extra(|x_dot|)
    y2 = integral of y0              for the work of the pulling end
    y3 = integral of 2 zeta u^2 + extra |u|,   u = x_dot / (w L), for the heat
    y4 ... = the friction law's own state, if it has one

``extra`` is the part of the dry friction that changes with speed, over k L; Coulomb has none.

A slip ends at the first zero of x_dot. Looking for a sign change of x_dot at the ends of steps
loses the shallow ones, so the integration also stops where x_dot turns (x_ddot crosses zero with
a slope there): if x_dot has passed zero at its turning point, its zero lies before it, after the
last step's beginning, where x_dot still had the sign of the slip.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from ..laws import FrictionLaw, State
from ..parameters import Parameters

Floats = NDArray[np.float64]


class Samples(NamedTuple):
    """Motion at several times of an arc.

    Attributes
    ----------
    relief : array, shape (n,)
        Fall of z since the beginning of the arc [m].
    x_dot : array, shape (n,)
        Velocity of the mass [m/s].
    integral_z : array, shape (n,)
        Integral of z since the beginning [m s].
    heat : array, shape (n,)
        Heat since the beginning [J].
    state : array, shape (number of own state variables, n)
        The friction law's own state.
    """

    relief: Floats
    x_dot: Floats
    integral_z: Floats
    heat: Floats
    state: Floats


Sampling = Callable[[Floats], Samples]
"""Gives the motion at times [s] that count from the beginning of an arc."""

MAX_STEP = 0.5
"""Largest step in 1 / w: about a twelfth of a period, so that no step hides two turns."""

SPAN = 100.0
"""Longest single integration in 1 / w; between two, a slip is seen to have become steady."""

STEADY = 1e-16
"""A deviation from steady sliding below this part of the pull is none to rounding."""

ATOL = 1e-18
"""Absolute tolerance of the deviation, relative to the pull: a deviation that decays is followed
down to where it is steady sliding."""

LEAST_ATOL = 1e-100
"""The same where there is no pull; its inverse squared must not overflow in SciPy's norms."""

BEGINNING = 1e-6
"""In radians of the spring: so soon after rest the velocity may still be rounding."""

GRAZE = 8.0
"""A turning point of x_dot within 8 rtol |v| of zero is a stop: it is zero, to what the
integration resolves (measured: its error stays below rtol). Without a gap (mu_s = mu_k, c = 0) the
velocity touches zero and no more; docs/theory.md (5)."""

RESOLVED = 10.0
"""What the integration leaves open of z at a stop, in units of `_Problem.uncertainty` (measured on
1,500 slips: below 2.2). A slip with mu_k = 0 ends exactly where equality sticks, and no integration
meets that to rounding; docs/theory.md (4)."""

KNOT_SLACK = 8.0 * 2.0**-52
"""Rounding slack of a speed against a corner of the friction: scaled and back, a start at the
corner may lie on either side of it."""

MOST_CALLS = 10_000.0
"""Evaluations in a radian of the spring, 140 as a rule. Where the friction depends on the speed,
more mean that the error of a step is the rounding of the friction, which no shorter step makes
less: the tolerance grows tenfold then."""

COARSEST = 1e-3
"""Tolerance beyond which a slip is given up."""

STIFF_ZETA = 30.0
"""From this damping ratio on, steps of the explicit method are bound by stability alone."""

STIFF_RTOL = 1e-11
"""Tolerance of the implicit method, whose order (5, its error estimate's 3) affords no less."""


@dataclass(frozen=True)
class Slip:
    """A piece of slip; times count from its beginning.

    Attributes
    ----------
    duration : float
        Its length [s].
    stopped : bool
        Whether it ends in x_dot = 0; otherwise it lasts as long as it was given.
    grazes : bool
        Whether it ends where x_dot = 0 and x_ddot = 0 to what the integration resolves.
    x_dot_peak : float
        Extreme velocity along the slip [m/s].
    uncertainty : float
        What the integration leaves open of z at a stop [m].
    sample : callable
        The motion along it.
    """

    duration: float
    stopped: bool
    grazes: bool
    x_dot_peak: float
    uncertainty: float
    sample: Sampling


def integrate_slip(
    p: Parameters,
    law: FrictionLaw,
    s: int,
    z: float,
    x_dot: float,
    net_force: float,
    state: State,
    duration: float,
    rtol: float,
) -> Slip:
    """Integrate a slip in direction ``s`` until x_dot is zero or the duration is over.

    Parameters
    ----------
    p : Parameters
        Numbers only.
    law : FrictionLaw
        A law with a stick.
    s : int
        +1 or -1, the direction of slip.
    z, x_dot : float
        Spring extension [m] and velocity [m/s] at the beginning; ``s x_dot >= 0``.
    net_force : float
        ``k z + F_ext - s slip_friction(0)`` [N] at the beginning. Taken apart from ``z`` because
        at break-away it is a difference known more exactly than its terms.
    state : tuple of float
        The law's own state at the beginning.
    duration : float
        How long at most [s], > 0.
    rtol : float
        Relative tolerance of a step.

    Raises
    ------
    RuntimeError
        If the integration fails; the message gives SciPy's reason.
    """
    problem = _Problem(p, law, s, z, x_dot, net_force, state)
    tau_end = duration * problem.w
    pieces: list[tuple[float, Any]] = []
    tau, y, from_rest, first_step = 0.0, problem.start, x_dot == 0.0, None
    knot: float | None = None
    stop, grazes, uncertainty = None, False, 0.0
    peak = problem.u(y)
    while tau < tau_end:
        if problem.slides_steadily(y):
            pieces.append((tau, problem.steady_sliding(y)))
            break
        span = min(tau_end - tau, SPAN)
        solution = _solve(problem, y, span, from_rest, knot, first_step, rtol)
        pieces.append((tau, solution.sol))
        peak = s * max(s * u for u in (peak, *(problem.u(at) for at in solution.y_events[1])))
        stop, grazes = _stop(problem, solution, rtol)
        if stop is not None:
            uncertainty = problem.uncertainty(solution.sol(stop), rtol)
            tau += stop
            break
        # Go on from where the span ended, the velocity turned short of zero, or friction bends.
        first_step = float(np.max(np.diff(solution.t))) or None
        early = solution.status == 1
        knot = _bend(problem, solution)
        from_rest = early and solution.t_events[1].size > 0 and knot is None
        tau = tau + float(solution.t[-1]) if early or span < tau_end - tau else tau_end
        y = solution.y[:, -1]
    return Slip(
        duration=duration if stop is None else tau / problem.w,
        stopped=stop is not None,
        grazes=grazes,
        x_dot_peak=problem.w * problem.scale * peak,
        uncertainty=uncertainty,
        sample=lambda times: _sample(problem, pieces, times),
    )


class _StalledError(Exception):
    """The steps of an integration get short without end."""


class _Problem:
    """The scaled initial value problem of one slip."""

    def __init__(
        self,
        p: Parameters,
        law: FrictionLaw,
        s: int,
        z: float,
        x_dot: float,
        net_force: float,
        state: State,
    ) -> None:
        k, v = float(p.k), float(p.v)
        self.p, self.law, self.s, self.v = p, law, s, v
        self.w = float(p.w)
        self.two_zeta = 2.0 * float(p.zeta)
        # m x_ddot = k (z - z_inf) - c (x_dot - v): what drives the start is split so.
        deviation = (net_force - float(p.c) * v) / k
        self.z_inf = z - deviation
        self.scale = max(abs(deviation), abs(v) / self.w, abs(x_dot) / self.w) or 1.0
        self.beta = v / self.w / self.scale
        self.start = np.array(
            [deviation / self.scale, x_dot / self.w / self.scale - self.beta, 0.0, 0.0, *state]
        )
        self.at_zero_speed = law.slip_friction(p, 0.0, state)
        self.state_scale = law.state_scale(p)
        self.knots = law.knots(p)
        self.coarse, self.calls = 0.0, 0

    @property
    def stiff(self) -> bool:
        """Whether the implicit method is called for."""
        return self.two_zeta > 2.0 * STIFF_ZETA

    def tolerance(self, rtol: float) -> float:
        """Return the tolerance that the method can keep where ``rtol`` is asked for."""
        return max(rtol, self.coarse, STIFF_RTOL if self.stiff else 0.0)

    def uncertainty(self, y: Any, rtol: float) -> float:
        """Return what the integration leaves open of z [m] at a stop in the state ``y``.

        The velocity is known to some rtol, so the stop's time to that over the acceleration, and
        the spring follows the pull meanwhile; docs/theory.md (17).
        """
        least = np.finfo(float).tiny
        shallow = abs(self.beta) / max(abs(self.acceleration(y)), least)
        return RESOLVED * self.tolerance(rtol) * self.scale * (1.0 + shallow)

    def u(self, y: Any) -> float:
        """Velocity of the mass in units of w L."""
        return float(y[1]) + self.beta

    def speed(self, u: float) -> float:
        """Speed of the mass [m/s]."""
        return abs(u) * self.w * self.scale

    def extra(self, u: float, state: State) -> float:
        """Dry friction beyond that at zero speed and the first state, over k L."""
        force = self.law.slip_friction(self.p, self.speed(u), state)
        return (force - self.at_zero_speed) / (float(self.p.k) * self.scale)

    def acceleration(self, y: Any) -> float:
        """Acceleration of the mass in units of w^2 L."""
        value = float(y[0]) - self.two_zeta * float(y[1])
        return (
            value
            if self.law.constant_in_slip
            else value - self.s * self.extra(self.u(y), tuple(y[4:]))
        )

    def rates(self, tau: float, y: Floats) -> tuple[float, ...]:
        """Right-hand side of the scaled equations."""
        self.calls += 1
        if self.calls > MOST_CALLS * (1.0 + tau) and not self.law.constant_in_slip:
            raise _StalledError
        a, b, _, _, *own = y.tolist()
        u = b + self.beta
        if self.law.constant_in_slip:
            return -b, a - self.two_zeta * b, a, self.two_zeta * u * u
        state = tuple(own)
        extra = self.extra(u, state)
        return (
            -b,
            a - self.two_zeta * b - self.s * extra,
            a,
            self.two_zeta * u * u + extra * abs(u),
            *(rate / self.w for rate in self.law.rates(self.p, self.speed(u), state)),
        )

    def never_ends(self, y: Any) -> bool:
        """Tell whether the slip lasts until something changes.

        The size of the deviation never grows under constant dry friction, so a velocity deviation
        that starts below |v| stays below it. The margin keeps the marginal case in view.
        """
        size = math.hypot(y[0], y[1])
        return (
            self.law.constant_in_slip
            and self.s * self.beta > 0.0
            and size < abs(self.beta) * (1.0 - 1e-9)
        )

    def slides_steadily(self, y: Any) -> bool:
        """Tell whether the mass moves with the pull to the last digit."""
        return self.never_ends(y) and math.hypot(y[0], y[1]) <= STEADY * abs(self.beta)

    def steady_sliding(self, y: Floats) -> Callable[[Floats], Floats]:
        """Return the solution from ``y`` on, its deviation being nought."""
        heating = self.two_zeta * self.beta * self.beta

        def solution(tau: Floats) -> Floats:
            nought = np.zeros_like(tau)
            return np.stack([nought, nought, y[2] + nought, y[3] + heating * tau])

        return solution


def _solve(
    problem: _Problem,
    y: Floats,
    tau_end: float,
    from_rest: bool,
    last_knot: float | None,
    first_step: float | None,
    rtol: float,
) -> Any:
    """Integrate until x_dot is zero, until s x_dot turns from falling to growing, or to the end.

    ``from_rest`` says that s x_dot is about to grow: what the events see at the very beginning is
    rounding then, and must count as positive. ``last_knot`` is the speed at the corner of the
    friction where the last piece ended, beside it by rounding.
    """
    s = problem.s
    never_ends = problem.never_ends(y)

    def velocity(tau: float, y: Floats) -> float:
        begins = tau == 0.0 or (tau < BEGINNING and abs(problem.u(y)) < 1e-15 * abs(problem.beta))
        return 1.0 if from_rest and begins else s * problem.u(y)

    def turn(tau: float, y: Floats) -> float:
        return 1.0 if from_rest and tau == 0.0 else s * problem.acceleration(y)

    grows_first = from_rest or turn(0.0, y) > 0.0

    def bend(knot: float) -> Callable[[float, Floats], float]:
        def beyond(tau: float, y: Floats) -> float:
            difference = problem.speed(problem.u(y)) - knot
            if tau == 0.0 and (knot == last_knot or abs(difference) <= KNOT_SLACK * knot):
                return 1.0 if grows_first else -1.0
            return difference

        beyond.terminal = True  # type: ignore[attr-defined]  # as above
        return beyond

    # SciPy takes an event's options as attributes of the function, which typing has no word for.
    velocity.terminal, velocity.direction = not never_ends, -1  # type: ignore[attr-defined]
    # Where s x_dot grows, its first turn is a maximum, its second the minimum that is looked for.
    turn.terminal = False if never_ends else 1 + grows_first  # type: ignore[attr-defined]  # same
    stiff = problem.stiff
    kept = problem.tolerance(rtol)
    problem.calls = 0
    atol = max(ATOL * min(1.0, abs(problem.beta)), LEAST_ATOL)
    try:
        solution = solve_ivp(
            problem.rates,
            (0.0, tau_end),
            y,
            method="Radau" if stiff else "DOP853",
            dense_output=True,
            events=(velocity, turn, *map(bend, problem.knots)),
            rtol=kept,
            atol=[atol, atol, kept, kept, *(kept * size for size in problem.state_scale)],
            max_step=np.inf if never_ends or stiff else MAX_STEP,
            first_step=None if first_step is None else min(first_step, tau_end),
        )
    except _StalledError:
        if kept > COARSEST:
            raise RuntimeError(
                "the integration of a slip failed: its steps get too short"
            ) from None
        problem.coarse = 10.0 * kept
        return _solve(problem, y, tau_end, from_rest, last_knot, None, rtol)
    if solution.status < 0:
        raise RuntimeError(f"the integration of a slip failed: {solution.message}")
    return solution


def _bend(problem: _Problem, solution: Any) -> float | None:
    """Return the speed at the corner of the friction at which a piece ends; None elsewhere."""
    events = solution.t_events[2:]
    return next((k for k, event in zip(problem.knots, events, strict=True) if event.size), None)


def _stop(problem: _Problem, solution: Any, rtol: float) -> tuple[float | None, bool]:
    """Return when x_dot is zero, None if it is not, and whether it grazes zero there."""
    if solution.status != 1:
        return None, False
    if solution.t_events[0].size:
        return float(solution.t_events[0][-1]), False
    begin, end = float(solution.t[-2]), float(solution.t[-1])

    def velocity(tau: float) -> float:
        return problem.s * problem.u(solution.sol(tau))

    depth = velocity(end)
    if abs(depth) <= GRAZE * rtol * abs(problem.beta):
        return end, True
    if depth > 0.0:
        return None, False
    return float(brentq(velocity, begin, end, xtol=1e-300, rtol=4.0 * np.finfo(float).eps)), False


def _sample(problem: _Problem, pieces: list[tuple[float, Any]], times: Floats) -> Samples:
    taus = times * problem.w
    begins = np.array([begin for begin, _ in pieces])
    which = np.maximum(np.searchsorted(begins, taus, side="right") - 1, 0)
    y = np.repeat(problem.start[:, np.newaxis], taus.size, axis=1)
    for number in np.unique(which) if pieces else ():
        here = which == number
        begin, sol = pieces[number]
        y[:, here] = sol(taus[here] - begin)
    scale, w = problem.scale, problem.w
    relief = scale * (problem.start[0] - y[0])
    x_dot = w * scale * (y[1] + problem.beta)
    integral_z = problem.z_inf * times + scale / w * y[2]
    heat = (
        problem.at_zero_speed * np.abs(problem.v * times + relief)
        + float(problem.p.k) * scale * scale * y[3]
    )
    return Samples(relief, x_dot, integral_z, heat, y[4:])
