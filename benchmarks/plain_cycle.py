"""The steady cycle as a competent reader of docs/theory.md writes it in NumPy: the yardstick."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def plain_steady_cycle(
    m: Array, g: float, k: Array, mu_s: Array, mu_k: Array, v: Array
) -> tuple[Array, ...]:
    """Return every field of `stickslip_ref.steady_cycle` for c = 0 and v > 0, (2) and (6)-(11)."""
    weight = m * g
    breakaway = mu_s * weight
    delta = (mu_s - mu_k) * weight / k
    w = np.sqrt(k / m)
    lambda_ = w * delta / v
    spring_drop = 2.0 * delta
    t_slip = (2.0 / w) * (np.pi - np.arctan(lambda_))
    t_stick = spring_drop / v
    delta_x = spring_drop + v * t_slip
    period = t_stick + t_slip
    frequency = 1.0 / period
    peak = v * (1.0 + np.sqrt(1.0 + lambda_ * lambda_))
    exists = np.isfinite(period)
    return (
        breakaway,
        delta,
        lambda_,
        spring_drop,
        delta_x,
        t_slip,
        t_stick,
        period,
        frequency,
        peak,
        exists,
    )
