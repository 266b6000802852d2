"""What closed forms say beforehand; the equations are numbered as in docs/feed-axis.md."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

from .axis import Axis

Vector = NDArray[np.float64]

# Motor position and speed, table position and speed, integral, command, one.
_X_MOTOR, _V_MOTOR, _X, _X_DOT, _INTEGRAL, _COMMAND, _ONE = range(7)

_LOOKS_PER_PERIOD = 200
_PERIODS = 3
"""How long a slip is watched: with the drive's damping its first minimum is the deepest."""

_MOST_SLIPS = 200
_STEADY = 1e-6
"""Relative change of the jump from slip to slip at which the cycle counts as steady."""


_SLOWEST, _FASTEST = 1e-4, 2e-2
_FASTER = 1.02
_SLIPS_PER_FEED = 3
"""The search for the critical feed [m/s]: in steps of 2 %, some slips at each."""


@dataclass(frozen=True)
class Slip:
    """A slip against the drive.

    Attributes
    ----------
    jump, t_slip
        Way [m] and length [s].
    relief
        By how much the spring force falls [N].
    period
        Time from its break-away to the next [s]; infinite where nothing loads the spring again.
    """

    jump: float
    t_slip: float
    relief: float
    period: float


def coupling_damping(w_d: float, w: float, h: float) -> float:
    """Return the damping ratio that explicit coupling adds; docs/feed-axis.md (3).

    Parameters
    ----------
    w_d, w
        sqrt(k / m_d), and the frequency of table and drive against each other [rad/s].
    h
        Communication step [s].

    Notes
    -----
    Of a drive that holds the force and gives its speed of now: it lags by one step.
    """
    return -0.5 * w_d * w_d * h / w


def first_slip(axis: Axis) -> Slip | None:
    """Return the slip out of rest, the motor at rest at break-away; docs/feed-axis.md (5).

    The drive is the continuous, linear one: no sampling, no encoder counts.
    """
    quiet = replace(axis, feed=0.0)
    end = _slide(quiet, _linear_rates(quiet, slips=True), _at_rest(quiet))
    if end is None:
        return None
    return Slip(end.jump, end.time, end.relief, math.inf)


def steady_slip(axis: Axis) -> Slip | None:
    """Return the slip of the steady cycle at the feed; docs/feed-axis.md (5).

    From the slip out of rest on, slip and load-up alternate until they repeat. None where a
    slip does not end: there is no stick-slip at this feed.
    """
    slipping = _linear_rates(axis, slips=True)
    sticking = _linear_rates(axis, slips=False)
    state = _at_rest(axis)
    found: Slip | None = None
    for _ in range(_MOST_SLIPS):
        end = _slide(axis, slipping, state)
        if end is None:
            return None
        state, loading = _load(axis, sticking, end.state)
        last, found = found, Slip(end.jump, end.time, end.relief, end.time + loading)
        if last is not None and abs(found.jump - last.jump) <= _STEADY * found.jump:
            break
    return found


@functools.lru_cache
def jumps_over_feed(axis: Axis) -> tuple[tuple[float, float], ...]:
    """Return feeds [m/s] and the jumps [m] of their cycles, up to where the cycle ends.

    The feed rises by 2 % at a time, and the cycle is carried along.
    """
    found: list[tuple[float, float]] = []
    feed, state = _SLOWEST, _at_rest(axis)
    while feed < _FASTEST:
        now = replace(axis, feed=feed)
        slipping, sticking = (_linear_rates(now, slips=slips) for slips in (True, False))
        for _ in range(_SLIPS_PER_FEED):
            end = _slide(now, slipping, state)
            if end is None:
                return tuple(found)
            state, _ = _load(now, sticking, end.state)
            jump = end.jump
        found.append((feed, jump))
        feed *= _FASTER
    return tuple(found)


def critical_feed(axis: Axis) -> float:
    """Return the feed [m/s] at which jumping ends when the feed rises slowly; 0 without any."""
    return max((feed for feed, _ in jumps_over_feed(axis)), default=0.0)


def hunting_slip(axis: Axis) -> Slip | None:
    """Return the slip of hunting around the target; docs/feed-axis.md (6).

    None where nothing winds up: position on the motor, or no integral; where a slip does not end;
    and where the dead band takes the error that a jump leaves for none.

    Notes
    -----
    Before the break-away the motor creeps at v_d = alpha K_v J / 2, so the integral feeds drive
    and spring in series, and during the slip it goes on at v_d but for what (5) tells:
    J = J_5 + v_d t_slip.
    """
    at_rest = first_slip(axis)
    if not axis.on_table or axis.T_n == 0.0 or at_rest is None or at_rest.jump <= 0.0:
        return None
    alpha = 1.0 / (1.0 + axis.k * axis.T_n / axis.K_p)
    longer = 1.0 - 0.5 * alpha * axis.K_v * at_rest.t_slip
    if longer <= 0.0:
        return None
    jump = at_rest.jump / longer
    if 0.5 * jump <= axis.dead_band:
        return None
    softness = 1.0 / axis.k + axis.T_n / axis.K_p
    period = 4.0 / axis.K_v * (2.0 * axis.F_s * softness / jump - 1.0)
    return replace(at_rest, jump=jump, period=period)


