"""Axes drawn at random, and what each does: the study that the other rooms of scatter read.

Random numbers come from the seed and the number of the machine alone, by Philox, which counts:
Salmon, Moraes, Dror, Shaw, Parallel random numbers: as easy as 1, 2, 3, SC'11, 2011,
doi:10.1145/2063384.2063405. Correlated numbers are those of a Gaussian copula: the correlation is
that of the normal scores, which for normal distributions is Pearson's.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from difflib import get_close_matches
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from ..axis import AxisFile
from ..chunks import Columns
from ..points.axes import axis_points, check, has_closed_form
from ..points.columns import WITHOUT_FEED
from .distributions import Distribution

Floats = NDArray[np.float64]
Factor = tuple[tuple[float, ...], ...]
"""Rows of a lower triangular matrix."""

_WORDS: Final = 4
"""Random numbers of a count of Philox."""
_ROUNDING: Final = 1e-12
"""A matrix is taken as one of correlations if its factor misses 0 by no more than this."""
_HALF: Final = 2.0**-54
"""Half of the step between two shares: they are never 0 or 1."""
_BLOCK: Final = 16384
"""Points of a closed form that are computed together, whatever the chunk: some vector loops round
by the place of a number in its array."""


@dataclass(frozen=True)
class Population:
    """The machines of a series: an axis file whose numbers vary.

    Attributes
    ----------
    file, varied
        The axis file, and the distributions by name.
    correlation
        Correlations of pairs of them, -1 to 1; others are 0.
    seed
        The seed of the random numbers.

    Raises
    ------
    ValueError
        If the correlations cannot be.
    """

    file: AxisFile
    varied: Mapping[str, Distribution]
    correlation: Mapping[tuple[str, str], float]
    seed: int

    def __post_init__(self) -> None:
        # Told where it is stated, and not by a worker.
        self._factor  # noqa: B018

    @cached_property
    def _factor(self) -> Factor:
        return factor_of(list(self.varied), self.correlation)

    @cached_property
    def block(self) -> int:
        """How many points are computed together."""
        return _BLOCK if has_closed_form(self.file.axis()) else 1

    @property
    def identity(self) -> dict[str, Any]:
        """All that the machines depend on, as JSON knows it."""
        return {
            "axis": self.file.identity,
            # In their order, by which each has its own random numbers.
            "varied": [[path, each.kind, *each.numbers] for path, each in self.varied.items()],
            "factor": self._factor,
            "seed": self.seed,
        }

    def drawn(self, start: int, stop: int) -> dict[str, Floats]:
        """Return the numbers that vary, of the machines from `start` up to `stop`."""
        drawn = correlated(shares(self.seed, start, stop, len(self.varied)), self._factor)
        return self.at(drawn)

    def at(self, drawn: Floats) -> dict[str, Floats]:
        """Return the numbers at shares of their distributions, (machines, numbers)."""
        return {
            path: each.values(np.ascontiguousarray(drawn[:, place]))
            for place, (path, each) in enumerate(self.varied.items())
        }

    def scaled(
        self, changes: dict[str, Floats], path: str, by: float | Floats
    ) -> dict[str, Floats]:
        """Return changes with one number multiplied, one that does not vary too; "" for none."""
        if not path:
            return changes
        count = len(next(iter(changes.values())))
        stated = np.full(count, check(self.file, path).value)
        return {**changes, path: changes.get(path, stated) * by}

    def answered(
        self, changes: Mapping[str, Floats], feeds: tuple[float, ...], *, regimes_only: bool = False
    ) -> Columns:
        """Return numbers and what each machine does at some feeds, as the columns of `Samples`."""
        found = axis_points(self.file, changes, feeds, regimes_only=regimes_only)
        columns: Columns = {**changes, **{name: found[name] for name in WITHOUT_FEED}}
        for name in ("jump", "rate", "regime"):
            for place, column in enumerate(found[name].T, 1):
                columns[f"{name} {place}"] = np.ascontiguousarray(column)
        return columns


@dataclass(frozen=True)
class Machines(ABC):
    """A study of a population, whose other fields say all that its results depend on beside it.

    A subclass computes so many points at a time as `Population.block` says, whatever the chunk.
    Its `count` is that of its points; `feeds` are those at which each machine is judged [m/s].
    """

    population: Population

    @property
    def quantum(self) -> int:
        """A chunk is a multiple of so many points."""
        return self.population.block

    @property
    def identity(self) -> Mapping[str, Any]:
        """All that the results depend on, but for versions."""
        own = {each.name: getattr(self, each.name) for each in fields(self)[1:]}
        name = type(self).__name__.lower()
        return {"study": f"scatter: {name}", **self.population.identity, **own}

    def compute(self, start: int, stop: int) -> Columns:
        """Return the columns of the machines from `start` up to `stop`."""
        starts = range(start, stop, self.quantum)
        parts = [self._block(each, min(each + self.quantum, stop)) for each in starts]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    @abstractmethod
    def _block(self, start: int, stop: int) -> Columns:
        """Return the columns of the machines of one quantum."""


@dataclass(frozen=True)
class Samples(Machines):
    """The study of machines drawn at random.

    Attributes
    ----------
    scaled
        A number of the file that is multiplied in all of them, empty for none, and the factor.
    regimes_only
        Whether the regimes alone are asked for.

    Notes
    -----
    Columns: the numbers that vary by their names; ``critical_feed``, ``stable``, ``clamped``;
    ``jump 1``, ``rate 1``, ``regime 1`` of the first feed, and so on; `points.axes.axis_points`
    describes them.
    """

    feeds: tuple[float, ...]
    count: int
    scaled: tuple[str, float] = ("", 1.0)
    regimes_only: bool = False

    def _block(self, start: int, stop: int) -> Columns:
        drawn = self.population.drawn(start, stop)
        changes = self.population.scaled(drawn, *self.scaled)
        return self.population.answered(changes, self.feeds, regimes_only=self.regimes_only)


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
