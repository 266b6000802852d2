"""From one stick to the next, for many sticks at once; docs/theory.md (21), (23)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..damped import damped_slip
from ..parameters import Parameters

Floats = NDArray[np.float64]

EPS = float(np.finfo(float).eps)

REST_SLACK = 8.0 * 2.0**-52
"""Rounding slack of the rest test; docs/theory.md (4)."""

MOST_SLIPS = 1000
"""Slips between two sticks. With friction in slip each reversal takes 2 mu_k N of the force."""

_STEPS = 60
"""Most steps of Newton's method, which converges in some six: as many as halving to rounding."""


class Slip(NamedTuple):
    """Slips from rest, in units of v and 1 / w: length, deceleration at the end, peak velocity.

    NaN where the slip does not end.
    """

    length: Any
    deceleration: Any
    peak: Any


class Stops(NamedTuple):
    """What the slips between two sticks come to.

    Attributes
    ----------
    force : array
        Spring force over k at the stop that holds [m]; NaN where none does.
    length : array
        Length of all slips [s].
    peak : array
        Largest velocity along the pull, over v.
    slips : array of int
        Number of slips that ended: one more than of reversals.
    """

    force: Floats
    length: Floats
    peak: Floats
    slips: NDArray[np.intp]


class Sticks:
    """One block with what its sticks hold, pulled at any speed ``v > 0`` [m/s].

    Parameters
    ----------
    p : Parameters
        Numbers only, with the values of dwell in ``own``; ``v`` is of no influence.
    """

    def __init__(self, p: Parameters) -> None:
        self.w, self.zeta, self.k = float(p.w), float(p.zeta), float(p.k)
        normal = float(p.N) / self.k
        self.tau_s, self.t_0 = p.own.get("tau_s", 0.0), p.own.get("t_0", 1.0)
        self.gap, self.B = float(p.mu_s - p.mu_k_used) * normal, p.own.get("B", 0.0) * normal
        self.kinetic = float(p.mu_k_used) * normal
        self.fresh = 0.0 if self.tau_s else self.gap
        self.holds = self.kinetic + self.fresh
        self.nu = math.sqrt(max(0.0, (1.0 - self.zeta) * (1.0 + self.zeta)))

    def excess(self, age: Any) -> Any:
        """Return ``g`` [m] at ages [s]; docs/theory.md (19)."""
        grown = -self.gap * np.expm1(-age / self.tau_s) if self.tau_s else self.gap
        return grown + self.B * np.log1p(age / self.t_0)

    def rate(self, age: Any) -> Any:
        """Return the rate of ``g`` [m/s] at ages [s]."""
        rate = self.gap / self.tau_s * np.exp(-age / self.tau_s) if self.tau_s else 0.0
        return rate + self.B / (self.t_0 + age)

    def along(self, lambda_: Any) -> Slip:
        """Return slips along the pull; docs/theory.md (8), (13)."""
        if self.zeta == 0.0:
            length = 2.0 * (math.pi - np.arctan(lambda_))
            return Slip(length, lambda_, 1.0 + np.hypot(1.0, lambda_))
        shape = np.shape(lambda_)
        values = np.reshape(lambda_, -1)
        with np.errstate(all="ignore"):
            slip = damped_slip(values, np.full(values.shape, self.zeta))
        return Slip(*(part.reshape(shape)[()] for part in slip[1:]))

    def against(self, lambda_: Floats) -> Slip:
        """Return slips against the pull after a reversal, which always end; zeta < 1.

        With s the time since the peak, the velocity relative to the pull is D G(s),
        ``G = exp(-zeta s) (cos(nu s) + zeta / nu sin(nu s))``, and the slip ends at G = 1 / D.
        """
        if self.zeta == 0.0:
            return Slip(2.0 * np.arctan(lambda_), lambda_, np.hypot(1.0, lambda_) - 1.0)
        zeta, nu = self.zeta, self.nu
        top = np.arctan2(lambda_ * nu, 1.0 + zeta * lambda_) / nu
        ratio = np.where(lambda_ < 1.0, lambda_, 1.0 / np.maximum(lambda_, 1.0))
        log_D = 0.5 * np.log1p(ratio * (ratio + 2.0 * zeta)) + np.log(np.maximum(lambda_, 1.0))
        log_D = np.maximum(log_D - zeta * top, 0.0)
        # 1 - G starts as s^2 / 2: its root is the unknown in which the equation is nearly linear.
        target = np.sqrt(-np.expm1(-log_D))
        low, high = np.zeros_like(top), np.full_like(top, math.acos(-zeta) / nu)
        s = np.minimum(math.sqrt(2.0) * target, 0.5 * high)
        for _ in range(_STEPS):
            half, decay_less_1 = np.sin(0.5 * nu * s), np.expm1(-zeta * s)
            fall = (1.0 + decay_less_1) * np.sin(nu * s) / nu
            lost = 2.0 * half * half - zeta * fall - decay_less_1 * np.cos(nu * s)
            root = np.sqrt(np.maximum(lost, 0.0))
            low, high = np.where(root > target, low, s), np.where(root > target, s, high)
            with np.errstate(all="ignore"):
                newton = s - 2.0 * root * (root - target) / fall
            before, s = s, np.where((newton >= low) & (newton <= high), newton, 0.5 * (low + high))
            if np.all(np.abs(s - before) <= 4.0 * EPS * (1.0 + s)):
                break
        fall = np.exp(log_D - zeta * s) * np.sin(nu * s) / nu
        return Slip(top + s, fall, np.expm1(log_D))

    def settle(self, excess: Floats, v: Floats | float) -> Stops:
        """Follow the slips from break-aways at ``excess`` [m] to the next sticks.

        A stop holds what a fresh stick holds, so it may reverse.
        """
        per_lambda = np.broadcast_to(v / self.w, excess.shape)
        length, peak = np.zeros((2, excess.size))
        slips = np.zeros(excess.size, np.intp)
        stops = Stops(np.full_like(excess, np.nan), length, peak, slips)
        at, direction = np.arange(excess.size), 1.0
        for _ in range(MOST_SLIPS):
            lambda_ = excess / per_lambda[at]
            slip = self.along(lambda_) if direction > 0.0 else self.against(lambda_)
            ends = ~np.isnan(slip.length)
            at, slip = at[ends], Slip(*(part[ends] for part in slip))
            stops.length[at] += slip.length / self.w
            stops.peak[at] = np.maximum(stops.peak[at], direction * slip.peak)
            stops.slips[at] += 1
            force = direction * (self.kinetic - per_lambda[at] * slip.deceleration)
            slack = REST_SLACK * (np.abs(force) + self.holds)
            reverses = -direction * force > self.holds + slack
            stops.force[at[~reverses]] = force[~reverses]
            at, direction = at[reverses], -direction
            excess = direction * force[reverses] - self.kinetic
            # Nothing holds, or nothing is lost.
            endless = self.kinetic == 0.0 and (self.fresh == 0.0 or self.zeta == 0.0)
            if not at.size or endless:
                break
        return stops

    def stick(self, force: Any, v: Any, age: float = 0.0) -> Any:
        """Return how long [s] sticks last that begin with this spring force over k [m].

        What the force lacks to break-away is concave in time: Newton's method from beyond its one
        zero falls to it. ``age`` [s] is that at the begin.
        """
        way = self.kinetic + self.excess(age) - force
        least = way / v
        t = least + (self.gap + self.B) / v

        def lacking(t: Any) -> Any:
            return way + (self.excess(age + t) - self.excess(age)) - v * t

        while np.any(short := lacking(t) > 0.0):
            t = np.where(short, 2.0 * t, t)
        for _ in range(_STEPS):
            before = t
            t = np.maximum(least, t - lacking(t) / (self.rate(age + t) - v))
            # It falls until rounding lifts it.
            if not np.any(t < before):
                break
            t = np.minimum(t, before)
        return t

    def ages(self, count: int, v: Floats | float) -> Floats:
        """Return the lengths [s] of ``count`` sticks over all that can occur, at each speed.

        They begin with forces that are equally spaced over all that a fresh stick holds.
        """
        forces = self.holds * (1.0 - (2.0 * np.arange(count) + 1.0) / count)
        return np.asarray(self.stick(forces, np.expand_dims(v, -1)))

    def follow(self, ages: Floats, v: Floats | float) -> tuple[Floats, NDArray[np.intp]]:
        """Return the ages [s] of the next sticks, NaN where there is none, and the slips before."""
        stops = self.settle(self.excess(ages), v)
        return self.stick(stops.force, v), stops.slips

    def next_stick(self, age: float, v: float) -> float:
        """Return the age [s] of the stick after one, NaN where there is none."""
        return float(self.follow(np.array([age]), v)[0][0])
