"""What a residual says: its memory, and how surely least squares know their numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
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
_OF_RUN: Final = 3
"""Least number of blocks of an unbroken run."""
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
    lags = max(2, int(_LAGS * max(run.size for run in runs)))
    power, products, pairs = 0.0, np.zeros(lags), np.zeros(lags)
    for run in runs:
        reach = min(lags, run.size - 1)
        power += float(run @ run)
        products[:reach] += correlate(run, run, "full")[run.size : run.size + reach]
        pairs[:reach] += run.size - 1.0 - np.arange(reach)
    if power == 0.0:
        return Memory(0, products)
    count = np.maximum(pairs, 1.0)
    correlation = products / count * sum(run.size for run in runs) / power
    seen = np.abs(correlation) * np.sqrt(count) > _SEEN
    quiet = ~(seen | np.append(seen[1:], False) | np.append(seen[2:], [False, False]))
    ends = np.flatnonzero(quiet)
    return Memory(int(ends[0]) if ends.size else lags, correlation)


class Estimate(NamedTuple):
    """Numbers by linear least squares, with their covariance as far as the residual tells it."""

    names: tuple[str, ...]
    value: Floats
    """Shape (p,)."""
    covariance: Floats
    """Shape (p, p)."""
    freedom: float
    """Degrees of freedom of the covariance."""
    fitted: Floats
    """Shape (n,)."""
    residual: Floats
    """Shape (n,)."""
    memory: Memory

    def number(self, name: str) -> float:
        """Return a number by its name."""
        return float(self.value[self.names.index(name)])

    def deviation(self, name: str, less: str = "") -> float:
        """Return the standard deviation of a number, or of its difference from another."""
        way = np.array([(each == name) - (each == less) for each in self.names], dtype=float)
        return math.sqrt(max(float(way @ self.covariance @ way), 0.0))

    def reach(self, name: str) -> float:
        """Return half the interval of 95 % of a number."""
        return float(student.ppf(0.5 + 0.5 * SURE, self.freedom)) * self.deviation(name)


def least_squares(
    columns: Mapping[str, Floats],
    y: Floats,
    run: Floats,
    noise: Mapping[str, float] | None = None,
    instruments: Mapping[str, Floats] | None = None,
    known: Mapping[str, float] | None = None,
) -> Estimate:
    """Return the numbers of columns, each shape (n,), whose sum is nearest to y.

    `run` counts the unbroken run to which a sample belongs. The covariance is that of white noise;
    where the residual has a memory that of leaving out one block after the other (jackknife), each
    longer than the memory. Noise in a column would draw its number to 0: `noise` are its
    variances, or `instruments` are what the columns would be without it, or nearly. `known` are
    standard deviations of numbers that are about 0, known before.
    """
    X = np.stack(list(columns.values()), axis=1)
    Z = np.stack([(instruments or {}).get(n, c) for n, c in columns.items()], axis=1)
    drawn = np.array([(noise or {}).get(name, 0.0) for name in columns])
    n, p = X.shape
    scale, size = (np.sqrt(np.sum(each * each, axis=0)) for each in (X, Z))
    scale[scale == 0.0] = size[size == 0.0] = 1.0
    X, Z = X / scale, Z / size
    before = np.zeros((p, p))
    if known:
        left = y - X @ np.linalg.lstsq(X, y, rcond=None)[0]
        share = float(left @ left) / n
        of = np.array([known.get(name, math.inf) for name in columns])
        # What is known before counts in the scale: else it would hide what the record tells weakly.
        more = np.hypot(1.0, math.sqrt(share) / (of * scale))
        X, Z, scale, size = X / more, Z / more, scale * more, size * more
        before = np.diag(share / (of * scale) ** 2)
    total = Z.T @ X - np.diag(n * drawn / scale**2) + before
    normal = np.linalg.pinv(total)
    value = normal @ (Z.T @ y)
    r = y - X @ value
    memory = memory_of(np.split(r, np.flatnonzero(np.diff(run)) + 1))
    if memory.samples:
        first, last = np.searchsorted(run, run), np.searchsorted(run, run, side="right")
        length = min(int(_OF_MEMORY * memory.samples), max(n // _BLOCKS, 1))
        # A block ends with its run, of which the others tell what it has told.
        lengths = np.minimum(length, -(-(last - first) // _OF_RUN))
        starts = np.flatnonzero((np.arange(n) - first) % lengths == 0)
        moves = []
        for begin, end in zip(starts, [*starts[1:], n], strict=True):
            part = Z[begin:end].T
            moves.append(np.linalg.pinv(total - part @ X[begin:end]) @ (part @ r[begin:end]))
        covariance, freedom = np.array(moves).T @ np.array(moves), max(len(moves) - p, 1)
    else:
        freedom = max(n - p, 1)
        covariance = normal @ (Z.T @ Z) @ normal.T * float(r @ r) / freedom
    covariance = covariance + normal @ before @ normal.T * float(r @ r) / n
    by, names = np.outer(scale, scale), tuple(columns)
    return Estimate(names, value / scale, covariance / by, freedom, X @ value, r, memory)
