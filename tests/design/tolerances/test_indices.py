"""Sobol indices, against functions whose indices are known."""

import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from numpy.typing import NDArray

from stickslip_design.tolerances.distributions import Distribution
from stickslip_design.tolerances.indices import Mixed, indices, mixed
from stickslip_design.tolerances.samples import Population

from .series import series

ROWS = 4096


def points(count: int, seed: int = 1) -> NDArray[np.float64]:
    """Return the shares of all points for so many numbers."""
    return mixed(seed, ROWS, count, 0, ROWS * (count + 2))


def test_indices_of_the_function_of_ishigami_are_found() -> None:
    """Of sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, of uniform numbers in -pi to pi.

    Ishigami and Homma, ISUMA 1990, doi:10.1109/ISUMA.1990.151285: the variances of its parts.
    """
    a, b = 7.0, 0.1
    x = -math.pi + 2.0 * math.pi * points(3)
    values = np.sin(x[:, 0]) + a * np.sin(x[:, 1]) ** 2 + b * x[:, 2] ** 4 * np.sin(x[:, 0])
    V1 = 0.5 * (1.0 + b * math.pi**4 / 5.0) ** 2
    V2 = a * a / 8.0
    V13 = b * b * math.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    V = V1 + V2 + V13
    found = indices(values, ROWS, 1)
    assert found is not None
    # Sampling: 4,096 rows of a Sobol sequence; 0.01 is twice what ten other seeds leave.
    assert found.first == pytest.approx([V1 / V, V2 / V, 0.0], abs=0.01)
    assert found.total == pytest.approx([(V1 + V13) / V, V2 / V, V13 / V], abs=0.01)
    for values_of, ends in ((found.first, found.first_range), (found.total, found.total_range)):
        assert np.all((ends[:, 0] < values_of) & (values_of < ends[:, 1]))


def test_indices_of_a_sum_are_the_parts_of_its_variance() -> None:
    """Of 1 x1 + 2 x2 + 3 x3 they are 1/14, 4/14 and 9/14, alone as in all."""
    found = indices(points(3) @ np.array([1.0, 2.0, 3.0]), ROWS, 1)
    assert found is not None
    expected = [1.0 / 14.0, 4.0 / 14.0, 9.0 / 14.0]
    assert found.first == pytest.approx(expected, abs=0.003)
    assert found.total == pytest.approx(expected, abs=0.003)


def test_critical_feed_scatters_with_the_coefficients_as_its_formula_says() -> None:
    """It is proportional to mu_s - mu_k: the parts are the squares of their deviations."""
    varied = {
        "friction.mu_s": Distribution("normal", (0.3, 0.01)),
        "friction.mu_k": Distribution("normal", (0.1, 0.02)),
    }
    study = Mixed(Population(series(), varied, {}, 5), (1e-3,), ROWS)
    found = indices(study.compute(0, study.count)["critical_feed"].astype(np.float64), ROWS, 5)
    assert found is not None
    assert found.first == pytest.approx([0.2, 0.8], abs=0.003)


def test_points_are_the_same_in_any_parts() -> None:
    """A point depends on its number; a row of A_B is that of A with one number of B."""
    whole = points(3)
    assert_array_equal(mixed(1, ROWS, 3, 5000, 13_000), whole[5000:13_000])
    A, B, A_B = (whole[block * ROWS : (block + 1) * ROWS] for block in (0, 1, 3))
    assert_array_equal(A_B[:, 1], B[:, 1])
    assert_array_equal(A_B[:, [0, 2]], A[:, [0, 2]])
    assert np.all((whole > 0.0) & (whole < 1.0))


@pytest.mark.parametrize("value", [0.0, math.inf, math.nan])
def test_what_has_no_variance_has_no_indices(value: float) -> None:
    """The same at all points, or not finite at one."""
    values = points(1)[:, 0].copy()
    values[-1 if value else slice(None)] = value
    assert indices(values, ROWS, 1) is None
