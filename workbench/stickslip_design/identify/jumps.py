"""What a record of stick-slip tells, and what it cannot."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from scipy.stats import chi2

from stickslip_score import Solution, by_cycle

from ..axis import Axis
from .block import (
    COEFFICIENTS,
    COLUMNS,
    CREEP,
    DRIFTS,
    LEVELS,
    LOAD_UP,
    Fitted,
    fitted_block,
    noise_of,
)
from .cycles import Run, runs_of
from .looped import fitted_loop
from .model import Floats, Identified, Number, Record, Trace

_SPARSE: Final = 1.0
"""Radians of the slip between two samples, above which it is not seen."""
_FAR: Final = 10.0
"""Of the scatter of a column: a residual that is not its noise; coloured noise has six."""
_NOTHING: Final = 0.25
"""Mean square of a residual, over its noise, that a solver's digits leave."""
_SURELY, _DIFFERS = 1e-6, 1e-3
"""Chance of a drift, or a creep, that is none; of feeds that differ."""
_CLEARLY: Final = 4.0
"""Of Akaike's criterion: the better law."""
_DRAWN: Final = 3000
"""Samples of a trace."""
_MUCH: Final = 0.3
"""Of the time in which the command moves: in cycles."""
_UNITS: Final = {"x": "m", "F": "N"}
_WHYS: Final = dict.fromkeys(LEVELS, "the zero of the force is taken as true") | dict.fromkeys(
    COEFFICIENTS, "the spring is taken as relaxed before the command begins"
)
_AGES: Final = "how friction ages"
_MEANINGS: Final = {
    "k/m": ("square of the natural frequency", "1/s2"),
    "c/m": ("viscous friction over mass", "1/s"),
    "gap": ("(F_s - F_k)/k: spring between static and kinetic friction", "m"),
    "axis.stiffness": ("stiffness of the spring", "N/m"),
    "axis.mass": ("mass of table and workpiece", "kg"),
    "axis.c": ("viscous friction of the guideway", "N.s/m"),
    "F_s - F_k": ("static less kinetic friction", "N"),
    "friction.F_s": ("static friction", "N"),
    "friction.F_k": ("kinetic friction, without its viscous part", "N"),
    "friction.mu_s": ("static coefficient", "1"),
    "friction.mu_k": ("kinetic coefficient", "1"),
}


def jumping(record: Record, axis: Axis | None = None) -> list[Run]:
    """Return the runs of a record in which the table rests and slips while the command goes on.

    ValueError, with the reason, of a record that is not one of stick-slip.
    """
    every = runs_of(record, axis)
    runs = [run for run in every if not run.still]
    if not runs:
        raise ValueError(f"no two slips in a row: {every[0].still}")
    lasts = sum(run.highs[-1] - run.highs[0] for run in runs)
    if lasts < _MUCH * sum(float(run.t[-1] - run.t[0]) for run in every):
        raise ValueError("the table slips in a small part of the record only")
    return runs


def stick_slip(record: Record, axis: Axis | None = None) -> Identified:
    """Return what a record of stick-slip tells; ValueError of another one, and of few slips."""
    runs, notes, creeps = jumping(record, axis), list[str](), False
    if axis is not None and axis.drive is not None:
        fits = [fitted_loop(record, axis, max(runs, key=lambda run: len(run.lows)))]
        if record.force is None:
            notes.append(
                "without a force, mass and stiffness are as true as the gains of the drive"
            )
    else:
        fits = [fitted_block(record, run) for run in runs]
        drifting, is_sure = _with(fits, DRIFTS) if "F" in fits[0].motion.noise else (fits, False)
        if is_sure:
            fits = drifting
            notes.append("the zero of the force drifts: it tells differences of forces only")
        creeps = _with(fits, CREEP)[1]
    first, unknown = fits[0], fits[0].motion.unknown()
    faults = dict.fromkeys(fault for one in fits for fault in _faults(one, record))
    if creeps:
        faults["the table creeps between its slips: friction is not of Coulomb's kind"] = None
    figures = [one.figures(axis) for one in fits]
    every = {name: np.array([own[name] for own in figures]).T for name in figures[0]}
    if len(fits) > 1 and not faults:
        motions = [one.motion.motion(one.value) for one in fits]
        note, rival = _law_of_gaps(every["gap"], motions)
        notes, unknown = [*note, *notes], unknown | rival
    if "friction.F_s" in {*every} - {*unknown} and not (axis and (axis.along or axis.drive)):
        notes.append("a constant force along the way, if there is one, is in the friction")
    numbers = [_number(name, every[name], first) for name in every if name not in unknown]
    cycles, following = sum(len(one.motion.run.highs) for one in fits), ""
    if LOAD_UP in unknown.values():
        following = (
            "Begin the record before the command, with the spring relaxed: for static friction."
        )
    elif numbers:
        widest = max(numbers, key=lambda number: number.width)
        following = f"{4 * cycles} cycles in place of {cycles} halve the interval of {widest.name}."
    if memory := first.estimate.memory.samples * first.motion.run.step:
        notes.append(f"the noise is coloured: it knows itself for {1e3 * memory:.2g} ms")
    name = [*first.motion.noise][-1]
    slips = sum(len(run.lows) for run in runs)
    return Identified(
        kind="stick-slip",
        reason=f"the table rests and slips {slips} times while the command goes one way",
        numbers=tuple(numbers),
        missing=tuple(unknown.items()),
        noise=max(one.motion.noise[name] for one in fits),
        faults=tuple(faults),
        traces=tuple(_traces(record, fits)),
        notes=tuple(notes),
        next_measurement=following,
        segments=tuple(part for one in fits for part in _segments(one)),
    )


