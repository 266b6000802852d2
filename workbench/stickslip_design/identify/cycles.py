"""Stick and slip in a record: its runs at one feed, and the turns of the spring in each."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from stickslip_score import scatter_of

from ..axis import Axis
from .model import Floats, Record

_MOST: Final = 60_000
"""Samples of a run; of more, every second, third, ... is taken."""
_BENDS, _JITTERS, _UNITS = (1e-5, 2e-3), 6.0, 2.0
"""What the command may be off a straight line: of its way, of which noise is no more than the
second; deviations of its noise; its digits."""
_NOTHING, _OFTEN = 1e-9, 0.05
"""Of the way of a column, what is no bend; and the part of the samples with a bend if counted."""
_SLOW: Final = 0.02
"""Of the fastest feed, below which the command rests."""
_LEAST_SAMPLES: Final = 40
_SWINGS: Final = tuple(0.4 * 0.7**n for n in range(12))
"""Shares of the whole swing that a turn of the spring has at least; the first that shows cycles."""
_WIDTHS: Final = (1, 4, 16, 64)
"""Samples over which turns are looked for in means, where noise hides them."""
_ALIKE: Final = 0.5
"""Least and greatest swing of cycles, over their median, are this or its inverse away."""
_OF_NOISE: Final = 6.0
"""Deviations of noise that are no turn."""
_STRAIGHT, _RESTS = 0.015, 0.03
"""Of the swing: how straight a force rises, and how still a table is, in the middle of a stick."""


@dataclass(frozen=True)
class Run:
    """Samples at one feed, turned so that it is forward, shape (n,)."""

    t: Floats
    speed: float
    """Of the spring's end [m/s]; NaN: not known."""
    x: Floats | None
    F: Floats | None
    sign: float
    start: float = -math.inf
    """When the command begins at rest, before [s]; minus infinity: not in the record."""
    highs: tuple[float, ...] = ()
    lows: tuple[float, ...] = ()
    """When the spring turns from rising to falling, and after that from falling to rising [s]."""
    still: str = ""
    """Why it is no stick-slip; empty where it is."""

    @property
    def period(self) -> float:
        """From cycle to cycle [s]."""
        return (self.highs[-1] - self.highs[0]) / (len(self.highs) - 1)

    def within(self, begin: float, end: float) -> Run:
        """Return the samples from one time to another."""
        run = self.at((self.t >= begin) & (self.t <= end))
        highs, lows = (
            tuple(at for at in turns if begin <= at <= end) for turns in (self.highs, self.lows)
        )
        return replace(run, highs=highs, lows=lows)

    def from_rest(self) -> Run:
        """Return the samples from a rest on: its own begin, or the first rest between two slips."""
        later = self.within(0.5 * (self.lows[0] + self.highs[1]), math.inf)
        return later if self.start == -math.inf and len(later.highs) > 1 and later.lows else self

    def at(self, some: slice | NDArray[np.bool_]) -> Run:
        """Return some of its samples."""
        x, F = (None if s is None else s[some] for s in (self.x, self.F))
        return replace(self, t=self.t[some], x=x, F=F)


def digit_of(s: Floats) -> float:
    """Return the last digit of a column that is counted: the least bend of it; else about 0."""
    bends = np.abs(np.diff(s, 2))
    bends = bends[bends > _NOTHING * float(np.ptp(s))]
    return float(bends.min()) if bends.size > _OFTEN * s.size else 0.0


