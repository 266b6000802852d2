"""From which velocity on a damped slip no longer comes to rest; docs/theory.md (13), (14)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .parameters import FloatOrArray, Parameters, plain_number

_MAX_ITERATIONS = 200
"""Bisection alone needs about 60; Newton from the starts below needs 3 to 8."""


def critical_lambda(zeta: ArrayLike) -> FloatOrArray:
    """Return the lambda below which the damped cycle ceases to exist; docs/theory.md (13).

    Parameters
    ----------
    zeta : float or array of any shape
        Damping ratio [-], >= 0.

    Returns
    -------
    float or array of the shape of ``zeta``
        lambda_c [-]: 0 at ``zeta = 0``, about ``sqrt(4 pi zeta)`` for light damping, 1667 at 0.9,
        1e10 at 0.99, infinite from where it overflows (above 0.99998) and at ``zeta >= 1``.

    Raises
    ------
    ValueError
        If a damping ratio is negative or not finite.
    """
    ratio = np.asarray(zeta, dtype=np.float64)
    if not np.all((ratio >= 0.0) & (ratio < np.inf)):
        bad = ratio[~((ratio >= 0.0) & (ratio < np.inf))].flat[0]
        raise ValueError(f"zeta = {float(bad)!r} is out of range; it must be finite and >= 0")
    with np.errstate(over="ignore"):
        return plain_number(np.exp(_log_critical_lambda(ratio)))


def critical_velocity(p: Parameters) -> FloatOrArray:
    """Return the pulling speed above which no stick-slip cycle exists; docs/theory.md (14).

    Parameters
    ----------
    p : Parameters
        ``v`` and ``F_ext`` are of no influence; ``load`` enters through the normal force.

    Returns
    -------
    float or array of the shape of the fields used
        v_c [m/s] >= 0. Infinite where ``c = 0``: there, stick-slip persists at every speed and
        no critical one exists. 0 where ``zeta >= 1`` or, with damping, ``mu_s = mu_k``: there
        is no cycle at any speed.
    """
    zeta = np.asarray(p.zeta, dtype=np.float64)
    with np.errstate(over="ignore"):
        # exp(-ln lambda_c) is 0 where lambda_c is infinite, without a division.
        slowest = p.w * p.Delta * np.exp(-_log_critical_lambda(np.where(zeta > 0.0, zeta, 0.5)))
    return plain_number(np.where(zeta > 0.0, slowest, np.inf))


def _log_critical_lambda(zeta: NDArray[np.float64]) -> NDArray[np.float64]:
    """Solve for ln lambda_c, the unknown in which the equation is nearly linear at both ends."""
    result = np.full(zeta.shape, np.inf)
    result[zeta == 0.0] = -np.inf
    inside = (zeta > 0.0) & (zeta < 1.0)
    if not inside.any():
        return result
    z = zeta[inside]
    nu = np.sqrt((1.0 - z) * (1.0 + z))
    # Light damping gives ln L = ln sqrt(4 pi zeta), heavy (zeta / nu) (pi + acos zeta). The root is
    # above the first and below the log of the sum of both; a unit to each side makes it a bracket.
    light = 0.5 * np.log(4.0 * np.pi * z)
    heavy = (z / nu) * (np.pi + np.arccos(z))
    low, high = light - 1.0, np.logaddexp(light, heavy) + 1.0
    root = np.where(z < 0.3, light, heavy)
    for _ in range(_MAX_ITERATIONS):
        excess, slope = _excess(root, z, nu)
        above = excess > 0.0
        high = np.where(above, root, high)
        low = np.where(above, low, root)
        newton = root - excess / slope
        update = np.where((newton >= low) & (newton <= high), newton, 0.5 * (low + high))
        converged = np.abs(update - root) <= 2e-15 * np.maximum(1.0, np.abs(root))
        root = update
        if np.all(converged):
            break
    result[inside] = root
    return result


def _excess(
    log_L: NDArray[np.float64], z: NDArray[np.float64], nu: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Log of the slip's deepest velocity deviation over v, and its slope in ln L; theory (13).

    Below L = 1 the logarithm is of 1 + L (L - 2 zeta), small; above, of L times a factor near 1.
    """
    small = log_L < 0.0
    e = np.exp(-np.abs(log_L))
    inner = e * (e - 2.0 * z)
    growth = 0.5 * np.log1p(inner) + np.where(small, 0.0, log_L)
    angle = np.where(small, np.arctan2(e * nu, 1.0 - z * e), np.arctan2(nu, e - z))
    excess = growth - (z / nu) * (2.0 * np.pi - angle)
    slope = np.where(small, e * e, 1.0) / (1.0 + inner)
    return excess, slope
