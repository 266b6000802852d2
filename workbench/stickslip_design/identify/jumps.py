"""What a record of stick-slip tells, and what it cannot."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from scipy.stats import chi2
from scipy.stats import t as student

from stickslip_score import Solution, by_cycle

from ..axis import Axis
from .block import DRIFTS as _DRIFTS
from .block import Block, fitted, measured, noise_of, one_by_one, shown
from .cycles import Run, runs_of
from .looped import begun, fitted_loop
from .model import Floats, Identified, Number, Record, Residual, Trace
from .nonlinear import Fitted

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
    spans = np.diff(highs)
    uneven = float(np.std(spans) / np.mean(spans)) if len(spans) > 2 else math.inf
    if _EVENLY < uneven < math.inf:
        return False
    if run.x is None:
        return True
    speed = run.speed
    if math.isnan(speed):
        # Without a command the table goes one way.
        if abs(run.x[-1] - run.x[0]) < _ONE_WAY * np.ptp(run.x):
            return False
        speed = float(np.polyfit(run.t, run.x, 1)[0])
    behind = speed * run.t - run.x
    doubtful = run.F is not None and uneven > _VERY_EVENLY
    if doubtful and np.corrcoef(behind, run.F)[0, 1] < _TOGETHER:
        return False
    pairs = min(len(highs), len(lows))
    fall = np.diff([np.interp(at[:pairs], run.t, run.x) for at in (highs, lows)], axis=0)
    fall = fall - speed * (lows - highs[:pairs])
    return float(np.median(fall)) > _COUNTS * 2.0 * record.rounding.get("position", 0.0)


def stick_slip(record: Record, axis: Axis | None = None) -> Identified:
    """Return what a record of stick-slip tells; ValueError if it shows fewer than two slips."""
    runs = runs_of(record, axis)
    reason = is_stick_slip(record, axis)
    found = [run for run in runs if not run.still]
    if not found:
        raise ValueError(f"no two slips in a row: {runs[0].still}")
    if axis is not None and axis.drive is not None:
        return _of_servo(record, axis, max(found, key=lambda run: len(run.lows)), reason)
    return _of_block(record, axis, found, reason)


@dataclass
class _Told:
    """Numbers that are told, and what is not."""

    numbers: list[Number] = field(default_factory=list)
    untold: list[tuple[str, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)


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


def number_of(name: str, value: float, low: float, high: float, why: str = "") -> Number:
    """Return a number by its name."""
    meaning, unit = _MEANINGS[name]
    if name in ("c/m", "axis.c"):
        # Friction brakes: below 0 noise alone has moved it.
        value, low, high = max(value, 0.0), max(low, 0.0), max(high, high - value, 0.0)
    return Number(
        name=name, meaning=meaning, unit=unit, value=value, low=low, high=high,
        why=why,
    )  # fmt: skip


def _of_block(record: Record, axis: Axis | None, runs: list[Run], reason: str) -> Identified:
    told = _Told()
    block = Block(tuple(run.from_rest() for run in runs), noise_of(record, runs))
    own = block.noise
    block, found = _with_extras(*fitted(block), told)
    cycles = sum(len(run.highs) for run in block.runs)
    told.faults += _faults(_phases(block, found.value), found)
    told.faults += _misfits(block, found, own)
    singly, drifts = bool(told.faults), _DRIFTS[0] in block.extras
    if singly:
        block, found = one_by_one(block, found)
    _tell(block, found, axis, singly, drifts, told)
    return Identified(
        kind="stick-slip", reason=reason, numbers=tuple(told.numbers), missing=tuple(told.untold),
        residual=_residual(block, found, tuple(told.faults)), traces=_traces(record, block, found),
        segments=_segments(block, found), notes=tuple(told.notes),
        next_measurement=_following(told, cycles),
    )  # fmt: skip


def _with_extras(block: Block, found: Fitted, told: _Told) -> tuple[Block, Fitted]:
    """Return the fit with what else the record shows: a drift of the force, or a delay."""
    both = block.has_force and block.runs[0].x is not None
    for names in (_DRIFTS,) * block.has_force + (("delay",),) * both:
        wider = replace(block, extras=(*block.extras, *names))
        wider, one = wider.fitted(wider.carried(block, found.value))
        at = [place[name] for _, place in wider.places() for name in names]
        moved, some = one.value[at], one.covariance[np.ix_(at, at)]
        if chi2.sf(moved @ np.linalg.pinv(some, hermitian=True) @ moved, len(at)) > _SURELY:
            continue
        block, found = wider, one
        told.notes.append(
            f"the force is {1e3 * float(np.median(moved)):.3g} ms behind the position"
            if names == ("delay",)
            else "the zero of the force drifts: it tells differences of forces only"
        )
    return block, found


def _phases(block: Block, n: Floats) -> list[tuple[Run, Floats, float]]:
    """Return runs, the times since their first break-away, and their period [s]."""
    return [
        (run, run.t - n[place["t_break"]], motion.figures()["period"])
        for (run, place), motion in zip(block.places(), block.solutions(n), strict=True)
    ]


def _faults(phases: Iterable[tuple[Run, Floats, float]], found: Fitted) -> list[str]:
    """Return what the residual shows that the model has not.

    Of runs the times since their first break-away, and their period [s].
    """
    parts = iter(zip(found.residual, found.memory, strict=True))
    shapes, wanders, ends = set(), False, False
    for run, after, period in phases:
        for name in shown(run):
            r, memory = next(parts)
            ends |= math.isnan(period)
            if math.isnan(period) or np.mean(r * r) < _NOTHING:
                continue
            step = float(np.median(np.diff(run.t)))
            if by_cycle(run.t, r, after, period)[0] and after[-1] >= 3.0 * period:
                shapes.add(_COLUMNS[name])
            wanders |= memory.samples * step > period
    faults = ["the nearest motion of the block does not stick again"] * ends
    if shapes:
        faults.append(
            f"the residual of the {' and '.join(sorted(shapes))} repeats from cycle to cycle: "
            "friction or spring are not of the block's kind"
        )
    if wanders:
        faults.append("the cycles are not alike: break-away or zero wander from cycle to cycle")
    return faults


def _misfits(block: Block, found: Fitted, own: dict[str, float]) -> list[str]:
    """Return where the fit leaves far more than the `own` noise, or the table creeps in stick."""
    faults = [
        f"the fit leaves {block.noise[name] / own[name]:.2g} times the noise of the "
        f"{_COLUMNS[name]}: the cycles are not those of one block"
        for name in own
        if block.noise[name] > _FAR * own[name]
    ]
    if any(
        math.isinf(replace(s, zeta=s.zeta + _EDGE).t_slip) for s in block.solutions(found.value)
    ):
        faults.append("the fit ends where a slip would slide on: damping and gap are not told")
    J, creep = np.concatenate(found.jacobian(found.value)), []
    phases = zip(_phases(block, found.value), block.solutions(found.value), strict=True)
    for (run, after, period), motion in phases:
        within, t_slip = after % period, motion.t_slip
        rise = (within - t_slip) / (period - t_slip) - 0.5
        way = np.where(within < t_slip, 0.5 - within / t_slip, rise) * (after >= 0.0)
        by = {"x": 1.0, "F": -math.exp(found.value[2])}
        creep += [way * by[name] / block.noise[name] for name in shown(run)]
    if not faults and np.isfinite(np.concatenate(creep)).all():
        # Only what the numbers of the block cannot follow tells a creep.
        J, seen = J / (np.linalg.norm(J, axis=0) + 1e-300), np.concatenate(creep)
        seen -= J @ np.linalg.lstsq(J, seen, rcond=None)[0]
        longest = max(memory.samples for memory in found.memory)
        far = abs(seen @ np.concatenate(found.residual)) / np.linalg.norm(seen)
        if far > _CREEPS * math.sqrt(1.0 + 2.0 * longest):
            faults.append("the table creeps between its slips: friction is not of Coulomb's kind")
    return faults


def _values(block: Block, axis: Axis | None, n: Floats) -> dict[str, Floats]:
    """Return the numbers that the columns of a block show, of each run."""
    motions, places = block.solutions(n), [place for _, place in block.places()]
    w2, run = motions[0].w ** 2, block.runs[0]
    c_m = 2.0 * float(n[1]) * motions[0].w
    g, load, m = (axis.g, axis.load, axis.m) if axis else (9.81, 0.0, 1.0)
    along = run.sign * axis.along if axis else 0.0
    gap = np.array([s.D + 2.0 * s.zeta * s.v / s.w for s in motions])
    values = {"k/m": np.array([w2]), "c/m": np.array([c_m]), "gap": gap}
    if block.has_force:
        k = math.exp(n[2])
        F_s = np.array([n[place["F_b"]] for place in places]) + along
        values |= {"axis.stiffness": np.array([k]), "axis.mass": np.array([k / w2])}
        values |= {"axis.c": np.array([c_m * k / w2]), "F_s - F_k": k * gap}
        values |= {"friction.F_s": F_s, "friction.F_k": F_s - k * gap}
    elif run.start > -math.inf:
        way = run.speed * (n[places[0]["t_break"]] - run.start)
        mu_s, per = w2 * way + along / m, g + load / m
        values["friction.mu_s"] = np.array([mu_s / per])
        values["friction.mu_k"] = np.array([(mu_s - w2 * gap[0]) / per])
    return values


def _tell(
    block: Block, found: Fitted, axis: Axis | None, singly: bool, drifts: bool, told: _Told
) -> None:
    """Add the numbers that a record tells, each the mean over runs, wider where they differ."""
    values = _values(block, axis, found.value)
    if math.isnan(block.runs[0].speed) and block.runs[0].x is None:
        why = "the speed of the spring's end is not in the record: state one feed"
        told.untold += [(name, why) for name in _BY_SPEED if values.pop(name, None) is not None]
    if drifts:
        why = "the zero of the force drifts"
        told.untold += [(name, why) for name in _LEVELS if values.pop(name, None) is not None]
    for name, own in values.items():

        def of(n: Floats, name: str = name) -> Floats:
            return _values(block, axis, n)[name]

        slopes = found.gradient(of)
        covariance = slopes.T @ found.covariance @ slopes
        spread = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        weight = np.ones(own.size) if singly else spread**-2.0
        weight /= weight.sum()
        value, half, why = float(weight @ own), 0.0, _WHYS.get(name, "")
        deviation = math.sqrt(max(float(weight @ covariance @ weight), 0.0))
        _, low, high = found.ends(value, deviation)
        if own.size > 1 and singly:
            half = float(student.ppf(0.975, own.size - 1) * np.std(own, ddof=1) / own.size**0.5)
        elif chi2.sf(np.sum(((own - value) / spread) ** 2), own.size - 1) < _DIFFERS:
            half, why = float(np.max(np.abs(own - value))), "it differs from feed to feed"
        low, high = value - math.hypot(value - low, half), value + math.hypot(high - value, half)
        told.numbers.append(number_of(name, value, low, high, why))
        if name == "gap" and own.size > 1 and not singly:
            _tell_gaps(own, spread, block.solutions(found.value), told)
    if not block.has_force and "friction.mu_s" not in values:
        why = "the position tells (F_s - F_k)/k; a load-up from a relaxed spring tells them apart"
        told.untold += [(name, why) for name in _COEFFICIENTS]
    if block.has_force and not drifts and (axis is None or axis.along == 0.0):
        told.notes.append("a constant force along the way, if there is one, is in the friction")


def _tell_gaps(gap: Floats, spread: Floats, motions: list[Solution], told: _Told) -> None:
    """Say how the gap goes with the feed, by Akaike's criterion for few numbers."""
    if len(gap) < 4:
        why = "fewer than four feeds do not tell how the gap goes with them"
        told.untold.append(("how friction ages", why))
        return
    laws = {
        "the gap is the same at all feeds": 0.0 * gap,
        "the gap grows with the logarithm of the time at rest": np.log(
            [s.relief / s.v for s in motions]
        ),
        "the gap falls with the speed of the slip": -np.array(
            [s.v + s.w * s.swing() for s in motions]
        ),
    }
    n, scores = len(gap), {}
    for law, by in laws.items():
        X, p = np.stack([gap**0, by], axis=1) / spread[:, None], 1 + bool(by.any())
        b, *_ = np.linalg.lstsq(X, gap / spread, rcond=None)
        square = float(np.sum((gap / spread - X @ b) ** 2))
        scores[law] = square + 2.0 * p * n / (n - p - 1) if b[1] >= 0.0 else math.inf
    best, following = sorted(scores, key=lambda law: scores[law])[:2]
    told.notes.append(best)
    if scores[following] - scores[best] < _CLEARLY:
        told.untold.append(
            ("how friction ages", f"{best}, or {following}: these feeds do not tell")
        )


