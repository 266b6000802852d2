"""The steady cycle where static friction grows with the time at rest; docs/theory.md (19) to (23).

Lengths are forces over k. ``g(t)`` is what a stick of the age t holds beyond kinetic friction. The
slip after it starts with ``lambda = w g / v`` and is that of (13), so the cycles of one block are a
curve in lambda: its stick lasts ``t(lambda)``, and ``v(lambda) = w g(t) / lambda``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from .critical import critical_lambda
from .damped import damped_slip
from .laws.coulomb import dwells, grown, growth_rate
from .parameters import Parameters
from .ranges import Interval

EPS = float(np.finfo(float).eps)

REST_SLACK = 8.0 * 2.0**-52
"""Rounding slack of the rest test; docs/theory.md (4)."""

LEAST_STICK = 1e-12
"""A stick shorter than this [1 / w] counts as none."""

MOST_SLIPS = 1000
"""Slips between two sticks. With friction in slip each reversal takes 2 mu_k N of the force."""

MOST_CYCLES = 200
"""Cycles after which a sequence of sticks that has not settled counts as irregular."""

STEP = 0.01
"""Speeds at which a motion with several reversals is tried, as a part of each."""

LEAST_RANGE = 1e-6
"""A range of speeds narrower than this part of them is one of rounding: the slack of the rest test
lets a slip that grazes hold up to its root, 4e-8, beside the limit."""


class Slip(NamedTuple):
    """A slip from rest, in units of v and 1 / w: length, deceleration at its end, peak velocity."""

    length: float
    deceleration: float
    peak: float


class Settled(NamedTuple):
    """The slips between two sticks: force over k at their end [m], length [s], peak over v."""

    force: float
    length: float
    peak: float


class Block:
    """One block pulled at ``v > 0``, with what its sticks hold.

    Parameters
    ----------
    p : Parameters
        Numbers only, with the values of dwell in ``own``; ``|v|`` counts.
    v : float
        Pulling speed in place of that of ``p`` [m/s].
    """

    def __init__(self, p: Parameters, v: float) -> None:
        self.p, self.v = p, v
        self.w, self.zeta = float(p.w), float(p.zeta)
        self.k = float(p.k)
        self.kinetic = float(p.mu_k_used * p.N) / self.k
        self.fresh = self.excess(0.0)

    def excess(self, age: float) -> float:
        """Return ``g`` [m] at an age [s]."""
        return grown(self.p, age) / self.k

    def rate(self, age: float) -> float:
        """Return the rate of ``g`` [m/s] at an age [s]."""
        return growth_rate(self.p, age) / self.k

    def along(self, lambda_: float) -> Slip | None:
        """Return the slip along the pull, None where it does not end; docs/theory.md (8), (13)."""
        if self.zeta == 0.0:
            peak = 1.0 + math.hypot(1.0, lambda_)
            return Slip(2.0 * (math.pi - math.atan(lambda_)), lambda_, peak)
        with np.errstate(all="ignore"):
            slip = damped_slip(np.array([lambda_]), np.array([self.zeta]))
        if not slip.ends[0]:
            return None
        return Slip(float(slip.length[0]), float(slip.deceleration[0]), float(slip.peak[0]))

    def against(self, lambda_: float) -> Slip:
        """Return the slip against the pull after a reversal, which always ends; zeta < 1."""
        zeta = self.zeta
        nu = math.sqrt((1.0 - zeta) * (1.0 + zeta))

        def motion(tau: float) -> tuple[float, float]:
            decay, sine, cosine = math.exp(-zeta * tau), math.sin(nu * tau), math.cos(nu * tau)
            relative = decay * (cosine + (lambda_ + zeta) / nu * sine)
            return relative - 1.0, decay * (lambda_ * cosine - (1.0 + zeta * lambda_) / nu * sine)

        top = math.atan2(lambda_ * nu, 1.0 + zeta * lambda_) / nu
        length = brentq(lambda tau: motion(tau)[0], top, top + math.pi / nu, xtol=1e-300)
        return Slip(length, -motion(length)[1], motion(top)[0])

    def settle(self, excess: float) -> Settled | None:
        """Follow the slips from a break-away at ``excess`` [m] to the next stick.

        A stop holds what a fresh stick holds, so it may reverse. None if the last slip does not
        end, or no stop sticks.
        """
        per_lambda = self.v / self.w
        length, peak, direction = 0.0, 0.0, 1
        for _ in range(MOST_SLIPS):
            lambda_ = excess / per_lambda
            slip = self.along(lambda_) if direction > 0 else self.against(lambda_)
            if slip is None:
                return None
            length += slip.length / self.w
            peak = max(peak, direction * slip.peak)
            force = direction * (self.kinetic - per_lambda * slip.deceleration)
            held = self.kinetic + self.fresh
            if not -direction * force > held + REST_SLACK * (abs(force) + held):
                return Settled(force, length, peak)
            direction = -direction
            excess = direction * force - self.kinetic
        return None

    def stick(self, force: float) -> float:
        """Return how long [s] the stick lasts that begins with this force over k [m]."""
        way = self.kinetic + self.fresh - force

        def lacking(t: float) -> float:
            return way + (self.excess(t) - self.fresh) - self.v * t

        low = way / self.v
        if lacking(low) <= 0.0:
            return low
        high = 2.0 * low
        while lacking(high) > 0.0:
            high *= 2.0
        return float(brentq(lacking, low, high, xtol=1e-300, rtol=4.0 * EPS))

    def next_stick(self, t: float) -> float | None:
        """Return the length [s] of the stick after one of ``t`` [s]; None if there is none."""
        settled = self.settle(self.excess(t))
        return None if settled is None else self.stick(settled.force)


class Family:
    """The cycles of one block without reversals, at all pulling speeds; docs/theory.md (21)."""

    def __init__(self, p: Parameters) -> None:
        self.block = Block(p, 1.0)
        self.w, self.zeta = self.block.w, self.block.zeta
        self.least = float(critical_lambda(self.zeta))

    def slip(self, lambda_: float) -> Slip:
        """Return the slip of a cycle; at the least lambda rounding may leave none, that grazes."""
        slip = self.block.along(lambda_)
        return Slip(math.nan, 0.0, math.nan) if slip is None else slip

    def t_stick(self, lambda_: float) -> float:
        """Return the length of the stick [s]; docs/theory.md (21)."""
        return (lambda_ + self.slip(lambda_).deceleration) / self.w

    def speed(self, lambda_: float) -> float:
        """Return the pulling speed [m/s] of the cycle; docs/theory.md (21)."""
        return self.w * self.block.excess(self.t_stick(lambda_)) / lambda_

    def slope(self, lambda_: float) -> float:
        """Return d ln v / d ln lambda; docs/theory.md (22)."""
        slip = self.slip(lambda_)
        t = (lambda_ + slip.deceleration) / self.w
        rate = self.block.rate(t) / self.block.excess(t)
        if rate == 0.0:
            return -1.0
        if slip.deceleration == 0.0:
            return math.inf
        if self.zeta == 0.0:
            stretch = 1.0
        else:
            nu = math.sqrt((1.0 - self.zeta) * (1.0 + self.zeta))
            decay = math.exp(-self.zeta * slip.length)
            sine, cosine = math.sin(nu * slip.length), math.cos(nu * slip.length)
            impulse, its_rate = decay * sine / nu, decay * (cosine - self.zeta / nu * sine)
            stretch = -its_rate - (1.0 / slip.deceleration + 2.0 * self.zeta) * impulse
        return lambda_ * (1.0 + stretch) * rate / self.w - 1.0

    def fastest(self) -> tuple[float, float, str]:
        """Return lambda, speed [m/s] and kind of the end of the family; docs/theory.md (22)."""
        if self.zeta == 0.0:
            if self.block.fresh > 0.0:
                return 0.0, math.inf, "none"
            return 0.0, 2.0 * self.block.rate(0.0), "grazing"
        if math.isinf(self.least):
            return math.inf, 0.0, "none"
        grazing = self.w * self.block.excess(self.least / self.w) / self.least
        low, high = self.least * (1.0 + 8.0 * EPS), 2.0 * self.least
        if self.slope(low) <= 0.0:
            return self.least, grazing, "grazing"
        while self.slope(high) > 0.0:
            high *= 2.0

        def slope(x: float) -> float:
            return min(self.slope(self.least + math.exp(x)), 1e300)

        x = brentq(slope, math.log(low - self.least), math.log(high - self.least), xtol=1e-13)
        fold = self.least + math.exp(x)
        if not self.speed(fold) > grazing * (1.0 + 8.0 * EPS):
            return self.least, grazing, "grazing"
        return fold, self.speed(fold), "fold"

    def at(self, v: float) -> float | None:
        """Return lambda of the stable cycle at the speed ``v`` [m/s]; None where there is none."""
        low, top, _ = self.fastest()
        if not v < top:
            return None

        def excess(x: float) -> float:
            return math.log(self.speed(math.exp(x)) / v)

        if low == 0.0:
            low = LEAST_STICK / 2.0
            if not self.speed(low) > v:
                return None
        high = 2.0 * low
        while self.speed(high) > v:
            low, high = high, 2.0 * high
        if not self.speed(low) > v:
            return low
        lambda_ = math.exp(brentq(excess, math.log(low), math.log(high), xtol=1e-15))
        slope = self.slope(lambda_)
        if slope < 0.0 and math.isfinite(slope):
            # The logarithm leaves some roundings: one step of Newton takes them away.
            lambda_ *= 1.0 - math.log(self.speed(lambda_) / v) / slope
        return float(lambda_)

    def reverses(self, v: float, lambda_: float) -> bool:
        """Tell whether the stop of the cycle is beyond what a fresh stick holds; theory (23)."""
        backward = v / self.w * self.slip(lambda_).deceleration - self.block.kinetic
        held = self.block.kinetic + self.block.fresh
        return backward > held + REST_SLACK * (abs(backward) + held)


def dwell_cycle(p: Parameters) -> tuple[float | bool, ...]:
    """Return the fields of `Cycle`, in their order, where static friction grows at rest.

    Parameters
    ----------
    p : Parameters
        Numbers only, with the values of dwell in ``own``.

    Returns
    -------
    tuple
        ``F_s``, ``Delta`` and ``lambda_`` are those of the break-away in the cycle; where there is
        none, those of a fresh stick. In a cycle with reversals ``t_slip`` and ``delta_x`` count
        from break-away to re-stick. ``exists`` is False also where the sticks do not settle to one
        length; docs/theory.md (23).
    """
    v = abs(float(p.v))
    block = Block(p, v)
    found = _steady(p, block) if v > 0.0 else None
    if found is None:
        F_s = block.k * (block.kinetic + block.fresh)
        lambda_ = block.w * block.fresh / v if v > 0.0 else _infinite(block.fresh)
        return (F_s, block.fresh, lambda_, *[math.nan] * 7, False)
    t_stick, slips = found
    Delta = block.excess(t_stick)
    T = t_stick + slips.length
    s = math.copysign(1.0, float(p.v))
    return (
        *(block.k * (block.kinetic + Delta), Delta, block.w * Delta / v),
        *(s * v * t_stick, s * v * T, slips.length, t_stick, T, 1.0 / T, s * v * slips.peak),
        True,
    )


def cycle_ranges(p: Parameters, between: tuple[float, float]) -> tuple[Interval, ...]:
    """Return the pulling speeds at which stick-slip goes on; docs/theory.md (20), (22), (23).

    Parameters
    ----------
    p : Parameters
        Numbers only, with the values of dwell in ``own``; ``v`` is of no influence.
    between : tuple of two floats
        The range of pulling speeds that is searched [m/s], > 0.

    Returns
    -------
    tuple of Interval
        Disjoint and in order. An end is "fold" or "grazing", or "none" at a bound of the search.
        Only a motion with several reversals may leave a gap, and one narrower than 1 % of v is
        not looked for.

    Raises
    ------
    ValueError
        If the range is empty or not above 0, ``p`` has arrays, or static friction does not grow.
    """
    low, high = between
    if not 0.0 < low < high < math.inf:
        raise ValueError(f"between = {between!r} m/s is out of range; it must rise and be > 0")
    if p.shape or not dwells(p):
        raise ValueError("cycle_ranges takes numbers and a static friction that grows at rest")
    family = Family(p)
    _, top, kind = family.fastest()
    if not top > low:
        return ()
    whole = Interval(low, min(top, high), "none", kind if top <= high else "none")
    return _without_gaps(p, family, whole)


def critical_speed(p: Parameters) -> float:
    """Return the pulling speed [m/s] above which no cycle has a stick; docs/theory.md (20), (22).

    Parameters
    ----------
    p : Parameters
        Numbers only, with the values of dwell in ``own``; ``v`` is of no influence. Infinite where
        ``c = 0`` and a fresh stick holds more than kinetic friction.
    """
    return Family(p).fastest()[1]


def _infinite(length: float) -> float:
    return math.inf if length > 0.0 else math.nan


def _steady(p: Parameters, block: Block) -> tuple[float, Settled] | None:
    """Return the length of the stick and the slips after it in the steady cycle."""
    family = Family(p)
    lambda_ = family.at(block.v)
    if lambda_ is None:
        return None
    if family.reverses(block.v, lambda_):
        t = _settled(block, family.t_stick(lambda_))
        slips = None if t is None else block.settle(block.excess(t))
        return None if t is None or slips is None else (t, slips)
    slip = family.slip(lambda_)
    t_stick = (lambda_ + slip.deceleration) / block.w
    if block.w * t_stick < LEAST_STICK or math.isnan(slip.length):
        return None
    force = block.kinetic - block.v / block.w * slip.deceleration
    return t_stick, Settled(force, slip.length / block.w, slip.peak)


def _settled(block: Block, t: float) -> float | None:
    """Return the length of stick [s] to which the sequence of sticks settles, event by event."""
    for _ in range(MOST_CYCLES):
        first = block.next_stick(t)
        second = None if first is None else block.next_stick(first)
        if first is None or second is None:
            return None
        if abs(second - first) <= 4.0 * EPS * first:
            return second
        # Steffensen's step, where it is one between the sticks seen; docs/theory.md (23).
        bend = second - 2.0 * first + t
        guess = t - (first - t) ** 2 / bend if bend else second
        t = guess if min(t, first, second) <= guess <= max(t, first, second) else second
        there = block.next_stick(t)
        if there is not None and abs(there - t) <= 32.0 * EPS * t:
            return t if _attracts(block, t) else None
    return None


def _attracts(block: Block, t: float) -> bool:
    """Tell whether sticks near one of the length ``t`` [s] come nearer to it."""
    off = 1e-6 * t
    near = [block.next_stick(t - off), block.next_stick(t + off)]
    return all(each is not None and abs(each - t) < off for each in near)


def _without_gaps(p: Parameters, family: Family, whole: Interval) -> tuple[Interval, ...]:
    """Take out the speeds at which a slip after two reversals does not come to rest, (23)."""
    fresh_holds = family.block.kinetic + family.block.fresh

    def goes_on(v: float) -> bool:
        block, lambda_ = Block(p, v), family.at(v)
        if lambda_ is None or not family.reverses(v, lambda_):
            return True
        t: float | None = family.t_stick(lambda_)
        for _ in range(MOST_CYCLES // 10):
            t = None if t is None else block.next_stick(t)
        return t is not None

    # Slower, each slip along the pull ends; faster, none reverses.
    always = family.w * fresh_holds / family.least if family.least > 0.0 else math.inf
    if family.block.kinetic == 0.0:
        always = 0.0
    start = max(whole.low, always)
    if start >= whole.high:
        return (whole,)
    count = 2 + math.ceil(math.log(whole.high / start) / STEP)
    speeds = [whole.low, *np.geomspace(start, whole.high, count).tolist()]
    speeds = sorted({each for each in speeds if whole.low <= each <= whole.high})
    found = [goes_on(each) for each in speeds]
    ends: list[float] = []
    for n in range(1, len(speeds)):
        if found[n] != found[n - 1]:
            ends.append(_edge(goes_on, speeds[n - 1], speeds[n]))
    marks = [whole.low, *ends, whole.high]
    return tuple(
        Interval(
            marks[n],
            marks[n + 1],
            whole.low_end if n == 0 else "grazing",
            whole.high_end if n == len(marks) - 2 else "grazing",
        )
        for n in range(len(marks) - 1)
        if found[0] == (n % 2 == 0) and marks[n + 1] - marks[n] > LEAST_RANGE * marks[n + 1]
    )


def _edge(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Return the speed between two at which a statement changes its truth."""
    first = holds(low)
    while high - low > 1e-9 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) == first else (low, middle)
    return 0.5 * (low + high)
