"""The oscillator's two responses against high precision."""

import random

import mpmath
import pytest

from stickslip_fmu.oscillator import Oscillator

CONTEXT = mpmath.mp.clone()
CONTEXT.dps = 60


def exact_responses(zeta: float, tau: float) -> tuple[float, float]:
    """Return G and K for w = 1."""
    a, t = CONTEXT.mpf(zeta), CONTEXT.mpf(tau)
    b = CONTEXT.sqrt(CONTEXT.mpc(1 - a * a))
    impulse = CONTEXT.exp(-a * t) * (CONTEXT.sin(b * t) / b if b else t)
    step = 1 - CONTEXT.exp(-a * t) * CONTEXT.cos(b * t) - a * impulse
    return float(step.real), float(impulse.real)


def test_step_response_keeps_its_digits_while_it_is_small() -> None:
    """Up to tau w = 1 the step response is right to 1e-13 relative at any damping.

    The closed form loses 2/(0.25)^2 ulp, about 32, at the end of the power series' range.
    """
    generator = random.Random(3)
    for zeta in [0.0, 1.0, 2.0, *(10.0 ** generator.uniform(-6.0, 3.0) for _ in range(500))]:
        tau = 10.0 ** generator.uniform(-9.0, 0.0)
        step, impulse = Oscillator(1.0, 1.0, 2.0 * zeta).responses(tau)
        expected = exact_responses(zeta, tau)
        assert step == pytest.approx(expected[0], rel=1e-13)
        assert impulse == pytest.approx(expected[1], rel=1e-13)


def test_responses_are_right_for_long() -> None:
    """Up to tau w = 100 both are right within rounding of the phase, 100 ulp of their scale."""
    generator = random.Random(4)
    near_critical = [1.0 + generator.uniform(-1e-6, 1e-6) for _ in range(50)]
    for zeta in [*near_critical, *(10.0 ** generator.uniform(-6.0, 3.0) for _ in range(500))]:
        tau = 10.0 ** generator.uniform(0.0, 2.0)
        step, impulse = Oscillator(1.0, 1.0, 2.0 * zeta).responses(tau)
        expected = exact_responses(zeta, tau)
        assert step == pytest.approx(expected[0], abs=100 * 2.0**-52)
        assert impulse == pytest.approx(expected[1], abs=100 * 2.0**-52)
