"""The critical feed of an axis, the highest that it reaches in jumps; its motion at a feed."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from stickslip_ref import (
    EVEN,
    STICKS,
    SWINGS,
    CriticalVelocity,
    Kind,
    Regime,
    coulomb_limit,
    critical_velocity,
    regime,
    simulate,
    steady_cycle,
)

from ..axis import Axis
from .courses import jolted, jump_ranges, regime_in_loop, up_to
from .jumps import Limit, limit_of_jumps, loaded
from .motion import MOST_TURNS, Watched, walk
from .stability import is_stable, swing, unstable_feeds
from .system import TABLE, Mode, Vector, line_at, system_of

_CYCLES: Final = 12
"""Cycles after which a jump under a law without a closed form is read."""
BESIDE: Final = 1e-9
"""A range of feeds this narrow is one feed."""


def limits_of(axis: Axis, reached: float | None = None) -> CriticalVelocity:
    """Return the feeds at which an axis sticks and slips, and at which even motion is unstable.

    The loop of a servo axis must be stable with the table sliding fast. With the feed that it has
    `reached` in jumps [m/s] those are all up to it; else they are looked for.
    """
    if axis.drive is None:
        return critical_velocity(axis.block(1.0), axis.friction.law, axis.friction.own)
    unstable = unstable_feeds(axis)
    jumps = jump_ranges(axis) if reached is None else up_to(reached)
    return CriticalVelocity(unstable, jumps, (0.0, math.inf), False)


def regime_of(axis: Axis, feed: float, limit: Limit | None = None) -> Regime:
    """Return what an axis, its loop stable, does at a feed [m/s] above 0.

    `limit` as of `regime_in_loop`, with a drive and friction that does not change with the speed.
    """
    if axis.drive is None:
        return regime(axis.block(feed), axis.friction.law, axis.friction.own)
    return regime_in_loop(axis, feed, limit)


def critical_feed(axis: Axis, highest: float = math.inf) -> float:
    """Return the highest feed that an axis reaches in jumps when the feed rises slowly [m/s].

    0 where it never jumps; infinite where jumps have no end. With a drive the coefficients are
    constant, and the search ends at the feed `highest` [m/s].
    """
    if axis.drive is None:
        return rigid_critical_feed(axis)
    return limit_of_jumps(axis, highest).feed


def rigid_critical_feed(axis: Axis) -> float:
    """Return the critical feed of an axis on a rigid drive [m/s], under its own friction law."""
    return limits_of(replace(axis, drive=None)).highest


def judders(axis: Axis, feed: float) -> bool:
    """Return whether an axis may stick and slip or swing at a feed [m/s]; an unstable loop does."""
    friction = axis.friction
    if axis.drive is None:
        beside = feed * (1.0 - BESIDE), feed
        found = critical_velocity(axis.block(feed), friction.law, friction.own, beside)
        return found.motions(feed) != (EVEN,)
    # What needs no motion first.
    if not is_stable(axis) or swing(axis, line=line_at(axis, feed)).damping < 0.0:
        return True
    return any(kind != EVEN for kind in jolted(axis, feed))


def is_allowed(axis: Axis, feed: float) -> bool:
    """Return whether the jumps of an axis at a feed [m/s] are no larger than allowed."""
    largest = axis.demand.largest_jump or 0.0
    return largest > 0.0 and (jumps := jumps_of(axis, feed)) is not None and jumps.way <= largest


def is_clean(axis: Axis) -> bool:
    """Return whether each feed asked for is even, or its jump allowed; the loop must be stable."""
    demand, reach = axis.demand, 0.0
    # RuntimeError: a slip cannot be followed.
    with suppress(RuntimeError):
        even = {feed: not judders(axis, feed) for feed in demand.feeds}
        # Jumps carried up from slower feeds may exist where no start ends in them.
        if axis.drive is not None and axis.friction.law == "coulomb" and any(even.values()):
            reach = critical_feed(axis, demand.feeds[-1 if demand.largest_jump else 0])
        return all((one and feed > reach) or is_allowed(axis, feed) for feed, one in even.items())
    return False


def kind_beside(axis: Axis, feed: float) -> Kind:
    """Return what a servo axis may do beside even motion at a feed [m/s]; "even" if nothing.

    After a break-away, a blow, and a hold.
    """
    kinds = set(jolted(axis, feed))
    if STICKS in kinds:
        return "sticks"
    unstable = swing(axis, line=line_at(axis, feed)).damping < 0.0
    return "swings" if unstable or SWINGS in kinds else "even"


def estimated_critical_feed(axis: Axis) -> float:
    """Return the quick estimate of the critical feed, of constant friction [m/s]; theory.md (14).

    With a drive the table is damped as the least damped swing of the sliding loop.
    """
    if axis.drive is not None:
        plain = replace(axis, friction=replace(axis.friction, law="coulomb", own={}))
        # From a damping ratio of 1 on nothing jumps; without damping the jumps have no end.
        axis = damped(axis, min(max(swing(plain).damping, 0.0), 2.0))
    return float(coulomb_limit(axis.block(1.0)))


def simplified_critical_feed(axis: Axis) -> float:
    """Return (mu_s - mu_k) N/sqrt(4 pi zeta k m) of the rigid drive [m/s]; infinite if c = 0."""
    zeta = axis.c / (2.0 * math.sqrt(axis.k * axis.m))
    if zeta == 0.0:
        return math.inf
    return (axis.F_s - axis.F_k) / math.sqrt(4.0 * math.pi * zeta * axis.k * axis.m)


class Jumps(NamedTuple):
    """The settled jumps at a feed: the way of the longest [m], and how many there are [1/s]."""

    way: float
    rate: float


def jumps_of(axis: Axis, feed: float) -> Jumps | None:
    """Return the jumps at a feed that an axis reaches in jumps [m/s].

    None where there is no even row of jumps: above the critical feed, and where a drive turns the
    table back between two jumps.
    """
    if axis.drive is not None:
        limit = limit_of_jumps(axis, highest=feed)
        if limit.jump is None or limit.feed < feed:
            return None
        return Jumps(limit.jump.way, limit.rate)
    p, friction = axis.block(feed), axis.friction
    if friction.constant:
        jump = float(steady_cycle(p).delta_x)
        return None if math.isnan(jump) else Jumps(jump, feed / jump)
    load_up = axis.F_s / (axis.k * feed)
    one = load_up + 2.0 * math.pi * math.sqrt(axis.m / axis.k)
    run = simulate(p, load_up + _CYCLES * one, law=friction.law, own=friction.own)
    return Jumps(run.cycles[-1].delta_x, 1.0 / run.cycles[-1].T) if run.cycles else None


def damped(axis: Axis, zeta: float) -> Axis:
    """Return the axis with another damping ratio of table and spring [-]."""
    return replace(axis, c=2.0 * zeta * math.sqrt(axis.k * axis.m))


_POINTS: Final = 600


class Record(NamedTuple):
    """A motion: times [s] since the break-away, and how far the table is ahead of the feed [m]."""

    time: Vector
    ahead: Vector


def record(axis: Axis, feed: float, span: float) -> Record:
    """Return how the table moves after a break-away at a feed [m/s], above 0, over a span [s]."""
    time = np.linspace(0.0, span, _POINTS)
    if axis.drive is None:
        load_up = max(axis.F_s - axis.along, 0.0) / (axis.k * feed)
        law, own = axis.friction.law, axis.friction.own
        run = simulate(axis.block(feed), load_up + span, times=load_up + time, law=law, own=own)
        return Record(time, run.x - run.x[0] - feed * time)
    system = system_of(axis)
    mode, point = Mode(0, 1), loaded(system, feed)
    place = np.empty_like(time)
    for number, step in enumerate(np.diff(time, prepend=0.0)):
        following = walk(system, mode, point, Watched(float(step)))
        following.turns(MOST_TURNS)
        mode, point = following.mode, following.point
        place[number] = point.state[TABLE]
    if not math.isfinite(float(place[-1])):
        place[:] = math.nan
    return Record(time, place - feed * time)
