"""Growth of the break-away force with the age t of a stick: docs/theory.md (19).

``F_s(t) = F_s(0) + rise (1 - exp(-t/tau_s)) + strength ln(1 + t/t_0)``

With ``tau_s = 0`` the first growth is over at once and part of F_s(0).
"""

import math
from typing import Optional, Tuple

from ..sticking import StickArc

# A step of Newton's method at least halves the way to the root, so this is never reached; it only
# keeps values that are no numbers from looping for ever.
_MOST_STEPS = 200


class Dwell:
    """The growth under given settings: concave, 0 at age 0.

    Parameters
    ----------
    rise
        What is still gained with the time constant tau_s [N]; 0 for tau_s = 0.
    tau_s
        Time constant of that growth [s].
    strength
        What is gained with the logarithm of the age, B N [N].
    t_0
        Age from which on the logarithm counts [s].
    """

    def __init__(self, rise: float, tau_s: float, strength: float, t_0: float) -> None:
        self.rise = rise
        self.tau_s = tau_s
        self.strength = strength
        self.t_0 = t_0

    def growth(self, age: float) -> float:
        """Return what a stick of this age has gained since it began."""
        grown = 0.0
        if self.rise > 0.0:
            grown = -self.rise * math.expm1(-age / self.tau_s)
        if self.strength > 0.0:
            grown += self.strength * _log_growth(age, self.t_0)
        return grown

    def tangent(self, age: float) -> Tuple[float, float]:
        """Return the tangent of the growth at an age: its value at age 0, and its slope."""
        start = slope = 0.0
        if self.rise > 0.0:
            ratio = age / self.tau_s
            left = math.exp(-ratio)
            gone = ratio * left if left > 0.0 else 0.0
            # Not below 0, but rounding may bring it there.
            start = self.rise * max(-math.expm1(-ratio) - gone, 0.0)
            slope = self.rise * left / self.tau_s
        if self.strength > 0.0:
            whole = self.t_0 + age
            start += self.strength * max(_log_growth(age, self.t_0) - age / whole, 0.0)
            slope += self.strength / whole
        return start, slope

    def extension(self, age: float, k: float) -> "Dwell":
        """Return the growth from this age on, of a spring of stiffness `k` [m for N]."""
        left = self.rise * math.exp(-age / self.tau_s) if self.rise > 0.0 else 0.0
        return Dwell(left / k, self.tau_s, self.strength / k, self.t_0 + age)


class AgeingStickArc(StickArc):
    """The mass rests while the pulled end loads the spring and the break-away force grows.

    Parameters
    ----------
    k, v, z, external, way, age
        As of `StickArc`; `way` is what the force lacks of the break-away force at the start.
    breakaway
        Break-away force at age 0 [N].
    dwell
        Its growth.
    """

    def __init__(
        self,
        k: float,
        v: float,
        z: float,
        breakaway: float,
        external: float,
        dwell: Dwell,
        way: Optional[float] = None,
        age: float = 0.0,
    ) -> None:
        super().__init__(k, v, z, breakaway + dwell.growth(age), external, way, age)
        if v == 0.0:
            return
        reach = math.copysign(1.0, v) * (self.z_end - z) if way is None else way / k
        self.duration = load_up(max(reach, 0.0), abs(v), dwell.extension(age, k))
        force = breakaway + dwell.growth(age + self.duration)
        self.z_end = (math.copysign(force, v) - external) / k


def load_up(reach: float, pull: float, dwell: Dwell) -> float:
    """Return how long a spring is loaded up to break-away [s].

    What lacks is ``reach + growth(t) - pull t``: concave, and not below 0 at the start. It has one
    root beyond which it stays below 0. A tangent is nowhere below the function, so where it falls
    its own root is beyond that one: Newton's method falls to the root from there.

    Parameters
    ----------
    reach
        What the extension lacks at the start of what breaks away then, at least 0 [m].
    pull
        Speed of the pulled end, above 0 [m/s].
    dwell
        Growth of the extension that breaks away [m], from the start on.
    """
    if reach == 0.0 and dwell.tangent(0.0)[1] <= pull:
        return 0.0
    # The tangent of the logarithm where its slope is below pull/2, and the other growth at its end.
    lasting = 2.0 * dwell.strength / pull
    if lasting == math.inf:
        return math.inf
    start, slope = Dwell(0.0, 0.0, dwell.strength, dwell.t_0).tangent(lasting)
    root = (reach + dwell.rise + start) / (pull - slope)
    for _ in range(_MOST_STEPS):
        start, slope = dwell.tangent(root)
        if not slope < pull:
            break
        following = (reach + start) / (pull - slope)
        if not following < root:
            break
        root = following
    return root


def _log_growth(age: float, t_0: float) -> float:
    """Return ln(1 + age/t_0), where the ratio is beyond the range of numbers too."""
    ratio = age / t_0
    return math.log1p(ratio) if ratio < math.inf else math.log(age) - math.log(t_0)
