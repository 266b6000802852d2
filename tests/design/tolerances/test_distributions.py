"""Distributions as people write them, against those of SciPy."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

from stickslip_design.axis import AxisError
from stickslip_design.tolerances.machines import Distribution, varying
from tests.design.tolerances.series import series

SHARES = np.array([1e-6, 0.01, 0.3, 0.5, 0.75, 0.999, 1.0 - 1e-6])


@pytest.mark.parametrize(
    ("path", "text", "expected"),
    [
        ("friction.mu_s", "normal 0.2 10 %", stats.norm(0.2, 0.02)),
        ("axis.mass", "normal 0.5 t 4 %", stats.norm(500.0, 20.0)),
        ("axis.stiffness", "lognormal 40 N/um 10 %", stats.lognorm(0.1, scale=4e7)),
        ("axis.mass", "uniform 450 kg 0.55 t", stats.uniform(450.0, 100.0)),
        ("axis.zeta", "triangular 1 2 5 %", stats.triang(0.25, 0.01, 0.04)),
        ("axis.mass", "± 10 %", stats.uniform(450.0, 100.0)),
        # Cut off at the end of the range of its number.
        ("friction.mu_k", "normal 0.15 0.1", stats.truncnorm(-1.5, math.inf, 0.15, 0.1)),
    ],
)
def test_a_distribution_is_the_one_of_its_name_in_scipy(
    path: str, text: str, expected: stats.rv_continuous
) -> None:
    found = varying(series(), {path: text})[path]
    # SciPy's quantiles are good to some ulp, of a distribution that is cut to 1e-10.
    assert_allclose(found.values(SHARES), expected.ppf(SHARES), rtol=1e-9)


def test_a_spread_of_the_file_is_uniform_or_two_sigma_and_what_is_said_comes_before_it() -> None:
    file = series(mu_s='"0.2 ± 10 %"', mu_k='"0.15 ± 10 %"')
    for found, kind, numbers in (
        (varying(file, {}, "uniform"), "uniform", (0.18, 0.22)),
        (varying(file, {}, "normal"), "normal", (0.2, 0.01)),
    ):
        assert found["friction.mu_s"].kind == kind
        assert found["friction.mu_s"].numbers == pytest.approx(numbers, rel=1e-15)  # one rounding
    said = {"friction.mu_s": "uniform 0.1..0.2", "friction.mu_k": "fixed"}
    assert varying(file, said) == {"friction.mu_s": Distribution("uniform", (0.1, 0.2))}


@pytest.mark.parametrize(
    ("path", "text", "message"),
    [
        ("friction.mus", "normal 0.2 0.02", r"friction\.mus is no number.*friction\.mu_s"),
        ("demand.feeds[1]", "± 10 %", "is asked of the axis and does not vary"),
        ("friction.mu_s", "gauss 0.2 0.02", 'is no distribution; expected "normal MEAN SIGMA"'),
        ("friction.mu_s", "normal 0.2 0", "has a standard deviation that is not above 0"),
        ("friction.mu_s", "triangular 0.1 0.3 0.2", "is empty or reversed"),
        ("friction.mu_s", "normal 0.2 0.5", "34 % of its distribution out of range"),
        ("axis.mass", "uniform -1..5 kg", "axis.mass = -1 kg is out of range"),
        ("axis.mass", "uniform 400..500", "has no unit"),
        ("axis.mass", "fixed", "nothing varies: no number of the file has a ±"),
    ],
)
def test_what_is_no_distribution_is_refused_in_one_line(path: str, text: str, message: str) -> None:
    with pytest.raises(AxisError, match=message) as refused:
        varying(series(), {path: text})
    assert "\n" not in str(refused.value)
