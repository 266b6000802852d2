"""What a record of stick-slip tells, and what it cannot."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Final

import numpy as np
from scipy.stats import chi2
from scipy.stats import t as student

from stickslip_score import Solution, by_cycle

from ..axis import Axis
from .block import COEFFICIENTS, DRIFTS, LEVELS, LOAD_UP, Block, fitted_block, noise_of
from .cycles import Run, runs_of
from .looped import Loop, fitted_loop
from .model import Floats, Identified, Number, Record, Residual, Trace
from .noise import memory_of
from .nonlinear import Fitted

_SPARSE: Final = 1.0
"""Radians of the slip between two samples, above which it is not seen."""
_FAR: Final = 10.0
"""Of the scatter of a column: a residual that is not its noise; coloured noise has six."""
_CREEPS: Final = 4.5
"""Deviations of a creep in stick that is none by chance in 100,000 records."""
_NOTHING: Final = 0.25
"""Mean square of a residual, over its noise, that a solver's digits leave."""
_DIFFERS: Final = 1e-3
"""Chance of a difference between feeds."""
_CLEARLY: Final = 4.0
"""Of Akaike's criterion: the better law."""
_DRAWN: Final = 3000
"""Samples of a trace."""
_PARTS: Final = 24
"""Cycles that are fitted one by one, where they differ."""
_MUCH: Final = 0.3
"""Of the time in which the command moves: in cycles."""
_ONE_WAY: Final = 0.8
"""Of its range: how far the table gets."""
_EVENLY, _EVENLY_OF_MOTOR, _VERY_EVENLY = 0.4, 0.3, 0.1
"""Deviation of the times from cycle to cycle, over their mean: cycles; and beyond doubt."""
_TOGETHER, _COUNTS = 0.3, 4.0
"""Correlation of force and spring, and counts of an encoder by which that falls in a slip."""
_SURELY: Final = 1e-6
"""Chance of a finding that is none: of a drift, a delay."""
_COLUMNS, _UNITS = {"x": "position", "F": "force"}, {"x": "m", "F": "N"}
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

Fits = Sequence[Fitted[Block]] | Sequence[Fitted[Loop]]
"""Of runs at several feeds, or of their cycles."""


def is_stick_slip(record: Record, axis: Axis | None = None) -> str:
    """Return why a record is one of stick-slip: rests and slips while the command goes one way.

    Empty where it is not.
    """
    try:
        every = runs_of(record, axis)
    except ValueError:
        return ""
    runs = [run for run in every if not run.still and _is_even(run, record, axis)]
    lasts = sum(run.highs[-1] - run.highs[0] for run in runs)
    if not runs or lasts < _MUCH * sum(float(run.t[-1] - run.t[0]) for run in every):
        return ""
    slips = sum(len(run.lows) for run in runs)
    return f"the table rests and slips {slips} times while the command goes one way"


def _is_even(run: Run, record: Record, axis: Axis | None) -> bool:
    """Return whether cycles come evenly, and fall by more than the counts of an encoder."""
    highs, lows = np.array(run.highs), np.array(run.lows)
    spans, x, F = np.diff(highs), run.columns.get("x"), run.columns.get("F")
    uneven = float(np.std(spans) / np.mean(spans)) if len(spans) > 2 else math.inf
    if _EVENLY < uneven < math.inf:
        return False
    if axis is not None and axis.drive is not None and not axis.drive.on_table:
        # A motor does not move as its table does.
        return uneven < _EVENLY_OF_MOTOR
    if x is None:
        return True
    speed = run.speed
    if math.isnan(speed):
        # Without a command the table goes one way.
        if abs(x[-1] - x[0]) < _ONE_WAY * np.ptp(x):
            return False
        speed = float(np.polyfit(run.t, x, 1)[0])
    behind = speed * run.t - x
    if F is not None and uneven > _VERY_EVENLY and np.corrcoef(behind, F)[0, 1] < _TOGETHER:
        return False
    pairs = min(len(highs), len(lows))
    fall = np.diff([np.interp(at[:pairs], run.t, -behind) for at in (highs, lows)], axis=0)
    return float(np.median(fall)) > _COUNTS * 2.0 * record.rounding.get("position", 0.0)


