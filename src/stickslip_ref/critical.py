"""From which velocity on a damped slip no longer comes to rest; docs/theory.md (13), (14)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .blocks import evaluate
from .parameters import FloatOrArray, Parameters

Floats = NDArray[np.float64]

_LOG_4_3 = 0.5 * math.log(4.0 / 3.0)

_STEPS = 2
"""Of Halley's method, which is cubic: errors of 2e-3, 2e-9, below rounding."""

_LIGHT = 1e-20
"""Up to this zeta the start is exact: L^2 = 4 pi zeta to rounding, which may underflow."""


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
    result: FloatOrArray = evaluate(_lambda, (ratio,), ratio.shape, [np.float64])[0]
    return result


def coulomb_limit(p: Parameters) -> FloatOrArray:
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
    operands = (p.m, p.g, p.k, p.c, p.mu_s, p.mu_k_used, p.load)
    shape = np.broadcast_shapes(*(np.shape(each) for each in operands))
    limit: FloatOrArray = evaluate(_limit, operands, shape, [np.float64])[0]
    return limit


def _lambda(out: list[Any], zeta: Any) -> None:
    """Evaluate one block of `critical_lambda`."""
    result = out[0]
    result[:] = zeta
    np.copyto(result, np.inf, where=result >= 1.0)
    at = np.flatnonzero((result > 0.0) & (result < 1.0))
    result[at] = np.exp(_log_critical_lambda(result[at]))


def _limit(out: list[Any], m: Any, g: Any, k: Any, c: Any, mu_s: Any, mu_k: Any, load: Any) -> None:
    """Evaluate one block of `coulomb_limit`."""
    result = out[0]
    w = np.sqrt(k / m)
    zeta = np.broadcast_to(c / (2.0 * m * w), result.shape)
    result[:] = w * ((mu_s - mu_k) * (m * g + load) / k)
    at = np.flatnonzero((zeta > 0.0) & (zeta < 1.0))
    # exp(-ln lambda_c) is 0 where lambda_c is infinite, without a division.
    result[at] *= np.exp(-_log_critical_lambda(zeta[at]))
    np.copyto(result, 0.0, where=zeta >= 1.0)
    np.copyto(result, np.inf, where=zeta == 0.0)


def _log_critical_lambda(zeta: Floats) -> Floats:
    """Solve for ln lambda_c, 0 < zeta < 1, by Halley's method; docs/theory.md (13).

    The unknown is the one in which the equation is nearly linear at both ends.
    """
    nu = np.sqrt((1.0 - zeta) * (1.0 + zeta))
    # Heavy damping gives ln L = e = (zeta / nu) (pi + acos zeta), light L^2 = 4 / 3 (exp(2 e) - 1).
    # The polynomial between the two is fitted, to 2e-3.
    heavy = (zeta / nu) * (np.pi + np.arccos(zeta))
    between = _LOG_4_3 + zeta * (0.995 + zeta * 1.48 - 2.621 * np.sqrt(zeta))
    log_L = heavy + 0.5 * np.log(-np.expm1(-2.0 * heavy)) + between
    for _ in range(_STEPS):
        # ln of the slip's deepest velocity deviation over v; theory (13). Below L = 1 it is of
        # 1 + L (L - 2 zeta), small; above, of L times a factor near 1.
        small = log_L < 0.0
        e = np.exp(-np.abs(log_L))
        amplitude = e * (e - 2.0 * zeta)
        beside = np.where(small, 1.0 - zeta * e, e - zeta)
        angle = np.arctan2(np.where(small, e, 1.0) * nu, beside)
        growth = 0.5 * np.log1p(amplitude) + np.maximum(log_L, 0.0)
        excess = growth - (zeta / nu) * (2.0 * np.pi - angle)
        per_slope = np.where(small, 1.0 / (e * e), 1.0)
        newton = excess * (1.0 + amplitude) * per_slope
        curved = excess * beside * np.where(small, per_slope, e)
        log_L -= np.where(zeta > _LIGHT, newton / (1.0 - curved), 0.0)
    return log_L
