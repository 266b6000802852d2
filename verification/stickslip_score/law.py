"""The law of the block with a gap of its own: what a curve is held against.

Between two break-aways the motion is a closed form of five numbers: w and zeta of the free
oscillation, v, and the distance D of the spring at break-away from its rest in sliding. A curve
that lies on it for some D has its cycle, to the digits that the samples carry, however far apart
they are. docs/theory.md (3) to (8), (13).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from stickslip_score.read import Floats

EPSILON = float(np.finfo(np.float64).eps)

_SCAN = 400
"""Points of a half turn on which a damped velocity is searched for its first zero."""


@dataclass(frozen=True)
class Law:
    """Stick-slip with Coulomb friction, pulled forward.

    Attributes
    ----------
    w
        Natural frequency [rad/s], > 0.
    zeta
        Damping ratio [-], >= 0.
    v
        Speed of the pulled end [m/s], > 0.
    D
        Spring extension at break-away beyond that of steady sliding [m]; without damping Delta.
    continued
        Whether other cycles went before the break-away from which time counts; else rest did.
    """

    w: float
    zeta: float
    v: float
    D: float
    continued: bool = False

    @cached_property
    def t_slip(self) -> float:
        """Length of a slip [s]; infinity where it ends in steady sliding."""
        if self.zeta == 0.0:
            return 2.0 / self.w * (math.pi - math.atan2(self.w * max(self.D, 0.0), self.v))
        return self._damped_t_slip()

    @cached_property
    def relief(self) -> float:
        """Fall of the spring over a slip [m]; NaN where a slip has no end."""
        if self.zeta == 0.0:
            return 2.0 * max(self.D, 0.0)
        t_slip = self.t_slip
        if math.isinf(t_slip):
            return math.nan
        return float(self._slip(np.array([t_slip]))[0]) - self.v * t_slip

    def quantities(self) -> dict[str, float]:
        """Return period, t_stick, t_slip [s] and delta_x [m] of the cycle; NaN where none is."""
        t_slip = self.t_slip
        if math.isinf(t_slip):
            return dict.fromkeys(("period", "t_stick", "t_slip", "delta_x"), math.nan)
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
        way = count * (self.v * period) + (self.v * t_slip + self.relief)
        slips = within < t_slip
        way[slips] += self._slip(within[slips]) - (self.v * t_slip + self.relief)
        return np.asarray(way)

    def with_gap(self, D: float) -> Law:
        """Return the law with another gap."""
        return replace(self, D=D)

    def time_to_move(self, way: float) -> float:
        """Return how long a slip from rest takes to move so far [s]; `way` [m] is positive."""
        high = 1.0 / self.w
        while float(self._slip(np.array([high]))[0]) < way:
            high *= 2.0
        return root(lambda tau: float(self._slip(np.array([tau]))[0]) - way, 0.0, high)

    def response(self, tau: Floats) -> tuple[Floats, Floats]:
        """Return the free oscillation from extension 1 at rate 0, and from 0 at rate 1 [-, s]."""
        unit = replace(self, D=1.0, v=0.0)._extension(tau)
        return unit, replace(self, D=0.0, v=1.0)._extension(tau)

    def _slip(self, tau: Floats) -> Floats:
        """Return the way of the mass [m] at times tau of one slip."""
        return self.v * tau + self.D - self._extension(tau)

    def _extension(self, tau: Floats) -> Floats:
        """Return the extension beyond steady sliding [m], docs/theory.md (3)."""
        if self.zeta >= 1.0:
            return self._overdamped(tau)
        decay, turn = self._rates()
        across = (self.v + decay * self.D) / turn
        z = self.D * np.cos(turn * tau) + across * np.sin(turn * tau)
        return np.asarray(np.exp(-decay * tau) * z if decay else z)

    def _speed(self, tau: Floats) -> Floats:
        """Return the velocity of the mass [m/s] at times tau of one slip; zeta is below 1."""
        decay, turn = self._rates()
        across = self.v + decay * self.D
        swing = across * np.cos(turn * tau) - self.D * turn * np.sin(turn * tau)
        return np.asarray(self.v - np.exp(-decay * tau) * swing + decay * self._extension(tau))

    def _rates(self) -> tuple[float, float]:
        """Return decay and frequency of the free oscillation [1/s, rad/s]."""
        return self.zeta * self.w, self.w * math.sqrt((1.0 - self.zeta) * (1.0 + self.zeta))

    def _overdamped(self, tau: Floats) -> Floats:
        """Return the same for zeta >= 1, written so that close or distant rates cancel nowhere."""
        wide = self.zeta + math.sqrt((self.zeta - 1.0) * (self.zeta + 1.0))
        slow, apart = self.w / wide, self.w * (wide - 1.0 / wide)
        across = self.v + slow * self.D
        since = -np.expm1(-apart * tau) / apart if apart else tau
        return np.asarray(np.exp(-slow * tau) * (self.D + across * since))

    def _damped_t_slip(self) -> float:
        if self.zeta >= 1.0:
            return math.inf
        _, turn = self._rates()
        # A damped slip that does not stop in its first turn never does; it starts with speed 0.
        tau = np.linspace(0.0, 2.0 * math.pi / turn, 2 * _SCAN + 1)[1:]
        stopped = np.flatnonzero(self._speed(tau) <= 0.0)
        if not stopped.size or self.D <= 0.0:
            return math.inf
        high = float(tau[stopped[0]])
        low = float(tau[stopped[0] - 1]) if stopped[0] else 0.5 * high
        return root(lambda at: float(self._speed(np.array([at]))[0]), low, high)


def root(rest: Callable[[float], float], low: float, high: float) -> float:
    """Return where a function that changes its sign between two places is 0, to the last digit."""
    if rest(low) * rest(high) >= 0.0:
        return low if abs(rest(low)) < abs(rest(high)) else high
    tiny = EPSILON * max(abs(low), abs(high))
    return float(brentq(rest, low, high, xtol=tiny, rtol=4.0 * EPSILON))
