"""Motions of servo axes under Coulomb's friction, exact between events; many axes at once."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from stickslip_design.axis import Axis

Array = NDArray[Any]

_HALVINGS: Final = 36
"""An event is located to a sample time over 2 to the power of this."""


def loops(
    axes: Sequence[Axis], back: Array, position: Array, speed: Array, *,
    struck: int = -1, by: Array | float = 0.0,
) -> tuple[Array, Array, Array, Array]:  # fmt: skip
    """Return motor [m], table [m], its speed [m/s] and the motor's force [N] at the samples.

    Of servo axes with their damping backward, shape (b,), that follow commanded positions and
    speeds, shape (b, n): docs/feed-axis.md (1), (2), by the exponential of the matrix of each mode.
    In the sample `struck` motor, its speed, its force, the integral and the command are moved `by`,
    (b, 5).
    """
    drives = [axis.drive for axis in axes if axis.drive]
    J, K_v, K_p, T_s, T_n, lag, part, on_table = np.array([
        (q.inertia, q.K_v, q.K_p, q.T_s, q.T_n, q.lag, q.velocity_feedforward, q.on_table)
        for q in drives
    ]).T  # fmt: skip
    m, k, c, along, F_s, F_k = np.array([(a.m, a.k, a.c, a.along, a.F_s, a.F_k) for a in axes]).T
    # Of motor and its speed, table and its speed, force, commanded force, 1; by mode -1, 0, 1.
    A = np.zeros((3, 7, 7, len(axes)))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 2], A[:, 1, 4] = 1.0, -k / J, k / J, 1.0 / J
    A[:, 4, 4], A[:, 4, 5] = -1.0 / lag, 1.0 / lag
    for sense, damping in ((-1, back), (1, c)):
        rows = A[sense + 1]
        rows[2, 3], rows[3, 0], rows[3, 2], rows[3, 3] = 1.0, k / m, -k / m, -damping / m
        rows[3, 6] = (along - sense * F_k) / m
    E = [expm(np.moveaxis(A * (T_s / 2.0**level), 3, 0)) for level in range(_HALVINGS + 1)]

    def onward(y: Array, mode: Array, level: int, which: Array) -> Array:
        return np.asarray((E[level][which, mode + 1] @ y[:, :, None])[:, :, 0])

    def pull(y: Array, which: Array) -> Array:
        return np.asarray(k[which] * (y[:, 0] - y[:, 2]) + along[which])

    def over(y: Array, mode: Array, which: Array) -> Array:
        return np.where(mode == 0, np.abs(pull(y, which)) > F_s[which], mode * y[:, 3] < 0.0)

    everyone, y = np.arange(len(axes)), np.zeros((len(axes), 7))
    mode: Array = np.zeros_like(everyone)
    y[:, 6], last, integral = 1.0, y[:, 0].copy(), y[:, 0].copy()
    seen, ahead = np.empty((position.shape[1], len(axes), 4)), np.zeros(len(axes))
    for n in range(position.shape[1]):
        if n == struck:
            blow = np.broadcast_to(by, (len(axes), 5)).T
            y[:, [0, 1, 4]] += blow[:3].T
            last, integral, ahead = last + blow[0], integral + blow[3], blow[4]
        seen[n] = y[:, [0, 2, 3, 4]]
        e = position[:, n] + ahead - np.where(on_table > 0.0, y[:, 2], y[:, 0])
        lack = K_v * e + part * speed[:, n] - (y[:, 0] - last) / T_s
        last, integral = y[:, 0].copy(), integral + K_p * T_s / T_n * lack
        y[:, 5] = K_p * lack + integral
        then = onward(y, mode, 0, everyone)
        if (at := np.flatnonzero(over(then, mode, everyone))).size:
            z, old, late = y[at], mode[at], []
            for level in range(1, _HALVINGS + 1):
                tried = onward(z, old, level, at)
                late.append(over(tried, old, at)[:, None])
                z = np.where(late[-1], z, tried)
            force, z[:, 3] = pull(z, at), 0.0
            slips = (old == 0) | (np.abs(force) > F_s[at])
            mode[at] = new = np.where(slips, np.sign(force), 0.0).astype(int)
            for level, rejected in enumerate(late, 1):
                z = np.where(rejected, onward(z, new, level, at), z)
            then[at] = z
        y = then
    motor, table, u, force = np.moveaxis(seen, 2, 0)
    return motor.T, table.T, u.T, force.T
