"""Axes drawn at random, and what each does: the study that the other rooms of scatter read."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ..axis import AxisFile
from ..chunks import Columns
from ..points.axes import axis_points, check, has_closed_form
from ..points.columns import WITHOUT_FEED
from .distributions import Distribution
from .sampling import Factor, correlated, factor_of, shares

Floats = NDArray[np.float64]

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
    population, count
        The machines, and how many are drawn.
    feeds
        Feeds at which each is judged [m/s].
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
