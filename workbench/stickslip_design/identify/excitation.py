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
from scipy.ndimage import binary_opening, maximum_filter1d

from ..axis import Axis
from .evened import Even, Filtered, evened, filtered, low_pass, scatter
from .laws import Law, law_of
from .model import Curve, Floats, Identified, Number, Record, Residual, Trace
from .noise import Estimate, Memory, least_squares
from .steady import Plateau, plateaus

_WHITENED: Final = 0.55
"""Corner of the low pass, of the rate of the samples behind it: white noise stays white to 1 %."""
_FIRST, _WIDER, _LAST = 6, 1.25, 200
"""Stride of the samples behind the widest low pass; of the next one; their least number."""
_FEW: Final = 60
"""Samples below which the low pass is widened, though motor and table are less as one."""
_LITTLE: Final = 0.15
"""Of the residual's power: that of the acceleration's noise."""
_KEPT: Final = 50_000
"""Samples that are kept of a long record, about."""
_STIFF: Final = 0.25
"""Of the frequency of the table on its spring: highest corner, where table and motor are nearly one
mass."""
_SPRING: Final = 0.2
"""The ± of the stiffness that an axis states, relative."""
_SLOW, _REST = 0.02, 0.002
"""Of the highest speed: below it friction is not taken for Coulomb's, and a table rests."""
_RINGING, _AFTER_REST = 1.1, 2.5
"""Length of the low pass's answer, over its corner's period: beside a turn, and where the table may
rest, as behind a spring or for longer."""
_STEADILY, _NEARLY, _FEW_SPEEDS, _INERTIA = 0.6, 0.85, 3, 0.15
"""A record is of steady runs if they are this part of the moving time, at so many speeds, and the
force of the inertia has at most this part of the power; or nearly all of the time."""
_OFF, _LONG = 0.01, 0.15
"""Of the range of the forces: how far a steady run may be off its friction law. Of a steady run: a
memory of the residual that makes it none."""
_LATE: Final = 0.1
"""Of the period of the low pass's corner: time between force and motion that is too much."""
_WAY, _FAULT = 3.0, 4.0
"""Deviations that tell two directions from chance, and a fault, of some that are sought."""
_OWN: Final = 1e-3
"""Of the power of what is sought: what mass and friction must not show of it."""
_LAG: Final = 0.05
"""Lag whose correlation is shown [s]."""
_MOST: Final = 3000
"""Points of a drawn trace."""
_BINS: Final = 10
"""Of a friction curve, for each direction."""
_FOLLOWS: Final = 0.95
"""Correlation of a table's speed with the commanded one, if it follows that."""
_MOVED: Final = ("m", "c", "c forward", "c backward", "F_k", "jerk", "jounce")
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

    t: Floats
    x: Floats
    force: Floats
    run: Floats
    """Number of the unbroken stretch."""
    moved: Mapping[str, Floats]
    """Acceleration and speed as "m" and "c", its parts "c forward" and "c backward", its sign."""
    wanted: Mapping[str, Floats] | None
    """The same of the commanded motion, if the table follows one."""
    corner: float
    sample: float
    """Time between samples of the record [s], known to be about what a force is ahead or late."""
    step: float
    """Time between those that are used [s]."""
    noise: tuple[float, float]
    """That of the acceleration [m/s2] and of the speed [m/s]."""
    yielding: float = 0.0
    """What the fourth derivative of the position adds to the acceleration [s2]."""
    steady: bool = False
    """Whether they are of steady runs alone, which have no acceleration."""

    @property
    def v(self) -> Floats:
        """Speed [m/s]."""
        return self.moved["c"]

    def fit(self, *more: Floats, apart: bool = False) -> Estimate:
        """Return m, c (or c forward, c backward), F_k, offset, and the numbers of more columns.

        "ahead" is by how much the force is ahead of the motion [s], as of a controller that holds
        it over a sample.
        """
        slopes = ("c forward", "c backward") if apart else ("c",)
        columns = {name: self.moved[name] for name in (*slopes, "F_k")}
        if self.v.min() < 0.0 < self.v.max():
            columns["offset"] = np.ones_like(self.v)
        columns |= {str(n): column for n, column in enumerate(more)}
        found = self.numbers(columns)
        if self.steady:
            return found
        m, c = found.number("m"), float(np.mean([found.number(name) for name in slopes]))
        rates = [m * way["jerk"] + c * way["m"] for way in (self.moved, self.wanted) if way]
        columns |= {"ahead": rates[0]}
        found = self.numbers(columns, {"ahead": rates[-1]})
        # How far the numbers are off if the spring is softer than stated.
        soft = _SPRING * m * self.yielding * self.moved["jounce"]
        moved = self.numbers(columns, {"ahead": rates[-1]}, soft).value
        return found._replace(covariance=found.covariance + np.outer(moved, moved))

    def numbers(
        self,
        columns: Mapping[str, Floats],
        more: Mapping[str, Floats] | None = None,
        force: Floats | None = None,
    ) -> Estimate:
        """Return the numbers of columns, and before them the mass, but in steady runs."""
        columns = columns if self.steady else {"m": self.moved["m"], **columns}
        force = self.force if force is None else force
        known = {"ahead": self.sample}
        if self.wanted is not None:
            instruments = {**self.wanted, **(more or {})}
            return least_squares(columns, force, self.run, None, instruments, known)
        noise = {"m": self.noise[0] ** 2}
        for name in ("c", "c forward", "c backward"):
            # Each direction has the noise of the speed for its part of the time.
            noise[name] = self.noise[1] ** 2 * float(np.mean(self.moved[name] != 0.0))
        return least_squares(columns, force, self.run, noise, None, known)

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
    def best(self) -> Estimate:
        """The numbers with as many slopes as are needed."""
        return self.apart if self.differ else self.both


