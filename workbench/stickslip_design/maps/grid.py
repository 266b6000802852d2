"""A grid of points, its order, and the study that computes one in blocks of a fixed size."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from typing import Any, Final, NamedTuple

import numpy as np

from ..chunks import Columns
from .sources import Dimension, Source

SLAB: Final = 2**20
"""Points that are read or written at a time: some 100 MB of columns, a chunk of the dataset."""


class Box(NamedTuple):
    """Points of a grid that follow each other, and are a range of values of each dimension."""

    start: int
    stop: int
    slices: tuple[slice, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values by dimension."""
        return tuple(cut.stop - cut.start for cut in self.slices)


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


@dataclass(frozen=True)
class GridStudy:
    """All combinations of the values of some dimensions, as `chunks.run` takes them.

    Points are computed in blocks that begin at the same places however the study is cut: the
    vector code of NumPy may round by where in an array a number stands.

    Attributes
    ----------
    over
        The dimensions as they were asked for.
    source
        What is computed.
    """

    over: tuple[Dimension, ...]
    source: Source

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        """In the order of computing: the last one changes from point to point."""
        return tuple(sorted(self.over, key=lambda each: each.name == self.source.fastest))

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values by dimension."""
        return tuple(len(each.values) for each in self.dimensions)

    @property
    def count(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    @property
    def quantum(self) -> int:
        """Points of a block."""
        return block(self.shape, self.source.most)

    @property
    def identity(self) -> Mapping[str, Any]:
        """All that the results depend on, but for versions."""
        over = [
            {
                "name": each.name,
                "low": each.values[0],
                "high": each.values[-1],
                "count": len(each.values),
                "values": sha256(np.array(each.values).tobytes()).hexdigest(),
            }
            for each in self.dimensions
        ]
        return {"study": "map", **self.source.identity, "over": over}

    def compute(self, start: int, stop: int) -> Columns:
        """Return the columns of the points from `start` up to `stop`."""
        columns: Columns = {}
        for box in boxes(self.shape, start, stop, self.source.most):
            cut = [
                each.values[part] for each, part in zip(self.dimensions, box.slices, strict=True)
            ]
            values = dict(zip((each.name for each in self.dimensions), np.ix_(*cut), strict=True))
            for name, column in self.source.at(values).items():
                if name not in columns:
                    columns[name] = np.empty(stop - start, column.dtype)
                part = columns[name][box.start - start : box.stop - start]
                part.reshape(box.shape)[...] = column
        return columns
