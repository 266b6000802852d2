"""What a record of stick-slip tells, and what it cannot."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from scipy.stats import chi2
from scipy.stats import t as student

from stickslip_score import Solution, by_cycle

from ..axis import Axis
from .block import DRIFTS, Block, fitted_block, noise_of
from .cycles import Run, runs_of
from .looped import Loop, fitted_loops
from .model import Floats, Identified, Number, Record, Residual, Trace
from .noise import memory_of
from .nonlinear import Fitted, Motion

_SPARSE: Final = 1.0
"""Radians of the slip between two samples, above which it is not seen."""
_FAR: Final = 10.0
"""Of the scatter of a column: a residual that is not its noise; coloured noise has six."""
_CREEPS: Final = 4.5
"""Deviations of a creep in stick that is none by chance in 100,000 records."""
_EDGE: Final = 1e-3
"""Of the damping ratio: how near to a slip without an end a fit tells nothing by its slopes."""
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
_EVENLY, _VERY_EVENLY = 0.4, 0.1
"""Deviation of the times from cycle to cycle, over their mean: cycles; and beyond doubt."""
_TOGETHER, _COUNTS = 0.3, 4.0
"""Correlation of force and spring, and counts of an encoder by which that falls in a slip."""
_SURELY: Final = 1e-6
"""Chance of a finding that is none: of a drift, a delay."""
_COLUMNS, _UNITS = {"x": "position", "F": "force"}, {"x": "m", "F": "N"}
_LEVELS, _COEFFICIENTS = ("friction.F_s", "friction.F_k"), ("friction.mu_s", "friction.mu_k")
_BY_SPEED: Final = ("gap", "axis.stiffness", "axis.mass", "axis.c")
_WHYS: Final = dict.fromkeys(_LEVELS, "the zero of the force is taken as true") | dict.fromkeys(
    _COEFFICIENTS, "the spring is taken as relaxed before the command begins"
)
_LOAD_UP: Final = (
    "the position tells (F_s - F_k)/k; a load-up from a relaxed spring tells them apart"
)
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
"""Of runs at several feeds, or of their cycles; of a loop others that are as good."""


def is_stick_slip(record: Record, axis: Axis | None = None) -> str:
    """Return why a record is one of stick-slip: rests and slips while the command goes one way.

    Empty where it is not.
    """
    try:
        every = runs_of(record, axis)
    except ValueError:
        return ""
    runs = [run for run in every if not run.still and _is_even(run, record)]
    lasts = sum(run.highs[-1] - run.highs[0] for run in runs)
    if not runs or lasts < _MUCH * sum(float(run.t[-1] - run.t[0]) for run in every):
        return ""
    slips = sum(len(run.lows) for run in runs)
    return f"the table rests and slips {slips} times while the command goes one way"


def _is_even(run: Run, record: Record) -> bool:
    """Return whether cycles come evenly, and fall by more than the counts of an encoder."""
    highs, lows = np.array(run.highs), np.array(run.lows)
    spans, x, F = np.diff(highs), run.columns.get("x"), run.columns.get("F")
    uneven = float(np.std(spans) / np.mean(spans)) if len(spans) > 2 else math.inf
    if _EVENLY < uneven < math.inf:
        return False
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
    notes, faults, unknown, has_force = [], [], {}, "F" in runs[0].columns
    if axis is not None and axis.drive is not None:
        fits = fitted_loops(record, axis, max(runs, key=lambda run: len(run.lows)))
        faults = [*_faults(fits[:1]), *_faults_of_loop(fits[0])]
        if not has_force:
            unknown = dict.fromkeys(
                _LEVELS, "without the force of the motor its level is not in the record"
            )
    else:
        blocks, found = _with_extras([fitted_block(record, run) for run in runs])
        faults = [*_faults(blocks), *_misfits(blocks, record)]
        if math.isnan(runs[0].speed) and "x" not in runs[0].columns:
            unknown = dict.fromkeys(
                _BY_SPEED, "the speed of the spring's end is not in the record: state one feed"
            )
        if any(DRIFTS[0] in one.motion.extras for one in blocks):
            unknown |= dict.fromkeys(_LEVELS, "the zero of the force drifts")
        elif has_force and (axis is None or axis.along == 0.0):
            found.append("a constant force along the way, if there is one, is in the friction")
        if not has_force and runs[0].start == -math.inf:
            unknown = dict.fromkeys(_COEFFICIENTS, _LOAD_UP)
        if faults:
            parts = [part for one in blocks for part in one.motion.parted(one.value, _PARTS)]
            blocks = parts if len(parts) > 1 else blocks
        elif len(blocks) > 1:
            gap, spread, *_ = _figures(blocks, axis)["gap"].T
            motions = [one.motion.motion(one.value) for one in blocks]
            note, rival = _law_of_gaps(gap, spread, motions)
            notes += [note] * bool(note)
            unknown |= {"how friction ages": rival} if rival else {}
        fits, notes = blocks, [*notes, *found]
    every_number = _numbers(fits, _figures(fits, axis), parted=bool(faults))
    numbers = [number for number in every_number if number.name not in unknown]
    fits = fits[:1] if isinstance(fits[0].motion, Loop) else fits
    return Identified(
        kind="stick-slip", reason=reason, numbers=tuple(numbers), missing=tuple(unknown.items()),
        residual=_residual(fits, tuple(faults)), traces=tuple(_traces(record, fits)),
        segments=tuple(part for one in fits for part in one.motion.segments(one.value)),
        notes=tuple(notes), next_measurement=_following(numbers, unknown, fits),
    )  # fmt: skip


def _with_extras(fits: list[Fitted[Block]]) -> tuple[list[Fitted[Block]], list[str]]:
    """Return fits with what else the record shows: a drift of the force, or a delay; and say it."""
    notes = []
    columns = fits[0].motion.noise
    for names in (DRIFTS,) * ("F" in columns) + (("delay",),) * (len(columns) > 1):
        wider = [one.motion.more(one, *names) for one in fits]
        moved = np.array([one.value[-len(names) :] for one in wider])
        some = [one.covariance[-len(names) :, -len(names) :] for one in wider]
        square = sum(
            by @ np.linalg.pinv(C, hermitian=True) @ by for by, C in zip(moved, some, strict=True)
        )
        if chi2.sf(square, moved.size) < _SURELY:
            fits = wider
            notes.append(
                f"the force is {1e3 * float(np.median(moved)):.3g} ms behind the position"
                if names == ("delay",)
                else "the zero of the force drifts: it tells differences of forces only"
            )
    return fits, notes


def _faults(fits: Fits) -> Iterator[str]:
    """Yield what residuals show that the model has not."""
    shapes, wanders, ends = set(), False, False
    for one in fits:
        t, (after, period) = one.motion.run.t, one.motion.cycles(one.value)
        ends |= math.isnan(period)
        for name, r in zip(one.motion.noise, one.residual, strict=True):
            if math.isnan(period) or np.mean(r * r) < _NOTHING:
                continue
            if by_cycle(t, r, after, period)[0] and after[-1] >= 3.0 * period:
                shapes.add(_COLUMNS[name])
            wanders |= memory_of([r - np.mean(r)]).samples * _step(t) > period
    if ends:
        yield "the nearest motion of the block does not stick again"
    if shapes:
        yield (
            f"the residual of the {' and '.join(sorted(shapes))} repeats from cycle to cycle: "
            "friction or spring are not of the block's kind"
        )
    if wanders:
        yield "the cycles are not alike: break-away or zero wander from cycle to cycle"


def _step(t: Floats) -> float:
    return float(np.median(np.diff(t)))


def _faults_of_loop(found: Fitted[Loop]) -> Iterator[str]:
    """Yield why a fit of a loop tells nothing."""
    axis = found.motion.candidate(found.value)
    if math.sqrt(axis.k / axis.m) * _step(found.motion.run.t) > _SPARSE:
        yield "the samples are too far apart to show a slip"
    if not found.left_is_little:
        yield "no motion of the loop is like the record: the search did not come to an end"


def _misfits(fits: list[Fitted[Block]], record: Record) -> Iterator[str]:
    """Yield where a fit leaves far more than the noise, or the table creeps in stick."""
    far = dict[str, float]()
    for one in fits:
        own = noise_of(record, one.motion.run)
        far |= {n: max(far.get(n, 0.0), e / own[n]) for n, e in one.motion.noise.items()}
    faults = [
        f"the fit leaves {times:.2g} times the noise of the {_COLUMNS[name]}: "
        "the cycles are not those of one block"
        for name, times in far.items()
        if times > _FAR
    ]
    motions = [one.motion.motion(one.value) for one in fits]
    if any(math.isinf(Solution(s.w, s.zeta + _EDGE, s.v, s.D).t_slip) for s in motions):
        faults.append("the fit ends where a slip would slide on: damping and gap are not told")
    yield from faults
    if not faults and max(map(_creeps, fits)) > _CREEPS:
        yield "the table creeps between its slips: friction is not of Coulomb's kind"


def _creeps(one: Fitted[Block]) -> float:
    """Return the deviations by which the table creeps between its slips."""
    block, (after, period) = one.motion, one.motion.cycles(one.value)
    t_slip = block.motion(one.value).t_slip
    within = after % period
    rise = (within - t_slip) / (period - t_slip) - 0.5
    way = np.where(within < t_slip, 0.5 - within / t_slip, rise) * (after >= 0.0)
    by = {"x": 1.0, "F": -block.by_name(one.value).get("k", 0.0)}
    seen = np.concatenate([way * by[name] / e for name, e in block.noise.items()])
    # Only what the numbers of the block cannot follow tells a creep.
    J = one.jacobian / (np.linalg.norm(one.jacobian, axis=0) + 1e-300)
    seen -= J @ np.linalg.lstsq(J, seen, rcond=None)[0]
    longest = max(memory_of([r - np.mean(r)]).samples for r in one.residual)
    power = np.linalg.norm(seen) * math.sqrt(1.0 + 2.0 * longest)
    return float(abs(seen @ np.concatenate(one.residual)) / power)


def _figures(fits: Fits, axis: Axis | None) -> dict[str, Floats]:
    """Return value, deviation and interval of what fits tell, by name, shape (fits, 4)."""
    figures = dict[str, list[tuple[float, ...]]]()
    for one in fits:

        def of(n: Floats, motion: Motion = one.motion) -> Floats:
            return np.array([*motion.figures(n, axis).values()])

        names, spreads = one.motion.figures(one.value, axis), one.deviations(of).tolist()
        for (name, value), spread in zip(names.items(), spreads, strict=True):
            spread = max(spread, 1e-300)
            figures.setdefault(name, []).append((value, spread, *one.ends(value, spread)))
    return {name: np.array(some) for name, some in figures.items()}


def _numbers(fits: Fits, figures: dict[str, Floats], *, parted: bool) -> Iterator[Number]:
    """Yield numbers, each the mean over runs, wider where they differ; of cycles by scatter."""
    for name, some in figures.items():
        (own, spread, lows, highs), why = some.T, _WHYS.get(name, "")
        weight, n = spread**-2.0 / np.sum(spread**-2.0), len(own)
        value, low, high = float(weight @ own), float(lows[0]), float(highs[0])
        if isinstance(fits[0].motion, Loop):
            value, low, high = float(own[0]), float(lows.min()), float(highs.max())
            why = "other numbers move the axis as well like this" if n > 1 else ""
        elif parted and n > 1:
            value = float(np.mean(own))
            half = float(student.ppf(0.975, n - 1) * np.std(own, ddof=1)) / math.sqrt(n)
            low, high = value - half, value + half
        elif n > 1:
            low, high = fits[0].ends(value, float(np.sum(spread**-2.0)) ** -0.5)
            if chi2.sf(np.sum(((own - value) / spread) ** 2), n - 1) < _DIFFERS:
                half, why = float(np.max(np.abs(own - value))), "it differs from feed to feed"
                low, high = low - half, high + half
        meaning, unit = _MEANINGS[name]
        if name in ("c/m", "axis.c"):
            # Friction brakes: below 0 noise alone has moved it.
            value, low, high = max(value, 0.0), max(low, 0.0), max(high, high - value, 0.0)
        yield Number(
            name=name, meaning=meaning, unit=unit, value=value, low=low, high=high,
            why=why,
        )  # fmt: skip


def _law_of_gaps(gap: Floats, spread: Floats, motions: list[Solution]) -> tuple[str, str]:
    """Say how the gap goes with the feed, by Akaike's criterion for few numbers; or why not."""
    n, scores = len(gap), dict[str, float]()
    if n < 4:
        return "", "fewer than four feeds do not tell how the gap goes with them"
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
    return best, "" if clear else f"{best}, or {following}: these feeds do not tell"


