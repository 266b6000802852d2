"""How a servo axis jumps at a feed, and up to which feed: docs/feed-axis.md.

The samples of the controller are kept, counts of the
encoders left out.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from ..axis import Axis
from ..one_thread import one_thread
from .lines import lines_of
from .motion import OF_TABLE, Event, Motion, Point, after, margins_of, rising_again
from .system import LAST, MOTOR, SPEED, TABLE, Mode, System

_CYCLES: Final = 12
"""Cycles at each feed: the first half lets it settle, over the second samples fall differently."""
_LONGEST: Final = 1e3
"""No cycle, where a slip or a stick lasts longer than this, relative to the time 1/w."""
_STEADY: Final = 2e-4
"""Cycles are steady where half of them is as long as the other, to this."""
_CLOSE: Final = 5e-4
"""The feed at which jumping ends is found to this, relative."""
_SHARE: Final = 0.7
"""Share of the way to the foretold end that a step takes."""
_BEGINNINGS: Final = tuple(0.5**n for n in range(1, 14))
"""Where the search begins, in units of w times the relief. Slower, the integral of a drive that
measures on the table turns it back in its rests: it hunts along the way."""
_RUNG: Final = 1.5
"""From feed to feed where jumps are looked for, if friction changes with the speed."""
_SLOWER, _FASTER = 0.02, 5.0
"""How far these reach beyond the speeds of the friction and of the jumps."""
_MOST: Final = 2_000
"""Steps of a search."""


class Jump(NamedTuple):
    """A slip of the table and the stick after it.

    Attributes
    ----------
    way
        Of the table in the slip [m].
    t_slip, t_stick
        How long it slips, and rests after it [s].
    relief
        By how much the spring force falls [N].
    least
        The speed that a slip without rest would have fallen to [m/s]; below 0.
    """

    way: float
    t_slip: float
    t_stick: float
    relief: float
    least: float

    @property
    def period(self) -> float:
        """From one break-away to the next [s]."""
        return self.t_slip + self.t_stick


class Limit(NamedTuple):
    """Where jumping ends as the feed rises.

    Attributes
    ----------
    feed
        The highest feed that is reached in jumps [m/s]; 0 where there is none.
    jump
        The longest jump of the settled cycle there; None where there is none.
    rate
        Jumps a second there [1/s].
    """

    feed: float
    jump: Jump | None
    rate: float = 0.0


class _Followed(NamedTuple):
    """An event of the table, and how table and motor move up to it."""

    mode: Mode
    reached: Event


class Jumping:
    """The cycle of a servo axis, carried from feed to feed.

    Parameters
    ----------
    axis
        An axis with a drive.
    feed
        Where it begins [m/s], above 0: out of an even creep of the motor against the table at rest.
    """

    def __init__(self, axis: Axis, feed: float) -> None:
        self._system = System(axis)
        self._motion = Motion(self._system)
        self.feed = feed
        self._at = loaded(self._system, feed)

    def at(self, feed: float) -> list[Jump] | None:
        """Return the jumps of some cycles at a feed [m/s]; None, and stay, where they end."""
        system = self._system
        there = self._moved(feed)
        mode = Mode(0, 1)
        event = self._followed(mode, there)
        jumps: list[Jump] = []
        for _ in range(_MOST):
            if len(jumps) >= _CYCLES and self._settled(jumps):
                break
            if event is None:
                return None
            mode, start = after(system, event.mode, event.reached)
            slip = self._followed(mode, start)
            if slip is None or mode.table != 1:
                return None
            # Within a swing; where the friction falls, going on so could grow without end.
            swing = 2.0 * math.pi * math.sqrt(system.axis.m / system.axis.k)
            least = self._motion.follow(
                slip.mode, rising_again(system, slip.mode), slip.reached.point, swing
            ).point.state[SPEED]
            mode, stick = after(system, slip.mode, slip.reached)
            way = float(stick.state[TABLE] - start.state[TABLE])
            relief = system.axis.k * float(start.state[MOTOR] - stick.state[MOTOR] + way)
            stick = _centred(system, stick)
            event = self._followed(mode, stick)
            if event is None:
                return None
            t_slip, t_stick = slip.reached.elapsed, event.reached.elapsed
            jumps.append(Jump(way, t_slip, t_stick, relief, float(least)))
        assert event is not None
        self._at, self.feed = event.reached.point, feed
        return jumps

    def _settled(self, jumps: list[Jump]) -> bool:
        """Tell whether the last cycles are steady; only growing friction takes long over it.

        Beyond a fold the jumps shrink slowly before they end.
        """
        if not len(self._system.growth[0]):
            return True
        before, last = (
            sum(each.way for each in jumps[begin:end])
            for begin, end in ((-_CYCLES, -_CYCLES // 2), (-_CYCLES // 2, None))
        )
        return abs(last / before - 1.0) <= _STEADY

    @property
    def _longest(self) -> float:
        axis = self._system.axis
        return _LONGEST * math.sqrt(axis.m / axis.k) + 4.0 * axis.F_s / (axis.k * self.feed)

    def _followed(self, mode: Mode, point: Point) -> _Followed | None:
        """Follow to the next event of the table, past those of the motor; None where none comes."""
        passed = 0.0
        for _ in range(_MOST):
            margins = margins_of(self._system, mode)
            found = self._motion.follow(mode, margins, point, self._longest - passed)
            passed += found.elapsed
            if found.event is None:
                return None
            if found.event in OF_TABLE:
                return _Followed(mode, found._replace(elapsed=passed))
            mode, point = after(self._system, mode, found)
        return None

    def _moved(self, feed: float) -> Point:
        """Return where the cycle stands, with an even motion of the difference in feed added."""
        system = self._system
        state = self._at.state.copy()
        difference = feed - self.feed
        if difference:
            even = system.holding(0.0, difference) - system.holding(0.0, 0.0)
            even[LAST] *= self._at.offset / system.drive.T_s
            state += even
        return Point(state, self._at.offset)


def loaded(system: System, feed: float) -> Point:
    """Return where a table at rest is about to break away, the motor creeping at a feed [m/s].

    The break-away comes half a sample later.
    """
    axis = system.axis
    age = axis.F_s / (axis.k * feed)
    pull = system.held(age) - axis.along
    state = system.holding(pull, feed)
    state[system.layout.ungrown] *= np.exp(-system.growth[0] * age)
    stretch = pull / axis.k - 0.5 * system.drive.T_s * feed
    state[[MOTOR, LAST]] += stretch
    if not system.drive.on_table:
        state[system.layout.command] += stretch
    return Point(state, 0.0)


@one_thread
def jump_at(axis: Axis, feed: float) -> Jump | None:
    """Return the longest jump of the settled cycle at a feed [m/s], None where none is reached."""
    limit = limit_of_jumps(axis, highest=feed)
    return limit.jump if limit.feed >= feed else None


@one_thread
def limit_of_jumps(axis: Axis, highest: float = math.inf, begin: float | None = None) -> Limit:
    """Return the highest feed that a servo axis reaches in jumps when the feed rises slowly.

    Parameters
    ----------
    axis
        An axis with a drive.
    highest
        Where the search ends [m/s].
    begin
        A feed with jumps to begin at [m/s]; else one is looked for.

    Notes
    -----
    At the end the least speed of a slip comes to 0 (grazing). The cycle is carried along; each step
    goes part of the way to where that speed, by its last change, would be 0.
    """
    if begin is None:
        found = _begun(axis, highest)
    else:
        cycle = Jumping(axis, begin)
        jumps = cycle.at(begin)
        found = None if jumps is None else (cycle, jumps)
    if found is None:
        return Limit(0.0, None)
    cycle, jumps = found
    known = cycle.feed, _least(jumps)
    step = min(0.5 * cycle.feed, highest - cycle.feed)
    for _ in range(_MOST):
        feed = min(cycle.feed + step, highest)
        now = cycle.at(feed)
        if now is None:
            if step <= _CLOSE * cycle.feed:
                break
            step = max(0.25 * step, _CLOSE * cycle.feed)
            continue
        jumps = now
        if feed >= highest:
            break
        least = _least(jumps)
        slope = (least - known[1]) / (feed - known[0])
        left = -least / slope if slope > 0.0 else feed
        known = feed, least
        step = min(max(_SHARE * left, _CLOSE * feed), feed)
    settled = jumps[-(_CYCLES // 2) :]
    rate = len(settled) / sum(each.period for each in settled)
    return Limit(cycle.feed, max(settled, key=lambda each: each.way), rate)


def _begun(axis: Axis, highest: float) -> tuple[Jumping, list[Jump]] | None:
    """Return the cycle at the highest of the feeds tried at which it forms; None without one."""
    for feed in dict.fromkeys(min(feed, highest) for feed in beginnings(axis)):
        if feed > 0.0:
            cycle = Jumping(axis, feed)
            jumps = cycle.at(feed)
            if jumps is not None:
                return cycle, jumps
    return None


def beginnings(axis: Axis) -> list[float]:
    """Return the feeds at which a cycle is looked for [m/s], the highest first."""
    w = math.sqrt(axis.k / axis.m)
    whole = 2.0 * (axis.F_s - axis.F_k) / axis.k * w
    if axis.friction.law == "coulomb":
        return [share * whole for share in _BEGINNINGS]
    # Where friction changes with the speed a cycle may begin above a feed, and begin again.
    knots = [line.low for line in lines_of(axis)[1:]]
    scales = [scale for scale in (*knots, axis.F_s / axis.k * w) if scale > 0.0]
    low, high = _SLOWER * min(scales), _FASTER * max(scales)
    count = math.ceil(math.log(high / low) / math.log(_RUNG))
    return [high * (low / high) ** (number / count) for number in range(count + 1)]


def _least(jumps: list[Jump]) -> float:
    """Return the highest of the least speeds of the settled slips: the first not to stop."""
    return max(jump.least for jump in jumps[-(_CYCLES // 2) :])


def _centred(system: System, point: Point) -> Point:
    """Return a point with the table at 0."""
    state = point.state.copy()
    state[[MOTOR, TABLE, LAST, system.layout.command]] -= state[TABLE]
    return Point(state, point.offset)
