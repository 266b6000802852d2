"""Random numbers of a sample: from the seed and its number alone, and correlated where asked.

The generator is Philox, which counts: Salmon, Moraes, Dror, Shaw, Parallel random numbers: as easy
as 1, 2, 3, SC'11, 2011, doi:10.1145/2063384.2063405. Correlated numbers are those of a Gaussian
copula: the correlation is that of the normal scores, which for normal distributions is Pearson's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

Floats = NDArray[np.float64]
Factor = tuple[tuple[float, ...], ...]
"""Rows of a lower triangular matrix."""

_WORDS: Final = 4
"""Random numbers of a count of Philox."""
_ROUNDING: Final = 1e-12
"""A matrix is taken as one of correlations if its factor misses 0 by no more than this."""
_HALF: Final = 2.0**-54
"""Half of the step between two shares: they are never 0 or 1."""


def shares(seed: int, start: int, stop: int, count: int) -> Floats:
    """Return the random shares of samples [-], above 0 and below 1.

    `count` of them for each sample from `start` up to `stop`; the seed is 0 to 2^128 - 1.
    """
    counts = -(-count // _WORDS)
    generator = np.random.Philox(key=seed)
    generator.advance(start * counts)
    drawn = np.random.Generator(generator).random((stop - start, counts * _WORDS))
    return drawn[:, :count] + _HALF


def factor_of(names: Sequence[str], correlation: Mapping[tuple[str, str], float]) -> Factor:
    """Return the lower triangular L of L L^T = R, the correlations of numbers.

    Parameters
    ----------
    names
        Names of the numbers that vary.
    correlation
        Correlations of pairs of them, -1 to 1 [-]; others are 0.

    Raises
    ------
    ValueError
        If a name does not vary, a correlation is out of range, or they exclude each other.
    """
    R = np.eye(len(names))
    for pair, value in correlation.items():
        for name in pair:
            if name not in names:
                near = get_close_matches(name, names, 3, 0.4) or list(names)
                raise ValueError(
                    f"{name} does not vary, and a correlation is of two numbers that do; "
                    f"nearest: {', '.join(near)}"
                )
        one, other = (list(names).index(name) for name in pair)
        if one == other:
            raise ValueError(f"{pair[0]} is correlated with itself; name two numbers")
        if not -1.0 <= value <= 1.0:
            raise ValueError(
                f"the correlation of {pair[0]} and {pair[1]} is {value:g}; it must be -1 to 1"
            )
        R[one, other] = R[other, one] = value
    L = np.zeros_like(R)
    for row in range(len(names)):
        for column in range(row + 1):
            rest = R[row, column] - math.fsum(L[row, :column] * L[column, :column])
            excluded = False
            if row == column:
                excluded = rest < -_ROUNDING
                L[row, row] = math.sqrt(max(rest, 0.0))
            elif L[column, column] > math.sqrt(_ROUNDING):
                L[row, column] = rest / L[column, column]
            else:
                excluded = abs(rest) > math.sqrt(_ROUNDING)
            if excluded:
                raise ValueError("the correlations exclude each other: no numbers have all of them")
    return tuple(tuple(map(float, row[: place + 1])) for place, row in enumerate(L))


def correlated(independent: Floats, factor: Factor) -> Floats:
    """Return shares with the correlations of a factor, from independent ones; of one shape.

    A share that is correlated with none before it stays as it is, to the bit.
    """
    if all(not any(row[:-1]) for row in factor):
        return independent
    scores = [np.ascontiguousarray(each) for each in ndtri(independent).T]
    found = independent.copy()
    for place, row in enumerate(factor):
        if any(row[:-1]):
            # Term by term, not as a product of matrices: its bits would depend on their size.
            total = np.zeros(len(independent))
            for weight, score in zip(row, scores, strict=False):
                if weight:
                    total = total + weight * score
            found[:, place] = np.clip(ndtr(total), _HALF, 1.0 - 2.0 * _HALF)
    return found
