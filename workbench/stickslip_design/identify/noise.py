"""What a residual says: its memory, and how surely least squares know their numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from scipy.signal import correlate
from scipy.stats import t as student

from .model import Floats

SURE: Final = 0.95
"""Of the intervals."""
_SEEN: Final = 3.0
"""Deviations of chance above which a correlation is seen."""
_LAGS: Final = 0.2
"""Longest lag that is looked at, of a residual's length."""
_BLOCKS: Final = 12
"""Least number of blocks that tell a variance."""
_OF_MEMORY: Final = 4.0
"""Length of a block, over the memory of the residual."""


class Memory(NamedTuple):
    """How long a residual knows itself, in samples: 0 if it is white; the correlation by lag."""

    samples: int
    correlation: Floats
    """From lag 1 on, shape (lags,)."""


def memory_of(runs: Sequence[Floats]) -> Memory:
    """Return the memory of residuals, each shape (n,), of unbroken runs of even samples.

    The correlation is that of all runs together; its memory ends before the first three lags in a
    row in which it is chance.
    """
    longest = max(run.size for run in runs)
    lags = max(2, int(_LAGS * longest))
    power, products, pairs = 0.0, np.zeros(lags), np.zeros(lags)
    for run in runs:
        reach = min(lags, run.size - 1)
        power += float(run @ run)
        products[:reach] += correlate(run, run, "full")[run.size : run.size + reach]
        pairs[:reach] += run.size - 1.0 - np.arange(reach)
    count = sum(run.size for run in runs)
    if power == 0.0:
        return Memory(0, products)
    correlation = products / np.maximum(pairs, 1.0) * count / power
    seen = np.abs(correlation) * np.sqrt(np.maximum(pairs, 1.0)) > _SEEN
    quiet = ~(seen | np.append(seen[1:], False) | np.append(seen[2:], [False, False]))
    ends = np.flatnonzero(quiet)
    return Memory(int(ends[0]) if ends.size else lags, correlation)


class Estimate(NamedTuple):
    """Numbers by linear least squares, with their covariance as far as the residual tells it."""

    value: Floats
    """Shape (p,)."""
    covariance: Floats
    """Shape (p, p)."""
    freedom: float
    """Degrees of freedom of the covariance."""
    residual: Floats
    """Shape (n,)."""

    def deviation(self, direction: Floats) -> float:
        """Return the standard deviation of a combination of the numbers, shape (p,)."""
        return math.sqrt(max(float(direction @ self.covariance @ direction), 0.0))

    def reach(self, direction: Floats) -> float:
        """Return half the interval of 95 % of a combination of the numbers, shape (p,)."""
        return float(student.ppf(0.5 + 0.5 * SURE, self.freedom)) * self.deviation(direction)


def least_squares(
    X: Floats,
    y: Floats,
    run: Floats,
    memory: int = 0,
    drawn: Floats | float = 0.0,
) -> Estimate:
    """Return the numbers b for which X b is nearest to y, X of shape (n, p).

    `run` counts the unbroken run to which a sample belongs. With a memory [samples] the covariance
    is that of leaving out one block after the other (jackknife), longer than the memory; else that
    of white noise. `drawn` are the variances of the noise in the columns, shape (p,), which would
    draw their numbers to 0.
    """
    scale = np.sqrt(np.sum(X * X, axis=0))
    scale[scale == 0.0] = 1.0
    own = np.broadcast_to(drawn, X.shape[1:]) * len(X) / scale**2
    total = (X / scale).T @ (X / scale) - np.diag(own)
    normal = np.linalg.pinv(total, hermitian=True) / np.outer(scale, scale)
    value = normal @ (X.T @ y)
    r = y - X @ value
    n, p = X.shape
    if memory == 0:
        return Estimate(value, normal * float(r @ r) / max(n - p, 1), max(n - p, 1), r)
    length = min(max(int(_OF_MEMORY * memory), 1), max(n // _BLOCKS, 1))
    # A block ends with its run.
    place = np.arange(n) - np.searchsorted(run, run)
    starts = np.flatnonzero(place % length == 0)
    scaled = X / scale
    moves = []
    for begin, end in zip(starts, [*starts[1:], n], strict=True):
        part = scaled[begin:end]
        left_out = np.linalg.pinv(total - part.T @ part, hermitian=True)
        moves.append(left_out @ (part.T @ r[begin:end]) / scale)
    moved = np.array(moves)
    return Estimate(value, moved.T @ moved, max(len(moved) - p, 1), r)
