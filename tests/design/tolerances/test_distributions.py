"""Distributions as people write them, against those of SciPy."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

from stickslip_design.axis import AxisError
from stickslip_design.tolerances.distributions import Distribution, range_of, varying

from .series import series

SHARES = np.array([1e-6, 0.01, 0.3, 0.5, 0.75, 0.999, 1.0 - 1e-6])


def of(path: str, text: str) -> Distribution:
    """Return the distribution of one number of the series."""
    return varying(series(), {path: text})[path]


@pytest.mark.parametrize(
    ("path", "text", "expected"),
    [
        ("friction.mu_s", "normal 0.2 0.02", stats.norm(0.2, 0.02)),
        ("friction.mu_s", "normal 0.2 10 %", stats.norm(0.2, 0.02)),
        ("friction.mu_s", "normal 20 % 2 %", stats.norm(0.2, 0.02)),
        ("axis.mass", "normal 500 kg 20 kg", stats.norm(500.0, 20.0)),
        ("axis.mass", "normal 500 20 kg", stats.norm(500.0, 20.0)),
        ("axis.mass", "normal 0.5 t 4 %", stats.norm(500.0, 20.0)),
        ("axis.stiffness", "lognormal 40 N/um 10 %", stats.lognorm(0.1, scale=4e7)),
        ("axis.stiffness", "lognormal 40 N/um 4 N/um", stats.lognorm(0.1, scale=4e7)),
        ("axis.mass", "uniform 450..550 kg", stats.uniform(450.0, 100.0)),
        ("axis.mass", "uniform 450 kg 0.55 t", stats.uniform(450.0, 100.0)),
        ("axis.zeta", "triangular 1 2 5 %", stats.triang(0.25, 0.01, 0.04)),
        ("axis.mass", "± 10 %", stats.uniform(450.0, 100.0)),
        ("axis.mass", "600 kg +/- 60 kg", stats.uniform(540.0, 120.0)),
    ],
)
def test_distribution_is_the_one_that_is_written(
    path: str, text: str, expected: stats.rv_continuous
) -> None:
    """Its quantiles are those of SciPy's distribution of the name, in the unit of the file."""
    # ndtri and SciPy's quantiles are good to some ulp.
    assert_allclose(of(path, text).values(SHARES), expected.ppf(SHARES), rtol=1e-12)


def test_spread_of_the_file_is_uniform_or_two_sigma() -> None:
    """A ± of 10 % is any value within it alike, or a normal with a deviation of 5 %."""
    file = series(mu_s='"0.2 ± 10 %"')
    uniform = varying(file, {})["friction.mu_s"]
    assert uniform.kind == "uniform"
    assert uniform.numbers == pytest.approx((0.18, 0.22), rel=1e-15)
    normal = varying(file, {}, "normal")["friction.mu_s"]
    assert normal.kind == "normal"
    assert normal.numbers == pytest.approx((0.2, 0.01), rel=1e-15)


def test_what_is_said_comes_before_the_spread_of_the_file() -> None:
    """A distribution takes the place of a ±, and "fixed" takes it away."""
    file = series(mu_s='"0.2 ± 10 %"', mu_k='"0.15 ± 10 %"')
    found = varying(file, {"friction.mu_s": "uniform 0.1..0.2", "friction.mu_k": "fixed"})
    assert found == {"friction.mu_s": Distribution("uniform", (0.1, 0.2))}


def test_normal_distribution_ends_at_the_range_of_its_number() -> None:
    """Beyond the range is cut off, and the rest is the conditional distribution."""
    found = of("friction.mu_k", "normal 0.15 0.1")
    expected = stats.truncnorm(-1.5, math.inf, 0.15, 0.1)
    assert_allclose(found.values(SHARES), expected.ppf(SHARES), rtol=1e-9)
    assert found.cut == pytest.approx(stats.norm.cdf(-1.5), rel=1e-12)


@pytest.mark.parametrize(
    ("path", "text", "message"),
    [
        ("friction.mus", "normal 0.2 0.02", r"friction\.mus is no number.*friction\.mu_s"),
        ("axis.load", "± 10 %", "axis.load is no number that the file states"),
        ("demand.feeds[1]", "± 10 %", "is asked of the axis and does not vary"),
        ("friction.mu_s", "gauss 0.2 0.02", 'is no distribution; expected "normal MEAN SIGMA"'),
        ("friction.mu_s", "normal 0.2", "has 1 numbers in place of 2"),
        ("friction.mu_s", "normal 0.2 0", "has a standard deviation that is not above 0"),
        ("friction.mu_s", "normal 0.2 -0.1", "has a standard deviation that is not above 0"),
        ("friction.mu_s", "normal nan 0.1", "has 1 numbers in place of 2|not a finite number"),
        ("friction.mu_s", "normal 0.2 nan", "not a finite number|numbers in place of 2"),
        ("friction.mu_s", "lognormal -0.2 0.1", "has a median that is not above 0"),
        ("friction.mu_s", "uniform 0.3..0.2", "is empty or reversed"),
        ("friction.mu_s", "uniform 0.2..0.2", "is empty or reversed"),
        ("friction.mu_s", "triangular 0.1 0.3 0.2", "is empty or reversed"),
        ("friction.mu_s", "± 0 %", "has a ± that is not above 0"),
        ("friction.mu_s", "normal 0.2 0.5", "34 % of its distribution out of range"),
        ("axis.mass", "uniform -1..5 kg", "axis.mass = -1 kg is out of range"),
        ("axis.mass", "uniform 400..500 N", "is a force"),
        ("axis.mass", "uniform 400..500", "has no unit"),
        ("axis.mass", "fixed", "nothing varies: no number of the file has a ±"),
    ],
)
def test_what_is_no_distribution_is_refused_in_one_line(path: str, text: str, message: str) -> None:
    """The message names the number, what was written and what is expected."""
    with pytest.raises(AxisError, match=message) as caught:
        varying(series(), {path: text})
    assert "\n" not in str(caught.value)


def test_range_is_read_with_its_unit() -> None:
    """A range to look within is in the unit of the file."""
    assert range_of(series(), "axis.stiffness", "36..44 N/um") == (3.6e7, 4.4e7)
    with pytest.raises(AxisError, match="reversed"):
        range_of(series(), "axis.stiffness", "44..36 N/um")
