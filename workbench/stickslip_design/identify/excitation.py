"""A driven axis: mass, viscous and Coulomb friction by inverse dynamics, or from steady runs.

F = m a + F_k sgn(v) + c v + offset, all behind the same low pass, which leaves it true. Numbers by
linear least squares; docs/identify.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from ..axis import Axis
from .evened import Columns, Even, Plateau, evened, filtered, low_pass, plateaus, scatter
from .laws import Law, law_of
from .model import Floats, Identified, Number, Record, Trace
from .noise import Estimate, Memory, least_squares

_WHITENED: Final = 0.55
"""Corner of the low pass, of the rate of the samples behind it: white noise stays white to 1 %."""
_FIRST, _WIDER, _FEW = 6, 1.25, 60
"""Stride of the samples behind the widest low pass; of the next one; so few samples that it is
wider though motor and table are less as one."""
_LITTLE: Final = 0.15
"""Of the residual's power: that of the acceleration's noise."""
_KEPT, _MOST = 50_000, 3000
"""Samples of a long record, and points of a drawn trace, about."""
_STIFF, _SPRING = 0.25, 0.2
"""Of the frequency of the table on its spring: highest corner, where table and motor are nearly one
mass. The ± of the stiffness that an axis states, relative."""
_SLOW: Final = 0.02
"""Of the highest speed: below it friction is not taken for Coulomb's."""
_RINGING: Final = 1.1
"""Length of the low pass's answer, over its corner's period."""
_STEADILY, _NEARLY, _FEW_SPEEDS, _INERTIA = 0.6, 0.85, 3, 0.15
"""A record is of steady runs if they are this part of the moving time, at so many speeds, and the
force of the inertia has at most this part of the power; or nearly all of the time."""
_OFF, _LONG = 0.01, 0.15
"""Of the range of the forces: how far a steady run may be off its friction law. Of a steady run: a
memory of the residual that makes it none."""
_LATE: Final = 0.18
"""Of the time between the samples that are used: time between force and motion that is too much."""
_LEFT, _ALIKE = 4.0, 10
"""Of the noise of the force, what a fit may leave though that is alike for more than so many
samples behind the low pass."""
_WAY, _FAULT = 3.0, 4.0
"""Deviations that tell two directions from chance, and a fault, of some that are sought."""
_LAG, _BINS = 0.05, 10
"""Lag whose correlation is shown [s]. Points of a friction curve, for each direction."""
_FOLLOWS: Final = 0.95
"""Correlation of a table's speed with the commanded one, if it follows that."""
_SHOWN: Final = {
    "m": ("axis.mass", "moved mass", "kg"),
    "c": ("axis.c", "viscous friction, both directions as one", "N.s/m"),
    "c forward": ("c forward", "viscous friction forward", "N.s/m"),
    "c backward": ("c backward", "viscous friction backward", "N.s/m"),
    "F_k": ("friction.F_k", "Coulomb friction", "N"),
    "fall": ("fall", "fall of friction from rest to high speed", "N"),
    "offset": ("axis.force_along", "constant force along the way, as of a weight", "N"),
}


