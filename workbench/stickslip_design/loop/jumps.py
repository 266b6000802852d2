"""How a servo axis jumps at a feed, and up to which feed: docs/feed-axis.md."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from ..axis import Axis
from ..one_thread import one_thread
from .motion import Point, Watched, walk
from .stability import decays, settling
from .system import LAST, TABLE, Mode, System, system_of

_CYCLES: Final = 12
"""Cycles at each feed: the first half lets it settle, over the second samples fall differently."""
_LONGEST: Final = 1e3
"""No cycle, where a slip lasts longer than this, relative to the time 1/w."""
_SLOW: Final = 25.0
"""And a rest by this longer, relative to what the drive takes to settle: it may wind up."""
_STEADY: Final = 2e-4
"""Cycles are steady where half of them is as long as the other, to this."""
_ON_AVERAGE: Final = 0.05
"""How far the mean speed of the table may be from the feed, relative: behind it the drive still
catches up."""
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
_LEFT: Final = 1e-2
"""What is left of a fall, relative, where it counts as over."""
_WITHIN: Final = 0.2
"""Share of the first line's end up to which a slip of a slow feed stays on it."""
_ROUNDING: Final = 1e-9
_MOST: Final = 1_000
"""Steps of a search."""


class Jump(NamedTuple):
    """A slip of the table and the stick after it."""

    way: float
    """Of the table in the slip [m]."""
    period: float
    """From one break-away to the next [s]."""
    least: float
    """The speed that a slip without rest would have fallen to [m/s]; below 0."""


class Limit(NamedTuple):
    """Where jumping ends as the feed rises."""

    feed: float
    """The highest feed that is reached in jumps [m/s]; 0 where there is none."""
    jump: Jump | None
    """The longest jump of the settled cycle there; None where there is none."""
    rate: float = 0.0
    """Jumps a second there [1/s]."""


