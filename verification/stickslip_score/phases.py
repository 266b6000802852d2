"""Sticks and slips of a motion, each event between two bounds.

The spring tells the cycles apart: its extension rises in stick, falls in slip, and turns once in
each direction however the friction is modelled. Between a lowest and the next highest extension
the mass is slowest; there it either rests, to the digits of the samples, or creeps.
"""

import math
from dataclasses import dataclass

import numpy as np

from stickslip_score.law import Law
from stickslip_score.motion import Motion
from stickslip_score.read import Floats

_DEEP = 0.4
"""Of the deepest fall of the spring: a fall or rise that counts as a turn. Cycles of one motion
are alike, so that all pass; the ripple of a solver does not."""

_FEW = 5
"""Samples below v/2 under which a creep and the run-out of a slip look alike."""

NO_GAP = 0.25
"""Of the exact gap: a curve that shows less has lost the difference of static and kinetic friction.
A solver with fixed steps only widens it, a smoothed law narrows it and creeps besides."""

VISIBLE = 2.0
"""Half units of the last digit by which two positions of a resting mass may differ, one each."""

LOST = 0.2
"""Of the slow time: what may be lacking of the rest after the slip's own run-out and start. A mass
that rests lacks none; one that creeps lacks nearly all."""


@dataclass(frozen=True)
class Event:
    """A transition between two bounds [s]."""

    low: float
    high: float


@dataclass(frozen=True)
class Stick:
    """The slow phase between two slips, or before the first.

    Attributes
    ----------
    begin, end
        Re-stick and break-away; begin is None where the curve starts in this phase, end where it
        ends in it.
    level
        Position [m].
    rests
        Whether the mass rests, to the digits of the samples.
    creep
        Speed over the middle half of the phase [m/s]; 0 where it rests, None where the samples
        are too few to tell.
    late_over_early
        Creep in the third quarter of the phase over that in the second [-]; NaN where the mass
        rests.
    z_low, z_high
        Spring extension at the turns before and after [m]; NaN where there is none.
    samples
        How many there are in the phase.
    """

    begin: Event | None
    end: Event | None
    level: float
    rests: bool
    creep: float | None
    late_over_early: float
    z_low: float
    z_high: float
    samples: int


@dataclass(frozen=True)
class Phases:
    """What was seen of a motion.

    Attributes
    ----------
    sticks
        In order of time.
    high_samples
        Indices of the samples at which the spring turns from rising to falling.
    highs, lows
        Spring extension at the turns [m].
    high_times
        Times of the highest extensions [s].
    fall
        Deepest fall of the spring [m].
    only_rests
        Whether the mass is not seen to move at all.
    """

    sticks: tuple[Stick, ...]
    high_samples: tuple[int, ...]
    highs: Floats
    lows: Floats
    high_times: Floats
    fall: float
    only_rests: bool


def find_phases(motion: Motion, law: Law) -> Phases:
    """Find the sticks of a motion.

    Parameters
    ----------
    motion
        The samples.
    law
        The exact law: how long a mass that rests needs to run out and to start.
    """
    z = motion.z
    only_rests = float(np.ptp(motion.y)) <= 2.0 * VISIBLE * motion.allowed
    fall = float(np.max(np.maximum.accumulate(z) - z))
    if fall <= 8.0 * motion.allowed:
        none = np.array([])
        stick = _stick(motion, law, 0, z.size - 1, math.nan, math.nan, fall)
        return Phases(tuple([stick] if stick else []), (), none, none, none, fall, only_rests)
    turns = _turns(z, _DEEP * fall)
    highs = [index for index, up in turns if up]
    lows = [index for index, up in turns if not up]
    sticks = []
    for begin, end in zip([None, *lows], [*highs, None][: len(lows) + 1], strict=True):
        first = 0 if begin is None else begin
        last = z.size - 1 if end is None else end
        low = math.nan if begin is None else float(z[begin])
        high = math.nan if end is None else float(z[end])
        stick = _stick(motion, law, first, last, low, high, fall)
        if stick is not None:
            sticks.append(stick)
    return Phases(
        sticks=tuple(sticks),
        high_samples=tuple(highs),
        highs=z[highs],
        lows=z[lows],
        high_times=motion.t[highs],
        fall=fall,
        only_rests=only_rests,
    )


def _turns(z: Floats, deep: float) -> list[tuple[int, bool]]:
    """Return the turns of z as (index, whether it is a highest), alternating, a highest first."""
    first_of_equals = np.flatnonzero(np.diff(z, prepend=np.nan) != 0.0)
    way = np.sign(np.diff(z[first_of_equals]))
    extremes = first_of_equals[np.flatnonzero(np.diff(way, prepend=0.0, append=0.0))]
    turns: list[tuple[int, bool]] = []
    rising = True
    best, at = float(z[0]), 0
    for index, value in zip(extremes.tolist(), z[extremes].tolist(), strict=True):
        if rising:
            if value > best:
                best, at = value, index
            elif value < best - deep:
                turns.append((at, True))
                rising, best, at = False, value, index
        elif value < best:
            best, at = value, index
        elif value > best + deep:
            turns.append((at, False))
            rising, best, at = True, value, index
    return turns