@dataclass(frozen=True)
class _Rows:
    """Samples of all runs that are used, behind the low pass and thinned to its corner."""

    moved: Columns
    """Time "t", position "x", "force"; acceleration "m", speed "c", its parts "c forward" and
    "c backward", its sign "F_k", "jerk", "jounce"; also the number of the "run"."""
    wanted: Columns
    """The same of the commanded motion, empty if the table follows none."""
    sample: float
    """Time between samples of the record [s], known to be about what a force is ahead or late."""
    step: float
    """Time between those that are used [s]."""
    noise: tuple[float, float, float]
    """That of the speed [m/s], of the acceleration [m/s2], of the force [N]."""
    yielding: float = 0.0
    """What the fourth derivative of the position adds to the acceleration [s2]."""
    steady: bool = False
    """Whether they are of steady runs alone, which have no acceleration."""

    def fit(self, more: Columns | None = None, *, apart: bool = False) -> Estimate:
        """Return m, c (or c forward, c backward), F_k, offset, and the numbers of more columns.

        "ahead" is by how much the force is ahead of the motion [s], as of a controller that holds
        it over a sample; "soft" by how much the spring is softer than stated, relative.
        """
        slopes = ("c forward", "c backward") if apart else ("c",)
        columns = {name: self.moved[name] for name in (*slopes, "F_k")}
        if self.moved["c"].min() < 0.0 < self.moved["c"].max():
            columns["offset"] = np.ones_like(self.moved["c"])
        columns |= more or {}
        found = self.numbers(columns)
        if self.steady:
            return found
        m, c = found.number("m"), float(np.mean([found.number(name) for name in slopes]))
        late = [
            {"ahead": m * way["jerk"] + c * way["m"], "soft": m * self.yielding * way["jounce"]}
            for way in (self.moved, self.wanted or self.moved)
        ]
        return self.numbers(columns | late[0], late[1])

    def numbers(self, columns: Columns, more: Columns | None = None) -> Estimate:
        """Return the numbers of columns, and before them the mass, but in steady runs."""
        columns = columns if self.steady else {"m": self.moved["m"], **columns}
        instruments = self.wanted and self.wanted | (more or {})
        # Each direction has the noise of the speed for its part of the time.
        noise = {
            name: self.noise[name == "m"] ** 2 * float(np.mean(columns[name] != 0.0))
            for name in columns.keys() & {"m", "c", "c forward", "c backward"}
            if not self.wanted
        }
        known = {"ahead": self.sample, "soft": _SPRING}
        force, run = self.moved["force"], self.moved["run"]
        return least_squares(columns, force, run, noise, instruments, known)

    @cached_property
    def both(self) -> Estimate:
        """The numbers with one slope of friction for both directions."""
        return self.fit()

    @cached_property
    def apart(self) -> Estimate:
        """The numbers with a slope for each direction."""
        return self.fit(apart=True)

    @cached_property
    def differ(self) -> bool:
        """Whether the directions differ."""
        if "offset" not in self.both.names:
            return False
        ways = "c forward", "c backward"
        forward, backward = map(self.apart.number, ways)
        return abs(forward - backward) > _WAY * self.apart.deviation(*ways)

    @property
    def quiet(self) -> bool:
        """Whether the noise of the acceleration is little of the residual."""
        noise = (self.both.number("m") * self.noise[1]) ** 2
        return not self.hidden and noise < _LITTLE * float(np.mean(self.both.residual**2))

    @property
    def hidden(self) -> bool:
        """Whether the noise of the acceleration is most of it."""
        return bool(np.var(self.moved["m"]) < 2.0 * self.noise[1] ** 2)

    @property
    def doubt(self) -> float:
        """Logarithm of the volume of the numbers' covariance; infinite if the mass is hidden."""
        return math.inf if self.hidden else float(np.linalg.slogdet(self.both.covariance)[1])

    @property
    def best(self) -> Estimate:
        """The numbers with as many slopes as are needed."""
        return self.apart if self.differ else self.both


