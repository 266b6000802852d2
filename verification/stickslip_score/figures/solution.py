"""The exact solution of stick-slip between break-aways, docs/theory.md (3) to (8)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from stickslip_score.read import Floats

EPSILON = float(np.finfo(np.float64).eps)
QUANTITIES = ("period", "t_stick", "t_slip", "delta_x")

_SCAN = 400  # points of a half turn on which a damped velocity is searched for its first zero


def root(rest: Callable[[float], float], low: float, high: float) -> float:
    """Return where a function that changes its sign between two places is 0, to the last digit."""
    if rest(low) * rest(high) >= 0.0:
        return low if abs(rest(low)) < abs(rest(high)) else high
    tiny = EPSILON * max(abs(low), abs(high))
    return float(brentq(rest, low, high, xtol=tiny, rtol=4.0 * EPSILON))


def normal_force(p: Mapping[str, float]) -> float:
    """Return the normal force [N] of parameters [SI]; 0 where they lift the mass by rounding."""
    return max(p["m"] * p["g"] + p["load"], 0.0)


@dataclass(frozen=True)
class Solution:
    """Stick-slip of a mass that is pulled forward, with Coulomb friction, between break-aways."""

    w: float  # natural frequency [rad/s], > 0
    zeta: float  # damping ratio [-]
    v: float  # speed of the pulled end [m/s], > 0
    D: float  # spring extension at break-away beyond that of steady sliding [m]: Delta - c v/k
    continued: bool = False  # whether other cycles went before time 0; else rest did

    @cached_property
    def t_slip(self) -> float:
        """Length of a slip [s]; infinity where it ends in steady sliding."""
        if self.zeta == 0.0:
            return 2.0 / self.w * (math.pi - math.atan2(self.w * max(self.D, 0.0), self.v))
        if self.zeta >= 1.0 or self.D <= 0.0:
            return math.inf
        # A damped slip that does not stop in its first turn never does; it starts with speed 0.
        tau = np.linspace(0.0, 2.0 * math.pi / self._turn, 2 * _SCAN + 1)
        stopped = np.flatnonzero(self._speed(tau[1:]) <= 0.0)
        if not stopped.size:
            return math.inf
        low, high = tau[stopped[0] : stopped[0] + 2].tolist()
        return root(lambda at: float(self._speed(np.asarray(at))), low or 0.5 * high, high)

    @cached_property
    def relief(self) -> float:
        """Fall of the spring over a slip [m]; NaN where a slip has no end."""
        if self.zeta == 0.0:
            return 2.0 * max(self.D, 0.0)
        t_slip = self.t_slip
        return math.nan if math.isinf(t_slip) else self._way(t_slip) - self.v * t_slip

    def figures(self) -> dict[str, float]:
        """Return period, t_stick, t_slip [s] and delta_x [m] of the cycle; NaN where none is."""
        t_slip = self.t_slip
        if math.isinf(t_slip):
            return dict.fromkeys(QUANTITIES, math.nan)
        t_stick = self.relief / self.v
        period = t_stick + t_slip
        return {"period": period, "t_stick": t_stick, "t_slip": t_slip, "delta_x": self.v * period}

    def position(self, after: Floats) -> Floats:
        """Return the position [m] at times after a break-away at 0, from where it was then."""
        t_slip = self.t_slip
        if math.isinf(t_slip):
            return self._slip(np.maximum(after, 0.0))
        late = after if self.continued else np.maximum(after, 0.0)
        period = self.relief / self.v + t_slip
        count = np.floor(late / period)
        within = late - count * period
        jump = self.v * t_slip + self.relief
        way = count * (self.v * period) + jump
        slips = within < t_slip
        way[slips] += self._slip(within[slips]) - jump
        return np.asarray(way)

    def without_gap(self) -> Solution:
        """Return the solution for one friction coefficient: D is minus the drag of the damping."""
        return replace(self, D=-2.0 * self.zeta * self.v / self.w)

    def swing(self) -> float:
        """Return half the swing of the spring about its rest in sliding [m]."""
        return math.hypot(self.D, self.v / self.w)

    def seen_gap(self, swing: float) -> float:
        """Return the gap [m] that a swing of the spring from turn to turn shows."""
        return math.sqrt(max((0.5 * swing) ** 2 - (self.v / self.w) ** 2, 0.0))

    def time_to_move(self, way: float) -> float:
        """Return how long a slip from rest takes to move so far [s]; `way` [m] is positive."""
        high = 1.0 / self.w
        while self._way(high) < way:
            high *= 2.0
        return root(lambda tau: self._way(tau) - way, 0.0, high)

    def response(self, tau: Floats) -> tuple[Floats, Floats]:
        """Return the free oscillation from extension 1 at rate 0, and from 0 at rate 1 [-, s]."""
        unit = replace(self, D=1.0, v=0.0)._extension(tau)
        return unit, replace(self, D=0.0, v=1.0)._extension(tau)

    @property
    def _turn(self) -> float:
        """Frequency of the free oscillation [rad/s]; zeta is below 1."""
        return self.w * math.sqrt((1.0 - self.zeta) * (1.0 + self.zeta))

    def _way(self, tau: float) -> float:
        return float(self._slip(np.asarray(tau)))

    def _slip(self, tau: Floats) -> Floats:
        """Return the way of the mass [m] at times tau of one slip."""
        return self.v * tau + self.D - self._extension(tau)

    def _speed(self, tau: Floats) -> Floats:
        """Return the velocity of the mass [m/s] at times tau of one slip."""
        of_extension, of_rate = self.response(tau)
        pull = self.w * self.D + 2.0 * self.zeta * self.v
        return self.v * (1.0 - of_extension) + self.w * pull * of_rate

    def _extension(self, tau: Floats) -> Floats:
        """Return the extension beyond steady sliding [m], docs/theory.md (3)."""
        if self.zeta >= 1.0:
            # So written that close or distant rates cancel nowhere.
            wide = self.zeta + math.sqrt((self.zeta - 1.0) * (self.zeta + 1.0))
            decay, apart = self.w / wide, self.w * (wide - 1.0 / wide)
            even, rate = np.ones_like(tau), apart or 1.0
            wave = -np.expm1(-apart * tau) if apart else tau
        else:
            decay, rate = self.zeta * self.w, self._turn
            even, wave = np.cos(rate * tau), np.sin(rate * tau)
        z = self.D * even + (self.v + decay * self.D) / rate * wave
        return np.asarray(np.exp(-decay * tau) * z)