def _with(fits: list[Fitted], extras: tuple[str, ...]) -> tuple[list[Fitted], bool]:
    """Return fits with numbers besides, and whether these are no chance."""
    wider = [one.motion.more(one, extras) for one in fits]
    square = 0.0
    for one in wider:
        some = slice(len(one.motion.names) - len(extras), len(one.motion.names))
        moved, covariance = one.value[some], one.covariance[some, some]
        square += float(moved @ np.linalg.pinv(covariance, hermitian=True) @ moved)
    return wider, bool(chi2.sf(square, len(extras) * len(wider)) < _SURELY)


def _faults(one: Fitted, record: Record) -> Iterator[str]:
    """Yield what a fit shows that the model has not, or where it tells nothing."""
    motion, t, own = one.motion, one.motion.run.t, noise_of(record, one.motion.run)
    (begin, period, _), step = motion.rhythm(one.value), motion.run.step
    if math.sqrt(motion.figures(one.value, None)["k/m"]) * step > _SPARSE:
        yield "the samples are too far apart to show a slip"
    if not one.ended:
        yield "no motion is like the record: the search did not come to an end"
    if math.isnan(period):
        yield "the fit ends where a slip would slide on: damping and gap are not told"
        return
    for (name, e), r in zip(motion.noise.items(), one.residual, strict=True):
        column, noisy = COLUMNS[name], np.mean(r * r) > _NOTHING
        if noisy and t[-1] >= begin + 3.0 * period and by_cycle(t, r, t - begin, period)[0]:
            yield (
                f"the residual of the {column} repeats from cycle to cycle: friction or spring are "
                "not of the block's kind"
            )
        if noisy and one.estimate.memory.samples * step > period:
            yield "the cycles are not alike: break-away or zero wander from cycle to cycle"
        if e > _FAR * own[name]:
            yield (
                f"the fit leaves far more than the noise of the {column}: the cycles are not those "
                "of one block"
            )


def _number(name: str, some: Floats, of: Fitted) -> Number:
    """Return a number of values and deviations, shape (2, fits): their mean, or all."""
    (own, spread), why = some, _WHYS.get(name, "")
    weight = spread**-2.0
    value = float(weight @ own / weight.sum())
    low, high = of.ends(value, float(weight.sum()) ** -0.5)
    if len(own) > 1 and chi2.sf(weight @ (own - value) ** 2, len(own) - 1) < _DIFFERS:
        low, high, why = min(low, *own), max(high, *own), "it differs from feed to feed"
    if name in ("c/m", "axis.c"):
        # Friction brakes: below 0 noise alone has moved it.
        value, low, high = max(value, 0.0), max(low, 0.0), max(high, high - value, 0.0)
    meaning, unit = _MEANINGS[name]
    return Number(name=name, meaning=meaning, unit=unit, value=value, low=low, high=high, why=why)


def _law_of_gaps(some: Floats, motions: Sequence[Solution]) -> tuple[list[str], dict[str, str]]:
    """Say how the gap goes with the feed, by Akaike's criterion for few numbers; or why not."""
    (gap, spread), n, scores = some, len(motions), dict[str, float]()
    if n < 4:
        return [], {_AGES: "fewer than four feeds do not tell how the gap goes with them"}
    laws = {
        "the gap is the same at all feeds": [0.0] * n,
        "the gap grows with the logarithm of the time at rest": [
            math.log(s.relief / s.v) for s in motions
        ],
        "the gap falls with the speed of the slip": [-s.v - s.w * s.swing() for s in motions],
    }
    for law, by in laws.items():
        X, p = np.stack([np.ones(n), by], axis=1) / spread[:, None], 1 + any(by)
        b, *_ = np.linalg.lstsq(X, gap / spread, rcond=None)
        square = float(np.sum((gap / spread - X @ b) ** 2))
        scores[law] = square + 2.0 * p * n / (n - p - 1) if b[1] >= 0.0 else math.inf
    best, following = sorted(scores, key=lambda law: scores[law])[:2]
    clear = scores[following] - scores[best] >= _CLEARLY
    rival = f"{best}, or {following}: these feeds do not tell"
    return [best], {} if clear else {_AGES: rival}


def _segments(one: Fitted) -> Iterator[tuple[float, float, str]]:
    """Yield parts of a run: begin and end [s], and what they are."""
    run, (begin, period, t_slip) = one.motion.run, one.motion.rhythm(one.value)
    if math.isnan(period + t_slip):
        yield float(run.t[0]), float(run.t[-1]), "jumps"
        return
    for at in (begin + period * np.arange(len(run.highs))).tolist():
        yield at, at + t_slip, "slips"
        yield at + t_slip, at + period, "rests"


def _traces(record: Record, fits: Sequence[Fitted]) -> Iterator[Trace]:
    """Yield the columns with the fits over them."""
    every, t = slice(None, None, -(-record.t.size // _DRAWN)), record.t
    for number, name in enumerate(fits[0].motion.noise):
        fitted = np.full(t.size, math.nan)
        for one in fits:
            run, left = one.motion.run, one.motion.noise[name] * one.residual[number]
            inside = (t >= run.t[0]) & (t <= run.t[-1])
            fitted[inside] = run.sign * np.interp(t[inside], run.t, run.columns[name] - left)
        measured = getattr(record, COLUMNS[name])[every]
        yield Trace(
            name=COLUMNS[name],
            unit=_UNITS[name],
            at=t[every],
            measured=measured,
            fitted=fitted[every],
        )
