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
_SEEN, _LAGS = 3.0, 0.2
"""Deviations of chance above which a correlation is seen; longest lag that is looked at, of a
residual's length."""
_BLOCKS, _OF_RUN, _OF_MEMORY = 12, 3, 4.0
"""Least number of blocks that tell a variance, and of an unbroken run; length of a block, over the
memory of the residual."""


class Memory(NamedTuple):
    """How long a residual knows itself, in samples: 0 if it is white; the correlation by lag."""

    samples: int
    correlation: Floats
    """From lag 1 on, shape (lags,)."""


def _memory_of(runs: Sequence[Floats]) -> Memory:
    """Return the memory of residuals, each shape (n,), of unbroken runs of even samples.

    It ends before the first three lags in a row in which the correlation is chance.
    """
    lags = max(2, int(_LAGS * max(run.size for run in runs)))
    power, products, pairs = 0.0, np.zeros(lags), np.zeros(lags)
    for run in runs:
        reach = min(lags, run.size - 1)
        power += float(run @ run)
        products[:reach] += correlate(run, run, "full")[run.size : run.size + reach]
        pairs[:reach] += run.size - 1.0 - np.arange(reach)
    count = np.maximum(pairs, 1.0)
    correlation = products / count * sum(run.size for run in runs) / max(power, 1e-300)
    seen = np.abs(correlation) * np.sqrt(count) > _SEEN
    quiet = np.convolve(seen, np.ones(3))[2:] == 0.0
    return Memory(int(np.argmax(np.append(quiet, True))), correlation)


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

    def sum(self, parts: Mapping[str, float]) -> tuple[float, float, float]:
        """Return a sum of numbers, each times a factor; its deviation, half its interval of 95 %.

        Parts of other names count as 0.
        """
        way = np.array([parts.get(name, 0.0) for name in self.names])
        deviation = math.sqrt(max(float(way @ self.covariance @ way), 0.0))
        reach = float(student.ppf(0.5 + 0.5 * SURE, self.freedom)) * deviation
        return float(way @ self.value), deviation, reach

    def number(self, name: str) -> tuple[float, float, float]:
        """Return a number by its name, its standard deviation, and half its interval of 95 %."""
        return self.sum({name: 1.0})


def least_squares(
    columns: Mapping[str, Floats],
    y: Floats,
    run: Floats,
    instruments: Mapping[str, Floats] | None = None,
    known: Mapping[str, float] | None = None,
) -> Estimate:
    """Return the numbers of columns, each shape (n,), whose sum is nearest to y.

    `run` counts the unbroken run to which a sample belongs. The covariance is that of white noise;
    where the residual has a memory, that of sums over blocks which are longer. Noise in a column
    would draw its number to 0: `instruments` are like columns whose noise is another. `known` are
    standard deviations of numbers that are about 0, known before.
    """
    X = np.stack(list(columns.values()), axis=1)
    Z = np.stack([(instruments or {}).get(n, c) for n, c in columns.items()], axis=1)
    n, p = X.shape
    size = np.maximum(np.linalg.norm(X, axis=0), 1e-300)
    left = y - X @ (np.linalg.lstsq(X / size, y, rcond=None)[0] / size)
    of = np.array([(known or {}).get(name, math.inf) for name in columns])
    before = np.diag(float(left @ left) / n / of**2)
    total = Z.T @ X + before
    scale = np.sqrt(np.maximum(np.abs(np.diag(total)), 1e-300))
    by = np.outer(scale, scale)
    normal = np.linalg.pinv(total / by) / by
    value = normal @ (Z.T @ y)
    r = y - X @ value
    runs = np.split(np.arange(n), np.flatnonzero(np.diff(run)) + 1)
    memory = _memory_of([r[part] for part in runs])
    if memory.samples:
        length = min(int(_OF_MEMORY * memory.samples), max(n // _BLOCKS, 1))
        # A block ends with its run, of which the others tell what it has told.
        parts = [np.array_split(part, max(_OF_RUN, part.size // length)) for part in runs]
        sums = np.array([Z[block].T @ r[block] for blocks in parts for block in blocks])
        freedom = max(len(sums) - p, 1)
        scatter = sums.T @ sums * len(sums) / freedom
    else:
        freedom = max(n - p, 1)
        scatter = Z.T @ Z * float(r @ r) / freedom
    covariance = normal @ (scatter + before * float(r @ r) / n) @ normal.T
    return Estimate(tuple(columns), value, covariance, freedom, X @ value, r, memory)
