"""How the axis swings while its table slides: its least damped oscillation, samples and all."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from .axis import Axis

Matrix = NDArray[np.float64]

# Motor position and speed, table position and speed; motor force, or integral; last motor position.
_X_MOTOR, _V_MOTOR, _X, _X_DOT, _FORCE, _LAST = range(6)
_INTEGRAL = _FORCE


class Mode(NamedTuple):
    """An oscillation.

    Attributes
    ----------
    damping
        Damping ratio [-]; below 0 it grows.
    w
        Undamped frequency [rad/s].
    """

    damping: float
    w: float


def sliding_mode(axis: Axis) -> Mode:
    """Return the least damped oscillation of the axis while its table slides in one direction.

    Notes
    -----
    Friction is constant then, so the motion around the feed is linear: a matrix from sample to
    sample, of drive, spring and table under a held motor force, and of the controller,
    docs/feed-axis.md (2). An eigenvalue z is a motion exp(s t) with s = ln(z) / T_s. No encoder
    counts, no force limit, no dead band.
    """
    z = np.linalg.eigvals(_from_sample_to_sample(axis)).astype(complex)
    # An eigenvalue that is real or 0 is no oscillation.
    s = np.log(z[z.imag > 0.0]) / axis.T_s
    modes = [Mode(float(-each.real / abs(each)), float(abs(each))) for each in s]
    return min(modes, default=Mode(math.inf, 0.0))


def _from_sample_to_sample(axis: Axis) -> Matrix:
    free, by_force = _under_held_force(axis)
    wanted = np.zeros(6)
    wanted[_X if axis.on_table else _X_MOTOR] = -axis.K_v
    wanted[_X_MOTOR] -= 1.0 / axis.T_s
    wanted[_LAST] += 1.0 / axis.T_s
    growth = axis.K_p * axis.T_s / axis.T_n * wanted if axis.T_n else np.zeros(6)
    integral = np.eye(6)[_INTEGRAL] + growth
    step = np.zeros((6, 6))
    step[:4, :4] = free
    step[:4] += np.outer(by_force, axis.K_p * wanted + integral)
    step[_INTEGRAL] = integral
    step[_LAST, _X_MOTOR] = 1.0
    return step


def _under_held_force(axis: Axis) -> tuple[Matrix, Matrix]:
    """Return what a sample makes of the motion, and of a motor force of 1 N."""
    rates = np.zeros((5, 5))
    rates[_X_MOTOR, _V_MOTOR] = rates[_X, _X_DOT] = 1.0
    rates[_V_MOTOR] = np.array([-axis.k, -axis.d, axis.k, 0.0, 1.0]) / axis.m_d
    rates[_X_DOT] = np.array([axis.k, 0.0, -axis.k, -axis.c, 0.0]) / axis.m
    solved = expm(rates * axis.T_s)
    return solved[:4, :4], solved[:4, _FORCE]
