"""LuGre's friction law: bristles that bend before the mass slides; docs/theory.md.

C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, IEEE Trans. Automatic Control 40 (1995)
419, 10.1109/9.376053.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from ..parameters import Bound, Parameters
from .law import NO_STATE, Floats, FrictionLaw, OwnParameter, State

_LEAST = 1e-12
"""Least friction in sliding over m g: N = 0 or mu_s = 0 is no division by 0."""

_NOISE = 300.0 * 2.0**-52
"""Rounding of the forces in presliding that no velocity is followed below, over F_s."""

_NONE = 1e-6
"""Break-away force over m g of bristles that are as good as none."""

_PART = 0.02
"""Of that time a step may be long: none passes break-away."""


class LuGre(FrictionLaw):
    """Bristles of deflection zeta [m], the own state; the mass never sticks.

    ``zeta' = x_dot - sigma_0 |x_dot| zeta / g(x_dot)``, and the friction on the mass is
    ``sigma_0 zeta + sigma_1(x_dot) zeta'``, c x_dot apart.
    """

    parameters: Mapping[str, OwnParameter] = MappingProxyType(
        {
            "sigma_0": OwnParameter(1e5, Bound("N/m", 0.0, strict=True), tunable=False),
            "sigma_1": OwnParameter(300.0, Bound("N.s/m", 0.0), tunable=False),
            "v_s": OwnParameter(1e-3, Bound("m/s", 0.0, strict=True), tunable=False),
            "delta": OwnParameter(2.0, Bound("", 1.0), tunable=False),
            "v_d": OwnParameter(0.0, Bound("m/s", 0.0), tunable=False),
            "zeta_start": OwnParameter(0.0, Bound("m"), tunable=False),
            "v_stick": OwnParameter(1e-4, Bound("m/s", 0.0), tunable=False),
        }
    )
    sticks = False

    def break_away_force(self, p: Parameters, age: float = 0.0, state: State = NO_STATE) -> float:
        """Return ``mu_s N`` [N]; the friction itself may pass it by sigma_1 zeta'."""
        return float(p.F_s)

    def sliding_friction(self, p: Parameters, speed: float) -> float:
        """Return g [N], the friction in steady sliding at a speed [m/s] >= 0, c apart."""
        falls = math.exp(-_power(speed / p.own["v_s"], p.own["delta"]))
        force = (float(p.mu_k_used) + float(p.mu_s - p.mu_k_used) * falls) * float(p.N)
        return max(force, _LEAST * float(p.m) * float(p.g))

    def slip_friction(self, p: Parameters, speed: float, state: State = NO_STATE) -> float:
        """Return ``sigma_0 zeta + sigma_1 zeta'`` [N] at a signed velocity [m/s]."""
        (rate,) = self.rates(p, speed, state)
        return p.own["sigma_0"] * state[0] + self.damping(p, speed) * rate

    def damping(self, p: Parameters, speed: float) -> float:
        """Return sigma_1 [N.s/m] at a velocity [m/s]."""
        sigma_1, v_d = p.own["sigma_1"], p.own["v_d"]
        return sigma_1 * math.exp(-_power(speed / v_d, 2.0)) if v_d else sigma_1

    def state_start(self, p: Parameters) -> State:
        """Return zeta at the start [m]."""
        return (p.own["zeta_start"],)

    def state_scale(self, p: Parameters) -> State:
        """Return the deflection at which the bristles give way [m]."""
        return (0.1 * self.sliding_friction(p, 0.0) / p.own["sigma_0"],)

    def rates(self, p: Parameters, speed: float, state: State) -> State:
        """Return zeta' [m/s] at a signed velocity [m/s]."""
        size = abs(speed)
        return (speed - p.own["sigma_0"] * size * state[0] / self.sliding_friction(p, size),)

    def jacobian(self, p: Parameters, force: float, coordinate: float, state: State) -> Floats:
        """Return the exact derivatives of x_dot, x_ddot and zeta' by force, x_dot and zeta."""
        u, (zeta,), own, m = coordinate, state, p.own, float(p.m)
        size, s = abs(u), float(np.sign(u))
        g, slope = self.sliding_friction(p, size), self.sliding_slope(p, size)
        by_zeta = -own["sigma_0"] * size / g
        # In steady sliding it is 1, and a rounding would be all of a damping of 0.
        bent = 1.0 if zeta == s * (g / own["sigma_0"]) else s * own["sigma_0"] * zeta / g
        by_u = 1.0 - bent * (1.0 - size * slope / g)
        damping = self.damping(p, u)
        weaker = -2.0 * u / own["v_d"] ** 2 * damping if own["v_d"] else 0.0
        friction_by_u = damping * by_u + weaker * (u + by_zeta * zeta) + float(p.c)
        friction_by_zeta = own["sigma_0"] + damping * by_zeta
        return np.array(
            [
                [0.0, 1.0, 0.0],
                [1.0 / m, -friction_by_u / m, -friction_by_zeta / m],
                [0.0, by_u, by_zeta],
            ]
        )

    def sliding_slope(self, p: Parameters, speed: float) -> float:
        """Return the rate of `sliding_friction` with the speed [N.s/m]."""
        v_s, delta = p.own["v_s"], p.own["delta"]
        fall = float(p.mu_s - p.mu_k_used) * float(p.N)
        power = _power(speed / v_s, delta)
        falling = delta * _power(speed / v_s, delta - 1.0) / v_s * math.exp(-power)
        return -fall * falling if power < math.inf else 0.0

    def resolution(self, p: Parameters) -> float:
        """Return what rounding of the forces makes of the creep in presliding [m/s]."""
        force = self.sliding_friction(p, 0.0)
        return _NOISE * force / math.sqrt(float(p.m) * (p.own["sigma_0"] + float(p.k)))

    def method(self, p: Parameters) -> str:
        """Return "LSODA", but where bristles give way to next to nothing, at rates without end."""
        return "LSODA" if self._holds(p) else "Radau"

    def speeds(self, p: Parameters) -> tuple[float, ...]:
        """Return v_s [m/s]."""
        return (p.own["v_s"],)

    def steady_state(self, p: Parameters, v: float) -> State:
        """Return zeta in sliding at a velocity [m/s]."""
        return (math.copysign(self.sliding_friction(p, abs(v)) / p.own["sigma_0"], v),)

    def longest_step(self, p: Parameters) -> float:
        """Return a part of the time in which the pull bends the bristles [s]."""
        pull = float(p.k) * abs(float(p.v))
        held = pull > 0.0 and self._holds(p)
        return _PART * self.sliding_friction(p, 0.0) / pull if held else math.inf

    def _holds(self, p: Parameters) -> bool:
        return self.sliding_friction(p, 0.0) > _NONE * float(p.m) * float(p.g)

    def stored(self, p: Parameters, state: Floats) -> Floats:
        """Return the energy in the bristles, ``sigma_0 zeta^2 / 2`` [J]."""
        energy: Floats = 0.5 * p.own["sigma_0"] * np.square(state[0])
        return energy

    def shown(self, p: Parameters, x_dot: Floats, state: Floats) -> dict[str, Floats]:
        """Return zeta [m] and the energy in the bristles [J]."""
        return {"zeta": state[0], "E_bristles": self.stored(p, state)}


def _power(ratio: float, exponent: float) -> float:
    """Return a power, infinity beyond the range."""
    try:
        return float(ratio**exponent)
    except OverflowError:
        return math.inf


LUGRE = LuGre()
