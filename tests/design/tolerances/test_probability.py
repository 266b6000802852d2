"""Intervals of probabilities and quantiles hold the truth as often as they say."""

import numpy as np
import pytest
from scipy.stats import beta, binom, binomtest

from stickslip_design.tolerances.probability import interval, probability, ranks


@pytest.mark.parametrize("count", [200, 2000])
@pytest.mark.parametrize(("low", "high"), [(5.0, 50.0), (50.0, 100.0)])
def test_interval_holds_the_probability_in_95_percent(count: int, low: float, high: float) -> None:
    """Summed over all counts, in the mean over probabilities of `low` to `high` events."""
    hits = np.arange(count + 1, dtype=np.float64)
    ends = interval(hits, np.full(count + 1, float(count)))
    truths = np.linspace(low, high, 400) / count
    held = [binom.pmf(hits, count, p)[(ends[0] <= p) & (p <= ends[1])].sum() for p in truths]
    assert 0.94 < np.mean(held) < 0.96


def test_interval_is_that_of_wilson() -> None:
    """SciPy has the same, also at none and at all."""
    for hits in (0, 3, 50, 100):
        expected = binomtest(hits, 100).proportion_ci(method="wilson")
        assert probability(hits, 100)[1:] == pytest.approx(tuple(expected), abs=1e-15)


@pytest.mark.parametrize(("count", "share"), [(1000, 0.99), (5000, 0.9), (300, 0.5)])
def test_bounds_of_a_quantile_hold_it_in_at_least_95_percent(count: int, share: float) -> None:
    """The n-th of the values in order lies below the quantile with a binomial probability."""
    low, value, high = ranks(count, share)
    assert low < value < high
    # The place of the n-th of uniform values is a beta variable.
    missed = beta.sf(share, low, count + 1 - low) + beta.cdf(share, high, count + 1 - high)
    # Whole places: 10 of 1,000 machines leave a per cent too much at each end.
    assert 0.95 <= 1.0 - missed < 0.98


def test_small_sample_has_no_upper_bound() -> None:
    """A hundred machines do not bound the quantile of 99 % from above."""
    assert ranks(100, 0.99)[2] == 101
