"""Any motion of a driven axis: mass, viscous and Coulomb friction by inverse dynamics.

F = m a + F_k sgn(v) + c v + offset, all behind the same low pass, which leaves it true. Numbers by
linear least squares; docs/identify.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, binary_opening

from ..axis import Axis
from .evened import Even, evened, filtered, low_pass, scatter
from .laws import law_of
from .model import Curve, Floats, Identified, Number, Record, Residual, Trace
from .noise import Estimate, Memory, least_squares, memory_of

_WHITENED: Final = 0.55
"""Corner of the low pass, of the rate of the samples behind it: white noise stays white to 1 %."""
_FIRST, _WIDER, _LAST = 6, 1.25, 200
"""Stride of the samples behind the widest low pass; of the next one; their least number."""
_LITTLE: Final = 0.15
"""Of the residual's power: that of the acceleration's noise."""
_KEPT: Final = 50_000
"""Samples that are kept of a long record, about."""
_SLOW, _REST = 0.02, 0.002
"""Of the highest speed: where friction is not taken for Coulomb's, and where the table rests."""
_RINGING: Final = 0.7
"""Length of the low pass's answer, over its corner's period."""
_WAY: Final = 3.0
"""Deviations that tell two directions from chance."""
_FAULT: Final = 4.0
"""Deviations that tell a fault from chance, of some that are sought."""
_LAG: Final = 0.05
"""Lag whose correlation is shown [s]."""
_MOST: Final = 3000
"""Points of a drawn trace."""
_BINS: Final = 10
"""Of a friction curve, for each direction."""


@dataclass(frozen=True)
class _Rows:
    """Samples of all runs that are used, behind the low pass and thinned to its corner."""

    t: Floats
    x: Floats
    v: Floats
    a: Floats
    jerk: Floats
    sign: Floats
    ahead: Floats
    """The speed forward, 0 backward [m/s]."""
    force: Floats
    run: Floats
    """Number of the unbroken stretch."""
    corner: float
    step: float
    noise: tuple[float, float]
    """That of the acceleration [m/s2] and of the speed [m/s]."""

    def columns(self, *more: Floats, apart: bool = False) -> Floats:
        """Return the regressors: acceleration, speed, perhaps by direction, sign, 1, and others."""
        speeds = [self.ahead, self.v - self.ahead] if apart else [self.v]
        return np.stack([self.a, *speeds, self.sign, np.ones_like(self.v), *more], axis=1)

    def fit(self, X: Floats, speeds: int) -> tuple[Estimate, Memory]:
        """Return the numbers of regressors, and the memory of what they leave.

        The acceleration comes first, then columns of the speed, so many.
        """
        drawn = np.zeros(X.shape[1])
        drawn[0] = self.noise[0] ** 2
        # Each direction has the noise for its part of the time.
        drawn[1 : 1 + speeds] = self.noise[1] ** 2 * np.mean(X[:, 1 : 1 + speeds] != 0.0, axis=0)
        first = least_squares(X, self.force, self.run, 0, drawn)
        memory = memory_of([first.residual[self.run == one] for one in np.unique(self.run)])
        return least_squares(X, self.force, self.run, memory.samples, drawn), memory

    @cached_property
    def both(self) -> tuple[Estimate, Memory]:
        """The numbers with one slope of friction for both directions: m, c, F_k, offset."""
        return self.fit(self.columns(), 1)

    @cached_property
    def apart(self) -> tuple[Estimate, Memory]:
        """The numbers with a slope for each direction: m, c forward, c backward, F_k, offset."""
        return self.fit(self.columns(apart=True), 2)

    @cached_property
    def differ(self) -> bool:
        """Whether the directions differ."""
        between = np.array([0.0, 1.0, -1.0, 0.0, 0.0])
        found, _ = self.apart
        two_ways = self.v.min() < 0.0 < self.v.max()
        size = abs(float(between @ found.value))
        return bool(two_ways and size > _WAY * found.deviation(between))


