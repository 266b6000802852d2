"""The model solved for the tests, from its equations: closed forms and matrix exponentials.

No code of the product; 60 digits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import mpmath

MP = mpmath.mp.clone()
MP.dps = 60

Real = Any
START = {
    "m": 1.0,
    "g": 9.81,
    "k": 1000.0,
    "c": 0.0,
    "mu_s": 0.5,
    "mu_k": 0.3,
    "v": 0.02,
    "load": 0.0,
    "F_ext": 0.0,
    "x_start": 0.0,
    "x_dot_start": 0.0,
    "z_start": 0.0,
    "tau_s": 0.0,
    "B": 0.0,
    "t_0": 1.0,
    "age_start": 0.0,
}
"""Start values, SI: those of the design and of friction that grows at rest."""


class Exact:
    """A setting as exact numbers, with what follows from it: forces [N], w [rad/s], zeta, lambda.

    Other values are those of START.
    """

    def __init__(self, values: Mapping[str, float]) -> None:
        self.values = {**START, **values}
        for name, value in self.values.items():
            setattr(self, name, MP.mpf(value))
        self.N = self.m * self.g + self.load
        self.F_s, self.F_k = self.mu_s * self.N, self.mu_k * self.N
        self.w = MP.sqrt(self.k / self.m)
        self.zeta = self.c / (2 * self.m * self.w)
        self.Delta = (self.mu_s - self.mu_k) * self.N / self.k
        self.lambda_ = self.w * self.Delta / abs(self.v) if self.v else MP.inf

    def __getattr__(self, name: str) -> Real:
        raise AttributeError(name)

    def but(self, **changes: float) -> Exact:
        return Exact({**self.values, **changes})

    def growth(self, age: Real) -> Real:
        """Return what a stick of this age holds beyond kinetic friction [N]."""
        share = -MP.expm1(-age / self.tau_s) if self.tau_s else 1
        gap = (self.mu_s - self.mu_k) * share
        return self.N * (gap + self.B * MP.log1p(age / self.t_0))

    def growing(self, age: Real) -> Real:
        rate = MP.exp(-age / self.tau_s) / self.tau_s if self.tau_s else 0
        return self.N * ((self.mu_s - self.mu_k) * rate + self.B / (self.t_0 + age))

    def stick(self, begin: Real, age: Real = 0) -> Real:
        """Return how long a stick lasts from a force `begin` along the pull [N] and an age [s].

        The last root of a concave function, by Newton from beyond it.
        """
        pull = self.k * abs(self.v)
        t = (self.N * (1 + self.mu_s + 99 * self.B) + abs(begin)) / pull * 9 + 10
        while True:
            lack = self.F_k + self.growth(age + t) - begin - pull * t
            less = t - lack / (self.growing(age + t) - pull)
            if less < MP.mpf(10) ** -30:
                return MP.zero
            if not less < t * (1 - MP.mpf(10) ** -45):
                return t
            t = less


def critical_lambda(zeta: Real) -> Real:
    """Return lambda_c, docs/theory.md (13), by halving in the logarithm."""
    nu = MP.sqrt(1 - zeta * zeta)

    def grazing(log: Real) -> Real:
        L = MP.exp(log)
        turn = 2 * MP.pi - MP.atan2(L * nu, 1 - zeta * L)
        return MP.log(1 - 2 * zeta * L + L * L) - 2 * zeta / nu * turn

    low, high = MP.log(4 * MP.pi * zeta) / 2 - 1, MP.mpf(30) / (1 - zeta)
    return MP.exp(root(grazing, low, high))


def root(rising: Callable[[Real], Real], low: Real, high: Real) -> Real:
    """Return where a function rises through 0: some halvings, then secants that keep the root."""
    for _ in range(6):
        middle = (low + high) / 2
        low, high = (middle, high) if rising(middle) < 0 else (low, middle)
    ends = (low, high)
    return MP.findroot(
        lambda t: rising(t), ends, solver="anderson", tol=1e-120, maxsteps=300, verify=False
    )


def cycle(p: Exact) -> dict[str, Real]:
    """Return the steady cycle: theory (7) to (11), damped from the first root of the velocity."""
    nu, L, zeta, w = MP.sqrt(1 - p.zeta**2), p.lambda_, p.zeta, p.w

    def x_dot(tau: Real) -> Real:
        wave = (L - zeta) / nu * MP.sin(nu * tau) - MP.cos(nu * tau)
        return 1 + MP.exp(-zeta * tau) * wave

    angle = MP.atan2(L * nu, 1 - zeta * L)
    top = (MP.pi - angle) / nu
    tau = 2 * (MP.pi - MP.atan(L))
    if p.c:
        bottom = (2 * MP.pi - angle) / nu
        tau = root(lambda tau: -x_dot(tau), top, bottom)
    relief = (L - MP.diff(x_dot, tau)) / w if p.c else 2 * L / w
    T, sign = relief + tau / w, MP.sign(p.v)
    return {
        "spring_drop": relief * p.v,
        "delta_x": p.v * T,
        "t_slip": tau / w,
        "t_stick": relief,
        "T": T,
        "f": 1 / T,
        "x_dot_peak": sign * abs(p.v) * x_dot(top),
    }


class Slip(NamedTuple):
    """A slip up to a time or to its end: SI, signed."""

    t: Real
    x: Real
    x_dot: Real
    z: Real
    W_pull: Real
    peak: Real

    def heat(self, p: Exact, z: Real, x_dot: Real = 0) -> Real:
        stored = p.k * (self.z**2 - z**2) + p.m * (self.x_dot**2 - MP.mpf(x_dot) ** 2)
        return self.W_pull + p.F_ext * self.x - stored / 2


def slip(
    p: Exact,
    z: Real,
    x_dot: Real = 0,
    direction: int = 1,
    until: Real = MP.inf,
    curve: Sequence[tuple[float, float]] = (),
) -> Slip:
    """Return the slip from a state to its end, or until a time [s].

    The friction is mu_k N, or that of a curve through points of speed [m/s] and coefficient. It is
    straight between them, so the motion has a Taylor series up to each corner, cut below 1e-60.
    """
    points = [(MP.mpf(u), MP.mpf(mu)) for u, mu in curve] or [(MP.zero, p.mu_k)]
    t, x, W_pull, z, u = MP.zero, MP.zero, MP.zero, MP.mpf(z), MP.mpf(x_dot)
    peak, piece = u, max(n for n, (at, _) in enumerate(points) if at <= abs(u))
    while True:
        low, mu = points[piece]
        high, slope = MP.inf, MP.zero
        if piece + 1 < len(points):
            high = points[piece + 1][0]
            slope = (points[piece + 1][1] - mu) / (high - low)
        b = p.c + slope * p.N
        constant = p.F_ext - direction * (mu - slope * low) * p.N
        speeds, springs = [u], [z]
        for n in range(_ORDER):
            force = p.k * springs[n] - b * speeds[n] + (0 if n else constant)
            speeds.append(force / p.m / (n + 1))
            springs.append(((0 if n else p.v) - speeds[n]) / (n + 1))
        h = end = min(until - t, 1 / (2 * max(p.w, abs(b) / p.m)))
        slower = _slope(speeds)
        marks = [h]
        if slower[0] * _at(slower, h) < 0:
            sign = MP.sign(slower[0])
            marks = [root(lambda t, s=slower, sign=sign: -sign * _at(s, t), MP.zero, h), h]  # type: ignore[misc]
        left, before = 0, MP.zero
        for mark in marks:
            speed = direction * _at(speeds, mark)
            left = -1 if speed < low else int(speed > high)
            if left:
                bound = low if left < 0 else high
                end = root(
                    lambda t, s=speeds, way=left, to=bound: way * (direction * _at(s, t) - to),  # type: ignore[misc]
                    before or h * MP.mpf(10) ** -20,
                    mark,
                )
                break
            peak = max(peak, _at(speeds, mark), key=abs)
            before = mark
        x += _at(_integral(speeds), end)
        W_pull += p.k * p.v * _at(_integral(springs), end)
        t, z, u = t + end, _at(springs, end), _at(speeds, end)
        if left:
            u = direction * bound
            piece += left
        if t >= until or piece < 0:
            return Slip(t, x, u, z, W_pull, peak)


_ORDER = 40


def _at(series: Sequence[Real], t: Real) -> Real:
    value = MP.zero
    for a in reversed(series):
        value = value * t + a
    return value


def _slope(series: Sequence[Real]) -> list[Real]:
    return [n * a for n, a in enumerate(series)][1:]


def _integral(series: Sequence[Real]) -> list[Real]:
    return [MP.zero, *(a / (n + 1) for n, a in enumerate(series))]
