"""Steady motions under friction that depends on the speed of slip; docs/theory.md (26) to (30).

Such friction has no memory: every slip from break-away starts alike, so the first one gives the
cycle. A stop with a force beyond F_s turns round; where the slip back ends beyond F_s too, the
motion grows and never sticks.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from stickslip_ref import Shape

from .columns import Floats
from .slips import (
    BESIDE,
    LEAST_STICK,
    REST_SLACK,
    Flags,
    Motion,
    Values,
    first_slips,
    taken,
)

HYPERBOLIC, CURVE = int(Shape.HYPERBOLIC), int(Shape.CURVE)
_MOST_POINTS: Final = 12

_NEAR: Final = 0.1
"""A slip that ends with a larger deceleration than this part of w v does not graze."""

_NEAR_REVERSAL: Final = 1e-3
"""A stop whose force is further from F_s than this part of it is not at the limit of reversal."""


class _Cycles(NamedTuple):
    """Cycles from break-away to break-away; `near`: whether a limit may be near."""

    sticks: Flags
    t_stick: Floats
    t_slip: Floats
    near: Flags


def motion(values: dict[str, float | Floats], law: str, row: int) -> Motion:
    """Return the steady motions of a list of blocks under a friction law.

    `values` are parameters and inputs by name [SI]: numbers and arrays of one length, ``v`` an
    array >= 0, ``mu_k`` after the clamp. So many blocks at a time as `row` says differ in nothing
    but ``v``, which rises. A limit is looked for beside a block that never sticks where its
    neighbours stick, or where it has none: slips without end take long to follow.
    """
    v = np.asarray(values["v"])
    cycles, swings = _cycles(values, law), slides_unstably(values)
    at_limit = np.zeros(v.shape, bool)
    # Beyond either end of a row there may be one that sticks.
    padded = np.pad(cycles.sticks.reshape(-1, row), ((0, 0), (1, 1)), constant_values=True)
    for factor, neighbours in ((1.0 - BESIDE, padded[:, :-2]), (1.0 + BESIDE, padded[:, 2:])):
        at_limit |= slides_unstably({**values, "v": v * factor}) != swings
        near = np.flatnonzero(cycles.near | ~cycles.sticks & neighbours.ravel())
        beside = _cycles({**taken(values, near), "v": v[near] * factor}, law)
        at_limit[near] |= beside.sticks != cycles.sticks[near]
    return Motion(cycles.sticks, cycles.t_stick, cycles.t_slip, swings, at_limit)


def _cycles(values: Values, law: str) -> _Cycles:
    """Follow the slip from break-away, and the slip back where it turns round."""
    v = np.asarray(values["v"])
    k, m, N = (np.broadcast_to(each, v.shape) for each in _block(values))
    F_s = np.broadcast_to(values["mu_s"] * N, v.shape)
    w = np.sqrt(k / m)
    slip = first_slips(values, law)
    drop, t_slip = slip.spring_drop.copy(), slip.t_slip.copy()
    with np.errstate(invalid="ignore", divide="ignore"):
        force = F_s - k * drop
        # The friction at the end of the slip is that of its beginning.
        ends = np.isfinite(t_slip)
        deceleration = (F_s * _first_share(values) - force) / (m * w * v)
        beyond = ends & (force < -F_s - REST_SLACK * (np.abs(force) + F_s))
        near = ends & ((deceleration < _NEAR) | (np.abs(force + F_s) < _NEAR_REVERSAL * F_s))
        back = np.flatnonzero(beyond)
        if back.size:
            following = first_slips({**taken(values, back), "z_start": force[back] / k[back]}, law)
            drop[back] += following.spring_drop
            t_slip[back] += following.t_slip
            over = -k[back] * drop[back]
            held = over <= REST_SLACK * (np.abs(over + F_s[back]) + F_s[back])
            ends[back] = np.isfinite(following.t_slip) & held
            near[back] |= np.abs(over) < _NEAR_REVERSAL * F_s[back]
        t_stick = drop / v
        sticks = ends & (t_stick * w >= LEAST_STICK)
    return _Cycles(sticks, t_stick, t_slip, near)


def _block(values: Values) -> tuple[Floats | float, Floats | float, Floats | float]:
    """Return stiffness [N/m], mass [kg] and normal force [N]."""
    m = values["m"]
    return values["k"], m, m * values["g"] + values["load"]


def _first_share(values: Values) -> Floats:
    """Return the friction of a slip that begins, as a part of F_s."""
    with np.errstate(invalid="ignore", divide="ignore"):
        of_curve = np.divide(values["mu_1"], values["mu_s"])
    return np.where(np.equal(values["shape"], CURVE), of_curve, 1.0)


def slides_unstably(values: Values) -> Flags:
    """Tell where steady sliding at v is unstable: c + N mu'(v) < 0; docs/theory.md (29)."""
    _, _, N = _block(values)
    return np.asarray(values["c"] + N * _slope(values) < 0.0)


def _slope(values: Values) -> Floats:
    """Return the rate of the coefficient of friction with the speed [s/m] at v."""
    v, v_s, delta = np.asarray(values["v"]), values["v_s"], values["delta"]
    fall = np.subtract(values["mu_s"], values["mu_k"])
    ratio = v / v_s
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        left = np.exp(-(ratio**delta))
        of_stribeck = np.where(left > 0.0, -fall / v_s * delta * ratio ** (delta - 1.0) * left, 0.0)
        of_hyperbola = -fall / v_s / (1.0 + ratio) ** 2
    shape = np.asarray(values["shape"])
    slope = np.where(shape == HYPERBOLIC, of_hyperbola, of_stribeck)
    if np.any(shape == CURVE):
        slope = np.where(shape == CURVE, _slope_of_curve(values, v), slope)
    return np.asarray(np.broadcast_to(slope, v.shape))


def _slope_of_curve(values: Values, v: Floats) -> Floats:
    slope = np.zeros(v.shape)
    u, mu = np.zeros(()), np.asarray(values["mu_1"])
    for number in range(2, _MOST_POINTS + 1):
        u_next, mu_next = np.asarray(values[f"u_{number}"]), np.asarray(values[f"mu_{number}"])
        here = (number <= np.asarray(values["n_points"])) & (u <= v) & (v < u_next)
        # Points that do not count need not rise.
        with np.errstate(invalid="ignore", divide="ignore"):
            slope = np.where(here, (mu_next - mu) / (u_next - u), slope)
        u, mu = u_next, mu_next
    return slope


def last_coefficient(values: Values) -> Floats:
    """Return the coefficient of the last point of a measured curve."""
    coefficients = [np.asarray(values[f"mu_{number}"]) for number in range(1, _MOST_POINTS + 1)]
    return np.choose(np.asarray(values["n_points"], dtype=np.intp) - 1, coefficients)
