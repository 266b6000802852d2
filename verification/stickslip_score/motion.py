"""A curve as the motion of a mass that is pulled forward: position, spring, what digits allow."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stickslip_score.curve import Curve, CurveError, Floats

_SOLVER_FLOOR = 1e-9
"""Of the range of x: no tool that integrates promises more, so less is held against none."""

_ROUNDINGS = 4.0 * 2.0**-53
"""Of the longest way: a position is the difference of two ways in double precision, and either is
a product or a sum that has been rounded before, once by the tool and once here."""

_DRIFT = 1e-3
"""Of a spring's way: how far F/k + x - v t may wander before F, x, k and v contradict each other.
Ten times what a curve printed to four digits shows."""


@dataclass(frozen=True)
class Motion:
    """Samples with the pull turned forward, shape (n,).

    Attributes
    ----------
    t, y
        Time [s] and position along the pull [m].
    z
        Spring extension [m]; up to a constant where `absolute` is false.
    x_dot
        Velocity along the pull [m/s], None where not given.
    absolute
        Whether the spring force was given, so that z is known in full.
    allowed
        How far y may be from the truth for the digits of the file [m].
    x_dot_allowed
        The same for x_dot [m/s].
    z_allowed
        How far a spring extension may be off for the digits of F [m]; 0 where F is not given.
    mismatch
        Why x and F do not belong together with this k and v; empty where they do.
    from_force
        Whether y follows from F by k and v.
    v
        Speed of the pulled end [m/s], > 0.
    """

    t: Floats
    y: Floats
    z: Floats
    x_dot: Floats | None
    absolute: bool
    allowed: float
    x_dot_allowed: float
    z_allowed: float
    mismatch: str
    from_force: bool
    v: float

    def extension(self, time: float, y: float) -> float:
        """Return the spring extension [m] at a time [s] at which the mass is at y [m]."""
        shift = float(np.median(self.z - (self.v * (self.t - self.t[0]) - self.y)))
        return self.v * (time - float(self.t[0])) - y + shift


def motion_of(curve: Curve, p: Mapping[str, float], top_speed: float) -> Motion:
    """Turn a curve into a motion; what is missing of x and F follows from F = k (v t - x) + const.

    Parameters
    ----------
    curve
        The samples.
    p
        All parameters of the block, SI; v is not 0.
    top_speed
        Largest speed of the mass that is to be expected [m/s]: what a digit of t is worth in x.
    """
    sign, speed, k = math.copysign(1.0, p["v"]), abs(p["v"]), p["k"]
    since = curve.t - curve.t[0]
    mismatch = ""
    if curve.x is not None:
        y = sign * (curve.x - curve.x[0])
        allowed = curve.x_rounding
    elif curve.F is not None:
        y = speed * since - sign * (curve.F - curve.F[0]) / k
        allowed = curve.F_rounding / k + speed * curve.t_rounding
    else:
        raise CurveError("neither x nor F is given; one of them is needed")
    z = speed * since - y
    longest = speed * float(np.max(np.abs(curve.t)))
    if curve.F is not None:
        given = sign * curve.F / k
        longest = max(longest, float(np.max(np.abs(given))))
        if curve.x is not None:
            mismatch = _mismatch(curve, given - z, given, speed, k)
        z = z + float(np.median(given - z))
    if curve.x is not None:
        longest = max(longest, float(np.max(np.abs(curve.x))))
    allowed += curve.t_rounding * top_speed + _SOLVER_FLOOR * float(np.ptp(y))
    allowed += _ROUNDINGS * longest
    return Motion(
        t=curve.t,
        y=y,
        z=z,
        x_dot=None if curve.x_dot is None else sign * curve.x_dot,
        absolute=curve.F is not None,
        allowed=max(allowed, 1e-300),
        x_dot_allowed=curve.x_dot_rounding,
        z_allowed=curve.F_rounding / k,
        mismatch=mismatch,
        from_force=curve.x is None,
        v=speed,
    )


def _mismatch(curve: Curve, apart: Floats, given: Floats, speed: float, k: float) -> str:
    """Say so where F/k + x - v t is no constant."""
    digits = curve.x_rounding + curve.t_rounding * speed + curve.F_rounding / k
    wander = float(np.ptp(apart))
    if wander <= _DRIFT * float(np.ptp(given)) + 4.0 * digits:
        return ""
    return (
        "F is not k (v t - x) + const with the k and v given: "
        f"it is off by up to {0.5 * wander / max(float(np.ptp(given)), 1e-300):.2g} of its range"
    )
