"""The oscillator's two responses against high precision."""

import random

import mpmath
import pytest

from fmukit.model import ModelError
from stickslip_fmu.laws.coulomb.oscillator import Oscillator

CONTEXT = mpmath.mp.clone()
CONTEXT.dps = 60


def exact_responses(zeta: float, tau: float) -> tuple[float, float, float, float]:
    """Return G, K, the slope of K and the integral of G for w = 1."""
    a, t = CONTEXT.mpf(zeta), CONTEXT.mpf(tau)
    b = CONTEXT.sqrt(CONTEXT.mpc(1 - a * a))
    cosine = (CONTEXT.exp(-a * t) * CONTEXT.cos(b * t)).real
    impulse = (CONTEXT.exp(-a * t) * (CONTEXT.sin(b * t) / b if b else t)).real
    step = 1 - cosine - a * impulse
    integral = t - impulse - 2 * a * step
    return float(step), float(impulse), float(cosine - a * impulse), float(integral)


def responses(zeta: float, tau: float) -> tuple[float, float, float, float]:
    """Return what the block computes for the same."""
    oscillator = Oscillator(1.0, 1.0, 2.0 * zeta)
    step, impulse, slope = oscillator.responses(tau)
    return step, impulse, slope, oscillator.step_integral(tau, step, impulse)


def test_responses_keep_their_digits_while_they_are_small() -> None:
    """Up to tau w = 1 each is right to 1e-12 relative at any damping.

    The closed forms lose up to 2 zeta/(0.25)^2 ulp where the power series ends, and H, which is
    smaller by another factor, up to 1e-13; the slope of K has a zero of its own.
    """
    generator = random.Random(3)
    for zeta in [0.0, 1.0, 2.0, *(10.0 ** generator.uniform(-6.0, 6.0) for _ in range(800))]:
        tau = 10.0 ** generator.uniform(-9.0, 0.0)
        step, impulse, slope, integral = responses(zeta, tau)
        expected = exact_responses(zeta, tau)
        assert step == pytest.approx(expected[0], rel=1e-12)
        assert impulse == pytest.approx(expected[1], rel=1e-13)
        assert slope == pytest.approx(expected[2], rel=1e-13, abs=1e-14)
        assert integral == pytest.approx(expected[3], rel=1e-12)


def test_responses_are_right_for_long() -> None:
    """Up to tau w = 100 all are right within rounding of the phase, 100 ulp of their scale."""
    generator = random.Random(4)
    near_critical = [1.0 + generator.uniform(-1e-6, 1e-6) for _ in range(50)]
    for zeta in [*near_critical, *(10.0 ** generator.uniform(-6.0, 3.0) for _ in range(500))]:
        tau = 10.0 ** generator.uniform(0.0, 2.0)
        for got, expected in zip(responses(zeta, tau), exact_responses(zeta, tau), strict=True):
            assert got == pytest.approx(expected, abs=100 * 2.0**-52, rel=100 * 2.0**-52)


@pytest.mark.parametrize(
    ("k", "m", "c"), [(1e300, 1e-300, 0.0), (1e-300, 1e300, 0.0), (1.0, 1e-300, 1e300)]
)
def test_rates_out_of_range_are_refused(k: float, m: float, c: float) -> None:
    """Values whose rates are no double-precision numbers are refused by name."""
    with pytest.raises(ModelError, match=r"k = .* m = .* c = .* out of range together"):
        Oscillator(k, m, c)


def test_responses_of_a_growing_motion_are_right() -> None:
    """With a damping ratio down to -3 all are right to 1e-14 of what the motion has grown to."""
    generator = random.Random(5)
    near_critical = [-1.0 - generator.uniform(-1e-6, 1e-6) for _ in range(20)]
    for zeta in [-1.0, *near_critical, *(-generator.uniform(1e-6, 3.0) for _ in range(300))]:
        tau = 10.0 ** generator.uniform(-6.0, 0.8)
        expected = exact_responses(zeta, tau)
        # G, K and H of a short time are much smaller than 1, the slope of K is not.
        grown = max(1.0, *(abs(value) for value in expected))
        for got, right in zip(responses(zeta, tau), expected, strict=True):
            assert got == pytest.approx(right, abs=1e-14 * grown, rel=0.0)
