"""What is computed at each point of a map: the motion of a block, or of an axis."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from fmi.table import Variable

from ..axis import AxisFile, Number
from ..axis.build import key_of
from ..points import columns
from ..points.axes import axis_points, check, read_number
from ..points.axes import has_closed_form as axis_has_closed_form
from ..points.blocks import WITHOUT_INFLUENCE, block_points, has_closed_form, table_of_law
from ..points.columns import FEED, WITHOUT_FEED, Column
from ..quantity import typed
from ..shown import EXACT, told
from .over import Dimension, Quantity

Arrays = Mapping[str, NDArray[np.float64]]

MOST_LIMITS: Final = 1000
"""Searches of a critical velocity, of 10 to 100 ms, that a map makes without being told to."""

_CLOSED: Final = 16384
"""Points of a block of closed forms: some ms, in the cache."""

_FOLLOWED: Final = 1024
"""Points of a block that is followed from event to event: some 0.1 s."""

_AXES: Final = 16
"""Axes of a block that are computed one by one."""


@dataclass(frozen=True)
class BlockSource:
    """The block under a friction law: `points.blocks.block_points`.

    Attributes
    ----------
    law
        The friction law.
    values
        Name and value [SI] of the parameters and inputs that are not at their start values.
    limit
        Whether the critical velocity is computed.
    by_slips
        Whether slips are followed, which is slow without a C compiler: where the map has no closed
        forms.
    """

    law: str
    values: tuple[tuple[str, float], ...]
    limit: bool
    by_slips: bool

    fastest: ClassVar = "v"
    """What changes from point to point: the critical velocity does not depend on it."""

    @property
    def title(self) -> str:
        """What is mapped, in words."""
        rows = table_of_law(self.law).by_name
        held = [
            f"{name} = {told(value, rows[name].unit or '1', EXACT)}" for name, value in self.values
        ]
        return f"Block, friction law {self.law}" + (f"; {', '.join(held)}" if held else "")

    @property
    def most(self) -> int:
        """About how many points are computed in one call."""
        return _FOLLOWED if self.by_slips else _CLOSED

    @property
    def identity(self) -> Mapping[str, Any]:
        """Law and values."""
        return {"law": self.law, "values": dict(self.values), "limit": self.limit}

    @property
    def columns(self) -> dict[str, Column]:
        """The columns by name."""
        return {name: each for name, each in columns.BLOCK.items() if self.limit or name != "v_c"}

    def at(self, values: Arrays) -> Mapping[str, NDArray[np.generic]]:
        """Return the columns at some points."""
        return block_points({**dict(self.values), **values}, self.law, limit=self.limit)

    def check(self, values: Arrays) -> None:
        """Raise a ValueError if values do not go together at a point."""
        try:
            block_points({**dict(self.values), **values}, self.law, limit=False)
        except ValueError as error:
            # The number of the run is that of a corner, which nobody typed.
            raise ValueError(re.sub(r"^run \d+: ", "", str(error))) from error

    def point(self, names: Sequence[str]) -> dict[str, float]:
        """Return the values of some parameters of the block itself, which the map is about."""
        start = {**table_of_law(self.law).start_values(), **dict(self.values)}
        return {name: start[name] for name in names}


def block_source(
    law: str,
    values: Mapping[str, float],
    over: Sequence[Dimension],
    limit: bool | None,
) -> BlockSource:
    """Return the source of a map of the block; `limit` None: where it costs a minute at most."""
    spanned = {**values, **{each.name: each.values[-1] for each in over}}
    closed = has_closed_form(spanned, law)
    if limit is None:
        searches = math.prod(len(each.values) for each in over if each.name != "v")
        limit = closed or searches <= MOST_LIMITS
    start = table_of_law(law).start_values()
    mapped = {*WITHOUT_INFLUENCE, *(each.name for each in over)}
    given = {
        name: each
        for name, each in values.items()
        if name not in mapped and each != start.get(name)
    }
    return BlockSource(law, tuple(sorted(given.items())), limit, by_slips=not closed)


def block_quantities(law: str) -> dict[str, Quantity]:
    """Return what a map of the block may be over."""
    return {
        row.name: Quantity(
            row.unit or "1",
            row.description,
            partial(typed, unit=row.unit or "1", within=f"({row.range})"),
            partial(_check, row),
        )
        for row in table_of_law(law).rows
        if row.settable and row.name not in WITHOUT_INFLUENCE
    }


def _check(row: Variable, values: NDArray[np.float64]) -> None:
    for value in values.tolist():
        whole = row.kind == "Real" or value.is_integer()
        reason = row.objection(value) if whole else f"{row.name} takes whole numbers, not {value:g}"
        if reason is not None:
            raise ValueError(reason)


@dataclass(frozen=True)
class AxisSource:
    """An axis whose file states other numbers: `points.axes.axis_points`.

    Attributes
    ----------
    file
        The axis file.
    feed
        The feed [m/s] where the map is not over it; None: the critical feed alone is mapped.
    feeds
        How many feeds the map is over.
    """

    file: AxisFile
    feed: float | None
    feeds: int

    fastest: ClassVar = FEED
    """What changes from point to point: one axis answers for all feeds."""
    by_slips: ClassVar = False

    @property
    def title(self) -> str:
        """What is mapped, in words."""
        feed = "" if self.feed is None else f" at {told(self.feed, 'm/s')}"
        return f"Axis {Path(self.file.name).stem}{feed}"

    @property
    def most(self) -> int:
        """About how many points are computed in one call."""
        return _CLOSED if axis_has_closed_form(self.file.axis()) else max(_AXES, self.feeds)

    @property
    def identity(self) -> Mapping[str, Any]:
        """What the file states, and the feed."""
        return {"axis": self.file.identity, "feed": self.feed}

    @property
    def columns(self) -> dict[str, Column]:
        """The columns by name."""
        without = self.feed is None and not self.feeds
        return {n: each for n, each in columns.AXIS.items() if not without or n in WITHOUT_FEED}

    def at(self, values: Arrays) -> Mapping[str, NDArray[np.generic]]:
        """Return the columns at some points."""
        changes = {name: each for name, each in values.items() if name != FEED}
        shape = np.broadcast_shapes(*(each.shape for each in values.values()))
        feeds = values.get(FEED)
        # The feed, where there is one, is the last dimension.
        of_axis = shape if feeds is None else (*shape[:-1], 1)
        flat = {name: np.broadcast_to(each, of_axis).ravel() for name, each in changes.items()}
        count = math.prod(of_axis)
        table = self.feed if feeds is None else np.broadcast_to(feeds.ravel(), (count, feeds.size))
        found = axis_points(self.file, flat, table)
        return {
            name: np.broadcast_to(each.reshape(of_axis if name in WITHOUT_FEED else shape), shape)
            for name, each in found.items()
        }

    def check(self, values: Arrays) -> None:
        """Raise an AxisError if values do not go together at a point."""
        points = np.broadcast_arrays(*values.values())
        for place in np.ndindex(points[0].shape):
            numbers = {name: float(each[place]) for name, each in zip(values, points, strict=True)}
            numbers.pop(FEED, None)
            self.file.changed(numbers).axis()

    def point(self, names: Sequence[str]) -> dict[str, float]:
        """Return the values of some parameters of the axis itself, which the map is about."""
        found = {name: check(self.file, name).value for name in names if name != FEED}
        feed = _first_feed(self.file)
        return found if feed is None or FEED not in names else found | {FEED: feed}


Source = BlockSource | AxisSource


def axis_source(file: AxisFile, over: Sequence[Dimension], feed: float | None) -> AxisSource:
    """Return the source of a map of an axis; its feed is that of the demand where none is given."""
    feeds = next((len(each.values) for each in over if each.name == FEED), 0)
    if feed is None and not feeds:
        feed = _first_feed(file)
    return AxisSource(file, None if feeds else feed, feeds)


def _first_feed(file: AxisFile) -> float | None:
    feeds = (path for path in file.values if path.startswith("demand.feeds"))
    return next((check(file, path).value for path in feeds), None)


def axis_quantities(file: AxisFile) -> dict[str, Quantity]:
    """Return what a map of an axis may be over: the numbers that its file states, and the feed."""
    found = {
        path: Quantity(
            each.unit,
            key_of(path).meaning,
            partial(read_number, each),
            partial(check, file, path),
        )
        for path, each in file.values.items()
        if isinstance(each, Number) and not path.startswith("demand.")
    }
    read = partial(typed, unit="m/s", within="> 0")
    return found | {FEED: Quantity("m/s", "Feed", read, _check_feed)}


def _check_feed(values: NDArray[np.float64]) -> None:
    if not (values.min() > 0.0 and np.isfinite(values).all()):
        raise ValueError(f"a feed is above 0, not {values.min():g} m/s")
