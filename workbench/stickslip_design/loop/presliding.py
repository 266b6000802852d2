"""What presliding makes of the verdict on an axis: docs/design.md, "With presliding".

Friction is that of `follower`. A feed of 0 is a target that is held.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np

from stickslip_units import told

from ..axis import Assumed, Axis
from ..one_thread import one_thread
from .critical import judders
from .follower import FALL, Follower, Matrix, Vector, assumed, presliding
from .rest import Hunting

_OF_FEED, _OF_SLIP = 1.0 / 3.0, 0.1
"""Speed over which two coefficients fall, over the feed, where friction is then kinetic to 1e-4 of
the gap, and at most over the speed of a slip. Much slower, it would fall in the presliding."""
_CHUNKS, _LEAST, _UNLIKE, _LONGER = 26, 4, 12, 1.25
"""Chunks after which a motion is left open; before one is judged, and before one whose cycles are
not alike is. Each is longer: where an integral winds up in the rests a cycle lasts."""
_CYCLES, _SWINGS, _DECAYS, _SLOWEST = 2.0, 10.0, 0.2, 1e-3
"""Cycles of Coulomb's friction or swings of the table on its spring in a chunk, at least; share of
the slowest time constant: what dies away shrinks by 18 %; slowest rate over w."""
_STEADY, _STILL, _STOPS = 0.01, 1e-3, 0.5
"""A motion is steady where its range changes by less from chunk to chunk, and even where it is
below this part of the feed, or of the jump at a target. Beyond which part of the feed it jumps."""
_SAMPLES, _MOST = 40, 200_000
"""Points in a swing, and at most in a chunk."""
_FACTOR, _FACTORS, _CLOSE = 3.0, 4, 1.1
"""Steps in which the presliding is sought at which the answer turns; how near it is found."""


class Motion(NamedTuple):
    """Where a start leads."""

    kind: Literal["even", "jumps", "swings", "hunts", "open"]
    """Even, or rest; jumps; swings above half of the feed; jumps about a target; open: it had not
    settled when it was no longer followed."""
    jump: float = 0.0
    """Way of the longest jump, at a target range of the places [m]."""
    period: float = 0.0
    """Of jumps or swings, on average [s]."""


class AtFeed(NamedTuple):
    """What an axis does with presliding at a feed [m/s]."""

    feed: float
    growth: float
    """Of the slowest motion about even sliding, or rest, in the linearised loop [1/s]."""
    from_rest: Motion
    from_jumps: Motion
    """Out of the motion without presliding: about to break away; where that ends evenly after a
    hold, and after a blow that winds the spring as much again."""
    falls: bool = False
    """Whether it judders without presliding, too, where friction falls as it does here and not at
    once; asked where the verdict says that it does not."""
    turns_at: float | None = None
    """Presliding from which on it does not judder [m], to 10 %; None: not asked, or not found."""

    @property
    def judders(self) -> bool | None:
        """Whether a motion that is not even exists; None where that is open."""
        kinds = {self.from_rest.kind, self.from_jumps.kind}
        if self.growth > 0.0 or kinds - {"even", "open"}:
            return True
        return None if "open" in kinds else False


@dataclass(frozen=True)
class Presliding:
    """What presliding makes of a verdict."""

    way: float
    """The presliding [m]."""
    refused: str
    """Why it is not judged, in words; empty where it is."""
    assumed: tuple[Assumed, ...] = ()
    """What is taken of it that the axis does not state."""
    feeds: tuple[AtFeed, ...] = ()
    target: AtFeed | None = None
    """The feeds, the slowest first; a target where the axis hunts without presliding."""


def _refusal(axis: Axis) -> str:
    friction = axis.friction
    reasons = {
        "no handbook has that of a rotary table": axis.turns,
        "the way has no dry friction": axis.F_s == 0.0,
        "a measured curve does not say how friction breaks away": friction.is_curve,
        "bristles know no static friction that grows at rest": friction.tau_s or friction.B,
    }
    found = next((reason for reason, holds in reasons.items() if holds), "")
    with suppress(ValueError):
        _ = found or Follower(axis)
        return found
    return "the loop is unstable with its sampling taken as a delay"


@one_thread
def with_presliding(axis: Axis, said: Mapping[float, bool], rest: Hunting | None) -> Presliding:
    """Return what presliding makes of the verdict on an axis, its loop stable.

    `said` are the feeds [m/s] with whether it judders by the verdict, `rest` its cycle at a target.
    """
    way, constant = presliding(axis), axis.friction.constant
    if reason := _refusal(axis):
        return Presliding(way, reason)

    def judged(feed: float, now: bool) -> AtFeed:
        found = at_feed(axis, feed, rest)
        if now and found.judders is not None:
            return found._replace(turns_at=_turns_at(axis, found, rest))
        if found.judders and not now and constant:
            own = {"shape": 1.0, "v_s": stribeck_speed(axis, feed), "delta": 2.0}
            fallen = replace(axis.friction, law="stribeck", own=own)
            return found._replace(falls=judders(replace(axis, friction=fallen), feed))
        return found

    taken = [each for each in assumed(axis) if each.key == "friction.presliding"]
    if constant and axis.F_s > axis.F_k:
        value = f"a third of the feed, {told(stribeck_speed(axis, math.inf), 'm/s')} at most"
        taken.append(Assumed("friction.v_s", value, "kinetic at the feed, as without presliding"))
    feeds = tuple(judged(feed, said[feed]) for feed in sorted(said))
    return Presliding(way, "", tuple(taken), feeds, judged(0.0, True) if rest else None)


def _turns_at(axis: Axis, found: AtFeed, rest: Hunting | None) -> float | None:
    """Return the presliding [m] beyond which an axis does not judder at a feed, to 10 %."""

    def same(way: float) -> bool:
        other = replace(axis, friction=replace(axis.friction, presliding=way))
        # What is open may judder.
        return (at_feed(other, found.feed, rest).judders is not False) is found.judders

    inside, factor = presliding(axis), _FACTOR if found.judders else 1.0 / _FACTOR
    ways = [inside * factor**number for number in range(1, _FACTORS + 1)]
    outside = next((way for way in ways if not same(way)), None)
    if outside is None:
        return None
    inside = outside / factor
    while max(inside / outside, outside / inside) > _CLOSE:
        middle = math.sqrt(inside * outside)
        inside, outside = (middle, outside) if same(middle) else (inside, middle)
    return max(inside, outside)


def stribeck_speed(axis: Axis, feed: float) -> float:
    """Return the speed [m/s] over which friction is taken to fall at a feed [m/s]."""
    slip = (axis.F_s - axis.F_k) / math.sqrt(axis.k * axis.m)
    return min(_OF_FEED * (feed or math.inf), _OF_SLIP * slip) or FALL


def at_feed(axis: Axis, feed: float, rest: Hunting | None = None) -> AtFeed:
    """Return what an axis does with presliding at a feed [m/s]; at 0 about a target, as `rest`."""
    follower, relief = Follower(axis, stribeck_speed(axis, feed)), (axis.F_s - axis.F_k) / axis.k
    table, bristles, growth = follower.table, follower.size, growth_of(follower, feed)
    jumping, held = follower.even(feed, held=True), follower.even(feed)
    begin, struck = np.zeros(held.size), jumping.copy()
    held[[table, table + 1, bristles]] += -relief, -feed, jumping[bristles] - held[bristles]
    struck[table] -= axis.F_s / axis.k
    if rest and not feed:
        # Half the relief of the spring away; and as far as in the cycle.
        begin[: table + 1 : 2] = -relief
        jumping[: table + 1 : 2] -= rest.dead_band
    cycle = 2.0 * relief / feed if feed else rest.period if rest else 0.0
    states = (begin, jumping, held, struck) if feed else (begin, jumping)
    motions = (_motion(axis, follower, feed, growth, cycle, state) for state in states)
    from_rest = next(motions)
    return AtFeed(
        feed, growth, from_rest, next((m for m in motions if m.kind != "even"), Motion("even"))
    )


def growth_of(follower: Follower, feed: float) -> float:
    """Return the growth of the slowest motion about even sliding at a feed [m/s], or rest [1/s].

    In sliding the bristles z of a contact answer its speed v with
    d/dt dz = v g'/g dv - (sigma_0 v/g) dz. At rest they go with the place: a spring sigma_0.
    """
    size = follower.size
    matrix = np.zeros((size + len(follower.contacts),) * 2)
    matrix[:size, :size] = follower.rates[:, :size]
    for place, one in enumerate(follower.contacts, size):
        force, g, step = matrix[one.speed], one.slip(feed), 1e-4 * feed
        if feed:
            slope = (one.slip(feed + step) - one.slip(feed - step)) / (2.0 * step)
            matrix[place, [one.speed, place]] = feed * slope / g, -one.sigma_0 * feed / g
            force -= one.sigma_1 * math.exp(-((feed / one.v_d) ** 2)) / one.mass * matrix[place]
            force[place] -= one.sigma_0 / one.mass
        else:
            force[[one.speed - 1, one.speed]] -= one.sigma_0 / one.mass, one.sigma_1 / one.mass
    roots = np.linalg.eigvals(matrix if feed else matrix[:size, :size])
    growth = float(roots.real.max())
    # Less is rounding.
    return growth if abs(growth) > 1e-9 * float(np.abs(roots).max()) else 0.0


def _motion(
    axis: Axis, follower: Follower, feed: float, growth: float, cycle: float, state: Vector
) -> Motion:
    """Return where a start leads: it is followed, chunk by chunk, until it is even or steady."""
    w, place = math.sqrt(axis.k / axis.m), follower.table + bool(feed)
    swing, ranges = 2.0 * math.pi / w, list[float]()
    length = max(_CYCLES * (cycle + swing), _SWINGS * swing)
    length = max(length, _DECAYS / max(abs(growth), _SLOWEST * w))
    still = _STILL * (feed or 2.0 * (axis.F_s - axis.F_k) / axis.k)
    # RuntimeError: it cannot be followed.
    with suppress(RuntimeError):
        # Bristles without load are at rest.
        if feed and not state.any():
            ramp = feed / (axis.demand.acceleration or 0.1)
            rising = (lambda t: feed * t / ramp), (lambda _: feed / ramp)
            state = follower.states(state, *rising, (0.0, 2.0 * ramp), np.array([ramp]))[0]
        for number in range(_CHUNKS):
            count = min(math.ceil(_SAMPLES * length / swing), _MOST)
            time = np.linspace(0.0, length, count + 1)[1:]
            even = (lambda _: feed), (lambda _: 0.0)
            rows = follower.states(state, *even, (0.0, 1.001 * length), time)
            state, length = rows[-1], _LONGER * length
            # Less the feed: a table that rests is not even.
            ranges.append(float(np.ptp(np.append(rows[:, place], 0.0 if feed else state[place]))))
            if number < _LEAST:
                continue
            if ranges[-1] < still and growth <= 0.0:
                return Motion("even")
            alike = all(abs(now / last - 1.0) < _STEADY for last, now in pairwise(ranges[-3:]))
            # What is not alike but as wide as before does not die away either.
            goes_on = alike or (number > _UNLIKE and ranges[-1] > 0.8 * max(ranges[number // 2 :]))
            if goes_on and ranges[-1] > still:
                found = _cycle(feed, swing, time, rows[:, follower.table : follower.table + 2])
                if found is not None:
                    return found
    return Motion("open")


def _cycle(feed: float, swing: float, time: Vector, rows: Matrix) -> Motion | None:
    """Return the motion of deviations of place and speed; None where they do not go to and fro."""
    seen, speed, place = rows[:, 1 if feed else 0], rows[:, 1] + feed, rows[:, 0] + feed * time
    rises, stops = _rises(time, seen, 0.5 * float(seen.max() + seen.min())), _STOPS * feed
    if len(rises) < 3:
        return None
    period = float(np.mean(np.diff(rises)))
    if not feed or speed.min() > stops:
        return (
            Motion("swings", 0.0, period) if feed else Motion("hunts", float(np.ptp(seen)), period)
        )
    begins, ends = _rises(time, speed, stops), _rises(time, -speed, -stops)
    if len(begins) < 3:
        return None
    ends = ends[ends > begins[0]]
    begins = begins[: ends.size]
    # Back and on again within a swing is the same jump, which rings.
    gaps = zip(ends, begins[1:], strict=False)
    new = [
        b - e > swing or speed[(time > e) & (time < b)].min(initial=feed) > -stops for e, b in gaps
    ]
    begins, ends = begins[[True, *new]], ends[[*new, True]]
    if len(begins) < 3:
        return None
    jumps = np.interp(ends, time, place) - np.interp(begins, time, place)
    return Motion("jumps", float(jumps.max()), float(np.mean(np.diff(begins))))


def _rises(time: Vector, seen: Vector, level: float) -> Vector:
    """Return the times at which what is seen rises through a level."""
    at = np.flatnonzero((seen[:-1] <= level) & (seen[1:] > level))
    return time[at] + (level - seen[at]) / (seen[at + 1] - seen[at]) * (time[at + 1] - time[at])