def driven(record: Record, axis: Axis | None) -> Identified:
    """Return what the motion of a driven axis tells; ValueError without a force or a motion.

    Without an axis the force acts on the table itself; else on the motor, whose inertia and
    friction are subtracted.
    """
    if record.force is None:
        raise ValueError("a driven axis needs a column of its force, torque or current")
    if not np.ptp(record.force):
        raise ValueError("the force does not change in this record")
    runs = evened(record)
    steady, share = plateaus(runs, record.rounding.get("position", 0.0))
    rows = _rows(runs, record, axis)
    inertia = float(np.var(rows.best.number("m") * rows.moved["m"]) / np.var(rows.force))
    is_steady = _count(steady) >= _FEW_SPEEDS and share >= (
        _STEADILY if inertia <= _INERTIA else _NEARLY
    )
    if is_steady:
        rows = _at(runs, record, axis, max(_FIRST, record.t.size // _KEPT), steady) or rows
    law, curve, inside = _curve(rows)
    others = _others(rows, axis)
    best = law.estimate if is_steady else rows.best
    seen = rows.both.memory
    lag = min(max(1, round(_LAG / rows.step)), seen.correlation.size)
    shown = slice(None, None, max(1, rows.t.size // _MOST))
    untold = [("friction.F_s", "a table that does not stick and slip tells no static friction")]
    if is_steady:
        untold.append(("axis.mass", "the table is not accelerated in steady runs"))
    if "offset" not in best.names:
        untold.append(
            ("axis.force_along", "motion in one direction does not tell it from friction")
        )
    return Identified(
        kind="steady runs" if is_steady else "excitation",
        reason=f"{len(steady)} runs of constant speed, of {share:.0%} of the moving time"
        if is_steady
        else "the table is accelerated and braked",
        numbers=tuple(_numbers(rows, law, others, axis)),
        untold=(*untold, ("axis.stiffness", "table and drive move as one in it")),
        residual=Residual(
            rms=float(np.sqrt(np.mean(rows.best.residual**2))),
            unit="N",
            memory=seen.samples * rows.step,
            at=(lag * rows.step, float(seen.correlation[lag - 1])),
            faults=(*others, *_faults(rows, law, curve, inside)),
        ),
        traces=(
            Trace(
                name="force",
                unit="N",
                t=rows.t[shown],
                measured=rows.force[shown],
                fitted=rows.best.fitted[shown],
            ),
        ),
        segments=tuple(_segments(rows, steady if is_steady else [])),
        curve=curve,
        notes=tuple(_notes(rows, lag)),
    )


def _count(steady: Sequence[Plateau]) -> int:
    """Return how many speeds differ by a tenth, with their sign."""
    speeds = sorted(each.speed for each in steady)
    return len(speeds) and 1 + sum(b - a > 0.1 * abs(b) for a, b in pairwise(speeds))


def _rows(runs: Sequence[Even], record: Record, axis: Axis | None) -> _Rows:
    """Return the samples behind the widest low pass whose noise of the acceleration is little.

    Where the position has all the noise, behind the one with which the numbers are known best.
    """
    count = sum(run.t.size for run in runs)
    stride, least, best = max(_FIRST, count // _KEPT), math.inf, None
    if axis and axis.drive:
        highest = _STIFF * math.sqrt(axis.k / axis.m) / (2.0 * math.pi)
        stride = max(stride, math.ceil(_WHITENED / (highest * runs[0].step)))
    while best is None or count // stride > _LAST:
        rows = _at(runs, record, axis, stride)
        if rows is None or rows.t.size < _FEW:
            if best is not None:
                break
            if stride > _FIRST:
                stride = max(_FIRST, int(stride / _WIDER))
                continue
        if rows is None:
            raise ValueError("the table does not move in this record")
        found, noise = rows.both, rows.noise[0] ** 2
        buried = bool(np.var(rows.moved["m"]) < 2.0 * noise)
        size = float(np.linalg.slogdet(found.covariance)[1])
        if best is not None and size > least:
            break
        least, best = math.inf if buried else size, rows
        if not buried and found.number("m") ** 2 * noise < _LITTLE * np.mean(found.residual**2):
            break
        stride = math.ceil(_WIDER * stride)
    return best


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
    noise = max(scatter(run, corner, rounding) for run in runs)
    ways = [filtered(run, corner) for run in runs]
    highest = max(float(np.max(np.abs(way.v))) for way in ways)
    yielding, reach = _yielding(axis), max(2, int(_RINGING / (corner * step)))
    far = int(_AFTER_REST / (corner * step))
    late, parts = _lateness(ways), list[list[Floats]]()
    for way in ways:
        size = np.abs(way.v)
        # Where the table turns it may rest, in which friction is anything, and the low pass brings
        # it in from there.
        slow = size < _SLOW * highest
        still = size < _REST * highest
        rests = slow if yielding else binary_opening(still, np.ones(reach))
        use = ~(_wider(slow, reach) | _wider(rests, far))
        if steady:
            use = np.any([(way.t >= p.begin) & (way.t <= p.end) for p in steady], axis=0)
        # At the ends of a run the low pass has other surroundings for each column.
        use[: 2 * reach] = use[-2 * reach :] = False
        assert way.force is not None
        a = way.a + yielding * np.gradient(np.gradient(way.a, step), step)
        columns = [way.t, way.x, way.force, *_moved(way.v, a, step, corner)]
        if late is not None:
            assert way.wanted is not None
            v, a = (np.interp(way.t - late, way.t, column) for column in way.wanted)
            columns += _moved(v, a, step, corner)
        edges = np.flatnonzero(np.diff(use, prepend=False, append=False))
        for begin, end in zip(edges[::2], edges[1::2], strict=True):
            part = [column[begin:end:stride] for column in columns]
            parts.append([*part, np.full(part[0].size, float(len(parts)))])
    if not parts or highest == 0.0:
        return None
    t, x, force, *others, run = map(np.concatenate, zip(*parts, strict=True))
    moved = dict(zip(_MOVED, others, strict=False))
    wanted = dict(zip(_MOVED, others[len(_MOVED) :], strict=True)) if late is not None else None
    scatters = noise.a, noise.v
    return _Rows(
        t, x, force, run, moved, wanted, corner, step, stride * step, scatters, yielding,
        bool(steady),
    )  # fmt: skip


def _wider(some: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    return np.asarray(maximum_filter1d(some, 2 * reach + 1))


def _moved(v: Floats, a: Floats, step: float, corner: float) -> list[Floats]:
    """Return what of a motion the force depends on, in the order of `_MOVED`."""
    ahead, sign = (low_pass(each, step, corner) for each in (np.maximum(v, 0.0), np.sign(v)))
    jerk = np.gradient(a, step)
    return [a, v, ahead, v - ahead, sign, jerk, np.gradient(jerk, step)]


def _lateness(ways: Sequence[Filtered]) -> float | None:
    """Return by how much the table is late on its command [s]; None if it follows none."""
    if any(way.wanted is None for way in ways):
        return None
    v = np.concatenate([way.v for way in ways])
    wanted, rate = (np.concatenate([way.wanted[n] for way in ways if way.wanted]) for n in (0, 1))
    if not np.ptp(wanted) or not np.ptp(v):
        return None
    late = float(rate @ (wanted - v) / max(float(rate @ rate), 1e-300))
    follows = float(np.corrcoef(v, wanted - late * rate)[0, 1]) > _FOLLOWS
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
    of_motor = (drive.inertia, drive.d, drive.dry) if drive else (0.0, 0.0, 0.0)
    less = dict(zip(("m", "c", "F_k"), of_motor, strict=True))
    best = law.estimate if rows.steady else rows.best
    estimates = dict.fromkeys(best.names, best)
    if "c" not in best.names and "c forward" in best.names:
        estimates["c"] = rows.both
    if "offset" in estimates:
        # With one slope for both directions a weight would be known too well.
        estimates["offset"] = rows.apart
    for symbol, (name, meaning, unit) in _SHOWN.items():
        if symbol not in estimates:
            continue
        found, sign = estimates[symbol], -1 if symbol == "offset" else 1
        own = less.get(symbol.partition(" ")[0], 0.0)
        value, reach = sign * found.number(symbol) - own, found.reach(symbol)
        others_of = [*others.values(), *(law.others if rows.steady else ())]
        apart = [sign * o.number(symbol) - own for o in others_of if symbol in o.names]
        also = f", without {drive.inertia:.4g} kg of the motor" if drive and symbol == "m" else ""
        yield Number(
            name=name,
            meaning=meaning + also,
            unit=unit,
            value=value,
            low=min(value - reach, *apart, value),
            high=max(value + reach, *apart, value),
            scales=True,
        )


def _others(rows: _Rows, axis: Axis | None) -> dict[str, Estimate]:
    """Return what else the record shows, in words, and the numbers of a model that has it.

    Of what is sought only that which is no chance, which acceleration, speed and sign do not show
    as well, and which moves a number by more than its interval.
    """
    size, middle, sign = np.abs(rows.v), rows.x - np.mean(rows.x), rows.moved["F_k"]
    tried: dict[str, tuple[Floats, ...]] = {
        "the force changes along the way": (middle,),
        "friction changes along the way": (sign * middle,),
        "the zero of the force drifts": (rows.t - np.mean(rows.t),),
    }
    if not rows.steady:
        tried |= {
            "friction is bent over the speed": (sign * size**2,),
            "friction is bent at low speed": (sign * np.exp(-10.0 * size / size.max()),),
        }
    if axis and axis.drive:
        turn = 2.0 * math.pi * middle / axis.drive.pitch
        tried["the force changes with the turn of the motor"] = np.sin(turn), np.cos(turn)
    best, shown = rows.best, dict[str, Estimate]()
    plain = {"c": rows.v, "F_k": sign, "offset": np.ones_like(sign)}
    for words, columns in tried.items():
        own = rows.numbers(plain, force=columns[0])
        # The noise of the acceleration, where that shows it as well.
        hidden = 0.0 if rows.steady else 2.0 * size.size * (own.number("m") * rows.noise[0]) ** 2
        if own.residual @ own.residual < _OWN * (columns[0] @ columns[0]) + hidden:
            continue
        found = rows.fit(*columns, apart=rows.differ)
        moved = [abs(found.number(n) - best.number(n)) > best.reach(n) for n in best.names]
        chance = [abs(found.number(str(n))) / found.deviation(str(n)) for n in range(len(columns))]
        if max(chance) > _FAULT and any(moved):
            shown[words] = found
    return shown


def _faults(rows: _Rows, law: Law, curve: Curve, inside: Memory) -> Iterator[str]:
    if rows.steady:
        left, known = np.abs(law.estimate.residual), np.sqrt(np.mean(curve.band**2))
        if np.max(left) > max(_OFF * float(np.ptp(rows.force)), 2.0 * known):
            worst = float(np.max(left))
            yield f"steady runs are up to {worst:.2g} N off every friction law that was tried"
        longest = max(np.count_nonzero(rows.run == one) for one in np.unique(rows.run))
        if inside.samples > _LONG * longest:
            yield "the force is not steady in steady runs"
        return
    late, chance = abs(rows.best.number("ahead")), rows.best.deviation("ahead")
    if late > max(_LATE / rows.corner, _FAULT * chance):
        yield f"force and motion are {late * 1e3:.2g} ms apart"


def _notes(rows: _Rows, lag: int) -> Iterator[str]:
    both, apart = rows.both, rows.apart
    if rows.differ:
        before, after = (float(np.sqrt(np.mean(each.residual**2))) for each in (both, apart))
        yield (
            f"The directions differ: {apart.number('c forward'):.0f} N s/m forward, "
            f"{apart.number('c backward'):.0f} backward. That takes the residual from "
            f"{before:.2g} to {after:.2g} N, and the constant part of the force from "
            f"{both.number('offset'):.2g} ± {both.reach('offset'):.2g} to "
            f"{apart.number('offset'):.2g} ± {apart.reach('offset'):.2g} N."
        )
        if abs(apart.number("offset")) < apart.reach("offset"):
            yield "What looks like a weight is the asymmetry of the directions."
    if both.memory.samples:
        span = both.memory.samples * rows.step * 1e3
        yield (
            f"With one slope the residual is not white: it knows itself for {span:.0f} ms, its "
            f"correlation is {both.memory.correlation[lag - 1]:.2f} over "
            f"{lag * rows.step * 1e3:.0f} ms."
        )
    yield f"Force and derivatives are behind a low pass of {rows.corner:.3g} Hz, forth and back."


def _segments(rows: _Rows, steady: Sequence[Plateau]) -> Iterator[tuple[float, float, str]]:
    for begin, end, speed in steady:
        yield begin, end, f"{speed * 6e4:.4g} mm/min"
    turns = np.flatnonzero(np.diff(np.sign(rows.v)) != 0.0) + 1
    for places in np.split(np.arange(rows.t.size), turns) if not steady else ():
        way = "forward" if rows.v[places[0]] > 0.0 else "backward"
        yield float(rows.t[places[0]]), float(rows.t[places[-1]]), way


def _curve(rows: _Rows) -> tuple[Law, Curve, Memory]:
    """Return friction over the speed, means of the force without the inertia, and its law.

    Of each steady run, else of parts of the speeds with as many samples; and the memory inside.
    """
    group: NDArray[Any] = rows.run
    if not rows.steady:
        ways = [rows.v[way] for way in (rows.v < 0.0, rows.v > 0.0) if np.any(way)]
        shares = np.linspace(0.0, 1.0, _BINS + 1)[1:]
        group = np.searchsorted(np.concatenate([np.quantile(way, shares) for way in ways]), rows.v)
    means = {int(one): (group == one).astype(float) for one in np.unique(group)}
    found = rows.numbers({str(one): inside for one, inside in means.items()})
    speed = np.array([float(inside @ rows.v / np.sum(inside)) for inside in means.values()])
    names, order = np.array([str(one) for one in means]), np.argsort(speed)
    force, deviation, band = np.array(
        [[found.number(n), found.deviation(n), found.reach(n)] for n in names[order]]
    ).T
    tiny = 1e-12 * float(np.max(np.abs(force)))
    law = law_of(speed[order], force, np.maximum(deviation, tiny))
    fitted = law.estimate.fitted
    curve = Curve(speed=speed[order], force=force, band=band, law=law.words, fitted=fitted)
    return law, curve, found.memory
