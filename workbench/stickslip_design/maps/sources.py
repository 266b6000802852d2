"""What a map is over, as people type it, and what is computed at each of its points."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fmi.table import Variable
from stickslip_units import EXACT, QuantityError, parse_range, told, typed

from ..axis import AxisFile, Number
from ..axis.keys import key_of
from ..points.axes import axis_points, check, read_number
from ..points.axes import has_closed_form as axis_has_closed_form
from ..points.blocks import WITHOUT_INFLUENCE, block_points, has_closed_form, table_of_law
from ..points.columns import AXIS, BLOCK, FEED, WITHOUT_FEED, Column

Values: TypeAlias = Mapping[str, NDArray[np.float64]]
Columns: TypeAlias = Mapping[str, NDArray[np.generic]]

DEFAULT_COUNT: Final = 200
"""Values of a range that says no number of them."""

_FORM: Final = "NAME=LOW..HIGH [UNIT] [log|lin] [COUNT]"

MOST_LIMITS: Final = 1000
"""Searches of a critical velocity, of 10 to 100 ms, that a map makes without being told to."""

_CLOSED: Final = 16384
"""Points of a block of closed forms: some ms, in the cache."""

_FOLLOWED: Final = 1024
"""Points of a block that is followed from event to event: some 0.1 s."""

_AXES: Final = 16
"""Axes of a block that are computed one by one."""


class OverError(ValueError):
    """A range cannot be taken; the message says which, why, and what is expected."""


class Quantity(NamedTuple):
    """What may be mapped over, in its SI unit, "1" for a plain number.

    `read` reads a quantity into SI, or raises QuantityError; `check` raises a ValueError if one of
    some values cannot be taken.
    """

    unit: str
    description: str
    read: Callable[[str], float]
    check: Callable[[NDArray[np.float64]], object]


@dataclass(frozen=True)
class Dimension:
    """A parameter and the values [SI] that it takes, rising.

    It was typed in the unit `shown`, "" for none; `log`: it is drawn on a logarithmic scale.
    """

    name: str
    quantity: Quantity
    values: tuple[float, ...]
    shown: str = ""
    log: bool = False


def dimensions(
    over: Mapping[str, str | Sequence[float]], known: Mapping[str, Quantity]
) -> tuple[Dimension, ...]:
    """Return the dimensions of a map, `over` as of `stickslip.map`, of what is `known` by name.

    OverError if there are less than two, a name is unknown, or a range cannot be taken.
    """
    if not isinstance(over, Mapping):
        raise OverError(
            f"a map is over parameters by name, not {over!r}; expected a dictionary such as "
            "{'v': '1..200 mm/s log 12', 'k': [500.0, 1000.0]}"
        )
    if len(over) < 2:
        raise OverError(
            f"a map is over two parameters or more, not {len(over)}; give each as {_FORM}"
        )
    return tuple(_dimension(name, span, known) for name, span in over.items())


def _dimension(name: str, span: str | Sequence[float], known: Mapping[str, Quantity]) -> Dimension:
    if name not in known:
        near = get_close_matches(name, known, 3, 0.4)
        remedy = f"nearest: {', '.join(near)}" if near else f"known are {', '.join(known)}"
        raise OverError(f"{name!r} is no parameter that can be mapped over; {remedy}")
    quantity = known[name]
    if isinstance(span, str):
        text = repr(f"{name}={span}")
        read = quantity.read
        try:
            spaced = parse_range(
                span, quantity.unit, read=lambda end, _: read(end), count=DEFAULT_COUNT
            )
        except QuantityError as error:
            raise OverError(f"{text} {error}") from None
        values, log, shown = spaced.values(), spaced.log, spaced.symbol
    else:
        text, shown = f"the range of {name}", ""
        try:
            values = np.asarray(span, dtype=np.float64)
        except (TypeError, ValueError):
            raise OverError(f"{text} is {span!r}; expected a text or rising numbers") from None
        if values.ndim != 1 or values.size < 2:
            raise OverError(f"{text} has {values.size} values; at least 2 are needed, in one row")
        # Drawn as it is spaced: by equal ratios or by equal distances.
        log = bool(np.all(values > 0.0)) and _even(np.log(values)) and not _even(values)
    if not np.all(np.diff(values) > 0.0):
        raise OverError(f"{text} does not rise from value to value")
    try:
        quantity.check(values)
    except ValueError as error:
        raise OverError(f"{text}: {error}") from None
    return Dimension(name, quantity, tuple(values.tolist()), shown, log)


def _even(numbers: NDArray[np.float64]) -> bool:
    steps = np.diff(numbers)
    return bool(np.allclose(steps, steps.mean(), rtol=1e-6))


@dataclass(frozen=True)
class Source:
    """What a map computes at points: `columns`, by `at`, which takes arrays by dimension.

    The arrays broadcast, and so do the columns. About `most` points are computed in one call, and
    the parameter `fastest`, if the map is over it, changes from point to point. `point` has the
    values [SI] of the block or axis itself; the results depend on `identity` beside the grid.
    """

    title: str
    fastest: str
    most: int
    columns: Mapping[str, Column]
    identity: Mapping[str, Any]
    point: Mapping[str, float]
    at: Callable[[Values], Columns]


def block_source(
    law: str, values: Mapping[str, float], over: Sequence[Dimension], limit: bool | None
) -> Source:
    """Return the source of a map of the block; `limit` None: where it costs a minute at most.

    ValueError if values do not go together at a corner of the map.
    """
    table = table_of_law(law)
    closed = has_closed_form({**values, **{each.name: each.values[-1] for each in over}}, law)
    if limit is None:
        searches = math.prod(len(each.values) for each in over if each.name != "v")
        limit = closed or searches <= MOST_LIMITS
    start = table.start_values()
    names = [each.name for each in over]
    held = {
        name: value
        for name, value in sorted(values.items())
        if name not in {*WITHOUT_INFLUENCE, *names} and value != start.get(name)
    }
    ends = np.ix_(*((each.values[0], each.values[-1]) for each in over))
    try:
        block_points({**held, **dict(zip(names, ends, strict=True))}, law, limit=False)
    except ValueError as error:
        # The number of the run is that of a corner, which nobody typed.
        raise ValueError(re.sub(r"^run \d+: ", "", str(error))) from error
    shown = [f"{n} = {told(v, table.by_name[n].unit or '1', EXACT)}" for n, v in held.items()]
    return Source(
        title=f"Block, friction law {law}" + (f"; {', '.join(shown)}" if shown else ""),
        # The critical velocity does not depend on it.
        fastest="v",
        most=_CLOSED if closed else _FOLLOWED,
        columns={name: each for name, each in BLOCK.items() if limit or name != "v_c"},
        identity={"law": law, "values": held, "limit": limit},
        point={name: held.get(name, start[name]) for name in names},
        at=partial(_blocks_at, held, law, limit),
    )


def _blocks_at(held: Mapping[str, float], law: str, limit: bool, values: Values) -> Columns:
    return block_points({**held, **values}, law, limit=limit)


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


def axis_source(file: AxisFile, over: Sequence[Dimension], feed: float | None) -> Source:
    """Return the source of a map of an axis; its feed is that of the demand where none is given.

    Without any feed the critical one alone is mapped. AxisError if numbers do not go together at a
    corner of the map.
    """
    names = [each.name for each in over if each.name != FEED]
    file.refuse_turning("a map")
    feeds = next((len(each.values) for each in over if each.name == FEED), 0)
    demanded = (check(file, path).value for path in file.values if path.startswith("demand.feeds"))
    first = next(demanded, None)
    feed = None if feeds else first if feed is None else feed
    for ends in product(*((d.values[0], d.values[-1]) for d in over if d.name != FEED)):
        file.changed(dict(zip(names, ends, strict=True))).axis()
    point = {name: check(file, name).value for name in names}
    if feeds and first is not None:
        point[FEED] = first
    closed = axis_has_closed_form(file.axis())
    at = "" if feed is None else f" at {told(feed, 'm/s')}"
    name = file.values.get("axis.name", f"Axis {Path(file.name).stem}")
    return Source(
        title=f"{name}{at}",
        # One axis answers for all feeds.
        fastest=FEED,
        most=_CLOSED if closed else max(_AXES, feeds),
        columns={n: each for n, each in AXIS.items() if feed or feeds or n in WITHOUT_FEED},
        identity={"axis": file.identity, "feed": feed},
        point=point,
        at=partial(_axes_at, file, feed),
    )


def _axes_at(file: AxisFile, feed: float | None, values: Values) -> Columns:
    changes = {name: each for name, each in values.items() if name != FEED}
    shape = np.broadcast_shapes(*(each.shape for each in values.values()))
    # The feed, where the map is over it, is the last dimension.
    of_axis = (*shape[:-1], 1) if FEED in values else shape
    flat = {name: np.broadcast_to(each, of_axis).ravel() for name, each in changes.items()}
    feeds = values[FEED].ravel().tolist() if FEED in values else [] if feed is None else [feed]
    found = axis_points(file, flat, feeds)
    return {
        name: np.broadcast_to(each.reshape(of_axis if name in WITHOUT_FEED else shape), shape)
        for name, each in found.items()
    }


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
