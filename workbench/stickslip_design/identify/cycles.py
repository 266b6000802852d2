"""Stick and slip in a record: its runs at one feed, and the turns of the spring in each."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.ndimage import uniform_filter1d

from stickslip_score import Solution, scatter_of, solved

from ..axis import Axis
from .model import Floats, Record

_MOST: Final = 60_000
"""Samples of a run; of more, means over some are taken."""
_BEND: Final = 1e-5
"""Of the way of the command: what it may be off a straight line."""
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
"""Deviations of noise that are no turn, and no motion."""
_RESTS: Final = 0.15
"""Of the jump: way in the middle of a stick that is rest; of a sine it is half."""


@dataclass(frozen=True)
class Run:
    """Samples at one feed, turned so that it is forward, shape (n,)."""

    t: Floats
    speed: float
    """Of the spring's end [m/s]; NaN: not known."""
    x: Floats | None
    F: Floats | None
    sign: float
    half: float = 0.0
    """Of a sample that is a mean over some: their standard deviation in time [s]."""
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
        some = (self.t >= begin) & (self.t <= end)
        x, F = (None if s is None else s[some] for s in (self.x, self.F))
        highs = tuple(at for at in self.highs if begin <= at <= end)
        lows = tuple(at for at in self.lows if begin <= at <= end)
        return replace(self, t=self.t[some], x=x, F=F, highs=highs, lows=lows)

    def first(self) -> Solution:
        """Return about the solution that the turns show."""
        half = float(np.median(np.subtract(self.lows, self.highs[: len(self.lows)])))
        speed, period = (1.0 if math.isnan(self.speed) else self.speed), self.period
        # Highest and lowest extension lie half a free swing apart.
        w = max(math.pi / half, 1.05 * math.pi / period)
        guess = Solution(w, 0.02, speed, speed / w)
        return solved(guess, "period", period, "D", 1e-3 * speed / w, 0.5 * speed * period)


def runs_of(record: Record, axis: Axis | None) -> list[Run]:
    """Return the runs at one feed each, with the turns of the spring."""
    x, F, t = record.position, record.force, record.t
    if x is None and F is None:
        raise ValueError("the record has neither a position nor a force")
    feeds = axis.demand.feeds if axis else ()
    pieces = [(0, t.size - 1)]
    if record.command is not None:
        pieces = _straight(t, record.command, 4.0 * record.rounding.get("command", 0.0))
        speeds = [(record.command[b] - record.command[a]) / (t[b] - t[a]) for a, b in pieces]
    else:
        speeds = [feeds[0] if len(feeds) == 1 else math.nan]
    runs, rested = [], False
    fastest = max(map(abs, speeds))
    for number, (speed, (begin, end)) in enumerate(zip(speeds, pieces, strict=True)):
        if abs(speed) < _SLOW * fastest or end - begin < _LEAST_SAMPLES:
            rested = number == 0
            continue
        way = speed if not math.isnan(speed) else float(np.ptp(_either(x, F)))
        if math.isnan(speed) and x is not None:
            way = float(x[-1] - x[0])
        sign, here = math.copysign(1.0, way), slice(begin, end + 1)
        start = -math.inf
        if rested and record.command is not None:
            start = float(t[begin] - (record.command[begin] - record.command[0]) / speed)
        run = Run(
            t[here], abs(speed), None if x is None else sign * x[here],
            None if F is None else sign * F[here], sign, 0.0, start,
        )  # fmt: skip
        rested = False
        runs.append(
            _turned(_thinned(run), shows=axis is None or axis.drive is None or axis.drive.on_table)
        )
    if not runs:
        raise ValueError("the command does not move long enough at one speed")
    return runs


def _either(x: Floats | None, F: Floats | None) -> Floats:
    if x is not None:
        return x
    assert F is not None
    return F


def _straight(t: Floats, s: Floats, least: float) -> list[tuple[int, int]]:
    """Return the straight pieces of a command: first and last sample."""
    allowed = max(least, _BEND * float(np.ptp(s)), 1e-300)
    pieces, rest = [], [(0, t.size - 1)]
    while rest:
        a, b = rest.pop()
        off = np.abs(s[a : b + 1] - np.interp(t[a : b + 1], [t[a], t[b]], [s[a], s[b]]))
        at = a + int(np.argmax(off))
        if off.max() <= allowed or b - a < _LEAST_SAMPLES:
            pieces.append((a, b))
        else:
            rest += [(at, b), (a, at)]
    return pieces


def _thinned(run: Run) -> Run:
    count = -(-run.t.size // _MOST)
    if count == 1:
        return run
    size = run.t.size // count * count
    t, x, F = (
        None if s is None else s[:size].reshape(-1, count).mean(axis=1)
        for s in (run.t, run.x, run.F)
    )
    assert t is not None
    step = float(np.median(np.diff(run.t)))
    return replace(run, t=t, x=x, F=F, half=step * math.sqrt((count * count - 1) / 12.0))


def _turned(run: Run, *, shows: bool) -> Run:
    """Return a run with the turns of its spring, and whether the table rests, if it `shows`."""
    shown = []
    for name in ("F", "x"):
        s = getattr(run, name)
        if s is None:
            continue
        speed = run.speed if math.isfinite(run.speed) else float(np.polyfit(run.t, s, 1)[0])
        u = s if name == "F" else speed * (run.t - run.t[0]) - s
        noise = scatter_of(run.t, s)
        noise = noise if math.isfinite(noise) else 0.0
        for width in _WIDTHS:
            highs, lows = _turns(uniform_filter1d(u, width), _OF_NOISE * noise / math.sqrt(width))
            if lows:
                break
        swing = float(np.median(u[highs[: len(lows)]] - u[lows])) if lows else 0.0
        shown.append(
            (
                len(lows) * swing / max(noise, 1e-3 * swing, 1e-300),
                name,
                u,
                noise,
                highs,
                lows,
                swing,
            )
        )
    _, name, u, noise, highs, lows, swing = max(shown, key=lambda one: one[0])
    if len(highs) < 2 or not lows:
        return replace(run, still="the spring does not turn twice at one feed")
    rests = _rests(run, u, noise, highs, lows, swing, name)
    still = (
        ""
        if rests >= 2 or not shows
        else f"the table rests between {rests} of {len(highs)} slips only"
    )
    at = run.t.tolist()
    return replace(
        run, highs=tuple(at[i] for i in highs), lows=tuple(at[i] for i in lows), still=still
    )


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
    if highs and highs[0] == 0:
        # A fall in which the record begins has no high.
        return highs[1:], lows[1:]
    return highs, lows


def _rests(
    run: Run, u: Floats, noise: float, highs: list[int], lows: list[int], swing: float, name: str
) -> int:
    """Return between how many slips the table rests, or the force rises evenly."""
    count = 0
    for low, high in zip(lows, highs[1:], strict=False):
        length = high - low
        begin, end = low + length // 4, high - length // 4
        if end - begin < 3:
            count += 1
            continue
        t, s = run.t[begin:end], u[begin:end]
        off = s - np.polyval(np.polyfit(t, s, 1), t)
        if name == "x":
            x = getattr(run, name)[begin:end]
            off = x - np.mean(x)
        rough = float(np.sqrt(np.mean(off**2)))
        count += rough < math.hypot(0.1 * _RESTS * swing * (1 if name == "F" else 2), 1.3 * noise)
    return count
