"""Slips of the tests in high precision, by power series with 40 digits: no code of the product.

The equation is ``m u' = P - f(u) - c u``, ``P' = k (V - u)``, with the speed u along the slip and
the force P of spring and external force along it. A friction gives the series of f from that of u.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from stickslip_verification.truth.parameters import high_precision

MP = high_precision(40)
ORDER = 32

Real = Any
Series = list[Real]
Grow = Callable[[Series], Real]
"""Given a series of the speed that has one coefficient more, returns the next one of a force."""
Friction = Callable[[], Grow]


class Slip(NamedTuple):
    """A slip from its start to its end: duration, way, relief of the spring, peak, heat."""

    duration: Real
    way: Real
    relief: Real
    peak: Real
    heat: Real
    force: Real


def convolution(one: Series, other: Series, n: int, start: int = 0) -> Real:
    """Return the coefficient n of a product, without the terms before `start`."""
    return MP.fsum(one[i] * other[n - i] for i in range(start, n + 1))


def product(one: Series, other: Series) -> Series:
    """Return the product of two series."""
    return [convolution(one, other, n) for n in range(min(len(one), len(other)))]


def _numbers(p: Mapping[str, float]) -> tuple[Real, Real, Real]:
    normal = MP.mpf(p["m"]) * MP.mpf(p["g"]) + MP.mpf(p.get("load", 0.0))
    mu_s, mu_k, v_s = (MP.mpf(p[name]) for name in ("mu_s", "mu_k", "v_s"))
    return normal * mu_k, normal * (mu_s - mu_k), v_s


def stribeck(p: Mapping[str, float]) -> Friction:
    """Return N (mu_k + (mu_s - mu_k) exp(-(u/v_s)^delta))."""
    rest, drop, v_s = _numbers(p)
    delta = MP.mpf(p["delta"])
    whole = int(delta) if delta == int(delta) else 0

    def begin() -> Grow:
        powers: list[Series] = [[] for _ in range(max(whole, 1))]
        q = powers[0]
        raised: Series = powers[-1] if whole else []
        steps: Series = []
        fall: Series = []

        def grow(u: Series) -> Real:
            n = len(u) - 1
            q.append(u[n] / v_s)
            if whole:
                for i in range(1, whole):
                    powers[i].append(convolution(powers[i - 1], q, n))
            elif n == 0:
                raised.append(q[0] ** delta)
            else:
                terms = ((delta * i - (n - i)) * q[i] * raised[n - i] for i in range(1, n + 1))
                raised.append(MP.fsum(terms) / (n * q[0]))
            steps.append(n * raised[n])
            fall.append(-convolution(steps, fall, n, 1) / n if n else MP.exp(-raised[0]))
            return drop * fall[n] + (rest if n == 0 else 0)

        return grow

    return begin


def hyperbolic(p: Mapping[str, float]) -> Friction:
    """Return N (mu_k + (mu_s - mu_k)/(1 + u/v_s))."""
    rest, drop, v_s = _numbers(p)

    def begin() -> Grow:
        base: Series = []
        fall: Series = []

        def grow(u: Series) -> Real:
            n = len(u) - 1
            base.append(u[n] / v_s + (1 if n == 0 else 0))
            fall.append(-convolution(base, fall, n, 1) / base[0] if n else 1 / base[0])
            return drop * fall[n] + (rest if n == 0 else 0)

        return grow

    return begin


def line(at: Real, force: Real, slope: Real) -> Friction:
    """Return the friction `force` at the speed `at`, straight with this slope."""

    def begin() -> Grow:
        def grow(u: Series) -> Real:
            return slope * u[-1] + (force - slope * at if len(u) == 1 else 0)

        return grow

    return begin


class Motion:
    """The motion along a slip, taken step by step."""

    def __init__(self, p: Mapping[str, float], speed: Real, force: Real, direction: int) -> None:
        self.k, self.m, self.c = (MP.mpf(p[name]) for name in ("k", "m", "c"))
        self.pull = direction * MP.mpf(p["v"])
        self.speed, self.force = MP.mpf(speed), MP.mpf(force)
        self.time = self.way = self.heat = MP.mpf(0)
        self.peak = self.speed
        self.k_z = self.force

    def series(self, friction: Friction) -> tuple[Series, Series, Series]:
        """Return the series of speed, force and friction with its viscous part."""
        u, force, resisting = [self.speed], [self.force], []
        grow = friction()
        for n in range(ORDER):
            resisting.append(grow(u) + self.c * u[n])
            u.append((force[n] - resisting[n]) / (self.m * (n + 1)))
            force.append(self.k * ((self.pull if n == 0 else 0) - u[n]) / (n + 1))
        resisting.append(grow(u) + self.c * u[ORDER])
        return u, force, resisting

    def step(self, friction: Friction, longest: Real, low: Real, high: Real | None) -> str | None:
        """Go on by a piece that the series resolve, or to where the speed is `low` or `high`."""
        u, force, resisting = self.series(friction)
        h = longest
        for series in (u, force, resisting) * 4:
            scale = max(abs(each) * h**n for n, each in enumerate(series[:3]))
            for n in (ORDER - 1, ORDER):
                if series[n] != 0:
                    h = min(h, (MP.mpf(10) ** -30 * scale / abs(series[n])) ** (MP.mpf(1) / n))
        left = None
        while True:
            left, end = None, h
            for name, bound, sign in (("low", low, 1), ("high", high, -1)):
                if bound is None:
                    continue
                gap = [sign * each for each in u]
                gap[0] -= sign * bound
                crossing = first_crossing(gap, end)
                if crossing is not None and crossing < end:
                    end, left = crossing, name
            if self.agrees(friction, u, force, end, left is not None):
                h = end
                break
            h = MP.mpf(0.7) * end
        turn = first_crossing(u_slope(u), h)
        if turn is not None:
            self.peak = max(self.peak, value(u, turn))
        power_series = product(resisting, u)
        self.heat += value(integral(power_series), h)
        self.way += value(integral(u), h)
        self.time += h
        self.speed, self.force = value(u, h), value(force, h)
        self.peak = max(self.peak, self.speed)
        if left is not None:
            bound = low if left == "low" else high
            assert bound is not None
            self.speed = MP.mpf(bound)
        return left

    def agrees(self, friction: Friction, u: Series, force: Series, h: Real, left: bool) -> bool:
        """Whether the speed's slope is what the friction makes it, where h leads."""
        speed = max(value(u, h), MP.mpf(0)) if left else value(u, h)
        slope = (value(force, h) - friction()([speed]) - self.c * speed) / self.m
        scale = abs(slope) + abs(u[1]) + abs(u[2]) * h
        return bool(abs(slope - value(u_slope(u), h)) < MP.mpf(10) ** -19 * scale)

    def result(self) -> Slip:
        """Return the slip so far."""
        relief = (self.k_z - self.force) / self.k
        return Slip(self.time, self.way, relief, self.peak, self.heat, self.force)


