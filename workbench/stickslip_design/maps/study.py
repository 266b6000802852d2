"""A map: the steady motion over a grid of two or more parameters, as a dataset with units."""

from __future__ import annotations

import json
import math
import os
import shutil
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from ..axis import AxisSource, read_axis_file
from ..chunks import Columns, Results
from ..datasets import need, provenance, read_grid
from ..points.columns import FEED
from .sources import (
    Dimension,
    OverError,
    Source,
    axis_quantities,
    axis_source,
    block_quantities,
    block_source,
    dimensions,
)

if TYPE_CHECKING:
    import xarray

SLAB: Final = 2**18
"""Points that are read or written at a time: some 25 MB of columns, a chunk of the dataset."""


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


FILE: Final = "map.zarr"
"""Name of the dataset in the folder of a map."""

_CHUNKS: Final = "chunks"
"""Name of the folder of the chunk files in that of the map."""

_REGIMES: Final = {"flag_values": [0, 1, 2], "flag_meanings": "even sticks swings"}


def study_of(
    over: Mapping[str, str | Sequence[float]],
    *,
    values: Mapping[str, float],
    law: str = "coulomb",
    axis: AxisSource | None = None,
    limit: bool | None = None,
) -> GridStudy:
    """Return the study of a map; `over`, `axis` and `limit` as of `stickslip.map`.

    `values` of the block are held [SI], the rest has its start value; of an axis: ``feed``.
    ValueError if a range or a value cannot be taken.
    """
    if axis is None:
        spans = dimensions(over, block_quantities(law))
        source = block_source(law, values, spans, limit)
    else:
        file = read_axis_file(axis)
        unknown = sorted(values.keys() - {FEED})
        if unknown:
            raise OverError(f"{unknown[0]}: the axis file states what is held, but for the feed")
        if FEED in values and FEED in over:
            raise OverError(f"{FEED}: it is held, and the map is over it too")
        spans = dimensions(over, axis_quantities(file))
        source = axis_source(file, spans, values.get(FEED))
    return GridStudy(spans, source)


def computed(
    study: GridStudy,
    folder: Path | str | None,
    compute: Callable[[GridStudy, str | None], Results],
) -> xarray.Dataset:
    """Return the dataset of a study that `compute` computes, given the folder of its chunks."""
    # Points do not wait for their import, a third of a second; without them none is computed.
    for package in ("xarray", "zarr"):
        if find_spec(package) is None:
            need(package)
    results = compute(study, None if folder is None else f"{folder}/{_CHUNKS}")
    zarr = need("zarr")
    # A store gives its arrays back in any order.
    names = [*(each.name for each in study.over), *study.source.columns]
    if folder is None:
        store = zarr.storage.MemoryStore()
        _write(study, results, store)
        return read_grid(store)[names].load()
    target = f"{folder}/{FILE}"
    # A local dataset has its name when it is whole.
    local = "://" not in target
    place = f"{target}.part" if local else target
    _write(study, results, place)
    with warnings.catch_warnings():
        # All metadata in one file is no part of the format yet; without, xarray warns of slowness.
        warnings.simplefilter("ignore")
        zarr.consolidate_metadata(place)
    if local:
        shutil.rmtree(target, ignore_errors=True)
        os.replace(place, target)  # noqa: PTH105 - both are texts, for addresses
    return read_grid(target)[names]


def _write(study: GridStudy, results: Results, target: Any) -> None:
    """Write the dataset slab by slab."""
    group = need("zarr").open_group(target, mode="w")
    for each in study.over:
        attributes = {
            "units": each.quantity.unit,
            "long_name": each.quantity.description,
            "shown_in": each.shown,
            "spacing": "log" if each.log else "lin",
        }
        group.create_array(
            each.name, data=np.array(each.values), dimension_names=(each.name,),
            attributes=attributes, fill_value=np.nan,
        )  # fmt: skip
    inner = [each.name for each in study.dimensions]
    for box in boxes(study.shape, 0, study.count, SLAB):
        for name, column in results.read(box.start, box.stop).items():
            about = study.source.columns[name]
            names = [each.name for each in study.over if each.name not in about.without]
            # What a column does not depend on is the same for all values: the first one tells.
            part = column.reshape(box.shape)[tuple(slice(None) if n in names else 0 for n in inner)]
            left = [n for n in inner if n in names]
            part = part.transpose([left.index(n) for n in names])
            if name not in group:
                group.create_array(
                    name,
                    shape=tuple(len(each.values) for each in study.over if each.name in names),
                    dtype=part.dtype,
                    chunks=part.shape,
                    dimension_names=names,
                    attributes={"units": about.unit, "long_name": about.description}
                    | (_REGIMES if name == "regime" else {}),
                    fill_value=np.nan if part.dtype.kind == "f" else part.dtype.type(0),
                )
            group[name][tuple(box.slices[inner.index(n)] for n in names)] = part
    group.attrs.update(
        {
            # What the pictures need to know, and that there is no seed.
            "title": study.source.title,
            "over": json.dumps([each.name for each in study.over]),
            "point": json.dumps(study.source.point),
            "seed": "none",
            **provenance(study.identity),
        }
    )
