"""The oscillator's responses G, K, slope of K and integral of G against 60 digits."""

import random

import mpmath
import pytest

from fmukit.model import ModelError
from stickslip_fmu.laws.coulomb.oscillator import Oscillator

CONTEXT = mpmath.mp.clone()
CONTEXT.dps = 60


def exact(zeta: float, tau: float) -> tuple[float, ...]:
    a, t = CONTEXT.mpf(zeta), CONTEXT.mpf(tau)
    b = CONTEXT.sqrt(CONTEXT.mpc(1 - a * a))
    cosine = (CONTEXT.exp(-a * t) * CONTEXT.cos(b * t)).real
    impulse = (CONTEXT.exp(-a * t) * (CONTEXT.sin(b * t) / b if b else t)).real
    step = 1 - cosine - a * impulse
    integral = t - impulse - 2 * a * step
    return float(step), float(impulse), float(cosine - a * impulse), float(integral)


def computed(zeta: float, tau: float) -> tuple[float, ...]:
    oscillator = Oscillator(1.0, 1.0, 2.0 * zeta)
    step, impulse, slope = oscillator.responses(tau)
    return step, impulse, slope, oscillator.step_integral(tau, step, impulse)


def test_responses_keep_their_digits_while_they_are_small() -> None:
    chance = random.Random(3)
    for zeta in [0.0, 1.0, 2.0, *(10.0 ** chance.uniform(-6.0, 6.0) for _ in range(400))]:
        tau = 10.0 ** chance.uniform(-9.0, 0.0)
        # The closed forms lose up to 2 zeta/(0.25)^2 ulp where the power series ends, the integral
        # up to 1e-13; the slope has a zero of its own.
        tolerances = ((1e-12, 0.0), (1e-13, 0.0), (1e-13, 1e-14), (1e-12, 0.0))
        for got, right, (rel, small) in zip(
            computed(zeta, tau), exact(zeta, tau), tolerances, strict=True
        ):
            assert got == pytest.approx(right, rel=rel, abs=small)


def test_responses_are_right_for_long_within_rounding_of_the_phase() -> None:
    chance = random.Random(4)
    near_critical = [1.0 + chance.uniform(-1e-6, 1e-6) for _ in range(30)]
    for zeta in [*near_critical, *(10.0 ** chance.uniform(-6.0, 3.0) for _ in range(250))]:
        tau = 10.0 ** chance.uniform(0.0, 2.0)
        # Of a phase of 100 one rounding, 100 ulp of the scale.
        hundred_ulp = 100 * 2.0**-52
        expected = pytest.approx(exact(zeta, tau), abs=hundred_ulp, rel=hundred_ulp)
        assert computed(zeta, tau) == expected


def test_responses_of_a_growing_motion_are_right_to_what_it_has_grown_to() -> None:
    chance = random.Random(5)
    near_critical = [-1.0 - chance.uniform(-1e-6, 1e-6) for _ in range(20)]
    for zeta in [-1.0, *near_critical, *(-chance.uniform(1e-6, 3.0) for _ in range(200))]:
        tau = 10.0 ** chance.uniform(-6.0, 0.8)
        right = exact(zeta, tau)
        # A few dozen roundings of the largest.
        grown = max(1.0, *map(abs, right))
        assert computed(zeta, tau) == pytest.approx(right, abs=1e-14 * grown, rel=0.0)


@pytest.mark.parametrize(
    ("k", "m", "c"), [(1e300, 1e-300, 0.0), (1e-300, 1e300, 0.0), (1.0, 1e-300, 1e300)]
)
def test_rates_out_of_range_are_refused_by_name(k: float, m: float, c: float) -> None:
    with pytest.raises(ModelError, match=r"k = .* m = .* c = .* out of range together"):
        Oscillator(k, m, c)
