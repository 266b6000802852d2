"""Stick and slip in a record: its runs at one feed, and the turns of the spring in each."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.signal import find_peaks

from stickslip_score import half_unit, scatter_of

from ..axis import Axis
from .model import Floats, Record

_MOST, _LEAST = 60_000, 40
"""Samples of a run: of more, every second, third, ... is taken."""
_BENDS, _JITTERS, _UNITS = (1e-5, 2e-3), 6.0, 4.0
"""What the command may be off a straight line: of its way, of which noise is no more than the
second; deviations of its noise; half digits."""
_SLOW, _ONE_WAY = 0.02, 0.8
"""Of the fastest feed, below which the command rests; of its range, how far the table gets."""
_WIDTHS: Final = (1, 4, 16, 64)
"""Samples over which turns are looked for in means, where noise hides them."""
_OF_NOISE, _OF_DIGIT, _LARGE, _ALIKE = 6.0, 1.4, 0.3, 0.5
"""Deviations of noise that are no turn, and the least of those, of half a digit; turns that are no
noise, of the largest; how far the cycles of a run are from their median, relative."""
_STRAIGHT, _RESTS, _EVENLY, _SURELY, _SPANS, _TOGETHER = 0.015, 0.03, 0.3, 0.1, 3, 0.3
"""Of the swing: how straight a force rises, and how still a table is, in the middle of a stick.
Deviation of the times from cycle to cycle, over their mean, of cycles, and of those beyond doubt;
so many that tell it. Correlation of force and spring."""


@dataclass(frozen=True)
class Run:
    """Samples at one feed, turned so that it is forward, shape (n,)."""

    t: Floats
    speed: float
    """Of the spring's end [m/s]; NaN: not known."""
    columns: dict[str, Floats]
    """"x" [m] and "F" [N], as far as there are."""
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

    @property
    def step(self) -> float:
        """Between samples [s]."""
        return float(np.median(np.diff(self.t)))

    def within(self, begin: float, end: float) -> Run:
        """Return the samples from one time to another."""
        run = self.at((self.t >= begin) & (self.t <= end))
        highs, lows = (
            tuple(at for at in turns if begin <= at <= end) for turns in (self.highs, self.lows)
        )
        return replace(run, highs=highs, lows=lows)

    def at(self, some: slice | NDArray[np.bool_]) -> Run:
        """Return some of its samples."""
        columns = {name: s[some] for name, s in self.columns.items()}
        return replace(self, t=self.t[some], columns=columns)


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
        if abs(speed) < _SLOW * fastest or end - begin < _LEAST:
            continue
        start, rest = -math.inf, lines[0][1]
        if command is not None and not runs and 0 < begin < rest + _LEAST:
            # From a rest on, the spring is drawn by what the command has gone since.
            start = float(t[begin] - (level - np.mean(command[: rest + 1])) / speed)
        way = x[end] - x[begin] if math.isnan(speed) and x is not None else speed
        sign = -1.0 if way < 0.0 else 1.0
        columns = {name: sign * s for name, s in (("x", x), ("F", F)) if s is not None}
        run = Run(t, abs(speed), columns, sign, start)
        runs.append(_turned(run.at(slice(begin, end + 1, -(-(end - begin) // _MOST))), shows))
    if not runs:
        raise ValueError("the command does not move long enough at one speed")
    return runs


def _straight(t: Floats, s: Floats) -> list[tuple[int, int, float, float]]:
    """Return the straight pieces of a command: first and last sample, speed, and first place."""
    noise = max(_UNITS * half_unit(s), _JITTERS * float(np.nan_to_num(scatter_of(t, s))))
    least, most = (share * float(np.ptp(s)) for share in _BENDS)
    allowed = max(least, min(noise, most), 1e-300)
    pieces, rest = list[tuple[int, int, float, float]](), [(0, t.size - 1)]
    while rest:
        a, b = rest.pop()
        off = np.abs(s[a : b + 1] - np.interp(t[a : b + 1], [t[a], t[b]], [s[a], s[b]]))
        at = a + int(np.argmax(off))
        if off.max() > allowed and b - a >= _LEAST:
            rest += [(at, b), (a, at)]
        elif b - a > 1:
            speed, level = np.polyfit(t[a : b + 1] - t[a], s[a : b + 1], 1).tolist()
            pieces.append((a, b, speed, level))
    return pieces


def _turned(run: Run, shows: bool) -> Run:
    """Return a run with the turns of its spring, or why it has none; `shows`: the table is seen."""
    turned = replace(run, still="the spring does not turn twice at one feed")
    clearest, t, x = 0.0, run.t, run.columns.get("x", run.t)
    for name, s in run.columns.items():
        degree, rough = (1, _STRAIGHT) if name == "F" else (0, _RESTS)
        speed = float(np.polyfit(t, s, 1)[0]) if math.isnan(run.speed) else run.speed
        noise = max(float(np.nan_to_num(scatter_of(t, s))), _OF_DIGIT * half_unit(s))
        highs, lows, swing = _turns(s if degree else speed * (t - t[0]) - s, noise)
        clear = len(lows) * swing / max(noise, 1e-3 * swing, 1e-300)
        if clear <= clearest:
            continue
        rests, clearest, spans = 0, clear, np.diff(t[highs])
        uneven = float(np.std(spans) / np.mean(spans))
        for low, high in zip(lows, highs[1:], strict=False):
            part = slice(low + (high - low) // 4, high - (high - low) // 4)
            at, y = t[part] - t[low], s[part]
            off = y - np.polyval(np.polyfit(at, y, degree), at) if at.size > 2 else np.zeros(1)
            rests += float(np.sqrt(np.mean(off**2))) < math.hypot(rough * swing, 1.3 * noise)
        whys = {
            f"the table rests between {rests} of {len(highs)} slips only": shows and rests < 2,
            "the spring does not turn evenly": uneven > _EVENLY
            or (len(spans) < _SPANS and not shows),
            "force and spring do not turn together": shows
            and len(run.columns) > 1
            and uneven > _SURELY
            and np.corrcoef(speed * t - x, run.columns["F"])[0, 1] < _TOGETHER,
            "the table goes forth and back": math.isnan(run.speed)
            and abs(x[-1] - x[0]) < _ONE_WAY * np.ptp(x),
        }
        still = next((why for why, is_so in whys.items() if is_so), "")
        turned = replace(run, highs=tuple(t[highs]), lows=tuple(t[lows]), still=still)
    return turned


def _turns(u: Floats, noise: float) -> tuple[NDArray[np.intp], NDArray[np.intp], float]:
    """Return where a saw tooth turns down, and after that up, in cycles that are alike; its swing.

    The means are as short as shows cycles.
    """
    for width in _WIDTHS:
        smooth = uniform_filter1d(u, width)
        least = max(_OF_NOISE * noise / math.sqrt(width), 1e-300)
        sides = [find_peaks(u, prominence=least, plateau_size=0)[1] for u in (smooth, -smooth)]
        sizes = np.append(sides[0]["prominences"], 0.0)
        size = _ALIKE * float(np.median(sizes[sizes >= _LARGE * sizes.max()]))
        # Where a top is cut off, its begin.
        highs, lows = (side["left_edges"][side["prominences"] > size] for side in sides)
        lows = lows[lows > highs[0]] if highs.size else lows
        pairs = min(highs.size, lows.size)
        swings = smooth[highs[:pairs]] - smooth[lows[:pairs]]
        middle = float(np.median(swings)) if pairs > 1 else 0.0
        if middle and np.all(np.abs(swings - middle) < _ALIKE * middle):
            return highs, lows, middle
    return np.empty(0, np.intp), np.empty(0, np.intp), 0.0
