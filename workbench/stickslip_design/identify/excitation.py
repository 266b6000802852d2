"""A driven axis: mass, viscous and Coulomb friction by inverse dynamics, or from steady runs.

F = m a + F_k sgn(v) + c v + offset, all behind the same low pass, which leaves it true. Numbers by
linear least squares; docs/identify.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from scipy.ndimage import maximum_filter1d

from stickslip_units import told

from ..axis import Axis
from .evened import Columns, Parts, evened, filtered, plateaus, stretches
from .laws import friction, law_of
from .model import Identified, Number, Record, Trace
from .noise import Estimate, least_squares

_WHITENED: Final = 0.55
"""Corner of the low pass, of the rate of the samples behind it: white noise stays white to 1 %."""
_FIRST, _WIDER, _FEW, _KEPT = 6, 1.25, 60, 50_000
"""Stride of the samples behind the widest low pass, and of the next one over it; so few samples
that none is narrower; samples of a long record, about."""
_STIFF, _SPRING = 0.4, 0.4
"""Of the frequency of the table on its spring: highest corner. What is known before of the part of
the spring, relative: an axis states its stiffness and mass to some 20 %."""
_SLOW, _RINGING = 0.02, 1.1
"""Of the highest speed: below it friction is not taken for Coulomb's. Length of the low pass's
answer, over its corner's period."""
_STEADILY, _RUNS = 0.4, 6
"""A record is of steady runs if they are so many, and their part of the time that is used is by
this above that of the inertia in the power of the force."""
_WAY, _FAULT, _BENT = 3.0, 4.0, {"at low speed": 0.1, "near rest": 0.025}
"""Deviations that tell two directions from chance, and a fault, of some that are sought. Of the
highest speed: over these another friction is sought."""
_LAG, _NOISE = 0.05, 0.5
"""Lag whose correlation is shown [s], and a correlation over it that no noise has."""
_BINS, _MOST = 10, 3000
"""Points of a friction curve, for each direction, and of a drawn trace, about."""
_SHOWN: Final[Mapping[str, tuple[Mapping[str, float], str, str]]] = {
    "axis.mass": ({"m": 1.0}, "moved mass", "kg"),
    "axis.c": ({"c": 1.0}, "viscous friction, both directions as one", "N.s/m"),
    "c forward": ({"c": 1.0, "uneven": 1.0}, "viscous friction forward", "N.s/m"),
    "c backward": ({"c": 1.0, "uneven": -1.0}, "viscous friction backward", "N.s/m"),
    "friction.F_k": ({"F_k": 1.0}, "Coulomb friction", "N"),
    "fall": ({"fall": 1.0}, "fall of friction from rest to high speed", "N"),
    "axis.force_along": ({"offset": -1.0}, "constant force along the way, as of a weight", "N"),
}
"""Of a number by its name: the sum of numbers of a fit that it is; meaning; unit."""
_MISSING: Final = {
    "friction.F_s": "a table that does not stick and slip tells no static friction",
    "axis.mass": "the table is not accelerated in steady runs",
    "axis.force_along": "motion in one direction does not tell it from friction",
    "axis.stiffness": "table and drive move as one in it",
}
"""Why a number is not among them."""


@dataclass(frozen=True)
class _Rows:
    """Samples of all runs that are used, behind the low pass and thinned to its corner."""

    columns: Columns
    """Those of `filtered`, the mass's with what a spring adds; "soft", by which the force is more
    where the spring is softer than stated; the number of the "run". "m else" and the like are
    means of neighbours half a row and three halves off: so the noise of a position, white or of low
    frequency, is another to 6 %."""
    step: float
    """Time between them [s]."""
    known: Mapping[str, float]
    """Standard deviations of numbers about 0: by how much the force is ahead [s]; "soft". None in
    steady runs, which tell no mass either."""

    def fit(self, columns: Columns) -> Estimate:
        """Return the numbers of columns, and those that go with a mass."""
        of, jerk = self.columns, self.columns["jerk else"]
        own = {name: of[name] for name in ("m", *self.known) if self.known}
        mass = float(jerk @ of["rate"]) / max(float(jerk @ jerk), 1e-300)
        instruments = {"m": of["m else"], "rate": mass * jerk, "soft": of["soft else"]}
        return least_squares(own | columns, of["force"], of["run"], instruments, self.known)

    @cached_property
    def rubs(self) -> Columns:
        """What friction depends on."""
        return friction(self.columns["c"]) | {"F_k": self.columns["F_k"]}

    @cached_property
    def best(self) -> Estimate:
        """All numbers."""
        return self.fit(self.rubs)


