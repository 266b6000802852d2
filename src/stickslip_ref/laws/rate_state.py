"""Friction of rate and state: contacts that renew over a distance D_c; docs/theory.md.

J. H. Dieterich, J. Geophys. Res. 84 (1979) 2161, 10.1029/JB084iB05p02161; A. Ruina, J. Geophys.
Res. 88 (1983) 10359, 10.1029/JB088iB12p10359. Regularised: N. Lapusta et al., J. Geophys. Res. 105
(2000) 23765, 10.1029/2000JB900250. Changes of the normal force: M. F. Linker, J. H. Dieterich, J.
Geophys. Res. 97 (1992) 4923, 10.1029/92JB00017.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from scipy.optimize import brentq

from ..parameters import Bound, Parameters
from .law import NO_STATE, Floats, FrictionLaw, OwnParameter, State

_FAR = 20.0
"""Beyond it sinh and cosh are half the exponential to the last digit."""

_LEAST = 1e-100
"""Width in velocity [m/s] that is as good as none."""

_PART = 0.2
"""Of it a step may be long: five times as long, some missed an instability by 1e-5 of a cycle."""


_AGING = 1
"""Of evolution: ``1 - |x_dot| theta / D_c``; else, 2, slip: ``-r ln r``, r their ratio."""

_INERTIA = 1
"""Of inertia: a force beyond the friction accelerates the mass; else, 2, it drives c x_dot."""


class RateState(FrictionLaw):
    """Friction ``N mu``, mu rising with the logarithm of rate and state.

    ``mu = a asinh(x_dot / (2 V_0) exp((mu_0 + b ln(V_0 theta / D_c)) / a))``. The own state is ln
    theta, theta in s; the velocity is followed as mu / a, its logarithm far from rest.
    """

    parameters: Mapping[str, OwnParameter] = MappingProxyType(
        {
            "mu_0": OwnParameter(0.6, Bound("", 0.0), tunable=False),
            "a": OwnParameter(0.01, Bound("", 0.0, strict=True), tunable=False),
            "b": OwnParameter(0.015, Bound("", 0.0), tunable=False),
            "D_c": OwnParameter(1e-5, Bound("m", 0.0, strict=True), tunable=False),
            "V_0": OwnParameter(1e-6, Bound("m/s", 0.0, strict=True), tunable=False),
            "alpha": OwnParameter(0.0, Bound("", 0.0), tunable=False),
            "evolution": OwnParameter(1.0, Bound("", 1.0), tunable=False),
            "inertia": OwnParameter(1.0, Bound("", 1.0), tunable=False),
            "theta_start": OwnParameter(10.0, Bound("s", 0.0, strict=True), tunable=False),
            "v_stick": OwnParameter(1e-4, Bound("m/s", 0.0), tunable=False),
        }
    )
    sticks = False

    def complete(self, p: Parameters, own: Mapping[str, float]) -> Parameters:
        """Return ``p`` with a value for each own parameter.

        Raises
        ------
        ValueError
            Also if evolution or inertia is neither 1 nor 2.
        """
        result = super().complete(p, own)
        for name in ("evolution", "inertia"):
            if result.own[name] not in (1.0, 2.0):
                raise ValueError(f"{name} = {result.own[name]!r} is out of range; it is 1 or 2")
        return result

    def mu_k_used(self, p: Parameters) -> float:
        """Return NaN: the law has no mu_k."""
        return math.nan

    def break_away_force(self, p: Parameters, age: float = 0.0, state: State = NO_STATE) -> float:
        """Return ``mu_0 N`` [N]."""
        return p.own["mu_0"] * float(p.N)

    def slip_friction(self, p: Parameters, speed: float, state: State = NO_STATE) -> float:
        """Return ``N mu`` [N] at a signed velocity [m/s]."""
        return float(p.N) * p.own["a"] * _asinh(speed, _logarithm(p, state))

    def state_start(self, p: Parameters) -> State:
        """Return ln theta at the start."""
        return (math.log(p.own["theta_start"]),)

    def state_scale(self, p: Parameters) -> State:
        """Return the size of a change of ln theta: 1."""
        return (1.0,)

    def rates(self, p: Parameters, speed: float, state: State) -> State:
        """Return the rate of ln theta [1/s] at a signed velocity [m/s]."""
        size = abs(speed) / p.own["D_c"]
        if p.own["evolution"] == _AGING:
            return (_exp(-state[0]) - size,)
        return (-size * (math.log(size) + state[0]) if size > 0.0 else 0.0,)

    def changed(self, before: Parameters, p: Parameters, state: State) -> State:
        """Return ln theta after a change of the normal force; Linker and Dieterich (1992)."""
        N_before, N, b = float(before.N), float(p.N), p.own["b"]
        if N_before == N or not (N_before > 0.0 and N > 0.0 and b > 0.0):
            return state
        return (state[0] + p.own["alpha"] / b * math.log(N_before / N),)

    def velocity_from(self, p: Parameters, z: float, x_dot: float, state: State) -> float:
        """Return the velocity [m/s]; without a mass the one that balances the forces."""
        if p.own["inertia"] == _INERTIA:
            return x_dot
        return balance(p, float(p.k) * z + float(p.F_ext), state)

    def logarithmic(self, p: Parameters) -> bool:
        """Return whether there is a normal force; without, the mass passes 0 at once."""
        return float(p.N) > 0.0

    def coordinate(self, p: Parameters, x_dot: float, state: State) -> float:
        """Return mu / a; without a normal force the velocity."""
        return _asinh(x_dot, _logarithm(p, state)) if self.logarithmic(p) else x_dot

    def velocity(self, p: Parameters, coordinate: float, state: State) -> float:
        """Return the velocity [m/s]."""
        return _sinh(coordinate, _logarithm(p, state)) if self.logarithmic(p) else coordinate

    def coordinate_rate(
        self, p: Parameters, x_ddot: float, x_dot: float, coordinate: float, state: State
    ) -> float:
        """Return the rate of mu / a [1/s]."""
        if not self.logarithmic(p):
            return x_ddot
        (aging,) = self.rates(p, x_dot, state)
        slowing = -p.own["b"] / p.own["a"] * aging
        width = _cosh(coordinate, _logarithm(p, state))
        if p.own["inertia"] == _INERTIA:
            return x_ddot / width - math.tanh(coordinate) * slowing
        # The balance of forces, differentiated: k (v - x_dot) = N mu' + c x_ddot.
        drag = float(p.c)
        driving = float(p.k) * (float(p.v) - x_dot) - drag * x_dot * slowing
        return driving / (float(p.N) * p.own["a"] + drag * width)

    def jacobian(self, p: Parameters, force: float, coordinate: float, state: State) -> Floats:
        """Return the exact derivatives of x_dot, (mu / a)', (ln theta)' by force, mu / a, theta."""
        own, m, k, v, c = p.own, float(p.m), float(p.k), float(p.v), float(p.c)
        q, L_s, resistance = coordinate, -own["b"] / own["a"], float(p.N) * own["a"]
        u = self.velocity(p, q, state)
        (aging,) = self.rates(p, u, state)
        by_u, by_s = self._aging_slopes(p, u, state)
        if not self.logarithmic(p):
            return np.array([[0.0, 1.0, 0.0], [1.0 / m, -c / m, 0.0], [0.0, by_u, by_s]])
        width = _cosh(q, _logarithm(p, state))
        whole_by_s = by_u * u * L_s + by_s
        aging_by_q, slowing = by_u * width, L_s * aging
        if own["inertia"] == _INERTIA:
            net, tanh = force - resistance * q - c * u, math.tanh(q)
            by_force = 1.0 / (m * width)
            by_q = -(resistance / width + c + net * tanh / width) / m
            by_q -= slowing / math.cosh(min(abs(q), 300.0)) ** 2 + tanh * L_s * aging_by_q
            along_by_s = -L_s * ((c * u + net) * by_force + tanh * whole_by_s)
        else:
            by_force, drag = 0.0, resistance + c * width
            rate = (k * (v - u) - c * u * slowing) / drag
            by_q = -(k + c * slowing) * width - c * u * L_s * aging_by_q - rate * c * u
            along_by_s = -L_s * (u * (k + c * slowing) + c * (u * whole_by_s + rate * width))
            by_q, along_by_s = by_q / drag, along_by_s / drag
        return np.array(
            [[0.0, width, u * L_s], [by_force, by_q, along_by_s], [0.0, aging_by_q, whole_by_s]]
        )

    def _aging_slopes(self, p: Parameters, speed: float, state: State) -> tuple[float, float]:
        """Return the derivatives of `rates` by the velocity and by ln theta."""
        s, size = float(np.sign(speed)) / p.own["D_c"], abs(speed) / p.own["D_c"]
        if p.own["evolution"] == _AGING:
            return -s, -_exp(-state[0])
        return (-s * (math.log(size) + state[0] + 1.0), -size) if size > 0.0 else (0.0, 0.0)

    def speeds(self, p: Parameters) -> tuple[float, ...]:
        """Return the velocity of contacts that renew in 1/w, and where sliding turns stable."""
        own, N, k, m, c = p.own, float(p.N), float(p.k), float(p.m), float(p.c)
        falls = (own["b"] - own["a"]) * N
        if own["inertia"] == _INERTIA:
            ratio = k * own["D_c"] / falls - 1.0 if falls else 0.0
            edge = math.sqrt(max(ratio * own["a"] * N * own["D_c"] / m, 0.0))
        else:
            edge = (falls - k * own["D_c"]) / c if c else 0.0
        return tuple(u for u in (own["D_c"] * float(p.w), edge) if u > 0.0)

    def steady_state(self, p: Parameters, v: float) -> State:
        """Return ln theta in sliding at a velocity [m/s]: theta is ``D_c / |v|``."""
        return (math.log(p.own["D_c"] / abs(v)),)

    def no_cycle(self, p: Parameters) -> str:
        """Return that steady friction rises with the velocity, if so."""
        a, b = p.own["a"], p.own["b"]
        return (
            f"a = {a!r} is at least b = {b!r}: steady friction does not fall with the velocity, so "
            "steady sliding is stable at any"
            if a >= b
            else ""
        )

    def longest_step(self, p: Parameters) -> float:
        """Return a part of the time in which the pull raises mu by a [s].

        A longer step of a mass that creeps sees nothing of the instability that is near.
        """
        pull, rise = float(p.k) * abs(float(p.v)), float(p.N) * p.own["a"]
        return _PART * rise / pull if pull > 0.0 and rise > 0.0 else math.inf

    def shown(self, p: Parameters, x_dot: Floats, state: Floats) -> dict[str, Floats]:
        """Return theta [s] and mu [-]."""
        mu = [
            p.own["a"] * _asinh(u, _logarithm(p, (own,)))
            for u, own in zip(x_dot.tolist(), state[0].tolist(), strict=True)
        ]
        return {"theta": np.exp(state[0]), "mu": np.array(mu)}


def balance(p: Parameters, force: float, state: State) -> float:
    """Return the velocity [m/s] at which friction and damping balance a force [N].

    Raises
    ------
    ValueError
        If neither a normal force nor damping holds the force.
    """
    resistance, c = float(p.N) * p.own["a"], float(p.c)
    if resistance == 0.0 == c:
        raise ValueError(
            "N = 0 N and c = 0 N.s/m are out of range together; without a mass (inertia = 2) "
            "friction or damping must balance the spring"
        )
    logarithm = _logarithm(p, state)
    if resistance == 0.0:
        return force / c
    size = abs(force)
    if size == 0.0:
        return 0.0

    def lacking(coordinate: float) -> float:
        return resistance * coordinate + c * _sinh(coordinate, logarithm) - size

    # Where damping alone would hold the force the coordinate is at least the true one.
    high = size / resistance
    if c:
        high = min(high, _asinh(size / c, logarithm))
    root = float(brentq(lacking, 0.0, high, xtol=1e-300, rtol=4.0 * 2.0**-52))
    return math.copysign(_sinh(root, logarithm), force)


def _logarithm(p: Parameters, state: State) -> float:
    """Return the logarithm of the velocity [m/s] at which mu is a asinh(1)."""
    own = p.own
    renewed = own["b"] * (math.log(own["V_0"] / own["D_c"]) + state[0])
    return math.log(2.0 * own["V_0"]) - (own["mu_0"] + renewed) / own["a"]


def _asinh(x_dot: float, logarithm: float) -> float:
    """Return asinh(x_dot / exp(logarithm)), without overflow."""
    if x_dot == 0.0:
        return 0.0
    ratio = math.log(abs(x_dot)) - logarithm
    size = ratio + math.log(2.0) if ratio > _FAR else math.asinh(math.exp(ratio))
    return math.copysign(size, x_dot)


def _sinh(coordinate: float, logarithm: float) -> float:
    """Return exp(logarithm) sinh(coordinate), without overflow."""
    size = abs(coordinate)
    if size > _FAR:
        return math.copysign(0.5 * _exp(logarithm + size), coordinate)
    return _exp(logarithm) * math.sinh(coordinate)


def _cosh(coordinate: float, logarithm: float) -> float:
    """Return exp(logarithm) cosh(coordinate), as `_sinh`, at least 1e-100.

    It is the velocity over which mu / a changes by 1; SciPy squares its inverse.
    """
    size = abs(coordinate)
    if size > _FAR:
        return max(0.5 * _exp(logarithm + size), _LEAST)
    return max(_exp(logarithm) * math.cosh(size), _LEAST)


def _exp(exponent: float) -> float:
    """Return an exponential; beyond 1e100 and below 1e-300, where only trials lead, no further."""
    return math.exp(max(-690.0, min(exponent, 230.0)))


RATE_STATE = RateState()
