"""A record on an even grid, behind one zero-phase filter with its derivatives; its steady runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.signal import butter, savgol_filter, sosfiltfilt
from scipy.special import beta

from stickslip_score import scatter_of

from .model import Floats, Record

_COLUMNS: Final = ("position", "velocity", "command", "force")
_GAP: Final = 5.5
"""A step longer than so many usual ones is a gap, over which nothing is interpolated."""
_LEAST: Final = 40
"""Samples of an unbroken run below which it is left out."""
_CLIPPED, _OFTEN, _COUNTS = 0.005, 2.0, 10
"""A force is clipped where its greatest or least value has more than this part of the samples, and
so many times those of any other value, of so many at least."""
_STEADY, _DEVIATIONS, _BURIED = 0.05, 4.0, 0.2
"""Of its speed: how far a steady run may be off its median, beside so many deviations of the noise,
and noise that hides whether it is steady."""
_SHORTEST, _FEWEST, _ENDS = 0.1, 100, 0.1
"""Time [s] and samples of a steady run at least; the part of it left out at each end."""
_STRIDE, _CORNER = 10, 0.02
"""Samples of which one is looked at for that; corner of the low pass before, of their rate."""
_MOVES: Final = 1e-3
"""Of the highest speed: below it the table rests."""


Columns = dict[str, Floats]


class Even(NamedTuple):
    """An unbroken run of a record on an even grid."""

    t: Floats
    step: float
    columns: Columns
    """Position, velocity, command and force, by their names in a record, as far as it has them."""
    clipped: NDArray[np.bool_]
    """Where the force stands at a limit."""


def evened(record: Record) -> list[Even]:
    """Return the unbroken runs of a record, its samples interpolated to its usual step.

    Without a position the speed is summed up. ValueError without both, or without a long run.
    """
    t, named = record.t, {name: getattr(record, name) for name in _COLUMNS}
    if record.position is None:
        if record.velocity is None:
            raise ValueError("a column of position or velocity is missing: name it by --column")
        named["position"] = cumulative_trapezoid(record.velocity, t, initial=0.0)
    columns = {name: column for name, column in named.items() if column is not None}
    step, runs = float(np.median(np.diff(t))), []
    values, counts = np.unique(columns["force"], return_counts=True)
    often = max(_CLIPPED * t.size, _OFTEN * counts[1:-1].max(initial=1))
    limits = values[[0, -1]][(counts[[0, -1]] > often) & (values.size > _COUNTS)]
    for part in np.split(np.arange(t.size), np.flatnonzero(np.diff(t) > _GAP * step) + 1):
        if part.size >= _LEAST:
            grid = np.arange(t[part[0]], t[part[-1]] + 0.5 * step, step)
            even = {n: np.interp(grid, t[part], column[part]) for n, column in columns.items()}
            runs.append(Even(grid, step, even, np.isin(even["force"], limits)))
    if not runs:
        raise ValueError(f"no {_LEAST} samples in a row are without a gap: record for longer")
    return runs


def low_pass(s: Floats, step: float, corner: float) -> Floats:
    """Return a signal of even steps [s] through a low pass with a corner [Hz], forth and back."""
    sos = butter(4, corner, fs=1.0 / step, output="sos")
    return np.asarray(sosfiltfilt(sos, s, padlen=min(s.size - 1, int(3.0 / (corner * step)))))


def filtered(run: Even, corner: float) -> Columns:
    """Return a run through the low pass with a corner [Hz]; ends of three samples are left out.

    Time "t", position "x", "force", speed "c" and acceleration "m"; where there is a command its
    "wanted c" and "wanted m".
    """

    def derived(name: str, *orders: int) -> list[Floats]:
        # Differences of sixth order: within 2e-4 at a tenth of the sample rate.
        x = low_pass(run.columns[name], run.step, corner)
        return [savgol_filter(x, 7, 6, n, run.step)[3:-3] for n in orders]

    columns = dict(zip(("x", "c", "m"), derived("position", 0, 1, 2), strict=True))
    if "velocity" in run.columns:
        columns["c"], columns["m"] = derived("velocity", 0, 1)
    if "command" in run.columns:
        columns["wanted c"], columns["wanted m"] = derived("command", 1, 2)
    return columns | {"t": run.t[3:-3], "force": derived("force", 0)[0]}


def scatter(run: Even, corner: float, rounding: float) -> tuple[float, float, float]:
    """Return the noise of speed [m/s], acceleration [m/s2], force [N] behind the low pass, rms.

    Of white noise of the force, and of the position, or of the speed where that is measured, its
    numbers rounded by at most `rounding`; the corner in Hz.
    """

    def left(name: str, n: int, rounding: float = 0.0) -> float:
        """Return the n-th derivative's, by the integral of u^(2n)/(1 + u^8)^2."""
        part = 0.125 * beta((2 * n + 1) / 8.0, 2.0 - (2 * n + 1) / 8.0)
        power = 2.0 * run.step * corner * part * (2.0 * math.pi * corner) ** (2 * n)
        sigma = np.nan_to_num(scatter_of(run.t, run.columns[name]))
        return max(float(sigma), rounding / math.sqrt(3.0)) * math.sqrt(power)

    name, first = ("velocity", 0) if "velocity" in run.columns else ("position", 1)
    return left(name, first, rounding), left(name, first + 1, rounding), left("force", 0)


class Plateau(NamedTuple):
    """A steady run: its begin and end [s], and its speed [m/s]."""

    begin: float
    end: float
    speed: float


def plateaus(runs: Sequence[Even], rounding: float) -> tuple[list[Plateau], float]:
    """Return the steady runs, and their share of the time in which the table moves.

    `rounding` is half a unit in the last digit of the positions [m].
    """
    found, moving, steady = [], 0, 0
    corner = _CORNER / runs[0].step
    window = max(_FEWEST, int(_SHORTEST / runs[0].step)) // _STRIDE
    ways = [filtered(run, corner) for run in runs]
    highest = max(float(np.max(np.abs(way["c"]))) for way in ways)
    for run, way in zip(runs, ways, strict=True):
        noise = _DEVIATIONS * scatter(run, corner, rounding)[0]
        t, v = way["t"][::_STRIDE], way["c"][::_STRIDE]
        size = np.abs(v)
        moves = size > max(_MOVES * highest, noise)
        moving += int(np.count_nonzero(moves))
        allowed = _STEADY * size + noise
        ahead = {"size": window, "origin": -(window // 2)}
        span = maximum_filter1d(v, **ahead) - minimum_filter1d(v, **ahead)
        starts = np.flatnonzero((span <= allowed) & moves & (noise <= _BURIED * size))
        end = 0
        for begin in starts[starts < t.size - window].tolist():
            if begin < end:
                continue
            speed = float(np.median(v[begin : begin + window]))
            off = np.abs(v[begin:] - speed) > allowed[begin]
            length = int(np.argmax(off)) if off.any() else off.size
            if length >= window:
                cut = int(_ENDS * length)
                inner = t[begin + cut : begin + length - cut - 1]
                found.append(Plateau(float(inner[0]), float(inner[-1]), speed))
                end, steady = begin + length, steady + length
    return found, min(steady / max(moving, 1), 1.0)
