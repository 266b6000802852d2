"""The motion of a servo axis from one event of its friction to the next.

Where each event lies is read off a trace: matrices, computed once for a mode, give values and
slopes of what is watched at the ends of many parts of samples in one product. Between the ends it
is a cubic, which also finds what dips below 0 and comes back within a part.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cache, lru_cache
from typing import Any, Final, NamedTuple

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from stickslip_ref import SETTLED

from .native import COLUMNS, EVENTS, Native, NativeWalk, native_of
from .system import FORCE, LAST, MOTOR, MOTOR_SPEED, SPEED, TABLE, Matrix, Mode, System, Vector

MOST_TURNS: Final = 50_000
"""Events after which a walk ends."""

_SAMPLES: Final = 64
"""Samples of a trace."""
_NONE: Final = 1e-12
"""What is left of a part of a sample counts as none, relative to the sample."""


class Margin(NamedTuple):
    """What is left before an event: a number linear in the state that is above 0 till then.

    Beside its row it takes `pushed` times the commanded force that acts.
    """

    event: str
    row: Vector
    pushed: float = 0.0

    def under(self, system: System, late: int) -> Vector:
        """Return its row under the `late`-th last commanded force."""
        row = self.row.copy()
        row[system.layout.commands + late] += self.pushed
        return row


class Point(NamedTuple):
    """Where a motion stands: its state, and the time since the last sample [s].

    At 0 the controller has not yet had its turn.
    """

    state: Vector
    offset: float


class Event(NamedTuple):
    """Where a stretch of motion ends, after how long [s], and by which event; None: by the time."""

    point: Point
    elapsed: float
    event: str | None


class _Trace(NamedTuple):
    """Of a mode and what is watched in it.

    `powers` are samples with their controller, `inside` the parts of one; `begin` and `end` give
    value and slope at the ends of each part, as [part, margin, value or slope, state].
    """

    powers: Matrix
    inside: list[Matrix]
    begin: Matrix
    end: Matrix


class Motion:
    """The motion of a servo axis, with its linear systems."""

    def __init__(self, system: System) -> None:
        self.system = system
        self._traces: dict[tuple[Mode, tuple[str, ...]], _Trace] = {}

    def follow(
        self, mode: Mode, margins: tuple[Margin, ...], point: Point, until: float = math.inf
    ) -> Event:
        """Return the first event, or the point after the time `until` [s].

        A margin that is 0 at the beginning is watched from when it is above.
        """
        passed = 0.0
        if point.offset > 0.0:
            rest = self._rest_of_sample(mode, margins, point, until)
            if rest.event is not None or rest.elapsed >= until:
                return rest
            point, passed = rest.point, rest.elapsed
        key = mode, tuple(margin.event for margin in margins)
        if key not in self._traces:
            self._traces[key] = self._traced(mode, margins)
        trace = self._traces[key]
        block = _SAMPLES * self.system.drive.T_s
        state = point.state
        while True:
            found = self._in_trace(mode, margins, trace, state)
            if found is not None and passed + found.elapsed <= until:
                return found._replace(elapsed=passed + found.elapsed)
            if passed + block >= until:
                return Event(self._after(mode, trace, state, until - passed), until, None)
            state = trace.powers[_SAMPLES] @ state
            passed += block

    def _rest_of_sample(
        self, mode: Mode, margins: tuple[Margin, ...], point: Point, until: float
    ) -> Event:
        """Follow up to the next sample, part by part."""
        system = self.system
        state, offset = point
        passed = 0.0
        for number, part in enumerate(system.parts):
            left = system.offsets[number + 1] - offset
            if left <= _NONE * system.drive.T_s:
                continue
            rates = system.rates(mode, part.late)
            length = min(left, until - passed)
            after = expm(rates * length) @ state
            both = np.array([[state, rates @ state], [after, rates @ after]])
            ends = [both @ margin.under(system, part.late) for margin in margins]
            crossing, which = _first(ends, length)
            if crossing < math.inf:
                there = Point(expm(rates * crossing) @ state, offset + crossing)
                return Event(there, passed + crossing, margins[which].event)
            state, offset, passed = after, offset + length, passed + length
            if passed >= until:
                return Event(Point(state, offset), passed, None)
        return Event(Point(state, 0.0), passed, None)

    def _in_trace(
        self, mode: Mode, margins: tuple[Margin, ...], trace: _Trace, state: Vector
    ) -> Event | None:
        """Return the first event within a trace that begins at a sample."""
        begin, end = trace.begin @ state, trace.end @ state
        parts = self.system.parts
        falls = (begin[:, :, 0] < 0.0) | (end[:, :, 0] <= 0.0)
        dips = (begin[:, :, 1] < 0.0) & (end[:, :, 1] > 0.0)
        for number in np.flatnonzero((falls | dips).any(axis=1)):
            sample, inside = divmod(int(number), len(parts))
            length = parts[inside].length
            crossing, which = _first(zip(begin[number], end[number], strict=True), length)
            if crossing < math.inf:
                start = trace.inside[inside] @ (trace.powers[sample] @ state)
                rates = self.system.rates(mode, parts[inside].late)
                offset = float(self.system.offsets[inside]) + crossing
                there = Point(expm(rates * crossing) @ start, offset)
                elapsed = sample * self.system.drive.T_s + offset
                return Event(there, elapsed, margins[which].event)
        return None

    def _after(self, mode: Mode, trace: _Trace, state: Vector, time: float) -> Point:
        """Return the point a time after a sample, within a trace."""
        system = self.system
        sample = min(math.floor(time / system.drive.T_s + _NONE), _SAMPLES)
        state, left = trace.powers[sample] @ state, time - sample * system.drive.T_s
        if left <= _NONE * system.drive.T_s:
            return Point(state, 0.0)
        return self._rest_of_sample(mode, (), Point(system.control @ state, 0.0), left).point

    def _traced(self, mode: Mode, margins: tuple[Margin, ...]) -> _Trace:
        system = self.system
        inside = [system.control]
        for step in system.steps(mode):
            inside.append(step @ inside[-1])
        size = system.layout.size
        powers = np.empty((_SAMPLES + 1, size, size))
        powers[0] = np.eye(size)
        for number in range(_SAMPLES):
            powers[number + 1] = inside[-1] @ powers[number]
        both = []
        for part in system.parts:
            rows = np.array([margin.under(system, part.late) for margin in margins])
            both.append(np.stack([rows, rows @ system.rates(mode, part.late)], axis=1))
        shape = (_SAMPLES * len(system.parts), len(margins), 2, size)
        spread = [
            np.einsum("pmvi,sij->spmvj", both @ each, powers[:-1], optimize=True).reshape(shape)
            for each in (np.stack(inside[:-1])[:, None], np.stack(inside[1:])[:, None])
        ]
        return _Trace(powers, inside, *spread)


class Turn(NamedTuple):
    """An event of the table: its name, time [s], place [m] and speed [m/s], and how it goes on."""

    event: str
    time: float
    place: float
    speed: float
    mode: Mode
    least: float = math.nan
    """At a stop, the speed that the slip without rest would have fallen to [m/s], if watched."""


class Watched(NamedTuple):
    """How long a motion is followed, and what is watched on the way; times in s."""

    end: float
    """The time after which it ends."""
    slips: float = 0.0
    rests: float = 0.0
    """What is left of it at least when a slip begins, and a rest."""
    most: int = MOST_TURNS
    """Events, those of the motor among them, after which it ends."""
    ramp: float = math.inf
    feed: float = 0.0
    """When the set point's ramp ends, and at which feed [m/s]."""
    beside: float = 0.0
    """Time after an extreme of the speed in which no other is looked for: its own rounding would be
    one. With 0 extremes are no events."""
    least: float = 0.0
    """Time in which the least speed of a slip is sought; 0: it is not."""
    rebased: bool = False
    """Whether the table is put at 0 after each stop."""
    settles: float = math.inf
    """The time after which motion within 1 % of the feed is taken as even for good."""