def excitation(record: Record, axis: Axis | None) -> Identified:
    """Return what the motion of a driven axis tells; ValueError without a force or a motion.

    Without an axis the force acts on the table itself; else on the motor, whose inertia and
    friction are subtracted.
    """
    if record.force is None:
        raise ValueError("a driven axis needs a column of its force, torque or current")
    rows = _rows(evened(record), record)
    best, _ = rows.apart if rows.differ else rows.both
    _, memory = rows.both
    lag = min(max(1, round(_LAG / rows.step)), memory.correlation.size)
    shown = slice(None, None, max(1, rows.t.size // _MOST))
    fitted = rows.columns(apart=rows.differ) @ best.value
    return Identified(
        kind="excitation",
        reason="the table is accelerated and braked",
        numbers=tuple(_numbers(rows, axis)),
        untold=(
            ("friction.F_s", "the table does not stick and slip in this record"),
            ("axis.stiffness", "table and drive move as one below the corner of the low pass"),
        ),
        residual=Residual(
            rms=float(np.sqrt(np.mean(best.residual**2))),
            unit="N",
            memory=rows.both[1].samples * rows.step,
            at=(lag * rows.step, float(memory.correlation[lag - 1])),
            faults=tuple(_faults(rows, best)),
        ),
        traces=(
            Trace(
                name="force",
                unit="N",
                t=rows.t[shown],
                measured=rows.force[shown],
                fitted=fitted[shown],
            ),
        ),
        segments=tuple(_segments(rows)),
        curve=_curve(rows),
        notes=tuple(_notes(rows)),
    )


def _rows(runs: Sequence[Even], record: Record) -> _Rows:
    """Return the samples behind the widest low pass whose noise of the acceleration is little.

    Where the position has all the noise, behind the one with which the numbers are known best.
    """
    column = "position" if record.velocity is None else "velocity"
    rounding, count = record.rounding.get(column, 0.0), sum(run.t.size for run in runs)
    stride, least, best = max(_FIRST, count // _KEPT), math.inf, None
    while best is None or count // stride > _LAST:
        rows = _at(runs, stride, rounding)
        found, noise = least_squares(rows.columns(), rows.force, rows.run), rows.noise[0] ** 2
        size, buried = float(np.linalg.slogdet(found.covariance)[1]), np.var(rows.a) < 2.0 * noise
        if best is not None and size > least:
            break
        least, best = math.inf if buried else size, rows
        if not buried and found.value[0] ** 2 * noise < _LITTLE * np.mean(found.residual**2):
            break
        stride = math.ceil(_WIDER * stride)
    return best


def _at(runs: Sequence[Even], stride: int, rounding: float) -> _Rows:
    """Return every so many samples behind a low pass, without rests."""
    step = runs[0].step
    corner = _WHITENED / (stride * step)
    ways = [filtered(run, corner) for run in runs]
    highest = max(float(np.max(np.abs(way.v))) for way in ways)
    noise = max(scatter(run, corner, rounding) for run in runs)
    parts: list[list[Floats]] = []
    for way in ways:
        size = np.abs(way.v)
        use = (size > _SLOW * highest) & ~_beside_rests(size < _REST * highest, corner * step)
        sign = low_pass(np.sign(way.v), step, corner)
        ahead = low_pass(np.maximum(way.v, 0.0), step, corner)
        assert way.force is not None
        columns = way.t, way.x, way.v, way.a, np.gradient(way.a, step), sign, ahead, way.force
        edges = np.flatnonzero(np.diff(use, prepend=False, append=False))
        for begin, end in zip(edges[::2], edges[1::2], strict=True):
            part = [column[begin:end:stride] for column in columns]
            parts.append([*part, np.full(part[0].size, float(len(parts)))])
    if not parts or highest == 0.0:
        raise ValueError("the table does not move in this record")
    t, x, v, a, jerk, sign, ahead, force, run = map(np.concatenate, zip(*parts, strict=True))
    return _Rows(
        t, x, v, a, jerk, sign, ahead, force, run, corner, stride * step, (noise.a, noise.v)
    )


def _beside_rests(slow: NDArray[np.bool_], corner: float) -> NDArray[np.bool_]:
    """Return where the low pass, its corner over the sample rate, brings in the force of a rest.

    In a rest, a slow stretch longer than its answer, friction is anything.
    """
    reach = max(2, int(_RINGING / corner))
    return np.asarray(binary_dilation(binary_opening(slow, np.ones(reach)), iterations=reach))


def _numbers(rows: _Rows, axis: Axis | None) -> Iterator[Number]:
    drive = axis.drive if axis else None
    inertia, d, dry = (drive.inertia, drive.d, drive.dry) if drive else (0.0, 0.0, 0.0)
    (both, _), (apart, _) = rows.both, rows.apart
    own = f", less {inertia:.4g} kg of the motor" if drive else ""

    def number(
        name: str, meaning: str, unit: str, of: Estimate, at: int, less: float = 0.0, sign: int = 1
    ) -> Number:
        value, reach = sign * float(of.value[at]) - less, of.reach(np.eye(of.value.size)[at])
        return Number(
            name=name, meaning=meaning, unit=unit, value=value, low=value - reach,
            high=value + reach, scales=True,
        )  # fmt: skip

    best = apart if rows.differ else both
    yield number("axis.mass", f"moved mass{own}", "kg", best, 0, inertia)
    yield number("axis.c", "viscous friction, both directions as one", "N.s/m", both, 1, d)
    if rows.differ:
        yield number("c forward", "viscous friction forward", "N.s/m", apart, 1, d)
        yield number("c backward", "viscous friction backward", "N.s/m", apart, 2, d)
    yield number("friction.F_k", "Coulomb friction", "N", best, -2, dry)
    if rows.differ:
        yield number("offset", "constant part of the force, with one slope", "N", both, -1)
    name = "axis.force_along"
    yield number(name, "constant force along the way, as of a weight", "N", best, -1, sign=-1)


def _faults(rows: _Rows, best: Estimate) -> Iterator[str]:
    """Yield what the record shows that the model has not, and that would move a number."""
    fast = float(np.max(np.abs(rows.v)))
    middle = rows.x - np.mean(rows.x)
    tried = {
        "friction rises faster than the speed": rows.sign * rows.v**2,
        "friction falls with the speed": rows.sign * np.exp(-np.abs(rows.v) / (0.1 * fast)),
        "the force changes along the way": middle,
        "friction changes along the way": rows.sign * middle,
        "the force and the motion are not of one time": rows.jerk,
        "the zero of the force drifts": rows.t - np.mean(rows.t),
    }
    count = best.value.size
    for words, column in tried.items():
        found, _ = rows.fit(rows.columns(column, apart=rows.differ), 1 + rows.differ)
        chance = found.deviation(np.eye(count + 1)[-1])
        moved = np.abs(found.value[:-1] - best.value)
        reach = np.array([best.reach(unit) for unit in np.eye(count)])
        if abs(found.value[-1]) > _FAULT * chance and np.any(moved > reach):
            yield words


def _notes(rows: _Rows) -> Iterator[str]:
    (both, memory), (apart, _) = rows.both, rows.apart
    if rows.differ:
        forward, backward = apart.value[1:3]
        before, after = (float(np.sqrt(np.mean(of.residual**2))) for of in (both, apart))
        yield (
            f"The directions differ: {forward:.0f} N s/m forward, {backward:.0f} backward. That "
            f"takes the residual from {before:.2g} to {after:.2g} N, and the constant part of the "
            f"force from {both.value[-1]:.2g} to {apart.value[-1]:.2g} N."
        )
        if abs(apart.value[-1]) < apart.reach(np.eye(5)[-1]):
            yield "What looks like a weight is the asymmetry of the directions."
    if memory.samples:
        yield (
            f"The residual with one slope is not white: it knows itself for "
            f"{memory.samples * rows.step * 1e3:.0f} ms."
        )
    yield f"Derivatives behind a low pass of {rows.corner:.3g} Hz, forth and back."


def _segments(rows: _Rows) -> Iterator[tuple[float, float, str]]:
    turns = np.flatnonzero(np.diff(np.sign(rows.v)) != 0.0) + 1
    for places in np.split(np.arange(rows.t.size), turns):
        way = "forward" if rows.v[places[0]] > 0.0 else "backward"
        yield float(rows.t[places[0]]), float(rows.t[places[-1]]), way


def _curve(rows: _Rows) -> Curve | None:
    """Return friction over the speed: means of what is left of the force without the inertia."""
    edges = [
        np.quantile(rows.v[way], np.linspace(0.0, 1.0, _BINS + 1)[1:])
        for way in (rows.v < 0.0, rows.v > 0.0)
        if np.any(way)
    ]
    bin_of = np.searchsorted(np.concatenate(edges), rows.v)
    names, at = np.unique(bin_of, return_inverse=True)
    inside = (at[:, None] == np.arange(names.size)).astype(float)
    found, _ = rows.fit(np.column_stack([rows.a, inside]), 0)
    units = np.eye(names.size + 1)[1:]
    speed = np.array([np.mean(rows.v[at == one]) for one in range(names.size)])
    law = law_of(speed, found.value[1:], np.array([found.deviation(unit) for unit in units]))
    band = np.array([found.reach(unit) for unit in units])
    return Curve(speed=speed, force=found.value[1:], band=band, law=law.words, fitted=law.fitted)
