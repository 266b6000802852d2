"""Where the motion of a servo axis leads at a feed, from different starts: docs/feed-axis.md.

The table is followed from event to event; where its speed is greatest and least is an event too.
`jump_ranges` has the feeds at which it sticks and slips, as ranges with both ends.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache, cached_property
from itertools import pairwise, takewhile
from typing import Final, Literal, NamedTuple

from stickslip_ref import SETTLED, STICKS, Interval, Kind, Regime, StickSlip, Swinging, merged

from ..axis import Axis
from ..one_thread import one_thread
from .jumps import Limit, beginnings, limit_of_jumps, loaded
from .motion import Point, Turn, Walk, Watched, walk
from .stability import decays, settling, swing
from .system import LAST, MOTOR, SPEED, Mode, line_at, system_of

Begin = Literal["rest", "jumps", "struck", "held", "even"]

_JOLTS: Final[tuple[Begin, ...]] = ("jumps", "struck", "held")
_EXTREMES: Final = ("peak", "dip")
_DEVIATION: Final = 0.02
"""Of the table's speed from the feed where a motion near even sliding begins."""
_STEADY: Final = 1e-3
"""A swing is steady where the range of its last extremes changes by less twice, relative: where a
decay turns into growth it hardly changes either."""
_SWINGS: Final = 8
"""Extremes of the speed that are looked at together."""
_LAST: Final = 16
"""Extremes whose range is the height of a swing."""
_STILL: Final = 1e-3
"""A swing of a smaller amplitude, over the feed, is even motion."""
_STICKS: Final = 12
"""Sticks after which a motion sticks and slips, where half of the last ones is as the other."""
_ALIKE: Final = 0.02
"""How far the slips of both halves may differ, relative."""
_ON_AVERAGE: Final = 0.005
"""How far the table's mean speed over the sticks that are looked at may be from the feed, relative:
behind it the drive still catches up."""
_CLOSE: Final = 0.05
"""The amplitude of a swing that is too slow to be followed is found to this, relative."""
_WIDEST: Final = 0.98
"""Deviation from which on nothing wider is begun: the table would stop."""
_TRIED: Final = 12
"""Windows of extremes after which a swing that was begun shows whether it grows: the loop settles
first."""
_BESIDE: Final = 1e-3
"""Time beside an extreme in which no other is looked for, in periods."""
_MOST: Final = 6_000
"""Events that are followed."""
_AHEAD: Final = 16
"""Events of the table that are followed at once."""
_LONGEST, _SLOW = 400.0, 25.0
"""Times the period of a swing of the table on its spring, and the time in which the drive settles,
that are followed after a slip begins."""


class Course(NamedTuple):
    """Where a motion leads."""

    kind: Kind
    """"even", "swings" or "sticks"."""
    swing: Swinging | None = None
    stick_slip: StickSlip | None = None
    """The swing or the cycle that it ends in."""
    settling: float = math.inf
    """Time from the first break-away until it is even [s]; infinite where it does not end so."""


