"""A grid of points, its order, and the study that computes one in blocks of a fixed size."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..chunks import Columns
from .over import Dimension


class Box(NamedTuple):
    """Points of a grid that follow each other, and are a range of values of each dimension."""

    start: int
    stop: int
    slices: tuple[slice, ...]


@dataclass(frozen=True)
class Grid:
    """All combinations of the values of some dimensions.

    Attributes
    ----------
    dimensions
        In the order of computing: the last one changes from point to point.
    """

    dimensions: tuple[Dimension, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values by dimension."""
        return tuple(len(each.values) for each in self.dimensions)

    @property
    def count(self) -> int:
        """Number of points."""
        return math.prod(self.shape)


def block(shape: tuple[int, ...], most: int) -> int:
    """Return how many points, at most `most` if any can, are a whole number of rows.

    A row are the values of the last dimensions that fit; a single row too long is cut.
    """
    row = _row(shape, most)[1]
    return max(most // row, 1) * row


def boxes(shape: tuple[int, ...], start: int, stop: int, most: int) -> Iterator[Box]:
    """Yield the points from `start` to `stop` as boxes of at most `block(shape, most)` points.

    `start` and `stop` are multiples of that, but for the last.
    """
    depth, row = _row(shape, most)
    length, whole = shape[depth], block(shape, most)
    for begin in range(start, stop, whole):
        first, last = begin // row, min(begin + whole, stop) // row
        while first < last:
            outer, here = divmod(first, length)
            end = min(last, first - here + length)
            places = np.unravel_index(outer, shape[:depth]) if depth else ()
            slices = (
                *(slice(int(place), int(place) + 1) for place in places),
                slice(here, here + end - first),
                *(slice(0, size) for size in shape[depth + 1 :]),
            )
            yield Box(first * row, end * row, slices)
            first = end


def _row(shape: tuple[int, ...], most: int) -> tuple[int, int]:
    """Return the dimension that is cut, and the number of points of one of its values."""
    depth, row = len(shape) - 1, 1
    while depth > 0 and row * shape[depth] <= most:
        row *= shape[depth]
        depth -= 1
    return depth, row


class Column(NamedTuple):
    """A column of results: SI unit, description, and the dimensions it does not depend on."""

    unit: str
    description: str
    without: tuple[str, ...] = ()


class Source(Protocol):
    """What a grid study computes at points."""

    @property
    def title(self) -> str:
        """What is mapped, in words."""

    @property
    def fastest(self) -> str:
        """The parameter, if the grid has it, that changes from point to point."""

    @property
    def by_slips(self) -> bool:
        """Whether slips are followed, which is slow without a C compiler."""

    @property
    def columns(self) -> Mapping[str, Column]:
        """The columns by name."""

    def check(self, values: Mapping[str, NDArray[np.float64]]) -> None:
        """Raise a ValueError if values do not go together at a point."""

    def point(self, names: Sequence[str]) -> dict[str, float]:
        """Return the values of some parameters of what the map is about, where it has them [SI]."""

    @property
    def most(self) -> int:
        """About how many points are computed in one call."""

    @property
    def identity(self) -> Mapping[str, Any]:
        """All that the results depend on beside the grid: JSON."""

    def at(self, values: Mapping[str, NDArray[np.float64]]) -> Mapping[str, NDArray[np.generic]]:
        """Return columns at the points of arrays that broadcast, by the name of the dimension.

        The columns broadcast to the common shape.
        """


def _identity(dimension: Dimension) -> dict[str, Any]:
    values = np.array(dimension.values)
    return {
        "name": dimension.name,
        "low": dimension.values[0],
        "high": dimension.values[-1],
        "count": len(dimension.values),
        "values": sha256(values.tobytes()).hexdigest(),
    }


@dataclass(frozen=True)
class GridStudy:
    """The points of a grid, as `chunks.run` takes them.

    Points are computed in blocks that begin at the same places however the study is cut: the
    vector code of NumPy may round by where in an array a number stands.
    """

    grid: Grid
    source: Source

    @property
    def count(self) -> int:
        """Number of points."""
        return self.grid.count

    @property
    def quantum(self) -> int:
        """Points of a block."""
        return block(self.grid.shape, self.source.most)

    @property
    def identity(self) -> Mapping[str, Any]:
        """All that the results depend on, but for versions."""
        over = [_identity(each) for each in self.grid.dimensions]
        return {"study": "map", **self.source.identity, "over": over}

    def compute(self, start: int, stop: int) -> Columns:
        """Return the columns of the points from `start` up to `stop`."""
        columns: Columns = {}
        rank = len(self.grid.dimensions)
        for box in boxes(self.grid.shape, start, stop, self.source.most):
            values = {
                each.name: np.array(each.values[cut]).reshape(
                    [-1 if place == other else 1 for other in range(rank)]
                )
                for place, (each, cut) in enumerate(
                    zip(self.grid.dimensions, box.slices, strict=True)
                )
            }
            shape = tuple(cut.stop - cut.start for cut in box.slices)
            for name, each in self.source.at(values).items():
                if name not in columns:
                    columns[name] = np.empty(stop - start, each.dtype)
                part = columns[name][box.start - start : box.stop - start]
                part.reshape(shape)[...] = each
        return columns