@cache
def _mode_of(table: float, motor: float, line: float) -> Mode:
    return Mode(int(table), int(motor), int(line))


_motion_of = lru_cache(maxsize=8)(Motion)


class _NativeWalk:
    """A motion on its way, in C.

    `over`: its time is over. `settled`: when its speed came within 5 % of the feed [s], if it was
    ended as even for good. `turns` follows it to the next events of the table, fewer than `count`
    where it ends; `go_on` has it end after another time [s].
    """

    def __init__(self, native: Native, mode: Mode, point: Point, watched: Watched) -> None:
        self._native, self._state = native, point.state.copy()
        self._settles = watched.settles
        self._walk = NativeWalk(
            self._state.ctypes.data, point.offset, 0.0, 0.0, 0.0, SETTLED, tuple(mode),
            watched.ramp, watched.end, watched.slips, watched.rests, watched.feed, watched.beside,
            watched.least, watched.settles, watched.beside > 0.0, watched.rebased,
            False, False, 0, watched.most,
        )  # fmt: skip

    @property
    def mode(self) -> Mode:
        mode = self._walk.mode
        return Mode(mode.table, mode.motor, mode.line)

    @property
    def point(self) -> Point:
        return Point(self._state, self._walk.offset)

    @property
    def over(self) -> bool:
        return bool(self._walk.end <= 0.0)

    @property
    def settled(self) -> float | None:
        walk = self._walk
        return float(walk.off) if walk.near > self._settles else None

    def go_on(self, time: float) -> None:
        self._walk.end = time

    def turns(self, count: int) -> list[Turn]:
        rows = np.empty((count, COLUMNS))
        found = self._native.walk(self._walk, rows)
        return [
            Turn(EVENTS[int(event)], time, place, speed, _mode_of(*mode), least)
            for event, time, place, speed, least, *mode in rows[:found].tolist()
        ]