def _residual(fits: Fits, faults: tuple[str, ...]) -> Residual:
    """Return what the fits leave, of the force where there is one."""
    name = [*fits[0].motion.noise][-1]
    parts = [one.residual[-1] for one in fits]
    memory = memory_of([part - np.mean(part) for part in parts])
    step, lag = _step(fits[0].motion.run.t), max(memory.samples // 2, 1)
    return Residual(
        rms=max(one.motion.noise[name] for one in fits), unit=_UNITS[name],
        memory=memory.samples * step,
        at=(lag * step, float(memory.correlation[lag - 1])) if memory.samples else (0.0, 0.0),
        faults=faults,
    )  # fmt: skip


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
            name=_COLUMNS[name], unit=_UNITS[name], t=t[every],
            measured=getattr(record, _COLUMNS[name])[every], fitted=fitted[every],
        )  # fmt: skip


def _following(numbers: list[Number], unknown: dict[str, str], fits: Fits) -> str:
    """Return what to measure next."""
    if not numbers:
        return ""
    if _LOAD_UP in unknown.values():
        return "Begin the record before the command, with the spring relaxed: for static friction."
    widest = max(numbers, key=lambda number: number.width)
    cycles = sum(len(one.motion.run.highs) for one in fits)
    return (
        f"{4 * cycles} cycles in place of {cycles} halve the interval of {widest.name}, the widest."
    )
