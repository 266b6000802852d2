"""Probabilities and quantiles out of a sample, each with its interval of confidence of 95 %."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import binom

Floats = NDArray[np.float64]

CONFIDENCE: Final = 0.95
"""Share of the samples whose interval holds the truth."""
_TAIL: Final = 0.5 * (1.0 - CONFIDENCE)


class Probability(NamedTuple):
    """A probability that was counted, and its interval [-]."""

    value: float
    low: float
    high: float


def probability(hits: int, count: int) -> Probability:
    """Return a probability from how often something happened in so many independent samples."""
    low, high = interval(np.array(float(hits)), np.array(float(count)))
    return Probability(hits / count, float(low), float(high))


def interval(hits: Floats, count: Floats) -> tuple[Floats, Floats]:
    """Return the ends of the intervals of probabilities, arrays of one shape.

    Notes
    -----
    Wilson's score interval: J. Am. Stat. Assoc. 22 (1927) 209, doi:10.1080/01621459.1927.10502953.
    Over all probabilities it holds the truth in 95.0 to 95.7 % of samples, also of rare events,
    where the exact interval of Clopper and Pearson does so in more than 97 %.
    """
    z = float(ndtri(1.0 - _TAIL))
    share = hits / count
    scale = 1.0 + z * z / count
    middle = (share + 0.5 * z * z / count) / scale
    half = z / scale * np.sqrt(share * (1.0 - share) / count + 0.25 * z * z / (count * count))
    # At the ends middle and half are the same number, but for rounding.
    low = np.where(hits == 0.0, 0.0, middle - half)
    high = np.where(hits == count, 1.0, middle + half)
    return low, high


def ranks(count: int, share: float) -> tuple[int, int, int]:
    """Return which of the values of a sample in order is a quantile, and which bound it.

    Parameters
    ----------
    count
        How many values there are.
    share
        Of the quantile [-].

    Returns
    -------
    tuple
        From 1: of the lower bound, the value, the upper bound. 0 or count + 1 where the sample is
        too small for the bound. Order statistics of a binomial count: David and Nagaraja, Order
        Statistics, 2003, section 7.1.
    """
    value = min(max(math.ceil(share * count - 1e-9), 1), count)
    low, high = binom.ppf([_TAIL, 1.0 - _TAIL], count, share)
    return int(low), value, int(high) + 1