def _residual(block: Block, found: Fitted, faults: tuple[str, ...]) -> Residual:
    """Return what the fit leaves, of the force where there is one."""
    name = "F" if block.has_force else "x"
    names = [one for run in block.runs for one in shown(run)]
    of = [m for m, n in zip(found.memory, names, strict=True) if n == name]
    memory = max(of, key=lambda one: one.correlation.size)
    step, lag = float(np.median(np.diff(block.runs[0].t))), max(memory.samples // 2, 1)
    return Residual(
        rms=block.noise[name], unit=_UNITS[name], memory=memory.samples * step,
        at=(lag * step, float(memory.correlation[lag - 1])) if memory.samples else (0.0, 0.0),
        faults=faults,
    )  # fmt: skip


def _traces(record: Record, block: Block, found: Fitted) -> tuple[Trace, ...]:
    traces, t = [], record.t
    drawn = {name: np.full(t.size, math.nan) for name in shown(block.runs[0])}
    for run, model in zip(block.runs, block.columns_of(found.value), strict=True):
        inside = (t >= run.t[0]) & (t <= run.t[-1])
        for name, seems in zip(shown(run), model, strict=True):
            drawn[name][inside] = run.sign * np.interp(t[inside], run.t, seems)
    for name, fitted_ in drawn.items():
        measured_, every = getattr(record, _COLUMNS[name]), slice(None, None, -(-t.size // _DRAWN))
        traces.append(
            Trace(
                name=_COLUMNS[name], unit=_UNITS[name], t=t[every], measured=measured_[every],
                fitted=fitted_[every],
            )
        )  # fmt: skip
    return tuple(traces)


def _segments(block: Block, found: Fitted) -> tuple[tuple[float, float, str], ...]:
    segments = []
    phases = zip(_phases(block, found.value), block.solutions(found.value), strict=True)
    for (run, after, period), motion in phases:
        begin, t_slip = float(run.t[0] - after[0]), motion.t_slip
        for at in begin + period * np.arange(len(run.highs) if math.isfinite(period) else 0):
            segments += [(at, at + t_slip, "slips"), (at + t_slip, at + period, "rests")]
    return tuple(segments)


def _following(told: _Told, cycles: int) -> str:
    """Return what to measure next."""
    if not told.numbers:
        return ""
    widest = max(told.numbers, key=lambda number: number.width)
    if told.untold and "load-up" in told.untold[0][1]:
        return "Begin the record before the command, with the spring relaxed: for static friction."
    return (
        f"{4 * cycles} cycles in place of {cycles} halve the interval of {widest.name}, the widest."
    )


def _of_servo(record: Record, axis: Axis, run: Run, reason: str) -> Identified:
    """Return what a run tells of a servo axis."""
    told = _Told()
    if math.isnan(run.speed):
        speed = float(np.polyfit(run.t, run.x, 1)[0]) if run.x is not None else math.nan
        run = replace(run, speed=speed)
    if math.isnan(run.speed):
        raise ValueError("the feed is not in the record: state one feed")
    run = begun(run)
    loop, found, others = fitted_loop(axis, run, noise_of(record, [run]))
    run, place = loop.run, {name: i for i, name in enumerate(loop.names)}
    told.faults += _faults([(run, run.t - run.t[0], run.period)], found)
    of: dict[str, Callable[[Floats], float]] = {
        "k/m": lambda n: math.exp(n[1] - n[0]),
        "c/m": lambda n: float(n[2]) * loop.unit / math.exp(n[0]),
        "gap": lambda n: math.exp(n[3] - n[1]),
        "axis.stiffness": lambda n: math.exp(n[1]),
        "axis.mass": lambda n: math.exp(n[0]),
        "axis.c": lambda n: float(n[2]) * loop.unit,
        "F_s - F_k": lambda n: math.exp(n[3]),
    }
    if "F_k" not in place:
        why = "without the force of the motor its level is not in the record"
        told.untold += [(name, why) for name in ("friction.F_s", "friction.F_k")]
    else:
        of["friction.F_k"] = lambda n: float(n[place["F_k"]])
        of["friction.F_s"] = lambda n: float(n[place["F_k"]]) + math.exp(n[3])
    for name, one in of.items():
        value, low, high = found.interval(one)
        ends = [other.interval(one) for other in others]
        low, high = min([low, *(a for _, a, _ in ends)]), max([high, *(b for *_, b in ends)])
        why = "other numbers move the axis as well like this" if others else ""
        told.numbers.append(number_of(name, value, low, high, why))
    step = float(np.median(np.diff(run.t)))
    if math.exp(0.5 * float(found.value[1] - found.value[0])) * step > _SPARSE:
        told.faults.append("the samples are too far apart to show a slip")
    if not found.left_is_little:
        told.faults.append(
            "no motion of the loop is like the record: the search did not come to an end"
        )
    names = shown(run)
    seen = zip(names, measured(run), found.residual, strict=False)
    traces = tuple(
        Trace(
            name={"x": "position", "F": "force"}[name], unit={"x": "m", "F": "N"}[name], t=run.t,
            measured=run.sign * s, fitted=run.sign * (s - loop.noise[name] * r),
        )
        for name, s, r in seen
    )  # fmt: skip
    residual = Residual(
        rms=loop.noise[names[-1]], unit="N" if names[-1] == "F" else "m",
        memory=found.memory[len(names) - 1].samples * step, faults=tuple(told.faults),
    )  # fmt: skip
    return Identified(
        kind="stick-slip", reason=reason, numbers=tuple(told.numbers), missing=tuple(told.untold),
        residual=residual, traces=traces,
        segments=((float(run.t[0]), float(run.t[-1]), "settled jumps"),),
        notes=tuple(told.notes), next_measurement=_following(told, len(run.highs)),
    )  # fmt: skip