class _PythonWalk:
    """As `_NativeWalk`, where there is no compiler."""

    def __init__(self, system: System, mode: Mode, point: Point, watched: Watched) -> None:
        self._motion, self._watched = _motion_of(system), watched
        self.mode, self.point = mode, point
        self._passed, self._left, self._end = 0.0, watched.ramp, watched.end
        self._rising = self._turned = False
        self._events = 0
        self.settled: float | None = None

    @property
    def over(self) -> bool:
        return self._end <= 0.0

    def go_on(self, time: float) -> None:
        self._end = time

    def turns(self, count: int) -> list[Turn]:
        turns: list[Turn] = []
        while len(turns) < count and self._events < self._watched.most:
            reached = self._next()
            if reached.event is None and self._left <= 0.0:
                self._end_ramp(reached.point)
                continue
            if reached.event is None and self._end <= 0.0:
                self.point = reached.point
                break
            turns += self._passed_by(reached)
        return turns

    def _next(self) -> Event:
        """Follow to the next event, or to the end of a time."""
        system, watched = self._motion.system, self._watched
        margins, until = margins_of(system, self.mode), min(self._left, self._end)
        if self._turned:
            until = min(until, watched.beside)
        elif watched.beside > 0.0 and self.mode.table:
            margins += (extreme(system, self.mode, rising=self._rising),)
        reached = self._motion.follow(self.mode, margins, self.point, until)
        self._events += 1
        self._passed += reached.elapsed
        self._left -= reached.elapsed
        self._end -= reached.elapsed
        return reached

    def _end_ramp(self, point: Point) -> None:
        layout, state = self._motion.system.layout, point.state.copy()
        state[[layout.feed, layout.acceleration]] = self._watched.feed, 0.0
        self.point, self._left = Point(state, point.offset), math.inf

    def _passed_by(self, reached: Event) -> list[Turn]:
        """Go on after an event; return it if it is one of the table."""
        system, watched, before = self._motion.system, self._watched, self.mode
        least = math.nan
        if reached.event == "stop" and watched.least > 0.0:
            dip = extreme(system, before, rising=False)
            slowest = self._motion.follow(before, (dip,), reached.point, watched.least)
            least = float(slowest.point.state[SPEED])
        self.mode, self.point = after(system, before, reached)
        self._turned = reached.event in ("peak", "dip")
        if self._turned:
            self._rising = not self._rising
        elif self.mode.table != before.table:
            self._rising = self.mode.table > 0
            self._end = max(self._end, watched.slips if self.mode.table else watched.rests)
        else:
            return []
        assert reached.event is not None
        state = self.point.state
        place = float(state[TABLE])
        turn = Turn(reached.event, self._passed, place, float(state[SPEED]), self.mode, least)
        if reached.event == "stop" and watched.rebased:
            state[[MOTOR, TABLE, LAST, system.layout.command]] -= place
        return [turn]


Walk = _NativeWalk | _PythonWalk


def walk(system: System, mode: Mode, point: Point, watched: Watched) -> Walk:
    """Begin to follow a motion."""
    native = native_of(system)
    if native is None:
        return _PythonWalk(system, mode, point, watched)
    return _NativeWalk(native, mode, point, watched)


