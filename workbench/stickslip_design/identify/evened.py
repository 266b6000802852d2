"""A record on an even grid, behind one zero-phase filter with its derivatives; its steady runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.signal import butter, savgol_filter, sosfiltfilt

from .model import Floats, Record

_GAP, _LEAST = 5.5, 40
"""A step longer than so many usual ones is a gap, over which nothing is interpolated. Samples of an
unbroken run below which it is left out."""
_OFTEN, _COUNTS = 2, 20
"""A force is clipped where its greatest or least value has so many times the samples of any other,
and so many at least; of as many values."""
_STEADY, _MOVES, _ENDS = 0.05, 1e-3, 0.1
"""How much the speed of a steady run changes, of it; of the highest speed: below it the table
rests; the part of a steady run that is left out at each end."""
_SHORTEST, _FEWEST, _CORNER = 0.04, 40, 0.03
"""Time [s] and samples over which the speed is steady; corner of the low pass before, of the rate
of the samples."""

Columns = dict[str, Floats]
Parts = list[tuple[float, float, float]]
"""Begin [s], end [s] and speed [m/s] of steady runs."""


def evened(record: Record) -> tuple[list[Columns], float]:
    """Return the unbroken runs of a record with a force, interpolated to its usual step.

    Time "t", position "x", "force". Samples whose force is clipped at a limit are left out; their
    part comes second. Without a position the speed is summed up. ValueError without both, or
    without a long run.
    """
    t, x, force = record.t, record.position, np.asarray(record.force)
    if x is None:
        if record.velocity is None:
            raise ValueError("a column of position or velocity is missing: name it by --column")
        x = cumulative_trapezoid(record.velocity, t, initial=0.0)
    values, counts = np.unique(force, return_counts=True)
    often = max(_COUNTS, _OFTEN * int(counts[1:-1].max(initial=1)))
    limits = values[[0, -1]][(counts[[0, -1]] > often) & (values.size > _COUNTS)]
    clipped, step, runs = np.isin(force, limits), float(np.median(np.diff(t))), list[Columns]()
    # Beside clipped samples there are those whose noise alone has left them below the limit.
    rows = np.flatnonzero(~maximum_filter1d(clipped, 2 * int(_GAP) + 1))
    for part in np.split(rows, np.flatnonzero(np.diff(t[rows]) > _GAP * step) + 1):
        if part.size >= _LEAST:
            grid = np.arange(t[part[0]], t[part[-1]] + 0.5 * step, step)
            even = {n: np.interp(grid, t[part], s[part]) for n, s in (("x", x), ("force", force))}
            runs.append({"t": grid, **even})
    if not runs:
        raise ValueError(f"no {_LEAST} samples in a row are without a gap: record for longer")
    return runs, float(np.mean(clipped))


def filtered(run: Columns, step: float, corner: float) -> Columns:
    """Return a run of even steps [s] through a low pass with a corner [Hz], forth and back.

    Time "t", position "x", its derivatives speed "c", acceleration "m", "jerk", "jounce", the sign
    of the speed "F_k"; "force" and its "rate".
    """
    sos, around = butter(4, corner, fs=1.0 / step, output="sos"), int(3.0 / (corner * step))

    def derived(s: Floats, *names: str) -> Columns:
        passed = sosfiltfilt(sos, s, padlen=min(s.size - 1, around))
        # Differences of sixth order: within 2e-4 at a tenth of the sample rate.
        return {name: savgol_filter(passed, 7, 6, n, step) for n, name in enumerate(names)}

    columns = {"t": run["t"], **derived(run["x"], "x", "c", "m", "jerk", "jounce")}
    return columns | derived(run["force"], "force", "rate") | derived(np.sign(columns["c"]), "F_k")


def stretches(of: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return begin and end of each part in a row that is true."""
    edges = np.flatnonzero(np.diff(of, prepend=False, append=False)).tolist()
    return list(zip(edges[::2], edges[1::2], strict=True))


def plateaus(runs: Sequence[Columns], step: float) -> Parts:
    """Return the steady runs."""
    found, window = Parts(), max(_FEWEST, int(_SHORTEST / step))
    ways = [filtered(run, step, _CORNER / step) for run in runs]
    highest = max(float(np.max(np.abs(way["c"]))) for way in ways)
    for way in ways:
        t, v = way["t"], way["c"]
        span = maximum_filter1d(v, window) - minimum_filter1d(v, window)
        even = (np.abs(v) > _MOVES * highest) & (span < _STEADY * np.abs(v))
        for begin, end in stretches(even):
            speed, cut = float(np.median(v[begin:end])), int(_ENDS * (end - begin + window))
            if end - begin > window and np.ptp(v[begin:end]) < 2.0 * _STEADY * abs(speed):
                found.append((float(t[begin + cut]), float(t[end - 1 - cut]), speed))
    return found
