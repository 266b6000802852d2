"""Many axes at once: one axis file with other numbers, and what each of its variants does.

A rigid drive with constant friction coefficients has closed forms for whole arrays; other friction
laws and servo loops are computed point by point.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from difflib import get_close_matches
from functools import partial
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip_ref import STICKS, Interval, coulomb_limit, critical_velocity, steady_cycle

from ..axis import Axis, AxisError, AxisFile, Number
from ..axis.keys import UNITS, key_of
from ..loop.courses import ranges_from_above, up_to
from ..loop.critical import BESIDE, jumps_of, kind_beside
from ..loop.jumps import limit_of_jumps
from ..loop.stability import is_stable
from ..one_thread import one_thread
from .columns import WITHOUT_FEED, Floats, Regime

_NOWHERE: Final = Interval(0.0, 0.0, "none", "none")


def axis_points(
    file: AxisFile,
    changes: Mapping[str, Floats],
    feeds: Sequence[float] = (),
    *,
    regimes_only: bool = False,
) -> dict[str, NDArray[Any]]:
    """Return the critical feed of many variants of an axis, and what each does at some feeds.

    `changes` are arrays of shape (n,) by the name of a number in the file, ``axis.mass``, in the SI
    unit in which the file states it; what else the file states is held, zeta and forces too. Feeds
    [m/s] are above 0. With `regimes_only`, which takes less time, jump and rate are NaN,
    and without closed forms the critical feed. The results of a point depend on its own numbers
    alone. A closed form takes 1 us a point, another friction law or a loop 1 to 100 ms.

    Returns
    -------
    dict
        Arrays of shape (n,): ``critical_feed`` [m/s] (0: never jumps; infinite: jumps have no end,
        or the loop is unstable; NaN: unknown), ``stable`` (bool: the loop is, or there is none),
        ``clamped`` (bool: mu_k came above mu_s and was taken as that). With feeds, of shape
        (n, feeds): ``jump`` [m] and ``rate`` [1/s] of the settled jumps (0 where there is none; NaN
        where unknown, as where a drive turns the table back between two jumps), ``regime`` (int8:
        `columns.Regime`).

    Raises
    ------
    AxisError, ValueError
        If the file has no such number, or values are out of range or do not go together; if a feed
        is not above 0, or lengths differ.
    """
    if not all(0.0 < feed < math.inf for feed in feeds):
        raise ValueError("a feed is a finite speed above 0")
    changes = {path: np.ascontiguousarray(each, np.float64) for path, each in changes.items()}
    shapes = {path: each.shape for path, each in changes.items()}
    count, *_ = next(iter(shapes.values()), (1,))
    if any(shape != (count,) for shape in shapes.values()):
        told = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise ValueError(f"arrays of one length are needed: {told}")
    for path, each in changes.items():
        check(file, path, each)
    found: dict[str, NDArray[Any]] = {
        "critical_feed": np.full(count, math.nan),
        "stable": np.ones(count, dtype=np.bool_),
        "clamped": np.empty(count, dtype=np.bool_),
        "jump": np.full((count, len(feeds)), math.nan),
        "rate": np.full((count, len(feeds)), math.nan),
        "regime": np.full((count, len(feeds)), Regime.UNKNOWN, dtype=np.int8),
    }
    compute = _closed if has_closed_form(file.axis()) else _each
    compute(found, file, changes, feeds, regimes_only)
    return found if feeds else {name: found[name] for name in WITHOUT_FEED}


def has_closed_form(axis: Axis) -> bool:
    """Return whether an axis has closed forms: rigid drive, constant friction coefficients."""
    return axis.drive is None and axis.friction.constant


def check(file: AxisFile, path: str, values: ArrayLike = ()) -> Number:
    """Return a number of a file by its name; AxisError if it states none, or refuses `values`.

    The values are in the SI unit in which the file states the number.
    """
    number = file.values.get(path)
    if not isinstance(number, Number):
        known = [name for name, each in file.values.items() if isinstance(each, Number)]
        near = get_close_matches(path, known, 3, 0.4)
        remedy = f"nearest: {', '.join(near)}" if near else f"it states {', '.join(known)}"
        reason = "is no number that the file states"
        raise AxisError(reason, key=path, name=file.name, remedy=remedy)
    key = key_of(path)
    for value in (np.min(values), np.max(values)) if np.size(values) else ():
        if float(value) not in key.within:
            raise AxisError(
                "is out of range", key=path, value=f"{value:.6g} {number.unit}".removesuffix(" 1"),
                within=str(key.within), name=file.name,
            )  # fmt: skip
    return number


def read_number(number: Number, text: str) -> float:
    """Read a quantity into the unit in which a file states a number; raises QuantityError."""
    kind = UNITS.kinds[number.unit]
    return UNITS.read(text, (kind,), kind if number.unit == "1" else None)[0]


def _closed(
    found: dict[str, NDArray[Any]], file: AxisFile, changes: Mapping[str, Floats],
    feeds: Sequence[float], regimes_only: bool,
) -> None:  # fmt: skip
    """Compute the columns of axes on a rigid drive with constant friction, in closed form."""
    axes = file.changed(changes).axis()
    found["critical_feed"][:] = limit = np.asarray(coulomb_limit(axes.block(1.0)))
    found["clamped"][:] = axes.friction.capped
    for column, feed in enumerate(feeds):
        found["regime"][:, column] = np.where(feed <= limit, Regime.STICKS, Regime.EVEN)
        if regimes_only:
            continue
        cycle = steady_cycle(axes.block(np.full(len(found["stable"]), feed)))  # type: ignore[arg-type]
        found["jump"][:, column] = np.where(cycle.exists, cycle.delta_x, 0.0)
        found["rate"][:, column] = np.where(cycle.exists, cycle.f, 0.0)
        # Within rounding of the limit the cycle itself decides.
        found["regime"][:, column] = np.where(cycle.exists, Regime.STICKS, Regime.EVEN)


@one_thread
def _each(
    found: dict[str, NDArray[Any]], file: AxisFile, changes: Mapping[str, Floats],
    feeds: Sequence[float], regimes_only: bool,
) -> None:  # fmt: skip
    """Compute the columns of axes one by one; an unstable loop swings."""
    for point in range(len(found["stable"])):
        axis = file.changed({path: float(each[point]) for path, each in changes.items()}).axis()
        found["clamped"][point] = axis.friction.capped
        # RuntimeError: a slip cannot be followed, a damping of some ten that a steep friction
        # overcomes.
        with suppress(RuntimeError):
            if axis.drive is not None and not is_stable(axis):
                found["stable"][point], found["critical_feed"][point] = False, math.inf
                found["regime"][point] = Regime.SWINGS
                continue
            critical, regimes = _regimes(axis, feeds, regimes_only=regimes_only)
            if not regimes_only:
                motions = [
                    (jumps_of(axis, v) or (math.nan, math.nan)) if kind == Regime.STICKS else (0, 0)
                    for v, kind in zip(feeds, regimes, strict=True)
                ]
                found["jump"][point], found["rate"][point] = np.reshape(motions, (-1, 2)).T
            found["critical_feed"][point], found["regime"][point] = critical, regimes


def _regimes(
    axis: Axis, feeds: Sequence[float], *, regimes_only: bool
) -> tuple[float, list[Regime]]:
    """Return the critical feed [m/s] and the regime of each feed: in jumps, where both exist."""
    friction = axis.friction
    critical = math.nan
    if axis.drive is not None:
        ranges: Iterator[Interval] = iter(())
        if not regimes_only:
            ranges = ranges_from_above(axis)
        elif friction.law == "coulomb":
            # A cycle that does not form at slow feeds may do so above them all.
            reached = limit_of_jumps(axis, max(feeds)).feed or limit_of_jumps(axis).feed
            ranges = iter(up_to(reached))
        jumps = next(ranges, _NOWHERE)
        critical = math.nan if regimes_only else jumps.high
        kinds: dict[float, Regime] = {}
        for v in sorted(feeds, reverse=True):
            kind = STICKS if v in jumps else kind_beside(axis, v)
            while kind != STICKS and v < jumps.low:
                jumps = next(ranges, _NOWHERE)
                kind = STICKS if v in jumps else kind
            kinds[v] = Regime[kind.upper()]
        return critical, [kinds[v] for v in feeds]
    search = partial(critical_velocity, axis.block(1.0), friction.law, friction.own)
    if regimes_only:
        found = [search((v * (1.0 - BESIDE), v)) for v in feeds]
    else:
        limit = search()
        critical, (low, high) = limit.highest, limit.between
        between = min([low, *feeds]), max([high, *feeds])
        found = [search(between) if between != (low, high) else limit] * len(feeds)
    both = zip(found, feeds, strict=True)
    return critical, [Regime[each.motions(v)[0].upper()] for each, v in both]
