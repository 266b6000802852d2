"""A record on an even grid, and through one zero-phase filter, with its derivatives."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from scipy.signal import butter, sosfiltfilt
from scipy.special import beta

from stickslip_score import scatter_of

from .model import Floats, Record

_GAP: Final = 5.5
"""A step longer than so many usual ones is a gap, over which nothing is interpolated."""
_ORDER: Final = 4
_LEAST: Final = 40
"""Samples of an unbroken run below which it is left out."""
_FIRST: Final = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
_SECOND: Final = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0
"""Derivatives by differences of sixth order: within 2e-4 at a tenth of the sample rate."""
_MARGIN: Final = 3


class Even(NamedTuple):
    """An unbroken run of a record on an even grid; columns that it has not are None."""

    t: Floats
    step: float
    position: Floats
    velocity: Floats | None
    command: Floats | None
    force: Floats | None


def evened(record: Record) -> list[Even]:
    """Return the unbroken runs of a record, its samples interpolated to its usual step.

    Without a position the speed is summed up.
    """
    step = float(np.median(np.diff(record.t)))
    breaks = np.flatnonzero(np.diff(record.t) > _GAP * step) + 1
    position = record.position
    if position is None and record.velocity is not None:
        mean = 0.5 * (record.velocity[1:] + record.velocity[:-1])
        position = np.concatenate([[0.0], np.cumsum(mean * np.diff(record.t))])
    if position is None:
        raise ValueError("the record has neither a position nor a speed")
    runs = []
    for places in np.split(np.arange(record.t.size), breaks):
        if places.size < _LEAST:
            continue
        t = record.t[places]
        is_even = bool(np.all(np.abs(np.diff(t) - step) < 1e-3 * step))
        grid = t if is_even else np.arange(t[0], t[-1], step)
        columns = [
            None if c is None else c[places] if is_even else np.interp(grid, t, c[places])
            for c in (position, record.velocity, record.command, record.force)
        ]
        assert columns[0] is not None
        runs.append(Even(grid, step, columns[0], *columns[1:]))
    if not runs:
        raise ValueError(f"the record has no {_LEAST} samples in a row without a gap")
    return runs


class Filtered(NamedTuple):
    """A run through a low pass, forth and back, shape (n,): it shifts nothing."""

    t: Floats
    x: Floats
    v: Floats
    a: Floats
    force: Floats | None
    wanted: tuple[Floats, Floats] | None
    """Commanded speed and acceleration."""


def low_pass(s: Floats, step: float, corner: float) -> Floats:
    """Return a signal of even steps [s] through a low pass with a corner [Hz], forth and back."""
    sos = butter(_ORDER, corner, fs=1.0 / step, output="sos")
    return np.asarray(sosfiltfilt(sos, s, padlen=min(s.size - 1, int(3.0 / (corner * step)))))


def filtered(run: Even, corner: float) -> Filtered:
    """Return a run through the low pass with a corner [Hz]; ends of three samples are left out."""
    inner = slice(_MARGIN, -_MARGIN)

    def derived(column: Floats) -> tuple[Floats, Floats, Floats]:
        x = low_pass(column, run.step, corner)
        v = np.convolve(x, _FIRST[::-1], "same") / run.step
        a = np.convolve(x, _SECOND, "same") / run.step**2
        return x[inner], v[inner], a[inner]

    x, v, a = derived(run.position)
    if run.velocity is not None:
        v, a, _ = derived(run.velocity)
    force = None if run.force is None else low_pass(run.force, run.step, corner)[inner]
    wanted = None if run.command is None else derived(run.command)[1:]
    return Filtered(run.t[inner], x, v, a, force, wanted)


class Scatter(NamedTuple):
    """What noise leaves on a filtered speed [m/s] and acceleration [m/s2], rms."""

    v: float
    a: float


def scatter(run: Even, corner: float, rounding: float) -> Scatter:
    """Return the noise of speed and acceleration behind the low pass with a corner [Hz].

    Of white noise of the position, or of the speed where that is measured, its numbers rounded by
    at most `rounding`.
    """
    white = run.position if run.velocity is None else run.velocity
    sigma = scatter_of(run.t, white)
    sigma = max(sigma if math.isfinite(sigma) else 0.0, rounding / math.sqrt(3.0))
    density, w = 2.0 * run.step * sigma**2, 2.0 * math.pi
    # What the low pass leaves: the integral of u^(2n)/(1 + u^8)^2.
    parts = [0.125 * beta((2 * n + 1) / 8.0, 2.0 - (2 * n + 1) / 8.0) for n in range(3)]
    powers = [density * w ** (2 * n) * corner ** (2 * n + 1) * parts[n] for n in range(3)]
    first = 1 if run.velocity is None else 0
    return Scatter(math.sqrt(powers[first]), math.sqrt(powers[first + 1]))