class Courses:
    """The motions of a servo axis at one feed [m/s], above 0."""

    def __init__(self, axis: Axis, feed: float) -> None:
        self._axis, self._feed = axis, feed
        self._system = system_of(axis)

    @one_thread
    def course(self, begin: Begin) -> Course:
        """Return where the motion leads: from rest, a break-away, a blow, a hold, or even motion.

        A break-away is that of a motor that creeps; of one that moves evenly after a hold.
        """
        if self._axis.F_s == 0.0:
            # Nothing holds: the loop is linear, and its least damped swing dies away.
            least = swing(self._axis)
            settling = -math.log(SETTLED) / (least.damping * least.w) if least.w else 0.0
            return Course("even", settling=settling)
        events, found = self._followed(*self._start(begin))
        return found or self._last(events)

    def _followed(
        self, mode: Mode, point: Point, most: float = math.inf
    ) -> tuple[list[Turn], Course | None]:
        """Return the events up to where the motion leads, or to a run of `most` extremes."""
        events: list[Turn] = []
        sticks: list[int] = []
        count = 0
        following = self._walk(mode, point)
        while turns := following.turns(_AHEAD):
            for turn in turns:
                events.append(turn)
                count = count + 1 if turn.event in _EXTREMES else 0
                if turn.mode.table == 0:
                    sticks.append(len(events) - 1)
                stopped = turn.event == "stop"
                found = self._sticks(events, sticks) if stopped else self._swings(events, count)
                if found is not None:
                    return events, found
                if count >= most:
                    return events, None
        if following.settled is not None:
            return events, Course("even", settling=self._settling(events, following.settled))
        return events, None

    def _start(self, begin: Begin) -> tuple[Mode, Point]:
        system, axis, feed = self._system, self._axis, self._feed
        motor = 0 if system.drive.dry > 0.0 else 1
        if begin == "jumps":
            return Mode(0, 1), loaded(system, feed)
        if begin == "held":
            return Mode(0, 1), loaded(system, feed, self._even_force())
        if begin == "struck":
            # As after a blow: the spring pulls with twice the break-away force.
            point = loaded(system, feed)
            point.state[[MOTOR, LAST]] += axis.F_s / axis.k
            return Mode(1, 1), point
        if begin == "rest":
            state = system.at_rest()
            ramp = axis.demand.acceleration
            begins = (feed, 0.0) if ramp is None else (0.0, ramp)
            state[[system.layout.feed, system.layout.acceleration]] = begins
            return Mode(0, motor), Point(state, 0.0)
        return self._beside(_DEVIATION)

    def _even_force(self) -> float:
        """Return the force of the spring in even motion [N]."""
        axis, system = self._axis, self._system
        line = system.lines[system.line(self._feed)]
        force = line.force + line.slope * (self._feed - line.low)
        return force + axis.c * self._feed - axis.along

    def _beside(self, deviation: float) -> tuple[Mode, Point]:
        """Return even motion but for the table's speed, which is off by so much of the feed."""
        system, axis, feed = self._system, self._axis, self._feed
        sliding, force = system.lines[system.line(feed)], self._even_force()
        state = system.holding(force, feed, force / axis.k)
        state[SPEED] = feed * (1.0 + deviation)
        if not sliding.low < state[SPEED] < sliding.high:
            state[SPEED] = feed * (1.0 - deviation)
        return Mode(1, 1, system.line(state[SPEED])), Point(state, 0.0)

    def _walk(self, mode: Mode, point: Point) -> Walk:
        """Begin to follow the events of the table and extremes of its speed, with the ramp."""
        axis, feed = self._axis, self._feed
        period = 2.0 * math.pi * math.sqrt(axis.m / axis.k)
        ramp = float(point.state[self._system.layout.acceleration])
        # What holds is loaded by the feed; a drive that lags or turns back takes longer.
        longest = _LONGEST * period + _SLOW * settling(axis)
        end, ends = 8.0 * axis.F_s / (axis.k * feed) + longest, feed / ramp if ramp else math.inf
        even = settling(axis) if decays(self._system, self._system.line(feed)) else math.inf
        watched = Watched(end, longest, longest, _MOST, ends, feed, _BESIDE * period, settles=even)
        return walk(self._system, mode, point, watched)

    def _sticks(self, events: list[Turn], sticks: list[int]) -> Course | None:
        """Return the cycle where sticks go on alike, None where that is not yet certain."""
        if events[-1].mode.table or len(sticks) <= _STICKS:
            return None
        last = sticks[-max(_STICKS, len(sticks) // 2) - 1 :]
        cycle = self._cycle(events, last)
        ways = [abs(events[end].place - events[begin].place) for begin, end in pairwise(last)]
        first, second = sum(ways[: len(ways) // 2]), sum(ways[-(len(ways) // 2) :])
        alike = abs(second - first) < _ALIKE * first
        settled = abs(cycle.jump / (cycle.period * self._feed) - 1.0) < _ON_AVERAGE
        if not (alike and settled) and len(sticks) < 8 * _STICKS:
            return None
        return Course("sticks", stick_slip=cycle)

    def _cycle(self, events: list[Turn], sticks: list[int]) -> StickSlip:
        reverses = any(event.mode.table < 0 for event in events[sticks[0] : sticks[-1]])
        count = len(sticks) - 1
        way = events[sticks[-1]].place - events[sticks[0]].place
        time = events[sticks[-1]].time - events[sticks[0]].time
        return StickSlip(way / count, time / count, reverses)

    def _swings(self, events: list[Turn], count: int) -> Course | None:
        """Return even motion or a steady swing; None where that is not yet certain.

        The last `count` events are extremes.
        """
        swings = abs(events[-1].speed / self._feed - 1.0) >= SETTLED
        if count < _SWINGS or (swings and count < 3 * _LAST):
            return None
        last = [event.speed for event in events[-_SWINGS:]]
        off = max(abs(speed / self._feed - 1.0) for speed in last)
        still = off < _STILL and self._even_is_stable
        if still or (off < SETTLED and self._in_stable_line(last)):
            return Course("even", settling=self._settling(events))
        if count < 3 * _LAST:
            return None
        first, before, now = _heights(events)
        if not (first and before and now):
            # Its extremes are rounding: the table does not swing.
            return Course("even", settling=self._settling(events))
        steady = max(abs(before / first - 1.0), abs(now / before - 1.0)) < _STEADY
        if steady and not self._in_stable_line(last):
            return Course("swings", swing=self._swing(self._run(events)))
        return None

    def _run(self, events: list[Turn]) -> list[Turn]:
        """Return the last extremes, back to the last stop or break-away."""
        run = takewhile(lambda event: event.event in _EXTREMES, reversed(events))
        return [*run][::-1]

    @cached_property
    def _even_is_stable(self) -> bool:
        return swing(self._axis, line=line_at(self._axis, self._feed)).damping >= 0.0

    def _in_stable_line(self, run: list[float]) -> bool:
        """Return whether a swing of such speeds stays on the feed's line, and decays there."""
        low, high = min(self._feed, *run), max(self._feed, *run)
        lines = enumerate(self._system.lines)
        return any(
            line.low <= low and high <= line.high and decays(self._system, number)
            for number, line in lines
        )

    def _swing(self, run: list[Turn]) -> Swinging:
        """Return the swing of the last extremes; of one that is not even, its whole range.

        A period is from a rise past the feed to the next: not each extreme of a swing lies beyond.
        """
        rises = [peak.time for dip, peak in pairwise(run) if dip.speed < self._feed < peak.speed]
        last = rises[-_LAST // 2 :]
        frequency = (len(last) - 1) / (last[-1] - last[0]) if len(last) > 1 else math.nan
        return Swinging(0.5 * _heights(run, 1)[0] / self._feed, frequency)

    def _settling(self, events: list[Turn], last: float = 0.0) -> float:
        """Return the time from the first break-away until the speed stays near the feed [s].

        That is its first extreme there; `last` is when it was away last, if no extreme follows.
        """
        off = [n for n, event in enumerate(events) if abs(event.speed / self._feed - 1.0) > SETTLED]
        if not off:
            return 0.0
        following = events[off[-1] + 1 :]
        end = following[0].time if following else max(last, events[-1].time)
        return end - events[0].time

    def _last(self, events: list[Turn]) -> Course:
        """Return where a motion leads that was followed to the end of its time."""
        run = self._run(events)
        sticks = [number for number, event in enumerate(events) if event.mode.table == 0]
        if len(sticks) > 2 and sticks[-1] >= len(events) - 2 - 2 * _SWINGS:
            return Course("sticks", stick_slip=self._cycle(events, sticks[len(sticks) // 2 :]))
        if not run or events[-1].mode.table == 0:
            # It creeps up to the feed without an extreme, or was never pulled away.
            return Course("even", settling=0.0)
        if len(run) < 3 * _LAST:
            # Slow against the swings of the table on its spring.
            if not self._even_is_stable and len(run) > _SWINGS:
                return Course("swings", swing=self._swing(run))
            return Course("even", settling=self._settling(events))
        _, before, now = _heights(run)
        if self._even_is_stable and now < (1.0 - _ALIKE) * before:
            return Course("even", settling=self._settling(events))
        return self._slow(self._swing(run), 1.0 if now > before else -1.0)

    def _slow(self, seen: Swinging, way: float) -> Course:
        """Return where a swing leads that grows (`way` > 0) or fades too slowly to be followed.

        Swings twice or half as wide are begun until one does not go the same way, then those
        between. One that grows at the widest comes to a stop.
        """
        goes_on, turns = seen.amplitude, math.nan
        while not abs(turns / goes_on - 1.0) < _CLOSE:
            tried = goes_on * 2.0**way if math.isnan(turns) else math.sqrt(goes_on * turns)
            tried = min(tried, _WIDEST)
            if tried in (goes_on, turns) or tried < _STILL:
                break
            grows = self._grows(tried)
            if isinstance(grows, Course):
                return grows
            if (grows > 0.0) == (way > 0.0):
                goes_on = tried
            else:
                turns = tried
        if goes_on == _WIDEST:
            return Course("sticks")
        return Course("swings", swing=Swinging(goes_on, seen.frequency))

    def _grows(self, deviation: float) -> float | Course:
        """Return whether a swing begun at a deviation grows (above 0), or where it leads."""
        events, found = self._followed(*self._beside(deviation), _TRIED * _LAST)
        if found is not None:
            return found
        run = self._run(events)
        _, before, now = _heights(run) if len(run) >= 3 * _LAST else (1.0, 1.0, 0.0)
        return now - before


def jolted(axis: Axis, feed: float) -> Iterator[Kind]:
    """Yield where motions out of a break-away, a blow and a hold lead at a feed [m/s]."""
    courses = Courses(axis, feed)
    for begin in _JOLTS:
        yield courses.course(begin).kind


def _heights(run: list[Turn], windows: int = 3) -> list[float]:
    """Return the ranges of the speed over the last windows of extremes [m/s]."""
    speeds = [extreme.speed for extreme in run[-windows * _LAST :]]
    parts = (speeds[begin : begin + _LAST] for begin in range(0, len(speeds), _LAST))
    return [max(part) - min(part) for part in parts]


def regime_in_loop(axis: Axis, feed: float, limit: Limit | None = None) -> Regime:
    """Return what a servo axis, its loop stable, does at a feed [m/s].

    `limit` is the end of its jumps from the slowest feed on, where that is known.
    """
    least = swing(axis, line=line_at(axis, feed))
    courses = Courses(axis, feed)
    begins: tuple[Begin, ...] = ("rest", *_JOLTS)
    begins += ("even",) if least.damping < 0.0 else ()
    found = [courses.course(begin) for begin in begins]
    # One that was followed to a stop only ends as jumps do.
    found = [found[1] if course == Course("sticks") else course for course in found]
    rest = found[0]
    stick_slip = next(filter(None, (course.stick_slip for course in found)), None)
    if axis.friction.law == "coulomb":
        stick_slip = _carried(axis, feed, limit, stick_slip)
    swings: list[Swinging] = []
    for course in found:
        if course.swing is not None and not any(
            abs(course.swing.amplitude / other.amplitude - 1.0) < 10.0 * _STEADY for other in swings
        ):
            swings.append(course.swing)
    return Regime(
        feed, least.damping, least.frequency, tuple(swings), stick_slip, rest.kind, rest.settling
    )


def _carried(
    axis: Axis, feed: float, limit: Limit | None, followed: StickSlip | None
) -> StickSlip | None:
    """Return the cycle carried up from slow feeds, or the one followed where there is none."""
    end = limit_of_jumps(axis).feed if limit is None else limit.feed
    if end < feed:
        return followed
    there = limit_of_jumps(axis, feed)
    if there.jump is not None and there.feed >= feed:
        return StickSlip(there.jump.way, float(1.0 / there.rate))
    # The drive turns the table back between two jumps.
    return followed or StickSlip(math.nan, math.nan, True)


_RUNG, _RUNGS = 1.25, 12
_NARROW: Final = 2e-3
"""An end that is no fold of the cycle is found to this, relative."""


@one_thread
def jump_ranges(axis: Axis) -> tuple[Interval, ...]:
    """Return the feeds [m/s] at which a servo axis sticks and slips.

    With constant coefficients, and with growth at rest, there is one range from the slowest feed
    on. Beyond it, and where friction changes with the speed, motions out of a break-away, a blow
    and a hold are followed: at `_RUNGS` feeds apart by `_RUNG`, or at those of `beginnings`, and at
    those of the demand. The upper end of a range is that of `limit_of_jumps`, or found by halving
    as the lower end is. Narrower ranges than between two feeds may be missed.
    """
    return merged([*ranges_from_above(axis, lower_ends=True)])


def ranges_from_above(axis: Axis, *, lower_ends: bool = False) -> Iterator[Interval]:
    """Yield the ranges of `jump_ranges` from the highest down, each as soon as it is met.

    Without `lower_ends` a range that was scanned begins at the highest feed that met it [m/s].
    """
    begin, asked = beginnings(axis), axis.demand.feeds
    if axis.friction.law != "coulomb":
        yield from _scanned(axis, sorted({*begin, *asked}), 0.0, lower_ends)
        return
    limit = limit_of_jumps(axis).feed
    first = limit * _RUNG or begin[0]
    feeds = {first * _RUNG**number for number in range(_RUNGS)} if first > 0.0 else set()
    feeds.update(feed for feed in asked if feed > limit)
    yield from _scanned(axis, sorted(feeds), limit or begin[-1], lower_ends)
    yield from up_to(limit)


def up_to(feed: float) -> tuple[Interval, ...]:
    """Return the jumps from the slowest feed up to one [m/s]; none up to 0."""
    return (Interval(0.0, feed, "none", "grazing"),) if feed > 0.0 else ()


def _scanned(axis: Axis, feeds: list[float], below: float, lower_ends: bool) -> Iterator[Interval]:
    """Yield the ranges that a scan of rising feeds meets; the lowest may begin at `below`."""

    @cache
    def forms(number: int) -> bool:
        return 0 <= number < len(feeds) and _forms(axis, feeds[number])

    for last in reversed(range(len(feeds))):
        if forms(last + 1) or not forms(last):
            continue
        low, high = feeds[last], limit_of_jumps(axis, begin=feeds[last]).feed
        if high < low and last + 1 < len(feeds):
            high = _end(axis, low, feeds[last + 1])
        high = max(high, low)
        if lower_ends:
            first = next(n for n in range(last, -1, -1) if not forms(n - 1))
            from_slowest = not first and (below == 0.0 or _forms(axis, below))
            without = feeds[first - 1] if first else below
            low = 0.0 if from_slowest else _end(axis, feeds[first], without)
        yield Interval(low, high, "grazing" if low > 0.0 else "none", "grazing")


def _forms(axis: Axis, feed: float) -> bool:
    """Return whether a motion out of one of the jolts at a feed goes on to stick and slip."""
    return any(kind == STICKS for kind in jolted(axis, feed))


def _end(axis: Axis, inside: float, outside: float) -> float:
    """Return the feed [m/s] at which a motion no longer sticks, between two."""
    while abs(outside / inside - 1.0) > _NARROW:
        middle = math.sqrt(inside * outside)
        inside, outside = (middle, outside) if _forms(axis, middle) else (inside, middle)
    return inside
