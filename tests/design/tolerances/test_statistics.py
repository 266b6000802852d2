"""Random numbers of machines, intervals of what is counted, and Sobol indices."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import stats
from scipy.special import ndtri

from stickslip_design.tolerances.machines import correlated, factor_of, shares
from stickslip_design.tolerances.statistics import indices, interval, mixed, probability

NAMES = ("a", "b", "c")
ROWS = 4096


def test_a_machine_depends_on_seed_and_its_number_alone() -> None:
    sample = shares(7, 0, 1000, 5)
    assert_array_equal(shares(7, 312, 345, 5), sample[312:345])
    assert np.all((sample > 0.0) & (sample < 1.0))
    assert not np.any(shares(8, 0, 1000, 5) == sample)


@pytest.mark.parametrize("rho", [-1.0, 0.0, 0.8])
def test_shares_are_uniform_and_their_scores_have_the_correlation_asked_for(rho: float) -> None:
    count = 20_000
    found = correlated(shares(3, 0, count, 3), factor_of(NAMES, {("c", "a"): rho}))
    scores = np.corrcoef(ndtri(found).T)
    # Four standard errors of a correlation, (1 - rho^2)/sqrt(n), and rounding.
    assert scores[0, 2] == pytest.approx(rho, abs=4.0 * (1.0 - rho * rho) / count**0.5 + 1e-9)
    assert_allclose(scores[1, [0, 2]], 0.0, atol=4.0 / count**0.5)
    for column in found.T:
        # One in a thousand; the seed is fixed.
        assert stats.kstest(column, "uniform").pvalue > 1e-3
        assert stats.spearmanr(column[:-1], column[1:]).pvalue > 1e-3


@pytest.mark.parametrize(("low", "high"), [(5.0, 50.0), (50.0, 100.0)])
def test_an_interval_holds_the_probability_in_95_percent(low: float, high: float) -> None:
    count = 200
    hits = np.arange(count + 1, dtype=np.float64)
    ends = interval(hits, np.full(count + 1, float(count)))
    truths = np.linspace(low, high, 400) / count
    # Summed over all counts, in the mean over probabilities of `low` to `high` events.
    held = [stats.binom.pmf(hits, count, p)[(ends[0] <= p) & (p <= ends[1])].sum() for p in truths]
    assert 0.94 < np.mean(held) < 0.96
    for number in (0, 3, 100, 200):
        expected = stats.binomtest(number, count).proportion_ci(method="wilson")
        assert probability(number, count)[1:] == pytest.approx(tuple(expected), abs=1e-15)


def test_indices_of_the_function_of_ishigami_are_known() -> None:
    # sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, of uniform numbers in -pi to pi; Ishigami and Homma,
    # ISUMA 1990, doi:10.1109/ISUMA.1990.151285: the variances of its parts.
    a, b = 7.0, 0.1
    x = -math.pi + 2.0 * math.pi * mixed(1, ROWS, 3, 0, 5 * ROWS)
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
    for value, ends in ((found.first, found.first_range), (found.total, found.total_range)):
        assert np.all((ends[:, 0] < value) & (value < ends[:, 1]))


def test_a_number_that_varies_alone_carries_all_the_scatter() -> None:
    found = indices(np.arange(24.0), 8, 1)
    assert found is not None
    assert (found.first.tolist(), found.total.tolist()) == ([1.0], [1.0])