class _End(NamedTuple):
    """The end of a slip: state, time since its start [s], jump [m], relief [N]."""

    state: Vector
    time: float
    jump: float
    relief: float


def _slide(axis: Axis, rates: Vector, state: Vector) -> _End | None:
    """Follow a slip from its break-away to its end, None where it has none."""
    h = _look(axis)
    step = expm(rates * h)
    force, start = _pull(axis, state), float(state[_X])
    for look in range(_PERIODS * _LOOKS_PER_PERIOD):
        after = step @ state
        # The first look still sees the start at rest.
        if look > 1 and after[_X_DOT] <= 0.0:
            rest = _zero(rates, state, h, lambda state: float(state[_X_DOT]))
            end = expm(rates * rest) @ state
            end[_X_DOT] = 0.0
            time = look * h + rest
            return _End(end, time, float(end[_X]) - start, force - _pull(axis, end))
        state = after
    return None


def _load(axis: Axis, rates: Vector, state: Vector) -> tuple[Vector, float]:
    """Follow a stick to its break-away; return the state there and the time it took [s]."""
    h = _look(axis)
    step = expm(rates * h)
    F_s, time = axis.F_s, 0.0
    # Ten times the load-up of a relaxed spring by the feed alone.
    longest = 10.0 * F_s / (axis.k * axis.feed)
    while time < longest:
        after = step @ state
        if _pull(axis, after) >= F_s:
            rest = _zero(rates, state, h, lambda state: F_s - _pull(axis, state))
            return expm(rates * rest) @ state, time + rest
        state, time = after, time + h
    return state, math.inf


def _zero(rates: Vector, state: Vector, h: float, of: Callable[[Vector], float]) -> float:
    return float(brentq(lambda tau: of(expm(rates * tau) @ state), 0.0, h, xtol=1e-12))


def _pull(axis: Axis, state: Vector) -> float:
    return float(axis.k * (state[_X_MOTOR] - state[_X]))


def _look(axis: Axis) -> float:
    return 2.0 * math.pi / math.sqrt(axis.k / axis.m) / _LOOKS_PER_PERIOD


def _linear_rates(axis: Axis, *, slips: bool) -> Vector:
    """Return the matrix of d state/dt, of table and drive while it slips or sticks."""
    rates = np.zeros((7, 7))
    wanted = np.zeros(7)
    wanted[_COMMAND] = axis.K_v
    wanted[_X if axis.on_table else _X_MOTOR] = -axis.K_v
    wanted[_V_MOTOR] -= 1.0
    wanted[_ONE] = axis.velocity_feedforward * axis.feed
    spring = np.zeros(7)
    spring[[_X_MOTOR, _X]] = axis.k, -axis.k
    rates[_X_MOTOR, _V_MOTOR] = 1.0
    rates[_COMMAND, _ONE] = axis.feed
    rates[_V_MOTOR] = (axis.K_p * wanted - spring) / axis.m_d
    rates[_V_MOTOR, _INTEGRAL] += 1.0 / axis.m_d
    rates[_V_MOTOR, _V_MOTOR] -= axis.d / axis.m_d
    if axis.T_n > 0.0:
        rates[_INTEGRAL] = axis.K_p / axis.T_n * wanted
    if slips:
        rates[_X, _X_DOT] = 1.0
        rates[_X_DOT] = spring / axis.m
        rates[_X_DOT, _X_DOT] -= axis.c / axis.m
        rates[_X_DOT, _ONE] -= axis.mu_k * axis.g
    return rates


def _at_rest(axis: Axis) -> Vector:
    """Return the state at break-away after a slow load-up: the motor at rest, holding F_s."""
    F_s = axis.F_s
    state = np.zeros(7)
    state[_X_MOTOR], state[_ONE] = F_s / axis.k, 1.0
    if axis.T_n > 0.0:
        state[_INTEGRAL] = F_s
    lag = 0.0 if axis.T_n > 0.0 else F_s / axis.K_p / axis.K_v
    state[_COMMAND] = lag + (0.0 if axis.on_table else state[_X_MOTOR])
    return state
