"""Will this axis judder? `design` puts the answer together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

from stickslip_ref import CriticalVelocity, simplified

from .axis import Axis, AxisFile, Number
from .levers import END, cures
from .loop.critical import (
    Record,
    critical_feed,
    estimated_critical_feed,
    limits_of,
    record,
    regime_of,
    rigid_critical_feed,
    simplified_critical_feed,
)
from .loop.jumps import Limit
from .loop.presliding import with_presliding
from .loop.rest import limit_from_rest
from .loop.stability import Response, gain_limits, is_stable, open_loop, swing
from .measures.judged import Found, hunting_of, measures
from .measures.robust import Series
from .one_thread import one_thread
from .verdict import (
    AxisCure,
    OperatingPoint,
    Verdict,
    best,
    feed_in_words,
    in_its_units,
    in_words,
    judder,
    margin_of,
)

_UNANSWERED: Final = (
    "Reversal and backlash: the axis moves in one direction.",
    "Other modes: screw, table and frame are one mass and one spring.",
)
_PRESLIDING: Final = (
    "Presliding: the guideway holds the table without give until it breaks away; a way that yields "
    "by some micrometres may end small jumps and hunting."
)
_OF_LOOP: Final = "Counts of the encoders and the limit of the motor's force are left out."

_PERIODS: Final = 8.0
"""Periods of the motions that are shown."""


@one_thread
def design(axis: Axis | AxisFile, *, presliding: bool = False) -> Verdict:
    """Return whether an axis judders at the feeds that are asked of it, and what cures it.

    Without feeds only its limits are found. Only a file has the ± that make a range of the critical
    feed. Of an unstable loop the limits and cures are left out: infinite, and empty. What
    `presliding` makes of the answer takes some seconds more, and is asked for.
    """
    file = axis if isinstance(axis, AxisFile) else None
    axis = axis.axis() if isinstance(axis, AxisFile) else axis
    loop, constant = axis.drive is not None, axis.friction.constant
    stable = is_stable(axis)
    limits = limits_of(axis) if stable else CriticalVelocity((), (), (0.0, math.inf), False)
    critical = limits.highest if stable else math.inf
    start = _from_rest(axis, critical) if stable else None
    points = tuple(_points(axis, limits, start)) if stable else ()
    rest = hunting_of(axis) if stable else None
    series = Series(axis, file)
    found, left_out = measures(series, points, critical, rest) if stable else ((), {})
    before, after = _motions(axis, judder(points), found)
    offered = tuple(each.measure for each in found)
    said = {point.feed: point.judders for point in points}
    yields = with_presliding(axis, said, rest) if presliding and stable else None
    answered = yields and not yields.refused
    left = _UNANSWERED if answered else (*_UNANSWERED, _PRESLIDING)
    return Verdict(
        axis=axis,
        stable=stable,
        cycle=limits.cycle,
        unstable=limits.unstable,
        critical_feed=critical,
        critical_range=_range(file, axis, critical) if stable else (critical, critical),
        rigid_critical_feed=rigid_critical_feed(axis) if loop else critical,
        estimated_critical_feed=estimated_critical_feed(axis) if loop and constant else None,
        simplified_critical_feed=simplified_critical_feed(axis),
        from_rest=start,
        sliding=swing(axis) if loop else None,
        stuck=swing(axis, sliding=False) if loop else None,
        gains=gain_limits(axis) if loop else None,
        points=points,
        robustness=series.robustness(axis),
        varied=series.varied,
        varied_by_default=series.assumed,
        hunting=rest,
        responses=tuple(_responses(axis)) if loop else (),
        measures=offered,
        left_out=left_out,
        cures=_cures(axis, points),
        before=before,
        after=after,
        sentence=in_words(axis, limits, points, offered, stable=stable),
        unanswered=(*left, _OF_LOOP) if loop else left,
        presliding=yields,
    )


def _from_rest(axis: Axis, highest: float) -> float | None:
    if axis.drive is None or axis.demand.acceleration is None or highest == 0.0:
        return None
    return limit_from_rest(axis, axis.demand.acceleration, highest)


def _points(axis: Axis, limits: CriticalVelocity, start: float | None) -> Iterator[OperatingPoint]:
    limit = None
    if axis.drive is not None and axis.friction.law == "coulomb" and limits.cycle:
        first = limits.cycle[0]
        limit = Limit(first.high if first.low == 0.0 else 0.0, None)
    for feed in sorted(axis.demand.feeds):
        simple = simplified(axis.block(feed))
        yield OperatingPoint(
            regime=regime_of(axis, feed, limit),
            margin=margin_of(limits, feed),
            after_start=None if start is None else feed <= start,
            simplified_jump=float(simple.delta_x),
            simplified_frequency=float(simple.f),
        )


@in_its_units
def _cures(axis: Axis, points: Sequence[OperatingPoint]) -> tuple[AxisCure, ...]:
    """Return how far one number must go to make the slowest feed that judders even."""
    point = judder(points)
    if point is None:
        return ()
    slowest = point is points[0] and point.jumps
    aim = END if slowest else f"even motion at {feed_in_words(point.feed)}"
    return cures(axis, point.feed, aim)


def _motions(
    axis: Axis, judders: OperatingPoint | None, found: Sequence[Found]
) -> tuple[Record | None, Record | None]:
    """Return the motion at the feed that judders, as it is and with the best measure."""
    if judders is None or judders.frequency is None:
        return None, None
    first, span = best(each.measure for each in found), _PERIODS / judders.frequency
    after = [record(each.axis, judders.feed, span) for each in found if each.measure is first]
    return record(axis, judders.feed, span), next(iter(after), None)


def _range(file: AxisFile | None, axis: Axis, critical: float) -> tuple[float, float]:
    """Return the lowest and the highest critical feed [m/s] within the ± and along the screw."""
    others = list(_ends_of_spread(file, axis)) if file is not None and axis.spread else []
    if axis.stiffest is not None:
        others.append(replace(axis, k=axis.stiffest))
    found = [critical_feed(each) if is_stable(each) else math.inf for each in others]
    return min(*found, critical, critical), max(*found, critical, critical)


def _ends_of_spread(file: AxisFile, axis: Axis) -> Iterator[Axis]:
    """Return the axes within the ± of the file that jump at the lowest and the highest feeds.

    Each number alone says by the estimate which way it moves the critical feed; all then move that
    way at once.
    """
    quick = rigid_critical_feed if axis.drive is None else estimated_critical_feed
    lowest: dict[str, float] = {}
    highest: dict[str, float] = {}
    for name, spread in axis.spread.items():
        number = file.values[name]
        assert isinstance(number, Number)
        less, more = number.value - spread, number.value + spread
        rising = quick(file.changed({name: more}).axis()) > quick(file.changed({name: less}).axis())
        lowest[name], highest[name] = (less, more) if rising else (more, less)
    for each in (lowest, highest):
        yield file.changed(each).axis()


def _responses(axis: Axis) -> Iterator[Response]:
    yield open_loop(axis, "position")
    # A stuck table does not answer a scale: that loop is not closed.
    if axis.drive is not None and not axis.drive.on_table:
        yield open_loop(axis, "position", sliding=False)
    yield open_loop(axis, "force")
    yield open_loop(axis, "force", sliding=False)
