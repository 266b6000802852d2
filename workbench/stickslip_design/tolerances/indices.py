"""Which number's scatter matters: Sobol indices of first and total order.

Estimators of Saltelli et al., Comput. Phys. Commun. 181 (2010) 259, doi:10.1016/j.cpc.2009.09.018,
by `scipy.stats.sobol_indices`. They split a variance between independent numbers: correlations of
the series are left out here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc, sobol_indices

from ..chunks import Columns
from .probability import CONFIDENCE
from .samples import Machines

Floats = NDArray[np.float64]

_RESAMPLES: Final = 200
"""Resamples of the rows, out of which the intervals come."""
_SHIFT, _RESAMPLING = 0, 1
"""What a seed is used for here."""


@dataclass(frozen=True)
class Indices:
    """Sobol indices of one result, arrays by the numbers that vary.

    Attributes
    ----------
    first, total
        Parts of the variance that a number makes alone, and alone and together with others [-].
    first_range, total_range
        Intervals of confidence of 95 %, shape (numbers, 2), by resampling the rows.
    """

    first: Floats
    total: Floats
    first_range: Floats
    total_range: Floats


@dataclass(frozen=True)
class Mixed(Machines):
    """The study of the machines that Sobol indices are made from; columns as of `Samples`.

    Attributes
    ----------
    population
        The machines; their correlations are left out.
    rows
        Rows of the samples A and B, a power of two. Point ``block * rows + row`` is of A, of B, or
        of A with one number of B.
    """

    feeds: tuple[float, ...]
    rows: int

    @property
    def count(self) -> int:
        """Points: rows times the numbers that vary and two."""
        return self.rows * (len(self.population.varied) + 2)

    def _block(self, start: int, stop: int) -> Columns:
        count = len(self.population.varied)
        drawn = mixed(self.population.seed, self.rows, count, start, stop)
        return self.population.answered(self.population.at(drawn), self.feeds)


def mixed(seed: int, rows: int, count: int, start: int, stop: int) -> Floats:
    """Return the shares of the points from `start` up to `stop`, as `Mixed` numbers them.

    Of `count` numbers that vary: (stop - start, count), above 0 and below 1 [-].
    """
    both = _rows(seed, rows, 2 * count)
    block, row = np.divmod(np.arange(start, stop), rows)
    of_B = (block == 1)[:, np.newaxis] | (block[:, np.newaxis] == np.arange(count) + 2)
    return np.where(of_B, both[row, count:], both[row, :count])


@lru_cache(maxsize=2)
def _rows(seed: int, rows: int, count: int) -> Floats:
    """Return a Sobol sequence, moved by a random way in each direction."""
    # Moved, not scrambled: the name of SciPy's argument for a generator depends on its version.
    sequence = qmc.Sobol(count, scramble=False).random_base2(rows.bit_length() - 1)
    moved = (sequence + _generator(seed, _SHIFT).random(count)) % 1.0
    return np.asarray(np.clip(moved, 2.0**-54, 1.0 - 2.0**-53))


def _generator(seed: int, use: int) -> np.random.Generator:
    # Far from the counts that draw the machines.
    return np.random.Generator(np.random.Philox(key=seed, counter=[0, 0, use, 1]))


def indices(values: Floats, rows: int, seed: int) -> Indices | None:
    """Return the Sobol indices of a result.

    Parameters
    ----------
    values
        The result at the points of `mixed`, in their order.
    rows
        Rows of A and of B.
    seed
        Of the resamples.

    Returns
    -------
    Indices or None
        None where the result is not finite at each point, or the same at all.
    """
    if not np.isfinite(values).all() or values.min() == values.max():
        return None
    parts = values.reshape(-1, rows)
    first, total = _estimated(parts)
    generator = _generator(seed, _RESAMPLING)
    again = [_estimated(parts[:, generator.integers(rows, size=rows)]) for _ in range(_RESAMPLES)]
    tail = 0.5 * (1.0 - CONFIDENCE)
    ranges = np.nanquantile(np.array(again), [tail, 1.0 - tail], axis=0)
    return Indices(first, total, ranges[:, 0].T, ranges[:, 1].T)


def _estimated(parts: Floats) -> tuple[Floats, Floats]:
    """Return the indices of first and total order from the results at A, B and each mixture."""
    if len(parts) == 3:
        # A number that varies alone carries all of it; SciPy fails there.
        return np.ones(1), np.ones(1)
    with np.errstate(invalid="ignore", divide="ignore"):
        found = sobol_indices(
            func={"f_A": parts[:1], "f_B": parts[1:2], "f_AB": parts[2:, np.newaxis]},
            n=parts.shape[1],
        )
    # Of one result SciPy leaves out the axis of results.
    return found.first_order.reshape(-1), found.total_order.reshape(-1)