def stick_slip(record: Record, axis: Axis | None = None) -> Identified:
    """Return what a record of stick-slip tells; ValueError if it shows fewer than two slips."""
    every, reason = runs_of(record, axis), is_stick_slip(record, axis)
    runs = [run for run in every if not run.still]
    if not runs:
        raise ValueError(f"no two slips in a row: {every[0].still}")
    fits: Fits
    notes = list[str]()
    if axis is not None and axis.drive is not None:
        fits = [fitted_loop(record, axis, max(runs, key=lambda run: len(run.lows)))]
    else:
        fits, notes = _with_extras([fitted_block(record, run) for run in runs])
    faults, unknown, parts = [*_faults(fits, record)], fits[0].motion.unknown(), []
    if faults:
        pairs = [(one.value, m) for one in fits if isinstance(m := one.motion, Block)]
        parts = [part for n, block in pairs for part in block.parts(n, _PARTS)]
        fits = parts if len(parts) > 1 else fits
    figures = _figures(fits, axis)
    if len(fits) > 1 and not faults:
        motions = [m.motion(one.value) for one in fits if isinstance(m := one.motion, Block)]
        note, rival = _law_of_gaps(figures["gap"], motions)
        notes, unknown = [*note, *notes], unknown | rival
    if "friction.F_s" in {*figures} - {*unknown} and not (axis and (axis.along or axis.drive)):
        notes.append("a constant force along the way, if there is one, is in the friction")
    numbers = [
        _number(name, some, fits[0].ends, by_scatter=len(parts) > 1)
        for name, some in figures.items()
        if name not in unknown
    ]
    memory, step = fits[0].estimate.memory, _step(fits[0].motion.run.t)
    lag, name = max(memory.samples // 2, 1), [*fits[0].motion.noise][-1]
    following, cycles = "", sum(len(one.motion.run.highs) for one in fits)
    if LOAD_UP in unknown.values():
        following = (
            "Begin the record before the command, with the spring relaxed: for static friction."
        )
    elif numbers:
        following = (
            f"{4 * cycles} cycles in place of {cycles} halve the interval of "
            f"{max(numbers, key=lambda number: number.width).name}, the widest."
        )
    return Identified(
        kind="stick-slip",
        reason=reason,
        numbers=tuple(numbers),
        missing=tuple(unknown.items()),
        residual=Residual(
            rms=max(one.motion.noise[name] for one in fits),
            unit=_UNITS[name],
            memory=memory.samples * step,
            faults=tuple(faults),
            at=(lag * step, float(memory.correlation[lag - 1])) if memory.samples else (0.0, 0.0),
        ),
        traces=tuple(_traces(record, fits)),
        notes=tuple(notes),
        next_measurement=following,
        segments=tuple(part for one in fits for part in one.motion.segments(one.value)),
    )


def _with_extras(fits: list[Fitted[Block]]) -> tuple[list[Fitted[Block]], list[str]]:
    """Return fits with what else the record shows: a drift of the force, or a delay; and say it."""
    notes = []
    columns = fits[0].motion.noise
    for names in (DRIFTS,) * ("F" in columns) + (("delay",),) * (len(columns) > 1):
        wider = [one.motion.more(one, *names) for one in fits]
        moved = np.array([one.value[-len(names) :] for one in wider])
        some = np.array([one.covariance[-len(names) :, -len(names) :] for one in wider])
        square = np.einsum("ij,ijk,ik", moved, np.linalg.pinv(some, hermitian=True), moved)
        if chi2.sf(square, moved.size) < _SURELY:
            fits = wider
            notes.append(
                f"the force is {1e3 * float(np.median(moved)):.3g} ms behind the position"
                if names == ("delay",)
                else "the zero of the force drifts: it tells differences of forces only"
            )
    return fits, notes


def _step(t: Floats) -> float:
    return float(np.median(np.diff(t)))


def _faults(fits: Fits, record: Record) -> Iterator[str]:
    """Yield what fits show that the model has not, or where they tell nothing."""
    faults = dict[str, list[str]]()
    for one in fits:
        motion, own, step = one.motion, noise_of(record, one.motion.run), _step(one.motion.run.t)
        after, period = motion.cycles(one.value)
        endless, w = math.isnan(period), math.sqrt(motion.figures(one.value, None)["k/m"])
        for (name, e), r in zip(motion.noise.items(), one.residual, strict=True):
            noisy = not endless and np.mean(r * r) > _NOTHING
            repeats = noisy and by_cycle(motion.run.t, r, after, period)[0]
            shown = {
                "the residual of the {} repeats from cycle to cycle: friction or spring are not of "
                "the block's kind": repeats and after[-1] >= 3.0 * period,
                "the cycles are not alike: break-away or zero wander from cycle to cycle": noisy
                and one.estimate.memory.samples * step > period,
                "the fit leaves far more than the noise of the {}: the cycles are not those of one "
                "block": e > _FAR * own[name],
                "the table creeps between its slips: friction is not of Coulomb's kind": not endless
                and e <= _FAR * own[name]
                and _creeps(one) > _CREEPS,
                "the samples are too far apart to show a slip": w * step > _SPARSE,
                "the fit ends where a slip would slide on: damping and gap are not told": endless,
                "no motion is like the record: the search did not come to an end": not one.ended,
            }
            for fault in (fault for fault, is_so in shown.items() if is_so):
                faults.setdefault(fault, []).append(_COLUMNS[name])
    for fault, columns in faults.items():
        yield fault.format(" and ".join(sorted({*columns})))


def _creeps(one: Fitted[Block] | Fitted[Loop]) -> float:
    """Return the deviations by which a table that is seen creeps between its slips."""
    motion = one.motion
    if isinstance(motion, Loop):
        return 0.0
    creep = motion.creep(one.value)
    # Only what the numbers cannot follow tells a creep.
    J = one.jacobian / (np.linalg.norm(one.jacobian, axis=0) + 1e-300)
    creep -= J @ np.linalg.lstsq(J, creep, rcond=None)[0]
    longest = max(memory_of([r - np.mean(r)]).samples for r in one.residual)
    power = np.linalg.norm(creep) * math.sqrt(1.0 + 2.0 * longest)
    return float(abs(creep @ np.concatenate(one.residual)) / power)


def _figures(fits: Fits, axis: Axis | None) -> dict[str, Floats]:
    """Return value, deviation and interval of what fits tell, by name, shape (fits, 4)."""
    figures = dict[str, list[tuple[float, ...]]]()
    for one in fits:

        def of(n: Floats, motion: Block | Loop = one.motion) -> Floats:
            return np.array([*motion.figures(n, axis).values()])

        names, spreads = one.motion.figures(one.value, axis), one.deviations(of).tolist()
        for (name, value), spread in zip(names.items(), spreads, strict=True):
            spread = max(spread, 1e-300)
            figures.setdefault(name, []).append((value, spread, *one.ends(value, spread)))
    return {name: np.array(some) for name, some in figures.items()}


def _number(
    name: str,
    some: Floats,
    ends: Callable[[float, float], tuple[float, float]],
    *,
    by_scatter: bool,
) -> Number:
    """Return a number, the mean over runs, wider where they differ; over cycles by scatter."""
    own, spread, lows, highs = some.T
    n, weight, why = len(own), spread**-2.0, _WHYS.get(name, "")
    value, deviation = float(weight @ own / weight.sum()), float(weight.sum()) ** -0.5
    low, high = ends(value, deviation) if n > 1 else (float(lows[0]), float(highs[0]))
    if by_scatter:
        value = float(np.mean(own))
        half = float(student.ppf(0.975, n - 1) * np.std(own, ddof=1)) / math.sqrt(n)
        low, high = value - half, value + half
    elif n > 1 and chi2.sf(np.sum(((own - value) / spread) ** 2), n - 1) < _DIFFERS:
        half, why = float(np.max(np.abs(own - value))), "it differs from feed to feed"
        low, high = low - half, high + half
    if name in ("c/m", "axis.c"):
        # Friction brakes: below 0 noise alone has moved it.
        value, low, high = max(value, 0.0), max(low, 0.0), max(high, high - value, 0.0)
    meaning, unit = _MEANINGS[name]
    return Number(
        name=name,
        meaning=meaning,
        unit=unit,
        value=value,
        low=low,
        high=high,
        why=why,
    )


def _law_of_gaps(some: Floats, motions: list[Solution]) -> tuple[list[str], dict[str, str]]:
    """Say how the gap goes with the feed, by Akaike's criterion for few numbers; or why not."""
    (gap, spread), n, scores = some.T[:2], len(some), dict[str, float]()
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


def _traces(record: Record, fits: Fits) -> Iterator[Trace]:
    """Yield the columns with the fits over them."""
    every, t = slice(None, None, -(-record.t.size // _DRAWN)), record.t
    for number, name in enumerate(fits[0].motion.noise):
        fitted = np.full(t.size, math.nan)
        for one in fits:
            run, left = one.motion.run, one.motion.noise[name] * one.residual[number]
            inside = (t >= run.t[0]) & (t <= run.t[-1])
            fitted[inside] = run.sign * np.interp(t[inside], run.t, run.columns[name] - left)
        yield Trace(
            name=_COLUMNS[name],
            unit=_UNITS[name],
            t=t[every],
            measured=getattr(record, _COLUMNS[name])[every],
            fitted=fitted[every],
        )