def driven(record: Record, axis: Axis | None) -> Identified:
    """Return what the motion of a driven axis tells; ValueError without a force or a motion.

    Without an axis the force acts on the table itself; else on the motor, whose inertia and
    friction are subtracted.
    """
    if record.force is None:
        raise ValueError("a column of force, torque or current is missing: name it by --column")
    if not np.ptp(record.force):
        raise ValueError("the force does not change in this record: is it the right column?")
    runs, clipped = evened(record)
    step, first = float(runs[0]["t"][1] - runs[0]["t"][0]), max(_FIRST, record.t.size // _KEPT)
    rows, parts, steady = _widest(runs, step, axis, first), plateaus(runs, step), None
    share = sum(end - begin for begin, end, _ in parts) / (rows.columns["t"].size * rows.step)
    inertia = np.var(rows.best.number("m")[0] * rows.columns["m"]) / np.var(rows.columns["force"])
    if len(parts) >= _RUNS and share - inertia >= _STEADILY:
        steady = _rows(runs, step, axis, first, parts)
    rows = steady or rows
    curve, law, means = _curve(rows)
    best, shown = (law, means) if steady else (rows.best, rows.best)
    uneven, deviation, _ = best.number("uneven")
    others, differ = _others(rows), abs(uneven) > _WAY * deviation
    numbers = tuple(_numbers(best, others, axis, differ))
    values = {number.name: number.value for number in numbers}
    noise, faults = float(np.sqrt(np.mean(shown.residual**2))), [*others]
    lag = min(max(1, round(_LAG / rows.step)), shown.memory.correlation.size)
    if shown.memory.correlation[lag - 1] > _NOISE:
        alike = lag * rows.step
        faults.append(f"it leaves {noise:.2g} N that are alike for {alike:.2g} s, and no noise")
    ahead, chance, _ = shown.number("rate")
    if abs(ahead) > step + _FAULT * chance:
        faults.append(f"force and motion are {abs(ahead) * 1e3:.2g} ms apart")
    if abs(shown.number("soft")[0]) > _FAULT * _SPRING:
        faults.append("table and motor move as on another spring than is stated")
    notes = [_directions(rows, lag, values)] if differ else []
    notes.append(f"Force and derivatives are behind a low pass of {_WHITENED / rows.step:.3g} Hz.")
    if clipped:
        notes.append(f"In {clipped:.1%} of the samples the force is clipped: they tell nothing.")
    t, v = rows.columns["t"], rows.columns["c"]
    segments = [(a, b, told(speed, "m/s", 3)) for a, b, speed in parts]
    if not steady:
        ways = ((v > 0.0, "forward"), (v < 0.0, "backward"))
        segments = [(float(t[a]), float(t[b - 1]), n) for way, n in ways for a, b in stretches(way)]
    thin = slice(None, None, max(1, t.size // _MOST))
    force = rows.columns["force"][thin], shown.fitted[thin]
    return Identified(
        kind="steady runs" if steady else "excitation",
        reason=f"{len(parts)} runs have a constant speed" if steady else "the table is accelerated",
        numbers=numbers,
        missing=tuple(one for one in _MISSING.items() if one[0] not in values),
        traces=(Trace(name="force", unit="N", at=t[thin], measured=force[0], fitted=force[1]),),
        noise=noise,
        segments=tuple(sorted(segments)),
        faults=tuple(faults),
        friction=curve,
        notes=tuple(notes),
    )


def _widest(runs: list[Columns], step: float, axis: Axis | None, stride: int) -> _Rows:
    """Return the samples behind the widest low pass before one that tells hardly more.

    Where a spring is stated it is narrow enough for motor and table to be nearly one mass.
    """
    best, least, volume = None, 0.0, math.inf
    if axis and axis.drive:
        least = _WHITENED * 2.0 * math.pi / (_STIFF * math.sqrt(axis.k / axis.m))
    while rows := _rows(runs, step, axis, stride):
        few, doubt = rows.columns["t"].size < _FEW, np.linalg.slogdet(rows.best.covariance)[1]
        if best and (few or (best.step >= least and doubt > volume - 1.0)):
            break
        best, volume, stride = rows, doubt, math.ceil(_WIDER * stride)
    if best is None:
        raise ValueError("no motion is left to judge: the table rests, or the force is clipped")
    return best


def _rows(
    runs: list[Columns], step: float, axis: Axis | None, stride: int, steady: Parts | None = None
) -> _Rows | None:
    """Return every so many samples behind a low pass, without turns; or those of steady runs.

    None where nothing is left.
    """
    mass = spring = 0.0
    if axis and axis.drive:
        # Of F = (m + J) a the table's spring takes J m/k x'''' where its position is measured, and
        # gives m^2/k x'''' back where the motor's is.
        mass, own = axis.m + axis.drive.inertia, axis.drive.on_table
        spring = (axis.drive.inertia if own else -axis.m) * axis.m / axis.k
    corner, half, parts = _WHITENED / (stride * step), (stride + 1) // 2, list[Columns]()
    ways, reach = [filtered(run, step, corner) for run in runs], int(_RINGING / (corner * step))
    highest = max(float(np.max(np.abs(way["c"]))) for way in ways)
    for way in ways:
        # Where the table turns it may rest, in which friction is anything, and the low pass brings
        # it in from there; at the ends of a run it has other surroundings for each column.
        slow, near = np.abs(way["c"]) <= _SLOW * highest, (3 if spring else 2) * reach + 1
        use = ~maximum_filter1d(slow, near)
        if steady:
            use = np.any([(way["t"] >= a) & (way["t"] <= b) for a, b, _ in steady], axis=0)
        use[: 2 * reach] = use[-2 * reach :] = False
        way["soft"] = spring * way["jounce"]
        way["m"] = way["m"] + way["soft"] / max(mass, 1e-300)
        for name in ("m", "jerk", "soft"):
            others = [np.roll(way[name], n * half) for n in (-3, -1, -1, 1, 1, 3)]
            way[f"{name} else"] = np.mean(others, axis=0)
        for begin, end in stretches(use):
            part = {name: column[begin:end:stride] for name, column in way.items()}
            parts.append(part | {"run": np.full(part["t"].size, float(len(parts)))})
    if not parts:
        return None
    columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    known = {} if steady else {"rate": step} | ({"soft": _SPRING} if spring else {})
    return _Rows(columns, stride * step, known)


def _numbers(
    best: Estimate, others: Mapping[str, Estimate], axis: Axis | None, differ: bool
) -> Iterator[Number]:
    """Yield the numbers; their intervals hold those of models that explain the record better."""
    drive = axis.drive if axis else None
    of_motor = {"m": drive.inertia, "c": drive.d, "F_k": drive.dry} if drive else {}
    for name, (parts, meaning, unit) in _SHOWN.items():
        if not parts.keys() <= {*best.names} or ("uneven" in parts and not differ):
            continue
        own = sum(of_motor.get(part, 0.0) for part in parts)
        value, _, reach = best.sum(parts)
        also = [one.sum(parts)[0] for one in others.values() if parts.keys() <= {*one.names}]
        low, high = min(value - reach, *also, value) - own, max(value + reach, *also, value) - own
        motor = f", without {drive.inertia:.4g} kg of the motor" if drive and "m" in parts else ""
        yield Number(
            name=name, meaning=meaning + motor, unit=unit, value=value - own, low=low, high=high
        )


def _others(rows: _Rows) -> dict[str, Estimate]:
    """Return what else the record shows, in words, and the numbers of a model that has it.

    Of what is sought only that which is no chance and moves a number by a standard deviation.
    """
    best, shown, size = rows.best, dict[str, Estimate](), np.abs(rows.columns["c"])
    tried = {"the zero of the force drifts": rows.columns["t"] - np.mean(rows.columns["t"])}
    if rows.known:
        tried["friction is bent over the speed"] = rows.rubs["F_k"] * size**2
        for name, part in _BENT.items():
            tried[f"friction is bent {name}"] = rows.rubs["F_k"] * np.exp(-size / size.max() / part)
    for words, column in tried.items():
        found = rows.fit(rows.rubs | {"other": column})
        other, deviation, _ = found.number("other")
        moves = np.abs(found.value[:-1] - best.value) > np.sqrt(np.diag(best.covariance))
        if abs(other) > _FAULT * deviation and moves.any():
            shown[words] = found
    return shown


def _directions(rows: _Rows, lag: int, values: Mapping[str, float]) -> str:
    """Return in words how the directions differ, beside one slope for both."""
    one, left = rows.fit({name: rows.rubs[name] for name in ("F_k", "c", "offset")}), []
    for fit in (one, rows.best):
        offset, _, reach = fit.number("offset")
        rms = float(np.sqrt(np.mean(fit.residual**2)))
        left.append(f"{rms:.2g} N, beside a constant force of {offset:.2g} ± {reach:.2g} N")
    weight = "What looks like a weight is the asymmetry of the directions. "
    return (
        f"The directions differ: {values['c forward']:.0f} N s/m forward, "
        f"{values['c backward']:.0f} backward. That takes the residual from {left[0]}, "
        f"to {left[1]}. {weight * (abs(offset) < reach)}With one slope the residual is not white: "
        f"its correlation is {one.memory.correlation[lag - 1]:.2f} over "
        f"{lag * rows.step * 1e3:.0f} ms."
    )


def _curve(rows: _Rows) -> tuple[Trace, Estimate, Estimate]:
    """Return friction over the speed, its law's numbers, and means of the force without inertia.

    Of each steady run, else of parts of the speeds with as many samples.
    """
    v, group = rows.columns["c"], rows.columns["run"].astype(int)
    if rows.known:
        shares = np.linspace(0.0, 1.0, _BINS + 1)[1:]
        ways = [v[way] for way in (v < 0.0, v > 0.0) if np.any(way)]
        group = np.searchsorted(np.concatenate([np.quantile(way, shares) for way in ways]), v)
    names = sorted(np.unique(group), key=lambda one: float(np.mean(v[group == one])))
    means = rows.fit({str(one): (group == one).astype(float) for one in names})
    speed = np.array([np.mean(v[group == one]) for one in names])
    force, deviation, band = np.array([means.number(str(one)) for one in names]).T
    words, law = law_of(speed, force, np.maximum(deviation, 1e-12 * np.abs(force).max()))
    drawn = Trace(name=words, unit="N", at=speed, measured=force, fitted=law.fitted, band=band)
    return drawn, law, means
