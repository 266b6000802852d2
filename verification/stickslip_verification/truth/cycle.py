"""Coulomb's steady cycle and the edge of its existence. docs/theory.md (7) to (14)."""

from __future__ import annotations

from collections.abc import Mapping

from stickslip_verification.truth.coulomb import Slip
from stickslip_verification.truth.parameters import (
    Context,
    Number,
    complete,
    exact,
    high_precision,
    root_tolerance,
    sign,
)


def steady_cycle(parameters: Mapping[str, float], *, digits: int = 50) -> dict[str, Number] | None:
    """Return the steady stick-slip cycle of exactly these numbers, or None where there is none.

    Parameters
    ----------
    parameters
        m g k c mu_s mu_k v load (SI), the rest at their start values; F_ext and the start do
        not matter to a cycle.
    digits
        Decimal digits that the result carries.

    Returns
    -------
    dict
        F_s [N], Delta [m], lambda_ [1], spring_drop [m], delta_x [m], t_slip [s], t_stick [s],
        T [s], f [Hz], x_dot_peak [m/s]; lengths and x_dot_peak with the sign of v.
        docs/theory.md (7) to (11) without damping, (13) with. None for v = 0 and, damped, for
        lambda < lambda_c.

    Raises
    ------
    ValueError
        Naming the parameter, its value and its range.
    """
    context = high_precision(digits)
    n = exact(context, complete(parameters))
    direction = sign(n.v)
    if direction == 0:
        return None
    slip = Slip(context, n, direction, context.zero, n.gap / n.m)
    if slip.duration is None:
        return None
    spring_drop = (n.gap - n.m * slip.end_acceleration) / n.k
    t_stick = spring_drop / abs(n.v)
    T = t_stick + slip.duration
    Delta = n.gap / n.k
    return {
        "F_s": n.F_s,
        "Delta": Delta,
        "lambda_": context.sqrt(n.k / n.m) * Delta / abs(n.v),
        "spring_drop": direction * spring_drop,
        "delta_x": n.v * T,
        "t_slip": slip.duration,
        "t_stick": t_stick,
        "T": T,
        "f": 1 / T,
        "x_dot_peak": direction * slip.top_speed(slip.duration),
    }


def critical_lambda(zeta: float, *, digits: int = 50) -> Number:
    """Return lambda_c(zeta), the least lambda = w Delta/|v| with a cycle, docs/theory.md (13).

    Parameters
    ----------
    zeta
        Damping ratio c/(2 m w) [1], a double or a number of high precision, taken exactly.
    digits
        Decimal digits that the result carries.

    Returns
    -------
    Number
        0 for zeta = 0 (a cycle at every speed), +inf for zeta >= 1 (at none).

    Raises
    ------
    ValueError
        If zeta is negative or no number.
    """
    context = high_precision(digits)
    ratio = context.mpf(zeta)
    if not ratio >= 0:
        raise ValueError(f"zeta = {zeta} is outside zeta >= 0")
    if ratio == 0:
        return context.zero
    if ratio >= 1:
        return context.inf
    return context.exp(_log_critical_lambda(context, ratio))


def _log_critical_lambda(context: Context, zeta: Number) -> Number:
    """Return ln lambda_c by Newton's method on (13) from above, bracketed."""
    nu = context.sqrt((1 - zeta) * (1 + zeta))
    low = context.log(2 * zeta)
    high = context.log1p(context.exp(2 * context.pi * zeta / nu))
    tolerance = root_tolerance(context)
    logarithm = high
    last = high - low
    while True:
        L = context.exp(logarithm)
        square = (L - zeta) ** 2 + nu * nu
        turn = 2 * context.pi - context.atan2(L * nu, 1 - zeta * L)
        excess = context.log(square) - 2 * zeta / nu * turn
        if excess > 0:
            high = logarithm
        else:
            low = logarithm
        step = -excess * square / (2 * L * L)
        if abs(step) > tolerance and (not (low < logarithm + step < high) or 2 * abs(step) > last):
            step = (low + high) / 2 - logarithm
        logarithm += step
        last = abs(step)
        if last <= tolerance:
            return logarithm