def runs_of(record: Record, axis: Axis | None) -> list[Run]:
    """Return the runs at one feed each, with the turns of the spring."""
    x, F, t, command = record.position, record.force, record.t, record.command
    if x is None and F is None:
        raise ValueError("the record has neither a position nor a force")
    feeds = axis.demand.feeds if axis else ()
    lines = [(0, t.size - 1, feeds[0] if len(feeds) == 1 else math.nan, 0.0)]
    if command is not None:
        lines = _straight(t, command)
    shows = axis is None or axis.drive is None or axis.drive.on_table
    fastest, runs = max((abs(line[2]) for line in lines), default=0.0), list[Run]()
    for begin, end, speed, level in lines:
        if abs(speed) < _SLOW * fastest or end - begin < _LEAST_SAMPLES:
            continue
        start, rest = -math.inf, lines[0][1]
        if command is not None and not runs and 0 < begin < rest + _LEAST_SAMPLES:
            # From a rest on, the spring is drawn by what the command has gone since.
            start = float(t[begin] - (level - np.mean(command[: rest + 1])) / speed)
        some = slice(begin, end + 1, -(-(end - begin) // _MOST))
        way = x[end] - x[begin] if math.isnan(speed) and x is not None else speed
        sign = -1.0 if way < 0.0 else 1.0
        run = Run(
            t[some], abs(speed), None if x is None else sign * x[some],
            None if F is None else sign * F[some], sign, start,
        )  # fmt: skip
        runs.append(_turned(run, shows=shows))
    if not runs:
        raise ValueError("the command does not move long enough at one speed")
    return runs


def _straight(t: Floats, s: Floats) -> list[tuple[int, int, float, float]]:
    """Return the straight pieces of a command: first and last sample, speed, and first place."""
    noise = max(_UNITS * digit_of(s), _JITTERS * float(np.nan_to_num(scatter_of(t, s))))
    least, most = (share * float(np.ptp(s)) for share in _BENDS)
    allowed = max(least, min(noise, most), 1e-300)
    pieces, rest = list[tuple[int, int, float, float]](), [(0, t.size - 1)]
    while rest:
        a, b = rest.pop()
        off = np.abs(s[a : b + 1] - np.interp(t[a : b + 1], [t[a], t[b]], [s[a], s[b]]))
        at = a + int(np.argmax(off))
        if off.max() > allowed and b - a >= _LEAST_SAMPLES:
            rest += [(at, b), (a, at)]
            continue
        if b - a > 1:
            speed, level = np.polyfit(t[a : b + 1] - t[a], s[a : b + 1], 1).tolist()
            pieces.append((a, b, speed, level))
    return pieces


def _turned(run: Run, *, shows: bool) -> Run:
    """Return a run with the turns of its spring, and whether the table rests, if it `shows`."""
    best, clearest = (run.t, 1, 0.0, list[int](), list[int](), 0.0), 0.0
    for s, degree in ((run.F, 1), (run.x, 0)):
        if s is None:
            continue
        speed = run.speed if math.isfinite(run.speed) else float(np.polyfit(run.t, s, 1)[0])
        u = s if degree else speed * (run.t - run.t[0]) - s
        noise = max(float(np.nan_to_num(scatter_of(run.t, s))), 0.3 * digit_of(s))
        for width in _WIDTHS:
            highs, lows = _turns(uniform_filter1d(u, width), _OF_NOISE * noise / math.sqrt(width))
            if lows:
                break
        swing = float(np.median(u[highs[: len(lows)]] - u[lows])) if lows else 0.0
        clear = len(lows) * swing / max(noise, 1e-3 * swing, 1e-300)
        if clear > clearest:
            best, clearest = (s, degree, noise, highs, lows, swing), clear
    column, degree, noise, highs, lows, swing = best
    if len(highs) < 2 or not lows:
        return replace(run, still="the spring does not turn twice at one feed")
    rests, still, rough = 0, "", _STRAIGHT if degree else _RESTS
    for low, high in zip(lows, highs[1:], strict=False):
        part = slice(low + (high - low) // 4, high - (high - low) // 4)
        t, s = run.t[part] - run.t[low], column[part]
        off = s - np.polyval(np.polyfit(t, s, degree), t) if t.size > 2 else np.zeros(1)
        rests += float(np.sqrt(np.mean(off**2))) < math.hypot(rough * swing, 1.3 * noise)
    if shows and rests < 2:
        still = f"the table rests between {rests} of {len(highs)} slips only"
    return replace(run, highs=tuple(run.t[highs]), lows=tuple(run.t[lows]), still=still)


def _turns(u: Floats, least: float) -> tuple[list[int], list[int]]:
    """Return where a saw tooth turns down, and after that up, in cycles that are alike."""
    for share in _SWINGS:
        size = share * float(np.ptp(u))
        if size < least:
            break
        highs, lows = _zigzag(u.tolist(), size)
        pairs = min(len(highs), len(lows))
        if pairs < 2:
            continue
        swings = u[highs[:pairs]] - u[lows[:pairs]]
        middle = float(np.median(swings))
        if np.all(np.abs(swings - middle) < _ALIKE * middle) and middle > 1.5 * size:
            return highs, lows
    return [], []


def _zigzag(u: list[float], size: float) -> tuple[list[int], list[int]]:
    """Return the turns of more than a size, the first one a high."""
    highs: list[int] = []
    lows: list[int] = []
    top = bottom = 0
    rising = True
    for i, value in enumerate(u):
        if rising:
            if value > u[top]:
                top = i
            elif value < u[top] - size:
                highs.append(top)
                rising, bottom = False, i
        elif value < u[bottom]:
            bottom = i
        elif value > u[bottom] + size:
            lows.append(bottom)
            rising, top = True, i
    # A fall in which the record begins has no high.
    return (highs[1:], lows[1:]) if highs and highs[0] == 0 else (highs, lows)
