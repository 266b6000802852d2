"""Random numbers of machines: from seed and number alone, correlated as asked."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from scipy import stats
from scipy.special import ndtri

from stickslip_design.tolerances.sampling import correlated, factor_of, shares

NAMES = ("a", "b", "c")


def test_a_machine_depends_on_seed_and_its_number_alone() -> None:
    """The numbers of a range are those of the whole; another seed gives others."""
    whole = shares(7, 0, 1000, 5)
    assert_array_equal(shares(7, 312, 345, 5), whole[312:345])
    assert np.all((whole > 0.0) & (whole < 1.0))
    assert not np.any(shares(8, 0, 1000, 5) == whole)


def test_shares_are_uniform_and_independent() -> None:
    """By the tests of Kolmogorov and Spearman at one in a thousand each; the seed is fixed."""
    drawn = shares(1, 0, 20_000, 3)
    for column in drawn.T:
        assert stats.kstest(column, "uniform").pvalue > 1e-3
    assert stats.spearmanr(drawn[:, 0], drawn[:, 1]).pvalue > 1e-3
    assert stats.spearmanr(drawn[:-1, 0], drawn[1:, 0]).pvalue > 1e-3


@pytest.mark.parametrize("rho", [-1.0, -0.6, 0.3, 0.8, 1.0])
def test_normal_scores_have_the_correlation_asked_for(rho: float) -> None:
    """Each share stays uniform, and only the pair that was asked for is correlated."""
    count = 40_000
    found = correlated(shares(3, 0, count, 3), factor_of(NAMES, {("c", "a"): rho}))
    scores = np.corrcoef(ndtri(found).T)
    # Standard error of a correlation: (1 - rho^2)/sqrt(n); four of them, and rounding.
    assert scores[0, 2] == pytest.approx(rho, abs=4.0 * (1.0 - rho * rho) / count**0.5 + 1e-9)
    assert abs(scores[0, 1]) < 4.0 / count**0.5
    assert abs(scores[1, 2]) < 4.0 / count**0.5
    for column in found.T:
        assert stats.kstest(column, "uniform").pvalue > 1e-3


def test_factor_times_itself_is_the_matrix_of_correlations() -> None:
    """So with three pairs at once, also where the third is what the others leave."""
    pairs = {("a", "b"): 0.5, ("b", "c"): -0.3, ("a", "c"): 0.2}
    rows = factor_of(NAMES, pairs)
    L = np.array([[*row, *(0.0,) * (3 - len(row))] for row in rows])
    expected = np.array([[1.0, 0.5, 0.2], [0.5, 1.0, -0.3], [0.2, -0.3, 1.0]])
    np.testing.assert_allclose(L @ L.T, expected, atol=1e-15)
    same = {("a", "b"): 1.0, ("b", "c"): 1.0, ("a", "c"): 1.0}
    assert factor_of(NAMES, same) == ((1.0,), (1.0, 0.0), (1.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        ({("a", "b"): 1.01}, "is 1.01; it must be -1 to 1"),
        ({("a", "b"): float("nan")}, "is nan; it must be -1 to 1"),
        ({("a", "d"): 0.5}, "d does not vary"),
        ({("a", "a"): 0.5}, "a is correlated with itself"),
        ({("a", "b"): 0.9, ("b", "c"): 0.9, ("a", "c"): -0.9}, "exclude each other"),
        ({("a", "b"): 1.0, ("b", "c"): 1.0, ("a", "c"): 0.5}, "exclude each other"),
    ],
)
def test_correlations_that_cannot_be_are_refused(
    pairs: dict[tuple[str, str], float], message: str
) -> None:
    """Beyond 1, of what does not vary, or three that no numbers can have."""
    with pytest.raises(ValueError, match=message):
        factor_of(NAMES, pairs)
