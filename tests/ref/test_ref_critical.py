"""The edge of existence of the damped cycle."""

import math

import mpmath
import numpy as np
import pytest

from stickslip_ref import Parameters, coulomb_limit, critical_lambda

EPS = float(np.finfo(float).eps)


@pytest.mark.parametrize("zeta", [1e-12, 1e-8, 1e-4, 0.01, 0.1, 0.3, 0.5, 0.9, 0.99, 0.9999])
def test_critical_lambda_solves_its_equation(zeta: float) -> None:
    """lambda_c is the root of the grazing condition, for the lightest and heaviest damping."""
    got = float(critical_lambda(zeta))
    with mpmath.workdps(60):
        z = mpmath.mpf(zeta)
        nu = mpmath.sqrt(1 - z * z)

        def grazing(log_L: mpmath.mpf) -> mpmath.mpf:
            L = mpmath.exp(log_L)
            turn = 2 * mpmath.pi - mpmath.atan2(L * nu, 1 - z * L)
            return mpmath.log(1 - 2 * z * L + L * L) - 2 * z / nu * turn

        start = mpmath.log(mpmath.mpf(got))
        truth = mpmath.findroot(grazing, (start * (1 - 1e-9), start * (1 + 1e-9)), tol=1e-90)
        error = float(mpmath.mpf(got) / mpmath.exp(truth) - 1)
    # Solved in the logarithm, whose rounding error is relative to it; 1 - zeta^2 is conditioned
    # by 1 / (1 - zeta) only through zeta, which is exact.
    assert abs(error) < 8 * EPS * max(1.0, abs(math.log(got)))


def test_known_values_of_critical_lambda() -> None:
    """lambda_c is 0 without damping, 1667 at zeta = 0.9, 1e10 at 0.99, infinite from 1 on."""
    lambdas = critical_lambda(np.array([0.0, 0.9, 0.99, 1.0, 7.0]))
    np.testing.assert_allclose(lambdas, [0.0, 1667.0, 1.0e10, np.inf, np.inf], rtol=0.02)


def test_the_lightest_damping_is_the_limit_of_light_damping() -> None:
    """lambda_c is sqrt(4 pi zeta) below 1e-16, where its square leaves the range of floats too."""
    zeta = np.array([1e-17, 1e-19, 1e-21, 1e-100, 1e-300, 1e-315])
    # The last has eight digits.
    limit = math.sqrt(4.0 * math.pi) * np.sqrt(zeta)
    np.testing.assert_allclose(critical_lambda(zeta), limit, rtol=1e-8)


def test_enough_damping_ends_stick_slip_at_any_stiffness() -> None:
    """v_c c / Delta_F is at most 0.14721, at zeta = 0.1814; docs/theory.md, below (14)."""
    gap = (0.5 - 0.3) * 2.0 * 9.81
    k = np.geomspace(1e-2, 1e6, 40_001)
    p = Parameters(m=2.0, mu_s=0.5, mu_k=0.3, c=3.0, k=k)
    part = np.asarray(coulomb_limit(p)) * 3.0 / gap
    highest = int(np.argmax(part))
    # A grid of 5e-4 in ln k finds the top of a parabola to 1e-7 and its place to 3e-4.
    assert part[highest] == pytest.approx(0.1472112, abs=2e-7)
    assert np.asarray(p.zeta)[highest] == pytest.approx(0.1814, abs=1e-4)


def test_critical_lambda_grows_with_damping() -> None:
    """More damping takes a larger gap to stick."""
    zeta = np.concatenate([np.logspace(-12, -1, 200), np.linspace(0.11, 0.9999, 200)])
    assert np.all(np.diff(critical_lambda(zeta)) > 0.0)


@pytest.mark.parametrize(("zeta", "excess"), [(0.01, 0.03), (0.1, 0.31)])
def test_the_familiar_formula_is_a_first_order(zeta: float, excess: float) -> None:
    """Delta_F / sqrt(4 pi zeta k m) is 3 % high at zeta = 0.01 and 31 % at 0.1."""
    p = Parameters(c=2.0 * math.sqrt(1000.0) * zeta)
    familiar = 0.2 * 9.81 / math.sqrt(4.0 * math.pi * zeta * 1000.0)
    assert familiar / coulomb_limit(p) - 1.0 == pytest.approx(excess, abs=5e-3)


def test_critical_velocity_at_the_limits() -> None:
    """Undamped stick-slip knows no critical velocity; over-damped or without a gap it is zero."""
    c = np.array([0.0, 1.0, 2.0 * math.sqrt(1000.0), 1e4])
    v_c = np.asarray(coulomb_limit(Parameters(c=c)))
    assert v_c[0] == np.inf
    assert 0.0 < v_c[1] < np.inf
    # w is rounded, so the third stands at zeta = 1 only to rounding.
    assert v_c[2] < 1e-300
    assert v_c[3] == 0.0
    assert coulomb_limit(Parameters(c=1.0, mu_s=0.3)) == 0.0
    assert coulomb_limit(Parameters(mu_s=0.3)) == math.inf


def test_direction_and_a_constant_force_do_not_matter() -> None:
    """The critical velocity is a speed of the machine, not of how it is pulled."""
    at_all = {coulomb_limit(Parameters(c=1.0, v=v, F_ext=F)) for v in (-1, 0, 2) for F in (0, 9)}
    assert len(at_all) == 1


@pytest.mark.parametrize("zeta", [-0.1, math.nan, math.inf])
def test_bad_damping_ratios_are_refused(zeta: float) -> None:
    """A damping ratio that is negative or no number is refused by name and value."""
    with pytest.raises(ValueError, match=r"zeta = .* is out of range"):
        critical_lambda(zeta)
