"""The damped slip from rest against a constant friction; docs/theory.md (13)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_ROOT_2 = math.sqrt(2.0)

_STEPS = 2
"""Of Halley's method, which is cubic: errors of 1e-2, 1e-7, below rounding. A number of steps that
is fixed needs no test of each point, and lets no point depend on its neighbours."""


class DampedSlip(NamedTuple):
    """A slip that starts from rest with the acceleration ``lambda w v``, in units of v and 1 / w.

    Attributes
    ----------
    ends : array of bool
        Whether the mass comes to rest; the other fields are NaN where it does not.
    length : array
        Length of the slip [1 / w].
    deceleration : array
        ``-x_ddot / (w v)`` at its end, >= 0.
    peak : array
        Largest velocity over v.
    """

    ends: NDArray[np.bool_]
    length: Floats
    deceleration: Floats
    peak: Floats


def damped_slip(lambda_: Floats, zeta: Floats) -> DampedSlip:
    """Return the slip that starts at the speed of the pull below it; docs/theory.md (13).

    In units of v and 1 / w the velocity deviation from the pull, ``x_dot / v - 1``, starts at -1
    and is ``-D G(delta)``, ``delta`` being the time left to its minimum, where

        D = sqrt(1 - 2 zeta lambda + lambda^2) exp(-zeta tau_min)
        G(delta) = exp(zeta delta) (cos(nu delta) - (zeta / nu) sin(nu delta))

    and G falls from 1 at the minimum to 0 at nu delta = acos zeta. The slip ends at G = 1 / D.

    Parameters
    ----------
    lambda_, zeta : array, of one shape
        ``w Delta / v`` and damping ratio, both > 0 [-]; from ``zeta = 1`` on no slip ends.
    """
    light = zeta < 1.0
    zeta = np.where(light, zeta, 0.5)
    nu = np.sqrt((1.0 - zeta) * (1.0 + zeta))
    angle = np.arctan2(lambda_ * nu, 1.0 - zeta * lambda_)
    # ln of the amplitude, from the small side of lambda = 1 and from the large: 1 + L (L - 2 zeta).
    ratio = np.where(lambda_ < 1.0, lambda_, 1.0 / lambda_)
    log_amplitude = 0.5 * np.log1p(ratio * (ratio - 2.0 * zeta)) + np.log(np.maximum(lambda_, 1.0))
    tau_min = (2.0 * np.pi - angle) / nu
    log_D = log_amplitude - zeta * tau_min
    ends = light & (log_D >= 0.0)
    result = DampedSlip(ends, *np.full((3, *ends.shape), np.nan))
    at = np.flatnonzero(ends)
    zeta, nu, log_D = zeta[at], nu[at], log_D[at]
    delta = _time_before_minimum(log_D, zeta, nu)
    result.length[at] = tau_min[at] - delta
    result.deceleration[at] = np.exp(log_D + zeta * delta) * np.sin(nu * delta) / nu
    result.peak[at] = 1.0 + np.exp(log_amplitude[at] - zeta * (np.pi - angle[at]) / nu)
    return result


def _time_before_minimum(log_D: Floats, zeta: Floats, nu: Floats) -> Floats:
    """Solve G(delta) = 1 / D by Halley's method on sqrt(1 - G); theory (13).

    1 - G starts as delta^2 / 2, so its root is the unknown in which the equation is nearly linear.
    G'' = 2 zeta G' - G gives the curvature for nothing.
    """
    target = np.sqrt(-np.expm1(-log_D))
    # delta is T - zeta T^2 / 3 + (zeta^2 / 9 + 1 / 24) T^3 + ... in T = sqrt(2 (1 - G)), and
    # acos(zeta) / nu where G = 0. The fourth power, put right there, leaves 1 % at most.
    third = zeta / 3.0
    cubic = third * third + 1.0 / 24.0
    quartic = 0.25 * np.arccos(zeta) / nu - _ROOT_2 / 4.0 + 0.5 * (third - _ROOT_2 * cubic)
    T = _ROOT_2 * target
    delta = T * (1.0 + T * (-third + T * (cubic + T * quartic)))
    for _ in range(_STEPS):
        half = np.sin(0.5 * nu * delta)
        sine = 2.0 * half * np.sqrt((1.0 - half) * (1.0 + half))
        cosine = 1.0 - 2.0 * half * half
        growth_less_1 = np.expm1(zeta * delta)
        # P = 1 - G with its leading ones cancelled by hand; what is left is rounded to zeta ulp.
        slope = (1.0 + growth_less_1) * sine / nu
        P = 2.0 * half * half + zeta * slope - growth_less_1 * cosine
        root = np.sqrt(P)
        newton = 2.0 * root * (root - target) / slope
        curved = (2.0 * P * (2.0 * zeta * slope + 1.0 - P) / (slope * slope) - 1.0) / (2.0 * root)
        delta -= newton / (1.0 - (root - target) * curved)
    # A slip that grazes rest ends at the minimum, where a step is 0 / 0.
    return np.where(target > 0.0, delta, 0.0)
