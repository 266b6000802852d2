"""Many axes at once: one axis file with other numbers, and what each of its variants does.

A rigid drive with constant friction coefficients has closed forms for whole arrays; other friction
laws and servo loops are computed point by point.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip_ref import CriticalVelocity, coulomb_limit, critical_velocity, steady_cycle

from ..axis import Axis, AxisError, AxisFile, Number
from ..axis.build import key_of
from ..critical import jumps_of, kind_beside, limits_of
from ..loop.jumps import limit_of_jumps
from ..loop.stability import is_stable

EVEN: Final = 0
"""Regime: the axis moves evenly; where its feed rose slowly it does not jump."""
STICKS: Final = 1
"""Regime: a cycle with a stick; the axis jumps."""
SWINGS: Final = 2
"""Regime: steady sliding is unstable and never rests, or the servo loop itself is unstable."""
UNKNOWN: Final = -1
"""Regime: it could not be computed."""

_CODES: Final = {"even": EVEN, "sticks": STICKS, "swings": SWINGS}

_BESIDE: Final = 1e-9
"""A range of feeds this narrow is one feed."""

Floats = NDArray[np.float64]


class _Answer(NamedTuple):
    """What one axis does: critical feed [m/s], stability, and at each feed the rest."""

    critical: float
    stable: bool
    jumps: list[float]
    rates: list[float]
    regimes: list[int]


def axis_points(
    file: AxisFile,
    changes: Mapping[str, NDArray[np.float64]],
    feed: ArrayLike | None = None,
    *,
    regimes_only: bool = False,
) -> dict[str, NDArray[Any]]:
    """Return the critical feed of many variants of an axis, and what each does at a feed.

    Parameters
    ----------
    file
        The axis file.
    changes
        Arrays of shape (n,) by the name of a number in the file, as `AxisFile.changed` takes it:
        ``axis.mass``, ``axis.stiffness[1]``, in the SI unit in which the file states it. What else
        the file states is held, zeta and forces too.
    feed
        Feed [m/s] > 0: one number, one for each point, or (n, f) for f feeds of each point. None:
        the critical feed alone.
    regimes_only
        Whether the regimes alone are asked for, which takes a tenth of the time: jump and rate are
        then NaN, and without closed forms the critical feed.

    Returns
    -------
    dict
        Arrays of shape (n,): ``critical_feed`` [m/s] (0: never jumps; infinite: jumps have no end,
        or the loop is unstable; NaN: unknown), ``stable`` (bool: the loop is, or there is none),
        ``clamped`` (bool: mu_k came above mu_s and was taken as that). With a feed, of the shape
        (n,) or that of the feed: ``jump`` [m] and ``rate`` [1/s] of the settled jumps (0 where
        there is none; NaN where unknown, as where a drive turns the table back between two jumps),
        ``regime`` (int8: `EVEN`, `STICKS`, `SWINGS`, `UNKNOWN`).

    Raises
    ------
    AxisError
        If the file has no such number, a value is out of the range of its key, or values do not go
        together.
    ValueError
        If a feed is not above 0, or lengths differ.

    Notes
    -----
    The results of a point depend on its own numbers alone. A closed form takes 1 us a point,
    another friction law or a loop 0.02 to 1 s.
    """
    feeds = None if feed is None else np.asarray(feed, dtype=np.float64)
    count = _count(changes, feeds)
    given = {path: np.ascontiguousarray(each, np.float64) for path, each in changes.items()}
    for path, each in given.items():
        check(file, path, each)
    table = _table_of(feeds, count)
    if has_closed_form(file.axis()):
        found = _closed(file, given, table, count, regimes_only=regimes_only)
    else:
        found = _each(file, given, table, count, regimes_only=regimes_only)
    if feeds is None:
        return {name: found[name] for name in ("critical_feed", "stable", "clamped")}
    if feeds.ndim < 2:
        for name in ("jump", "rate", "regime"):
            found[name] = found[name][:, 0]
    return found


def has_closed_form(axis: Axis) -> bool:
    """Return whether an axis has closed forms: rigid drive, constant friction coefficients."""
    return axis.drive is None and axis.friction.constant


def check(file: AxisFile, path: str, values: ArrayLike) -> None:
    """Raise AxisError if a file states no such number, or one of some values is out of its range.

    Parameters
    ----------
    file
        The axis file.
    path
        Name of the number.
    values
        Values for it, in the SI unit in which the file states it.
    """
    number = file.values.get(path)
    if not isinstance(number, Number):
        known = [name for name, each in file.values.items() if isinstance(each, Number)]
        near = get_close_matches(path, known, 3, 0.4)
        remedy = f"nearest: {', '.join(near)}" if near else f"it states {', '.join(known)}"
        reason = "is no number that the file states"
        raise AxisError(reason, key=path, name=file.name, remedy=remedy)
    key = key_of(path)
    array = np.atleast_1d(np.asarray(values, dtype=np.float64))
    good = np.isfinite(array) & (array <= key.within.high)
    good &= array > key.within.low if key.within.strict else array >= key.within.low
    if not good.all():
        value = f"{float(array[int(np.argmin(good))]):.6g} {number.unit}".removesuffix(" 1")
        raise AxisError(
            "is out of range", key=path, value=value, within=str(key.within), name=file.name
        )


def _count(changes: Mapping[str, Floats], feeds: Floats | None) -> int:
    """Return the number of points; raises ValueError where arrays have other lengths."""
    lengths: dict[str, tuple[int, ...]] = {path: np.shape(each) for path, each in changes.items()}
    if feeds is not None and feeds.ndim:
        lengths["feed"] = feeds.shape[:1]
    one_line = all(len(each) == 1 for each in lengths.values())
    if len(set(lengths.values())) > 1 or not one_line or (feeds is not None and feeds.ndim > 2):
        told = ", ".join(f"{name} {shape}" for name, shape in lengths.items())
        raise ValueError(f"arrays of one length are needed: {told}")
    return next((each[0] for each in lengths.values()), 1)


def _table_of(feeds: Floats | None, count: int) -> Floats:
    """Return the feeds of each point as (points, feeds)."""
    if feeds is None:
        return np.empty((count, 0))
    if not np.all((feeds > 0.0) & np.isfinite(feeds)):
        raise ValueError("a feed is a finite speed above 0")
    columns = feeds if feeds.ndim == 2 else feeds.reshape(-1, 1)
    return np.broadcast_to(columns, (count, columns.shape[1]))


def _closed(
    file: AxisFile, changes: Mapping[str, Floats], table: Floats, count: int, *, regimes_only: bool
) -> dict[str, NDArray[Any]]:
    """Return the columns of axes on a rigid drive with constant friction, in closed form."""
    axes = file.changed(changes).axis()
    shape = (count,)
    limit = np.array(np.broadcast_to(coulomb_limit(axes.block(1.0)), shape))
    found: dict[str, NDArray[Any]] = {
        "critical_feed": limit,
        "stable": np.ones(shape, dtype=np.bool_),
        "clamped": np.array(np.broadcast_to(axes.friction.capped, shape)),
        "jump": np.full(table.shape, math.nan),
        "rate": np.full(table.shape, math.nan),
        "regime": np.where(table <= limit[:, np.newaxis], STICKS, EVEN).astype(np.int8),
    }
    for column, feed in enumerate(() if regimes_only else table.T):
        cycle = steady_cycle(axes.block(np.ascontiguousarray(feed)))  # type: ignore[arg-type]
        found["jump"][:, column] = np.where(cycle.exists, cycle.delta_x, 0.0)
        found["rate"][:, column] = np.where(cycle.exists, cycle.f, 0.0)
        # Within rounding of the limit the cycle itself decides.
        found["regime"][:, column] = np.where(cycle.exists, STICKS, EVEN)
    return found


def _each(
    file: AxisFile, changes: Mapping[str, Floats], table: Floats, count: int, *, regimes_only: bool
) -> dict[str, NDArray[Any]]:
    """Return the columns of axes that are computed one by one."""
    found: dict[str, NDArray[Any]] = {
        "critical_feed": np.empty(count),
        "stable": np.empty(count, dtype=np.bool_),
        "clamped": np.empty(count, dtype=np.bool_),
        "jump": np.empty(table.shape),
        "rate": np.empty(table.shape),
        "regime": np.empty(table.shape, dtype=np.int8),
    }
    for point in range(count):
        axis = file.changed({path: float(each[point]) for path, each in changes.items()}).axis()
        feeds = [float(each) for each in table[point]]
        try:
            answer = _answer(axis, feeds, regimes_only=regimes_only)
        except RuntimeError:
            # A slip cannot be followed: a damping of some ten that a steep friction overcomes.
            unknown = [math.nan] * len(feeds)
            answer = _Answer(math.nan, True, unknown, unknown, [UNKNOWN] * len(feeds))
        found["critical_feed"][point] = answer.critical
        found["stable"][point] = answer.stable
        found["clamped"][point] = axis.friction.capped
        found["jump"][point] = answer.jumps
        found["rate"][point] = answer.rates
        found["regime"][point] = answer.regimes
    return found


def _answer(axis: Axis, feeds: Sequence[float], *, regimes_only: bool) -> _Answer:
    """Return what one axis does; an unstable loop swings at every feed."""
    unknown = [math.nan] * len(feeds)
    if axis.drive is None:
        find = _rigid_regimes if regimes_only else _rigid
    elif is_stable(axis):
        find = _loop_regimes if regimes_only else _loop
    else:
        return _Answer(math.inf, False, unknown, unknown, [SWINGS] * len(feeds))
    critical, regimes = find(axis, feeds)
    if regimes_only:
        return _Answer(critical, True, unknown, unknown, regimes)
    jumps, rates = [], []
    for feed, regime in zip(feeds, regimes, strict=True):
        way, rate = 0.0, 0.0
        if regime == STICKS:
            way, rate = jumps_of(axis, feed) or (math.nan, math.nan)
        jumps.append(float(way))
        rates.append(float(rate))
    return _Answer(critical, True, jumps, rates, regimes)


def _loop(axis: Axis, feeds: Sequence[float]) -> tuple[float, list[int]]:
    """Return the critical feed [m/s] of a servo axis and its regimes."""
    return limits_of(axis).highest, _loop_regimes(axis, feeds)[1]


def _loop_regimes(axis: Axis, feeds: Sequence[float]) -> tuple[float, list[int]]:
    """Return the regimes of a servo axis: in jumps, where both exist."""
    reached = 0.0
    if axis.friction.law == "coulomb":
        # A cycle that does not form at slow feeds may do so above them all.
        reached = limit_of_jumps(axis, max(feeds)).feed or limit_of_jumps(axis).feed
    return math.nan, [STICKS if v <= reached else _CODES[kind_beside(axis, v)] for v in feeds]


def _rigid(axis: Axis, feeds: Sequence[float]) -> tuple[float, list[int]]:
    """Return critical feed [m/s] and regimes on a rigid drive under a law without closed forms."""
    friction, p = axis.friction, axis.block(1.0)
    found = critical_velocity(p, friction.law, friction.own)
    critical, (low, high) = found.highest, found.between
    between = min([low, *feeds]), max([high, *feeds])
    if between != (low, high):
        found = critical_velocity(p, friction.law, friction.own, between)
    return critical, [_regime(found, v) for v in feeds]


def _rigid_regimes(axis: Axis, feeds: Sequence[float]) -> tuple[float, list[int]]:
    """Return the regimes on a rigid drive, searched for beside each feed only."""
    friction, p = axis.friction, axis.block(1.0)
    return math.nan, [
        _regime(critical_velocity(p, friction.law, friction.own, (v * (1.0 - _BESIDE), v)), v)
        for v in feeds
    ]


def _regime(found: CriticalVelocity, feed: float) -> int:
    """Return the regime at a feed [m/s] that rose from rest: in jumps, where both exist."""
    return _CODES[found.motions(feed)[0]]
