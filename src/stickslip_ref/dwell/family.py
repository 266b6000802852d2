"""The cycles of one block without reversals, at all pulling speeds; docs/theory.md (21), (22).

The slip after a stick of the age t starts with ``lambda = w g(t) / v`` and is that of (13). So the
cycles are a curve in lambda: the stick lasts ``t(lambda)``, and ``v(lambda) = w g(t) / lambda``.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ..critical import critical_lambda
from .sticks import EPS, REST_SLACK, Floats, Slip, Sticks

LEAST_STICK = 1e-12
"""A stick shorter than this [1 / w] counts as none."""

NEAR = 0.02
"""A stop so near to what holds, relative, counts as one that may reverse."""


class Family:
    """The cycles without reversals of the block with these sticks."""

    def __init__(self, sticks: Sticks) -> None:
        self.sticks = sticks
        self.w, self.zeta = sticks.w, sticks.zeta
        self.least = float(critical_lambda(self.zeta))

    def slip(self, lambda_: float) -> Slip:
        """Return the slip of a cycle; at the least lambda rounding may leave none, that grazes."""
        slip = self.sticks.along(lambda_)
        return Slip(math.nan, 0.0, math.nan) if math.isnan(slip.length) else slip

    def t_stick(self, lambda_: float) -> float:
        """Return the length of the stick [s]; docs/theory.md (21)."""
        return float((lambda_ + self.slip(lambda_).deceleration) / self.w)

    def speed(self, lambda_: float) -> float:
        """Return the pulling speed [m/s] of the cycle; docs/theory.md (21)."""
        return float(self.w * self.sticks.excess(self.t_stick(lambda_)) / lambda_)

    def slope(self, lambda_: float) -> float:
        """Return d ln v / d ln lambda; docs/theory.md (22)."""
        slip = self.slip(lambda_)
        t = (lambda_ + slip.deceleration) / self.w
        rate = self.sticks.rate(t) / self.sticks.excess(t)
        if rate == 0.0:
            return -1.0
        if slip.deceleration == 0.0:
            return math.inf
        if self.zeta == 0.0:
            stretch = 1.0
        else:
            nu = self.sticks.nu
            decay = math.exp(-self.zeta * slip.length)
            sine, cosine = math.sin(nu * slip.length), math.cos(nu * slip.length)
            impulse, its_rate = decay * sine / nu, decay * (cosine - self.zeta / nu * sine)
            stretch = -its_rate - (1.0 / slip.deceleration + 2.0 * self.zeta) * impulse
        return float(lambda_ * (1.0 + stretch) * rate / self.w - 1.0)

    @cached_property
    def fastest(self) -> tuple[float, float, str]:
        """Lambda, speed [m/s] and kind of the end of the family; docs/theory.md (22)."""
        sticks = self.sticks
        if self.zeta == 0.0:
            if sticks.fresh > 0.0:
                return 0.0, math.inf, "none"
            return 0.0, 2.0 * float(sticks.rate(0.0)), "grazing"
        if math.isinf(self.least):
            return math.inf, 0.0, "none"
        grazing = self.w * float(sticks.excess(self.least / self.w)) / self.least
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
        low, top, _ = self.fastest
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
        sticks = self.sticks
        backward = v / self.w * self.slip(lambda_).deceleration - sticks.kinetic
        return bool(backward > sticks.holds + REST_SLACK * (abs(backward) + sticks.holds))

    def may_reverse(self, speeds: Floats) -> NDArray[np.bool_]:
        """Tell at which speeds [m/s] the stable cycle reverses, or nearly does."""
        lambda_ = max(self.fastest[0], LEAST_STICK) * (1.0 + 1e-9)
        slowest = lambda_
        while self.speed(slowest) > np.min(speeds):
            slowest *= 10.0
        # Half a per cent apart, so that the stops between are known to less than NEAR.
        count = 2 + math.ceil(math.log(10.0 * slowest / lambda_) / 0.005)
        curve = np.geomspace(lambda_, 10.0 * slowest, count)
        slip = self.sticks.along(curve)
        v = self.w * self.sticks.excess((curve + slip.deceleration) / self.w) / curve
        backward = v / self.w * slip.deceleration - self.sticks.kinetic
        result: NDArray[np.bool_] = (
            np.interp(-speeds, -v, backward) > (1.0 - NEAR) * self.sticks.holds
        )
        return result
