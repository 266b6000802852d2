"""The linear motion over a step: a matrix exponential to the last digit."""

import math

import mpmath
import numpy as np
import pytest

from stickslip_verification.judge.metrics.propagation import Slips, State, Wide

ZETAS = (0.0, 0.3, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 50.0)
TURNS = (0.0, 1e-9, 1e-3, 0.1, 1.0, 7.0, 40.0)
"""Lengths of a step in radians of the undamped motion."""

SCALE = 1e-15
"""Five units in the last place of a double: a residual of 1e-14 then shows nothing of it."""

M, K, V, DRIVE = 1.0, 1000.0, 0.02, -2.943
Z, X_DOT = 0.0049, 0.013
W = math.sqrt(K / M)


def wide(*values: float) -> Wide:
    return np.array(values, np.longdouble)


def slips(zeta: float, count: int) -> tuple[Slips, State]:
    """Return the equation of slip of a damping ratio for so many steps, and a start of each."""
    ones = wide(*[1.0] * count)
    equation = Slips(*(value * ones for value in (M, K, 2.0 * zeta * W * M, V, DRIVE)))
    return equation, State(Z * ones, X_DOT * ones)


def moved(zeta: float, *durations: float) -> State:
    equation, start = slips(zeta, len(durations))
    return equation.move(start, wide(*durations))


def number(value: np.longdouble) -> mpmath.mpf:
    return mpmath.mpf(float(value)) + mpmath.mpf(float(value - np.longdouble(float(value))))


@pytest.mark.parametrize("zeta", ZETAS)
def test_a_step_is_a_matrix_exponential(zeta: float) -> None:
    durations = [turn / W for turn in TURNS]
    found = moved(zeta, *durations)
    # The balance is far off where damping is strong.
    reach = max(Z, X_DOT / W, (2.0 * zeta * W * M * V - DRIVE) / K)
    with mpmath.workdps(50):
        c = mpmath.mpf(2.0 * zeta * W * M)
        rates = mpmath.matrix([[0, -1, V], [mpmath.mpf(K) / M, -c / M, DRIVE / M], [0, 0, 0]])
        for n, duration in enumerate(durations):
            end = mpmath.expm(rates * mpmath.mpf(duration)) * mpmath.matrix([Z, X_DOT, 1])
            assert abs(number(found.z[n]) - end[0]) <= SCALE * reach
            assert abs(number(found.x_dot[n]) - end[1]) <= SCALE * W * reach


@pytest.mark.parametrize("zeta", ZETAS)
def test_acceleration_and_jerk_are_the_rates_of_the_motion(zeta: float) -> None:
    equation, start = slips(zeta, 1)
    short = 1e-5 / (1.0 + zeta) / W
    before, after = moved(zeta, -short), moved(zeta, short)
    slope = (after.x_dot - before.x_dot) / (2.0 * short)
    bend = (equation.acceleration(after) - equation.acceleration(before)) / (2.0 * short)
    # A central difference is off by the square of its length, 1e-10, and some.
    assert float(slope[0]) == pytest.approx(float(equation.acceleration(start)[0]), rel=1e-8)
    assert float(bend[0]) == pytest.approx(float(equation.jerk(start)[0]), rel=1e-8)


def test_no_steps_give_no_states() -> None:
    assert moved(0.3).z.size == 0
