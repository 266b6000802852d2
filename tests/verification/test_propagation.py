"""The linear motion over a step, against a matrix exponential and against the exact motion."""

import math
from pathlib import Path

import mpmath
import numpy as np
import pytest

from stickslip_verification import truth
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.judge.metrics import Course
from stickslip_verification.judge.metrics.propagation import Slips, State, Wide, slips, state
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.experiment import CommunicationStep

ZETAS = (0.0, 0.3, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 50.0)
TURNS = (1e-9, 1e-3, 0.1, 1.0, 7.0, 40.0)
"""Lengths of a step in radians of the undamped motion."""

SCALE = 1e-15
"""Five units in the last place of a double: a residual of 1e-14 then shows nothing of it."""

M, K, V, DRIVE = 1.0, 1000.0, 0.02, -2.943
Z, X_DOT = 0.0049, 0.013


def wide(*values: float) -> Wide:
    """Return numbers in the widest floating-point format."""
    return np.array(values, np.longdouble)


def equation(zeta: float, count: int = 1) -> Slips:
    """Return the equation of slip of a damping ratio, for so many steps."""
    c = 2.0 * zeta * math.sqrt(M * K)
    return Slips(*(wide(*[value] * count) for value in (M, K, c, V, DRIVE)))


def reach(zeta: float) -> float:
    """Return the largest length in play [m]: the balance is far off where damping is strong."""
    w = math.sqrt(K / M)
    return max(abs(Z), abs(X_DOT) / w, (2.0 * zeta * w * M * V - DRIVE) / K)


def number(value: np.longdouble) -> mpmath.mpf:
    """Return a number of the widest format as it is."""
    high = float(value)
    return mpmath.mpf(high) + mpmath.mpf(float(value - np.longdouble(high)))


def exponential(zeta: float, duration: float) -> tuple[mpmath.mpf, mpmath.mpf]:
    """Return z and x_dot after a step by the matrix exponential of (z, x_dot, 1), to 50 digits."""
    c = 2.0 * zeta * math.sqrt(M * K)
    rates = mpmath.matrix(
        [
            [0, -1, mpmath.mpf(V)],
            [mpmath.mpf(K) / M, -mpmath.mpf(c) / M, mpmath.mpf(DRIVE) / M],
            [0, 0, 0],
        ]
    )
    end = mpmath.expm(rates * mpmath.mpf(duration)) * mpmath.matrix([Z, X_DOT, 1])
    return end[0], end[1]


@pytest.mark.parametrize("zeta", ZETAS)
def test_a_step_is_a_matrix_exponential(zeta: float) -> None:
    """At any damping, the critical one and a hair beside it, a step is right to its last digit."""
    durations = [turn / math.sqrt(K / M) for turn in TURNS]
    start = State(wide(*[Z] * len(TURNS)), wide(*[X_DOT] * len(TURNS)))
    moved = equation(zeta, len(TURNS)).move(start, wide(*durations))
    w, length = math.sqrt(K / M), reach(zeta)
    with mpmath.workdps(50):
        for n, duration in enumerate(durations):
            z, x_dot = exponential(zeta, duration)
            assert abs(number(moved.z[n]) - z) <= SCALE * length
            assert abs(number(moved.x_dot[n]) - x_dot) <= SCALE * w * length


@pytest.mark.parametrize("zeta", ZETAS)
def test_a_step_in_slip_is_that_of_the_exact_motion(zeta: float) -> None:
    """The step agrees with the closed form that the truth is made of, which knows no matrix."""
    c = 2.0 * zeta * math.sqrt(K)
    # Pulled on with 200 N, it does not stop within these steps at any damping.
    values = {"c": c, "x_dot_start": 2.0, "z_start": 0.003, "F_ext": 200.0}
    lengths = (1e-3, 4e-3, 0.011)
    case = Case(
        "slips",
        "",
        "",
        values,
        tuple(CommunicationStep(h, {}) for h in lengths),
        (),
        Path("s.toml"),
    )
    exact = exact_motion(case)
    assert not exact.event_times
    course = Course(case, exact.record, exact.record, np.array([]))
    chosen = np.ones(len(lengths), np.bool_)
    moved = slips(course, chosen, np.ones(len(lengths))).move(state(course, chosen), wide(*lengths))
    samples = truth.run(values, [truth.Step(h) for h in lengths]).samples
    w = math.sqrt(K)
    # Each step starts from samples that were rounded to a double.
    for n, sample in enumerate(samples):
        assert abs(float(moved.z[n] - np.longdouble(float(sample["z"])))) <= SCALE * 2.0 / w
        assert abs(float(moved.x_dot[n] - np.longdouble(float(sample["x_dot"])))) <= SCALE * 2.0


@pytest.mark.parametrize("zeta", ZETAS)
def test_two_steps_are_one_step_of_both_lengths(zeta: float) -> None:
    """Motion for a time and then for another is motion for their sum."""
    start = State(wide(Z, Z), wide(X_DOT, -X_DOT))
    first, second = wide(0.0123, 1e-4), wide(0.2, 0.0004)
    slip = equation(zeta, 2)
    once = slip.move(start, first + second)
    twice = slip.move(slip.move(start, first), second)
    w, length = math.sqrt(K / M), reach(zeta)
    # Squaring doubles the rounding of the widest format each time: some thousand of its units.
    rounding = 4096.0 * float(np.finfo(np.longdouble).eps)
    assert np.max(np.abs(once.z - twice.z)) <= rounding * length
    assert np.max(np.abs(once.x_dot - twice.x_dot)) <= rounding * w * length


def test_steps_of_all_lengths_go_together() -> None:
    """A step of a microsecond beside one of a minute is the step it is alone."""
    together = equation(0.01, 2).move(State(wide(Z, Z), wide(X_DOT, X_DOT)), wide(1e-6, 60.0))
    alone = equation(0.01).move(State(wide(Z), wide(X_DOT)), wide(1e-6))
    assert abs(float(together.z[0] - alone.z[0])) <= SCALE * Z
    assert abs(float(together.x_dot[0] - alone.x_dot[0])) <= SCALE * Z * math.sqrt(K)


def test_no_time_moves_nothing() -> None:
    """A step of no length keeps the state, and no steps give no states."""
    kept = equation(0.3).move(State(wide(Z), wide(X_DOT)), wide(0.0))
    assert abs(float(kept.z[0]) - Z) <= SCALE * Z
    assert abs(float(kept.x_dot[0]) - X_DOT) <= SCALE * X_DOT
    assert equation(0.3, 0).move(State(wide(), wide()), wide()).z.size == 0


@pytest.mark.parametrize("zeta", ZETAS)
def test_acceleration_and_jerk_are_the_rates_of_the_motion(zeta: float) -> None:
    """The equation of motion gives the slope of the velocity, and its slope the jerk."""
    slip, start = equation(zeta), State(wide(Z), wide(X_DOT))
    short = wide(1e-5) / (1.0 + zeta) / np.sqrt(slip.k / slip.m)
    before, after = slip.move(start, -short), slip.move(start, short)
    slope = (after.x_dot - before.x_dot) / (2.0 * short)
    bend = (slip.acceleration(after) - slip.acceleration(before)) / (2.0 * short)
    # A central difference is off by the square of its length, 1e-10, and some.
    assert float(slope[0]) == pytest.approx(float(slip.acceleration(start)[0]), rel=1e-8)
    assert float(bend[0]) == pytest.approx(float(slip.jerk(start)[0]), rel=1e-8)