def _stick(
    motion: Motion, law: Law, first: int, last: int, z_low: float, z_high: float, fall: float
) -> Stick | None:
    """Look at the samples between a lowest and a highest extension; None where none is slow."""
    t, y = motion.t[first : last + 1], motion.y[first : last + 1]
    if t.size < 2:
        return None
    i, j, level = plateau(t, y, VISIBLE * motion.allowed)
    begins, ends = not math.isnan(z_low), not math.isnan(z_high)
    slow = np.flatnonzero(_speed(t, y, motion.allowed, law.v) < 0.5 * law.v)
    if not slow.size:
        return None
    from_, to = int(min(slow[0], i)), int(max(slow[-1], j))
    gap = _seen_gap(z_high - z_low if begins and ends else fall, law)
    hidden = _invisible(law, gap, motion.allowed)
    tail = _run_out(law, gap) * (begins + ends) + 2.0 * hidden
    window = max(8.0 * motion.allowed / law.v, float(np.max(np.diff(t))))
    slow_time, rest = float(t[to] - t[from_]), float(t[j] - t[i])
    creeps = to - from_ >= _FEW and slow_time - rest > tail + LOST * slow_time + 2.0 * window
    quarter = (to - from_) // 4
    a, b = from_ + quarter, to - quarter
    if creeps:
        creep: float | None = _slope(t, y, a, b)
        late_over_early = _slope(t, y, (a + b) // 2, b) / (
            _slope(t, y, a, (a + b) // 2) or math.nan
        )
        i, j, hidden = from_, to, 0.0
    else:
        creep, late_over_early = (0.0 if j > i else None), math.nan
    before = float(motion.t[max(first + i - 1, 0)]) - motion.blur
    after = float(motion.t[min(first + j + 1, motion.t.size - 1)]) + motion.blur
    hidden += motion.blur
    return Stick(
        begin=Event(before, float(t[i]) + hidden) if begins else None,
        end=Event(float(t[j]) - hidden, after) if ends else None,
        level=level,
        rests=j > i and not creeps,
        creep=creep,
        late_over_early=late_over_early,
        z_low=z_low,
        z_high=z_high,
        samples=to - from_ + 1,
    )


def _slope(t: Floats, y: Floats, a: int, b: int) -> float:
    """Return the mean velocity between two samples [m/s]; 0 where they are one."""
    return float((y[b] - y[a]) / (t[b] - t[a])) if b > a else 0.0


def plateau(t: Floats, y: Floats, band: float) -> tuple[int, int, float]:
    """Return first and last sample and the level of the longest time within a band of y.

    A solver may step back a little where it stops, so that y only nearly rises; a mass that
    creeps back falls.
    """
    runs = []
    for i, j in (_longest(t, y, band), _longest(t, -y, band)):
        level = float(np.median(y[i : j + 1]))
        edges = np.flatnonzero(np.diff(np.abs(y - level) <= band, prepend=False, append=False))
        first, last = edges[::2], edges[1::2] - 1
        if first.size:
            best = int(np.argmax(t[last] - t[first]))
            runs.append((int(first[best]), int(last[best]), level))
    return max(runs, key=lambda run: float(t[run[1]] - t[run[0]]), default=(0, 0, float(y[0])))


def _longest(t: Floats, y: Floats, band: float) -> tuple[int, int]:
    """Return first and last sample of the longest time in which a rising y gains a band."""
    highest = np.maximum.accumulate(y)
    last = np.searchsorted(highest, y + band, side="right") - 1
    last = np.maximum(last, np.arange(t.size))
    i = int(np.argmax(t[last] - t))
    return i, int(last[i])


def _speed(t: Floats, y: Floats, allowed: float, v: float) -> Floats:
    """Return the velocity at each sample [m/s], over times in which v outweighs the digits."""
    half = 4.0 * allowed / v
    mean_step = (t[-1] - t[0]) / (t.size - 1)
    reach = max(1, math.ceil(min(half / mean_step, float(t.size))))
    low = np.maximum(np.arange(t.size) - reach, 0)
    high = np.minimum(np.arange(t.size) + reach, t.size - 1)
    return np.asarray((y[high] - y[low]) / (t[high] - t[low]))


def _seen_gap(swing: float, law: Law) -> float:
    """Return the gap [m] that a swing of the spring from turn to turn shows."""
    amplitude = 0.5 * swing
    return math.sqrt(max(amplitude**2 - (law.v / law.w) ** 2, 0.0))


def _run_out(law: Law, gap: float) -> float:
    """Return how long a slip from rest needs to reach v/2, or to come to rest from there [s]."""
    amplitude = math.hypot(gap, law.v / law.w)
    turn = math.acos(0.5 * law.v / (law.w * amplitude))
    return (turn - math.atan2(law.w * gap, law.v)) / law.w


def _invisible(law: Law, gap: float, allowed: float) -> float:
    """Return how long a slip from rest stays within the digits of the samples [s]."""
    way = 4.0 * allowed
    by_jerk = (6.0 * way / (law.v * law.w**2)) ** (1.0 / 3.0)
    by_acceleration = math.sqrt(2.0 * way / (gap * law.w**2)) if gap > 0.0 else math.inf
    return float(min(by_jerk, by_acceleration))