def value(series: Series, t: Real) -> Real:
    """Return the value of a series."""
    total = MP.mpf(0)
    for each in reversed(series):
        total = total * t + each
    return total


def u_slope(series: Series) -> Series:
    """Return the derivative of a series."""
    return [n * each for n, each in enumerate(series)][1:]


def integral(series: Series) -> Series:
    """Return the integral of a series."""
    return [MP.mpf(0), *(each / (n + 1) for n, each in enumerate(series))]


def first_crossing(series: Series, h: Real) -> Real | None:
    """Return the first time up to h at which a series falls below 0, by a grid and its extremes."""
    grid = [h * n / 24 for n in range(25)]
    values = [value(series, t) for t in grid]
    slope = u_slope(series)
    for n in range(24):
        low, high = grid[n], grid[n + 1]
        if values[n + 1] >= 0:
            if value(slope, low) < 0 < value(slope, high):
                high = bisect(lambda t: -value(slope, t), low, high)
            if value(series, high) >= 0:
                continue
        if values[n] <= 0 and value(slope, low) > 0:
            low = bisect(lambda t: value(slope, t), low, high)
        if values[n] < 0 or value(series, low) < 0:
            return low
        return bisect(lambda t: value(series, t), low, high)
    return None


def bisect(falling: Callable[[Real], Real], low: Real, high: Real) -> Real:
    """Return where a function falls below 0, by halving and then secants."""
    for _ in range(40):
        middle = (low + high) / 2
        if falling(middle) >= 0:
            low = middle
        else:
            high = middle
    for _ in range(6):
        one, other = falling(low), falling(high)
        if one == other:
            break
        low, high = high, low + (high - low) * one / (one - other)
    return high


def smooth_slip(p: Mapping[str, float], friction: Friction, longest: float) -> Slip:
    """Return the slip forward from break-away to its end.

    Where the exponent of Stribeck's shape is not whole, the first 1e-6/w are taken without damping
    from ``V (1 - cos w t)`` and the first order of the friction that has fallen until then.
    """
    normal = MP.mpf(p["m"]) * MP.mpf(p["g"]) + MP.mpf(p.get("load", 0.0))
    start = MP.mpf(p["mu_s"]) * normal
    motion = Motion(p, 0, start, 1)
    if p["shape"] == 1 and p["delta"] != int(p["delta"]):
        w, pull = MP.sqrt(motion.k / motion.m), motion.pull
        t = MP.mpf(10) ** -6 / w
        _, drop, v_s = _numbers(p)
        delta = MP.mpf(p["delta"])
        grown = drop / motion.m * (w**2 * pull / 2 / v_s) ** delta / (2 * delta + 1)
        motion.time = t
        motion.speed = pull * (1 - MP.cos(w * t)) + grown * t ** (2 * delta + 1)
        motion.way = pull * (t - MP.sin(w * t) / w) + grown * t ** (2 * delta + 2) / (2 * delta + 2)
        motion.force = start + motion.k * (pull * t - motion.way)
        motion.heat = start * motion.way
    while motion.step(friction, MP.mpf(longest), MP.mpf(0), None) is None:
        pass
    return motion.result()


def curve_slip(p: Mapping[str, float], points: list[tuple[float, float]], longest: float) -> Slip:
    """Return the slip forward from break-away over a curve of points."""
    normal = MP.mpf(p["m"]) * MP.mpf(p["g"])
    knots = [MP.mpf(speed) for speed, _ in points]
    forces = [MP.mpf(mu) * normal for _, mu in points]
    motion = Motion(p, 0, MP.mpf(p["mu_s"]) * normal, 1)
    position = 0
    while True:
        last = position == len(points) - 1
        slope = (
            0
            if last
            else (forces[position + 1] - forces[position]) / (knots[position + 1] - knots[position])
        )
        friction = line(knots[position], forces[position], slope)
        left = motion.step(
            friction, MP.mpf(longest), knots[position], None if last else knots[position + 1]
        )
        if left == "high":
            position += 1
        elif left == "low":
            if position == 0:
                return motion.result()
            position -= 1
