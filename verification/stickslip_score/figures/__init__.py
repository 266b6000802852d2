"""The figures of a cycle: as the exact solution has them, and as the samples of a motion show them.

Between two break-aways the exact motion is a closed form of five numbers. A curve that lies on it
has its figures, to the digits of the samples, however far apart they are. Else the spring tells
the cycles apart: its extension rises in stick, falls in slip, and turns once in each direction
however the friction is modelled. Between a lowest and the next highest extension the mass is
slowest; there it either rests, to the digits of the samples, or creeps. docs/theory.md (3) to (8),
(13).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np

from stickslip_score.figures.motion import Motion
from stickslip_score.figures.solution import Solution
from stickslip_score.read import Floats

VISIBLE = 2.0  # half units of the last digit by which two positions of a resting mass may differ
LOST = 0.2  # of the slow time: what may lack of the rest after run-out and start; creep lacks most
_DEEP = 0.4  # of the deepest fall of the spring: a turn of the cycle, and no ripple of a solver
_FEW = 5  # samples below v/2 under which a creep and the run-out of a slip look alike


@dataclass(frozen=True)
class Event:
    """A transition between two bounds [s]."""

    low: float
    high: float


@dataclass(frozen=True)
class Stick:
    """The slow phase between two slips, or before the first."""

    begin: Event | None  # re-stick; None where the curve starts in this phase
    end: Event | None  # break-away; None where the curve ends in this phase
    level: float  # position [m]
    samples: int  # how many there are in the phase
    rests: bool = True  # whether the mass rests, to the digits of the samples
    creep: float | None = 0.0  # speed over its middle half [m/s]; None where samples are too few
    late_over_early: float = math.nan  # creep in the third quarter over that in the second [-]
    z_high: float = math.nan  # spring extension at the turn after it [m]


@dataclass(frozen=True)
class Phases:
    """Sticks of a motion and turns of its spring, in order of time."""

    sticks: tuple[Stick, ...]
    highs: Floats  # spring extension where it turns from rising to falling [m]
    high_times: Floats  # [s]
    lows: Floats  # spring extension where it turns from falling to rising [m]
    fall: float  # deepest fall of the spring [m]
    only_rests: bool  # whether the mass is not seen to move at all


def find_phases(motion: Motion, solution: Solution) -> Phases:
    """Find the sticks of a motion; `solution` tells how long run-out and start of a rest take."""
    z = motion.z
    fall = float(np.max(np.maximum.accumulate(z) - z))
    turns = _turns(z, _DEEP * fall) if fall > 8.0 * motion.allowed else []
    highs, lows = turns[::2], turns[1::2]
    sticks = [
        _stick(motion, solution, begin, end, fall)
        for begin, end in zip([None, *lows], [*highs, None][: len(lows) + 1], strict=True)
    ]
    return Phases(
        sticks=tuple(stick for stick in sticks if stick),
        highs=z[highs],
        high_times=motion.t[highs],
        lows=z[lows],
        fall=fall,
        only_rests=float(np.ptp(motion.y)) <= 2.0 * VISIBLE * motion.allowed,
    )


def _turns(z: Floats, deep: float) -> list[int]:
    """Return the turns of z, a highest first, then alternating."""
    first_of_equals = np.flatnonzero(np.diff(z, prepend=np.nan) != 0.0)
    way = np.sign(np.diff(z[first_of_equals]))
    extremes = first_of_equals[np.flatnonzero(np.diff(way, prepend=0.0, append=0.0))]
    turns: list[int] = []
    direction, best, at = 1.0, float(z[0]), 0
    for index, value in zip(extremes.tolist(), z[extremes].tolist(), strict=True):
        if direction * value > direction * best:
            best, at = value, index
        elif direction * value < direction * best - deep:
            turns.append(at)
            direction, best, at = -direction, value, index
    return turns


def _stick(
    motion: Motion, solution: Solution, low: int | None, high: int | None, fall: float
) -> Stick | None:
    """Look at the samples between a lowest and a highest extension; None where none is slow."""
    first, last = low or 0, motion.t.size - 1 if high is None else high
    t, y, v = motion.t[first : last + 1], motion.y[first : last + 1], solution.v
    if t.size < 2:
        return None
    i, j, level = _plateau(t, y, VISIBLE * motion.allowed)
    slow = np.flatnonzero(_speed(t, y, motion.allowed, v) < 0.5 * v)
    if not slow.size:
        return None
    from_, to = int(min(slow[0], i)), int(max(slow[-1], j))
    begins, ends = low is not None, high is not None
    swing = float(motion.z[high] - motion.z[low]) if low is not None and high is not None else fall
    run_out, hidden = _invisible(solution, solution.seen_gap(swing), motion.allowed)
    tail = run_out * (begins + ends) + 2.0 * hidden
    window = max(8.0 * motion.allowed / v, float(np.max(np.diff(t))))
    slow_time, rest = float(t[to] - t[from_]), float(t[j] - t[i])
    creeps = to - from_ >= _FEW and slow_time - rest > tail + LOST * slow_time + 2.0 * window
    creep, late_over_early = (0.0 if j > i else None), math.nan
    if creeps:
        quarter = (to - from_) // 4
        a, b = from_ + quarter, to - quarter
        middle = (a + b) // 2
        creep = _slope(t, y, a, b)
        late_over_early = _slope(t, y, middle, b) / (_slope(t, y, a, middle) or math.nan)
        i, j, hidden = from_, to, 0.0
    before = float(motion.t[max(first + i - 1, 0)]) - motion.blur
    after = float(motion.t[min(first + j + 1, motion.t.size - 1)]) + motion.blur
    hidden += motion.blur
    return Stick(
        begin=Event(before, float(t[i]) + hidden) if begins else None,
        end=Event(float(t[j]) - hidden, after) if ends else None,
        level=level,
        samples=to - from_ + 1,
        rests=j > i and not creeps,
        creep=creep,
        late_over_early=late_over_early,
        z_high=math.nan if high is None else float(motion.z[high]),
    )


def _slope(t: Floats, y: Floats, a: int, b: int) -> float:
    return float((y[b] - y[a]) / (t[b] - t[a]))


def _plateau(t: Floats, y: Floats, band: float) -> tuple[int, int, float]:
    """Return first and last sample and the level of the longest time within a band of y.

    A solver may step back a little where it stops, so that y only nearly rises; a mass that
    creeps back falls.
    """
    runs = []
    for rising in (y, -y):
        highest = np.maximum.accumulate(rising)
        ends = np.searchsorted(highest, rising + band, side="right") - 1
        ends = np.maximum(ends, np.arange(t.size))
        i = int(np.argmax(t[ends] - t))
        level = float(np.median(y[i : int(ends[i]) + 1]))
        edges = np.flatnonzero(np.diff(np.abs(y - level) <= band, prepend=False, append=False))
        first, last = edges[::2], edges[1::2] - 1
        if first.size:
            best = int(np.argmax(t[last] - t[first]))
            runs.append((int(first[best]), int(last[best]), level))
    return max(runs, key=lambda run: float(t[run[1]] - t[run[0]]), default=(0, 0, float(y[0])))


def _speed(t: Floats, y: Floats, allowed: float, v: float) -> Floats:
    """Return the velocity at each sample [m/s], over times in which v outweighs the digits."""
    half = 4.0 * allowed / v
    mean_step = (t[-1] - t[0]) / (t.size - 1)
    reach = max(1, math.ceil(min(half / mean_step, float(t.size))))
    low = np.maximum(np.arange(t.size) - reach, 0)
    high = np.minimum(np.arange(t.size) + reach, t.size - 1)
    return np.asarray((y[high] - y[low]) / (t[high] - t[low]))


def _invisible(solution: Solution, gap: float, allowed: float) -> tuple[float, float]:
    """Return how long a slip from rest needs to reach v/2, and stays within the digits [s]."""
    w, v = solution.w, solution.v
    turn = math.acos(0.5 * v / (w * math.hypot(gap, v / w)))
    way = 4.0 * allowed
    by_jerk = (6.0 * way / (v * w**2)) ** (1.0 / 3.0)
    by_acceleration = math.sqrt(2.0 * way / (gap * w**2)) if gap > 0.0 else math.inf
    return (turn - math.atan2(w * gap, v)) / w, float(min(by_jerk, by_acceleration))


def first_rest(motion: Motion) -> int:
    """Return the last sample of those at the begin in which the mass is not seen to move."""
    out = np.flatnonzero(np.abs(motion.y - motion.y[0]) > VISIBLE * motion.allowed)
    return int(out[0]) - 1 if out.size else motion.t.size - 1


def rests_of(motion: Motion) -> list[tuple[int, int]]:
    """Return first and last sample of the rest at the begin, and of the longest if it is later."""
    begin, longest = first_rest(motion), _plateau(motion.t, motion.y, VISIBLE * motion.allowed)[:2]
    return [(0, begin), longest] if longest[0] > begin else [(0, begin)]


def break_away(motion: Motion, solution: Solution, last: int) -> tuple[float, float] | None:
    """Return the times [s] between which a mass breaks away that rests till sample `last`.

    None where it rests to the end.
    """
    if last + 1 >= motion.t.size:
        return None
    # The band of a rest is `VISIBLE` wide, and so may its level be off.
    hidden = solution.time_to_move(2.0 * VISIBLE * motion.allowed)
    return float(motion.t[last]) - hidden, float(motion.t[last + 1])


@dataclass(frozen=True)
class Figures:
    """What the cycles of a curve come to; what it does not show is missing."""

    values: dict[str, tuple[float, float]]  # of `QUANTITIES`: value > 0 and resolution [s, m]
    cycles: int  # complete ones, from break-away to break-away
    jumps: tuple[float, ...] = ()  # of the mass between two rests [m], where sticks were seen


def figures_of(sticks: Sequence[Stick], allowed: float) -> Figures:
    """Take means over the cycles between sticks that are resolved, from the bounds of their events.

    `sticks` are in order of time; `allowed` is how far a position may be off for its digits [m].
    """
    resolved = [stick if stick.rests or stick.creep is not None else None for stick in sticks]
    slips = [(a, b, a.end, b.begin) for a, b in pairwise(resolved) if a and b and a.end and b.begin]
    rests = [(begin, b.end) for _, b, _, begin in slips if b.end]
    jumps = tuple(b.level - a.level for a, b, *_ in slips)
    values: dict[str, tuple[float, float]] = {}
    if rests:
        # The events inside an unbroken chain of cycles cancel.
        ends = (stick.end if stick else None for stick in resolved)
        chains = [[end for end in chain if end] for _, chain in groupby(ends, bool)]
        spans = [_between(chain[0], chain[-1]) for chain in chains if len(chain) > 1]
        values["period"] = _mean(spans, len(rests))
        values["t_stick"] = _mean([_between(*events) for events in rests], len(rests))
    if slips:
        values["t_slip"] = _mean([_between(end, begin) for *_, end, begin in slips], len(slips))
        levels = [_level_resolution(stick) for a, b, *_ in slips for stick in (a, b)]
        resolution = 2.0 * allowed * len(slips) + sum(levels)
        values["delta_x"] = (sum(jumps) / len(jumps), resolution / len(slips))
    return Figures(values, len(rests), jumps)


def _level_resolution(stick: Stick) -> float:
    """How far the level may be off [m]: by half the creep."""
    if stick.rests or not (stick.begin and stick.end and stick.creep):
        return 0.0
    return 0.25 * abs(stick.creep) * (stick.end.low - stick.begin.high)


def _between(begin: Event, end: Event) -> tuple[float, float]:
    """Middle and half the width of the time between two events, never below 0."""
    least, most = max(end.low - begin.high, 0.0), max(end.high - begin.low, 0.0)
    return 0.5 * (least + most), 0.5 * (most - least)


def _mean(spans: Sequence[tuple[float, float]], count: int) -> tuple[float, float]:
    """Return middle and half the width of the mean of `count` times that make up some spans."""
    return sum(middle for middle, _ in spans) / count, sum(half for _, half in spans) / count