def margins_of(system: System, mode: Mode) -> tuple[Margin, ...]:
    """Return what is left before table or motor stop or break away: docs/feed-axis.md."""
    axis, drive, layout = system.axis, system.drive, system.layout
    unit = np.eye(layout.size)
    pull = axis.k * (unit[MOTOR] - unit[TABLE])
    margins: list[Margin] = []
    if mode.table:
        speed, line = mode.table * unit[SPEED], system.lines[mode.line]
        if mode.line == 0:
            margins.append(Margin("stop", speed))
        else:
            margins.append(Margin("slower", speed - line.low * unit[layout.one]))
        if line.high < math.inf:
            margins.append(Margin("faster", line.high * unit[layout.one] - speed))
    else:
        pushed = pull + axis.along * unit[layout.one]
        held = system.fully * unit[layout.one] - system.growth[1] @ unit[layout.ungrown]
        margins += [Margin("forward", held - pushed), Margin("backward", held + pushed)]
    if drive.dry > 0.0:
        if mode.motor:
            margins.append(Margin("motor stops", mode.motor * unit[MOTOR_SPEED]))
        else:
            lags = drive.lag > 0.0
            push = (unit[FORCE] if lags else 0.0) - pull
            held = drive.dry * unit[layout.one]
            margins.append(Margin("motor forward", held - push, 0.0 if lags else -1.0))
            margins.append(Margin("motor backward", held + push, 0.0 if lags else 1.0))
    return tuple(margins)


def extreme(system: System, mode: Mode, *, rising: bool) -> Margin:
    """Return what is left before the speed of the table is greatest ("peak") or least ("dip")."""
    acceleration = system.rates(mode, 0)[SPEED]
    return Margin("peak", acceleration) if rising else Margin("dip", -acceleration)


def after(system: System, mode: Mode, reached: Event) -> tuple[Mode, Point]:
    """Return how it goes on after an event: the mode, and the point with what stands at rest."""
    axis, drive = system.axis, system.drive
    state, offset = reached.point
    state = state.copy()
    pull = axis.k * (state[MOTOR] - state[TABLE])
    if reached.event == "stop":
        state[SPEED] = 0.0
        pushed = pull + axis.along
        state[system.layout.ungrown] = 1.0
        holds = system.held(0.0)
        direction = 0 if abs(pushed) <= holds else int(math.copysign(1.0, pushed))
        mode = mode._replace(table=direction)
    elif reached.event in ("slower", "faster"):
        line = system.lines[mode.line]
        faster = reached.event == "faster"
        state[SPEED] = mode.table * (line.high if faster else line.low)
        mode = mode._replace(line=mode.line + (1 if faster else -1))
    elif reached.event in ("forward", "backward"):
        mode = mode._replace(table=1 if reached.event == "forward" else -1)
    elif reached.event == "motor stops":
        state[MOTOR_SPEED] = 0.0
        part = int(np.searchsorted(system.offsets, offset, side="right")) - 1
        late = system.parts[min(part, len(system.parts) - 1)].late
        force = state[FORCE if drive.lag > 0.0 else system.layout.commands + late] - pull
        direction = 0 if abs(force) <= drive.dry else int(math.copysign(1.0, force))
        mode = mode._replace(motor=direction)
    elif reached.event in ("motor forward", "motor backward"):
        mode = mode._replace(motor=1 if reached.event == "motor forward" else -1)
    return mode, Point(state, offset)


def _first(ends: Iterable[Any], length: float) -> tuple[float, int]:
    """Return when the first of some margins falls to 0 within a part, or infinity, and which."""
    crossings = [_crossing(begin, end, length) for begin, end in ends]
    first = min(crossings, default=math.inf)
    return first, crossings.index(first) if crossings else 0


def _crossing(begin: Vector, end: Vector, length: float) -> float:
    """Return when a cubic falls to 0 within a part, by value and slope at its ends; or infinity."""
    v0, d0, v1, d1 = (float(each) for each in (*begin, *end))
    if v0 < 0.0:
        # Another commanded force has moved it there at once.
        return 0.0
    if v1 > 0.0 and not (d0 < 0.0 < d1 and v0 > 0.0):
        return math.inf
    if v0 <= 0.0 and d0 <= 0.0:
        return 0.0
    a1 = length * d0
    a2, a3 = 3.0 * (v1 - v0) - length * (2.0 * d0 + d1), 2.0 * (v0 - v1) + length * (d0 + d1)

    def value(s: float) -> float:
        # One that stood at 0 as the part began is watched from when it has risen.
        rest = a1 + s * (a2 + s * a3)
        return v0 + s * rest if v0 > 0.0 else rest

    last = 1.0
    if v1 > 0.0:
        # The least value lies where the slope of the cubic comes up through 0.
        last = -a1 / (a2 + math.sqrt(max(a2 * a2 - 3.0 * a1 * a3, 0.0)))
        if not 0.0 < last < 1.0 or value(last) > 0.0:
            return math.inf
    elif value(1.0) >= 0.0:
        # By rounding: it falls to 0 at the end.
        return length
    return length * float(brentq(value, 0.0, last, xtol=1e-15))
