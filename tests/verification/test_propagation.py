"""The linear motion over a step: a matrix exponential to the last digit."""

import math

import mpmath
import numpy as np
import pytest

from stickslip_verification.judge.course import Slips, State

ZETAS = (0.0, 0.3, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 50.0)
TURNS = (0.0, 1e-9, 1e-3, 0.1, 1.0, 7.0, 40.0)
"""Lengths of a step in radians of the undamped motion."""

SCALE = 1e-15
"""Five units in the last place of a double: a residual of 1e-14 then shows nothing of it."""

M, K, V, DRIVE = 1.0, 1000.0, 0.02, -2.943
Z, X_DOT = 0.0049, 0.013
W = math.sqrt(K / M)


def number(value: np.longdouble) -> mpmath.mpf:
    return mpmath.mpf(float(value)) + mpmath.mpf(float(value - np.longdouble(float(value))))


@pytest.mark.parametrize("zeta", ZETAS)
def test_a_step_is_a_matrix_exponential(zeta: float) -> None:
    durations = np.array([turn / W for turn in TURNS], np.longdouble)
    one = np.ones_like(durations)
    equation = Slips(M * one, K * one, 2.0 * zeta * W * M * one, V * one, DRIVE * one)
    found = equation.move(State(Z * one, X_DOT * one), durations)
    # The balance is far off where damping is strong.
    reach = max(Z, X_DOT / W, (2.0 * zeta * W * M * V - DRIVE) / K)
    with mpmath.workdps(50):
        c = mpmath.mpf(2.0 * zeta * W * M)
        rates = mpmath.matrix([[0, -1, V], [mpmath.mpf(K) / M, -c / M, DRIVE / M], [0, 0, 0]])
        for n, duration in enumerate(map(number, durations)):
            end = mpmath.expm(rates * duration) * mpmath.matrix([Z, X_DOT, 1])
            assert abs(number(found.z[n]) - end[0]) <= SCALE * reach
            assert abs(number(found.x_dot[n]) - end[1]) <= SCALE * W * reach
    # The rates of the motion, by a difference that is off by the square of its length and some.
    short = np.longdouble(1e-5 / (1.0 + zeta) / W)
    before, after = (equation.move(found, sign * short * one) for sign in (-1.0, 1.0))
    slope = (after.x_dot - before.x_dot) / (2.0 * short)
    bend = (equation.acceleration(after) - equation.acceleration(before)) / (2.0 * short)
    for rate, difference in ((equation.acceleration, slope), (equation.jerk, bend)):
        assert float(rate(found)[0]) == pytest.approx(float(difference[0]), rel=1e-8)