class Jumping:
    """The cycle of a servo axis, carried from feed to feed [m/s].

    It begins out of an even creep of the motor, at a feed above 0, against the table at rest.
    """

    def __init__(self, axis: Axis, feed: float) -> None:
        self._system = system_of(axis)
        self.feed = feed
        self._at = loaded(self._system, feed)

    def at(self, feed: float) -> list[Jump] | None:
        """Return the jumps of some cycles at a feed [m/s]; None, and stay, where they end."""
        axis = self._system.axis
        w = math.sqrt(axis.k / axis.m)
        slips = _LONGEST / w + 4.0 * axis.F_s / (axis.k * self.feed)
        rests = slips + _SLOW * settling(axis)
        # The least speed comes within a swing; where the friction falls, going on so could grow
        # without end.
        even = settling(axis) if decays(self._system, self._system.line(feed)) else math.inf
        watched = Watched(slips, slips, rests, least=2.0 * math.pi / w, rebased=True, settles=even)
        following = walk(self._system, Mode(0, 1), self._moved(feed), watched)
        turns = following.turns(1)
        jumps: list[Jump] = []
        while len(jumps) < _CYCLES or not self._settled(jumps, feed):
            if len(jumps) > _MOST:
                return None
            count = 2 * (1 + len(jumps) // _CYCLES) if jumps else 2 * _CYCLES
            turns = turns[-1:] + following.turns(count)
            if len(turns) <= count or any(turn.mode.table != 1 for turn in turns[:-1:2]):
                return None
            for begin, stop, end in zip(turns[::2], turns[1::2], turns[2::2], strict=False):
                jumps.append(Jump(stop.place, end.time - begin.time, stop.least))
        self._at, self.feed = following.point, feed
        return jumps

    def _settled(self, jumps: list[Jump], feed: float) -> bool:
        """Tell whether the last cycles keep up with the feed, and are steady.

        A drive that winds up jumps in rows, with a long rest between. Growing friction takes long
        until cycles are steady: beyond a fold the jumps shrink slowly before they end.
        """
        last = jumps[-max(_CYCLES, len(jumps) // 2) :]
        way, time = sum(jump.way for jump in last), sum(jump.period for jump in last)
        if abs(way / (feed * time) - 1.0) > _ON_AVERAGE:
            return False
        if not len(self._system.growth[0]):
            return True
        ways = [jump.way for jump in jumps[-_CYCLES:]]
        before, after = sum(ways[: _CYCLES // 2]), sum(ways[_CYCLES // 2 :])
        return abs(after / before - 1.0) <= _STEADY

    def _moved(self, feed: float) -> Point:
        """Return where the cycle stands, with an even motion of the difference in feed added."""
        system, state = self._system, self._at.state
        even = system.holding(0.0, feed - self.feed) - system.holding(0.0, 0.0)
        even[LAST] *= self._at.offset / system.drive.T_s
        return Point(state + even, self._at.offset)


def loaded(system: System, feed: float, even: float | None = None) -> Point:
    """Return where a table at rest is about to break away, the motor creeping at a feed [m/s].

    The break-away comes half a sample later. The motor pushes with the force of the spring, or with
    that of an even motion [N], during which the table was held.
    """
    axis = system.axis
    age = axis.F_s / (axis.k * feed)
    pull = system.held(age) - axis.along
    pushed = pull if even is None else even
    state = system.holding(pushed, feed, pushed / axis.k - 0.5 * system.drive.T_s * feed)
    state[TABLE] = (pushed - pull) / axis.k
    state[system.layout.ungrown] *= np.exp(-system.growth[0] * age)
    return Point(state, 0.0)


@one_thread
def limit_of_jumps(axis: Axis, highest: float = math.inf, begin: float | None = None) -> Limit:
    """Return the highest feed that a servo axis reaches in jumps when the feed rises slowly.

    The search ends at the feed `highest` [m/s]; it begins at `begin`, a feed with jumps [m/s], or
    looks for one. At the end the least speed of a slip comes to 0 (grazing). The cycle is carried
    along; each step goes part of the way to where that speed, by its last change, would be 0.
    """
    feeds = [begin] if begin is not None else [min(feed, highest) for feed in beginnings(axis)]
    for feed in dict.fromkeys(feeds):
        if feed > 0.0:
            cycle = Jumping(axis, feed)
            if (jumps := cycle.at(feed)) is not None:
                break
    else:
        return Limit(0.0, None)
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
    settled = _steady(cycle, jumps) if cycle.feed >= highest else jumps[-(_CYCLES // 2) :]
    rate = len(settled) / sum(jump.period for jump in settled)
    return Limit(cycle.feed, max(settled, key=lambda jump: jump.way), rate)


def _steady(cycle: Jumping, jumps: list[Jump]) -> list[Jump]:
    """Return jumps of a cycle that is followed at its feed until they are as those before."""
    for _ in range(_MOST // _CYCLES):
        following = cycle.at(cycle.feed)
        if following is None:
            break
        before, after = (sum(jump.way for jump in each[-_CYCLES:]) for each in (jumps, following))
        jumps = following
        if abs(after / before - 1.0) <= _STEADY:
            break
    return jumps[-_CYCLES:]


def beginnings(axis: Axis) -> list[float]:
    """Return the feeds at which a cycle is looked for [m/s], the highest first."""
    w = math.sqrt(axis.k / axis.m)
    whole = 2.0 * (axis.F_s - axis.F_k) / axis.k * w
    if axis.friction.law == "coulomb":
        return [share * whole for share in _BEGINNINGS]
    # Where friction changes with the speed a cycle may begin above a feed, and begin again.
    lines = system_of(axis).lines
    speeds = (*(line.low for line in lines[1:]), axis.F_s / axis.k * w)
    scales = [scale for scale in speeds if scale > 0.0]
    low, high = _SLOWER * min(scales), _FASTER * max(scales)
    count = math.ceil(math.log(high / low) / math.log(_RUNG))
    feeds = [high * (low / high) ** (number / count) for number in range(count + 1)]
    # Beyond the fall nothing changes. On a first line that begins at the break-away force the
    # motion is linear and scales with the feed: one slow feed stands for all below.
    left = _LEFT * abs(lines[0].force - lines[-1].force)
    ends = [line.low for line in lines if abs(line.force - lines[-1].force) > left]
    fastest = _FASTER * max([*ends, axis.F_s / axis.k * w])
    continuous = abs(lines[0].force - axis.F_s) <= _ROUNDING * axis.F_s
    slow = [feed for feed in feeds if continuous and feed < _WITHIN * lines[0].high]
    return [feed for feed in feeds if feed <= fastest and feed not in slow[1:]]


def _least(jumps: list[Jump]) -> float:
    """Return the highest of the least speeds of the settled slips: the first not to stop."""
    return max(jump.least for jump in jumps[-(_CYCLES // 2) :])