def driven(record: Record, axis: Axis | None) -> Identified:
    """Return what the motion of a driven axis tells; ValueError without a force or a motion.

    Without an axis the force acts on the table itself; else on the motor, whose inertia and
    friction are subtracted.
    """
    if record.force is None:
        raise ValueError("a column of force, torque or current is missing: name it by --column")
    if not np.ptp(record.force):
        raise ValueError("the force does not change in this record: is it the right column?")
    runs = evened(record)
    steady, share = plateaus(runs, record.rounding.get("position", 0.0))
    rows, speeds = _rows(runs, record, axis), sorted(run.speed for run in steady)
    count = 1 + sum(b - a > 0.1 * abs(b) for a, b in pairwise(speeds))
    inertia = np.var(rows.best.number("m") * rows.moved["m"]) / np.var(rows.moved["force"])
    if count >= _FEW_SPEEDS and share >= (_STEADILY if inertia <= _INERTIA else _NEARLY):
        rows = _at(runs, record, axis, max(_FIRST, record.t.size // _KEPT), steady) or rows
    law, curve, inside = _curve(rows)
    others, memory, moved = _others(rows, axis), rows.both.memory, rows.moved
    best = law.estimate if rows.steady else rows.best
    lag = min(max(1, round(_LAG / rows.step)), memory.correlation.size)
    at = lag * rows.step, float(memory.correlation[lag - 1])
    part = float(np.mean(np.concatenate([run.clipped for run in runs])))
    notes = [*_notes(rows, at, axis.drive.d if axis and axis.drive else 0.0)]
    if part:
        notes.append(
            f"In {100.0 * part:.2g} % of the samples the force is clipped: they tell nothing."
        )
    shown = slice(None, None, max(1, moved["t"].size // _MOST))
    missing = {"friction.F_s": "a table that does not stick and slip tells no static friction"}
    if rows.steady:
        missing["axis.mass"] = "the table is not accelerated in steady runs"
    if "offset" not in best.names:
        missing["axis.force_along"] = "motion in one direction does not tell it from friction"
    missing["axis.stiffness"] = "table and drive move as one in it"
    parts = [(run.begin, run.end, f"{run.speed * 6e4:.4g} mm/min") for run in steady]
    if not rows.steady:
        t, v = moved["t"], moved["c"]
        ways = np.split(np.arange(t.size), np.flatnonzero(np.diff(np.sign(v))) + 1)
        names = ["forward" if v[way[0]] > 0.0 else "backward" for way in ways]
        parts = [(float(t[w[0]]), float(t[w[-1]]), n) for w, n in zip(ways, names, strict=True)]
    return Identified(
        kind="steady runs" if rows.steady else "excitation",
        reason=f"{len(steady)} runs of constant speed, of {share:.0%} of the moving time"
        if rows.steady
        else "the table is accelerated and braked",
        numbers=tuple(_numbers(rows, law, others, axis)),
        missing=tuple(missing.items()),
        noise=float(np.sqrt(np.mean(rows.best.residual**2))),
        faults=(*others, *_faults(rows, law, curve, inside)),
        traces=(
            Trace(
                name="force",
                unit="N",
                at=moved["t"][shown],
                measured=moved["force"][shown],
                fitted=rows.best.fitted[shown],
            ),
        ),
        segments=tuple(parts),
        friction=curve,
        notes=tuple(notes),
    )


def _rows(runs: Sequence[Even], record: Record, axis: Axis | None) -> _Rows:
    """Return the samples behind the widest low pass whose noise of the acceleration is little.

    Where the position has all the noise, behind the one with which the numbers are known best.
    """
    stride = max(_FIRST, record.t.size // _KEPT)
    if axis and axis.drive:
        highest = _STIFF * math.sqrt(axis.k / axis.m) / (2.0 * math.pi)
        stride = max(stride, math.ceil(_WHITENED / (highest * runs[0].step)))
    rows = _at(runs, record, axis, stride)
    while stride > _FIRST and (rows is None or rows.moved["t"].size < _FEW):
        stride = max(_FIRST, int(stride / _WIDER))
        rows = _at(runs, record, axis, stride)
    if rows is None:
        raise ValueError("no motion is left to judge: the table rests, or the force is clipped")
    while not rows.quiet:
        stride = math.ceil(_WIDER * stride)
        narrower = _at(runs, record, axis, stride)
        if narrower is None or narrower.moved["t"].size < _FEW or narrower.doubt > rows.doubt:
            break
        rows = narrower
    return rows


def _at(
    runs: Sequence[Even],
    record: Record,
    axis: Axis | None,
    stride: int,
    steady: Sequence[Plateau] = (),
) -> _Rows | None:
    """Return every so many samples behind a low pass, without rests, or those of steady runs.

    None where nothing is left.
    """
    step = runs[0].step
    corner = _WHITENED / (stride * step)
    rounding = record.rounding.get("position" if record.velocity is None else "velocity", 0.0)
    ways = [filtered(run, corner) for run in runs]
    highest = max(float(np.max(np.abs(way["c"]))) for way in ways)
    yielding, reach = _yielding(axis), max(2, int(_RINGING / (corner * step)))
    late, parts = _lateness(ways), list[Columns]()
    for run, way in zip(runs, ways, strict=True):
        # Where the table turns it may rest, behind a spring for long, in which friction is
        # anything, and the low pass brings it in from there.
        near = 4 * reach + 1 if yielding else 2 * reach + 1
        use = ~maximum_filter1d(np.abs(way["c"]) <= _SLOW * highest, near)
        if steady:
            use = np.any([(way["t"] >= p.begin) & (way["t"] <= p.end) for p in steady], axis=0)
        use &= ~maximum_filter1d(run.clipped[3:-3], 2 * reach + 1)
        # At the ends of a run the low pass has other surroundings for each column.
        use[: 2 * reach] = use[-2 * reach :] = False
        a = way["m"] + yielding * np.gradient(np.gradient(way["m"], step), step)
        columns = way | _moved(way["c"], a, step, corner)
        if late is not None:
            v, a = (np.interp(way["t"] - late, way["t"], way[f"wanted {n}"]) for n in ("c", "m"))
            columns |= {f"wanted {n}": one for n, one in _moved(v, a, step, corner).items()}
        edges = np.flatnonzero(np.diff(use, prepend=False, append=False))
        for begin, end in zip(edges[::2], edges[1::2], strict=True):
            part = {name: column[begin:end:stride] for name, column in columns.items()}
            parts.append(part | {"run": np.full(part["t"].size, float(len(parts)))})
    if not parts:
        return None
    moved = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return _Rows(
        moved=moved,
        sample=step,
        step=stride * step,
        yielding=yielding,
        steady=bool(steady),
        wanted={n[7:]: moved[n] for n in moved if n[:7] == "wanted "} if late is not None else {},
        noise=max(scatter(run, corner, rounding) for run in runs),
    )


def _moved(v: Floats, a: Floats, step: float, corner: float) -> Columns:
    """Return what of a motion the force depends on."""
    ahead, sign = (low_pass(each, step, corner) for each in (np.maximum(v, 0.0), np.sign(v)))
    jerk = np.gradient(a, step)
    return {
        "m": a,
        "c": v,
        "c forward": ahead,
        "c backward": v - ahead,
        "F_k": sign,
        "jerk": jerk,
        "jounce": np.gradient(jerk, step),
    }


def _lateness(ways: Sequence[Columns]) -> float | None:
    """Return by how much the table is late on its command [s]; None if it follows none."""
    if "wanted c" not in ways[0]:
        return None
    v, aim, rate = (np.concatenate([w[n] for w in ways]) for n in ("c", "wanted c", "wanted m"))
    if not np.ptp(aim) or not np.ptp(v):
        return None
    late = float(rate @ (aim - v) / max(float(rate @ rate), 1e-300))
    follows = float(np.corrcoef(v, aim - late * rate)[0, 1]) > _FOLLOWS
    return late if follows else None


def _yielding(axis: Axis | None) -> float:
    """Return what the fourth derivative of the position adds to the acceleration [s2].

    Of F = (m + J) a the table's spring takes J m/k x'''' where its position is measured, and gives
    m^2/k x'''' back where the motor's is.
    """
    if axis is None or axis.drive is None:
        return 0.0
    inertia = axis.drive.inertia
    part = inertia if axis.drive.on_table else -axis.m
    return part * axis.m / axis.k / (axis.m + inertia)


def _numbers(
    rows: _Rows, law: Law, others: Mapping[str, Estimate], axis: Axis | None
) -> Iterator[Number]:
    """Yield the numbers; their intervals hold those of models that explain the record better."""
    drive = axis.drive if axis else None
    of_motor = {"m": drive.inertia, "c": drive.d, "F_k": drive.dry} if drive else {}
    best = law.estimate if rows.steady else rows.best
    estimates = dict.fromkeys(best.names, best)
    if "c forward" in best.names:
        estimates["c"] = rows.both
    if "offset" in estimates:
        # With one slope for both directions a weight would be known too well.
        estimates["offset"] = rows.apart
    for symbol, (name, meaning, unit) in _SHOWN.items():
        if symbol not in estimates:
            continue
        found, sign = estimates[symbol], -1 if symbol == "offset" else 1
        own = of_motor.get(symbol.partition(" ")[0], 0.0)
        value, reach = sign * found.number(symbol) - own, found.reach(symbol)
        apart = [sign * o.number(symbol) - own for o in others.values() if symbol in o.names]
        also = f", without {drive.inertia:.4g} kg of the motor" if drive and symbol == "m" else ""
        yield Number(
            name=name,
            meaning=meaning + also,
            unit=unit,
            value=value,
            low=min(value - reach, *apart, value),
            high=max(value + reach, *apart, value),
        )


def _others(rows: _Rows, axis: Axis | None) -> dict[str, Estimate]:
    """Return what else the record shows, in words, and the numbers of a model that has it.

    Of what is sought only that which is no chance and moves a number by more than its interval.
    """
    moved, v, sign = rows.moved, rows.moved["c"], rows.moved["F_k"]
    size, middle = np.abs(v), moved["x"] - np.mean(moved["x"])
    tried: dict[str, list[Floats]] = {
        "the force changes along the way": [middle],
        "friction changes along the way": [sign * middle],
        "the zero of the force drifts": [moved["t"] - np.mean(moved["t"])],
    }
    if not rows.steady:
        tried |= {
            "friction is bent over the speed": [sign * size**2],
            "friction is bent at low speed": [sign * np.exp(-10.0 * size / size.max())],
            "friction is bent near rest": [sign * np.exp(-40.0 * size / size.max())],
        }
    if axis and axis.drive:
        turn = 2.0 * math.pi * middle / axis.drive.pitch
        tried["the force changes with the turn of the motor"] = [np.sin(turn), np.cos(turn)]
    best, shown = rows.best, dict[str, Estimate]()
    for words, columns in tried.items():
        found = rows.fit({str(n): one for n, one in enumerate(columns)}, apart=rows.differ)
        moves = [abs(found.number(n) - best.number(n)) > best.reach(n) for n in best.names]
        chance = [abs(found.number(str(n))) / found.deviation(str(n)) for n in range(len(columns))]
        # What mass and friction show as well takes nothing from the residual.
        less = 1.0 - (found.residual @ found.residual) / (best.residual @ best.residual)
        if max(chance) > _FAULT and any(moves) and less * size.size > _FAULT**2:
            shown[words] = found
    return shown


def _faults(rows: _Rows, law: Law, curve: Trace, inside: Memory) -> Iterator[str]:
    if rows.steady:
        worst, known = np.abs(law.estimate.residual).max(), np.sqrt(np.mean(curve.band**2))
        if worst > max(_OFF * np.ptp(rows.moved["force"]), 2.0 * known):
            yield f"steady runs are up to {worst:.2g} N off every friction law that was tried"
        if inside.samples > _LONG * np.bincount(rows.moved["run"].astype(int)).max():
            yield "the force is not steady in steady runs"
        return
    left, alike = np.sqrt(np.mean(rows.best.residual**2)), rows.best.memory.samples
    noise = np.hypot(rows.noise[2], rows.best.number("m") * rows.noise[1])
    if left > _LEFT * noise and alike > _ALIKE:
        yield f"it leaves {left:.2g} N that are alike for {alike * rows.step:.2g} s, and no noise"
    late, chance = abs(rows.best.number("ahead")), rows.best.deviation("ahead")
    if late > max(_LATE * rows.step, _FAULT * chance):
        yield f"force and motion are {late * 1e3:.2g} ms apart"


def _notes(rows: _Rows, at: tuple[float, float], of_motor: float) -> Iterator[str]:
    both, apart = rows.both, rows.apart
    if rows.differ:
        before, after = (float(np.sqrt(np.mean(each.residual**2))) for each in (both, apart))
        yield (
            f"The directions differ: {apart.number('c forward') - of_motor:.0f} N s/m forward, "
            f"{apart.number('c backward') - of_motor:.0f} backward. That takes the residual from "
            f"{before:.2g} to {after:.2g} N, and the constant part of the force from "
            f"{both.number('offset'):.2g} ± {both.reach('offset'):.2g} to "
            f"{apart.number('offset'):.2g} ± {apart.reach('offset'):.2g} N."
        )
        if abs(apart.number("offset")) < apart.reach("offset"):
            yield "What looks like a weight is the asymmetry of the directions."
    if both.memory.samples:
        yield (
            "With one slope the residual is not white: it knows itself for "
            f"{both.memory.samples * rows.step * 1e3:.0f} ms, its correlation is {at[1]:.2f} over "
            f"{at[0] * 1e3:.0f} ms."
        )
    corner = _WHITENED / rows.step
    yield f"Force and derivatives are behind a low pass of {corner:.3g} Hz, forth and back."


def _curve(rows: _Rows) -> tuple[Law, Trace, Memory]:
    """Return friction over the speed, means of the force without the inertia, and its law.

    Of each steady run, else of parts of the speeds with as many samples; and the memory inside.
    """
    v, group = rows.moved["c"], rows.moved["run"]
    if not rows.steady:
        ways = [v[way] for way in (v < 0.0, v > 0.0) if np.any(way)]
        shares = np.linspace(0.0, 1.0, _BINS + 1)[1:]
        edges: NDArray[Any] = np.concatenate([np.quantile(way, shares) for way in ways])
        group = np.searchsorted(edges, v).astype(float)
    means = {str(one): (group == one).astype(float) for one in np.unique(group)}
    found = rows.numbers(means)
    speeds = {name: float(inside @ v / np.sum(inside)) for name, inside in means.items()}
    names = sorted(means, key=lambda name: speeds[name])
    speed = np.array([speeds[name] for name in names])
    force, deviation, band = np.array(
        [[found.number(n), found.deviation(n), found.reach(n)] for n in names]
    ).T
    law = law_of(speed, force, np.maximum(deviation, 1e-12 * float(np.max(np.abs(force)))))
    drawn = Trace(
        name=law.words,
        unit="N",
        at=speed,
        measured=force,
        fitted=law.estimate.fitted,
        band=band,
    )
    return law, drawn, found.memory
