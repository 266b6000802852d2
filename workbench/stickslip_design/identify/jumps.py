"""What a record of stick-slip tells, and what it cannot."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from scipy.stats import chi2
from scipy.stats import t as student

from stickslip_score import by_cycle

from ..axis import Axis
from .block import Block, fitted, measured, noise_of, one_by_one, reweighted, shown
from .cycles import Run, runs_of
from .looped import Loop, fitted_loop, settled
from .model import Floats, Identified, Number, Record, Residual, Trace
from .nonlinear import Fitted, fit

_MODEL: Final = 5e-4
"""Of a number of a servo axis: what its simulation leaves open."""
_SPARSE: Final = 1.0
"""Radians of the slip between two samples, above which it is not seen."""
_USUAL, _OFF = (1e-3, 3.0), 30.0
"""Static coefficients that there are, and how far a mass may be off that of an axis file."""
_MUCH: Final = 0.3
"""Of the time in which the command moves: in cycles."""
_EVENLY, _VERY_EVENLY = 0.4, 0.1
"""Deviation of the times from cycle to cycle, over their mean: cycles; and beyond doubt."""
_TOGETHER, _COUNTS = 0.3, 4.0
"""Correlation of force and spring, and counts of an encoder by which that falls in a slip."""
_SURELY: Final = 1e-6
"""Chance of a finding that is none: of a drift, a delay, another speed."""


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
    if lasts < _MUCH * sum(float(run.t[-1] - run.t[0]) for run in every):
        return ""
    if not runs:
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
    if run.x is None or math.isnan(run.speed):
        return True
    behind = run.speed * run.t - run.x
    doubtful = run.F is not None and uneven > _VERY_EVENLY
    if doubtful and np.corrcoef(behind, run.F)[0, 1] < _TOGETHER:
        return False
    pairs = min(len(highs), len(lows))
    fall = np.diff([np.interp(at[:pairs], run.t, run.x) for at in (highs, lows)], axis=0)
    fall = fall - run.speed * (lows - highs[:pairs])
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
_FORCES: Final = (
    "axis.stiffness",
    "axis.mass",
    "axis.c",
    "F_s - F_k",
    "friction.F_s",
    "friction.F_k",
)


def number_of(name: str, value: float, low: float, high: float, why: str = "") -> Number:
    """Return a number by its name."""
    meaning, unit = _MEANINGS[name]
    if name in ("c/m", "axis.c"):
        # Friction brakes: below 0 noise alone has moved it.
        value, low, high = max(value, 0.0), max(low, 0.0), max(high, high - value, 0.0)
    return Number(
        name=name, meaning=meaning, unit=unit, value=value, low=low, high=high,
        scales=name in _FORCES, why=why,
    )  # fmt: skip


def _of_block(record: Record, axis: Axis | None, runs: list[Run], reason: str) -> Identified:
    told = _Told(notes=list(record.notes))
    block = Block(tuple(runs), (False,) * len(runs), noise_of(record, runs))
    block, found = _with_extras(*fitted(block), told)
    cycles = sum(len(run.highs) for run in block.runs)
    told.faults += _faults(_phases(block, found.value), found)
    by_cycle_ = bool(told.faults)
    if by_cycle_:
        block, found = one_by_one(block, found)
    _tell(block, found, axis, by_cycle_, told)
    _doubt(axis, told)
    _tell_gaps(block, found, by_cycle_, told)
    return Identified(
        kind="stick-slip", reason=reason, numbers=tuple(told.numbers), untold=tuple(told.untold),
        residual=_residual(block, found, tuple(told.faults)), traces=_traces(record, block, found),
        segments=_segments(block, found), notes=tuple(told.notes),
        following=_following(told, cycles),
    )  # fmt: skip


def _with_extras(block: Block, found: Fitted, told: _Told) -> tuple[Block, Fitted]:
    """Return the fit with what else the record shows: a drift, a delay, another speed."""
    both = block.has_force and block.runs[0].x is not None
    tried: list[tuple[str, tuple[str, ...]]] = []
    if block.has_force:
        tried.append(("drift", ("drift 1", "drift 2", "drift 3")))
    if both:
        tried.append(("delay", ("delay",)))
    if block.runs[0].x is not None and not math.isnan(block.runs[0].speed):
        tried.append(("speed", ("v",)))
    for extra, names in tried:
        wider = replace(block, extras=block.extras | {extra})
        _, one = reweighted(
            wider, fit(wider.columns, wider.jacobian, wider.carried(block, found.value))
        )
        at = [place[name] for _, _, place in wider.places() for name in names]
        zero = (
            [math.log(run.speed) for run in block.runs] if extra == "speed" else np.zeros(len(at))
        )
        moved, some = one.value[at] - zero, one.covariance[np.ix_(at, at)]
        size = float(moved @ np.linalg.pinv(some, hermitian=True) @ moved)
        if chi2.sf(size, len(at)) > _SURELY:
            continue
        block, found = reweighted(wider, one)
        if extra == "speed":
            share = math.exp(float(np.median(moved)))
            told.faults.append(
                f"the table moves at {share:.4g} times the speed of the command: "
                "a unit, or a drive that slips"
            )
        elif extra == "delay":
            told.notes.append(
                f"the force is {1e3 * float(np.median(moved)):.3g} ms behind the position"
            )
        else:
            told.notes.append("the zero of the force drifts: it tells differences of forces only")
    return block, found


def _phases(block: Block, n: Floats) -> Iterator[tuple[Run, Floats, float]]:
    """Yield runs, the times since their first break-away, and their period [s]."""
    for run, continued, place in block.places():
        period = block.solution(run, continued, place, n).figures()["period"]
        yield run, run.t - n[place["t_break"]], period


def _faults(phases: Iterable[tuple[Run, Floats, float]], found: Fitted) -> list[str]:
    """Return what the residual shows that the model has not.

    Of runs the times since their first break-away, and their period [s].
    """
    parts = iter(zip(found.residual, found.memory, strict=True))
    shapes, wanders, ends = set(), False, False
    for run, after, period in phases:
        for name in shown(run):
            r, memory = next(parts)
            if math.isnan(period):
                ends = True
                continue
            step = float(np.median(np.diff(run.t)))
            repeats, _ = by_cycle(run.t, r, after, period)
            count = math.floor(float(after[-1]) / period)
            if repeats and count >= 3:
                shapes.add(name)
            wanders |= memory.samples * step > period
    names = " and ".join({"x": "position", "F": "force"}[name] for name in sorted(shapes))
    faults = []
    if ends:
        faults.append("the nearest motion of the block does not stick again")
    if shapes:
        faults.append(
            f"the residual of the {names} repeats from cycle to cycle: "
            "friction or spring are not of the block's kind"
        )
    if wanders:
        faults.append("the cycles are not alike: break-away or zero wander from cycle to cycle")
    return faults


Of = Callable[[Floats], float]


def _tell(block: Block, found: Fitted, axis: Axis | None, singly: bool, told: _Told) -> None:
    """Add the numbers of spring, mass and friction, with their intervals."""
    known_speed = "v" in next(block.places())[2] or not math.isnan(block.runs[0].speed)

    def w2(n: Floats) -> float:
        return math.exp(2.0 * n[0])

    def c_m(n: Floats) -> float:
        return 2.0 * float(n[1]) * math.exp(n[0])

    def k(n: Floats) -> float:
        return math.exp(n[2])

    gaps = [_gap_of(block, *one) for one in block.places()]
    _add(told, found, "k/m", [w2])
    _add(told, found, "c/m", [c_m])
    if known_speed:
        _add(told, found, "gap", gaps, singly)
    else:
        told.untold.append(
            ("gap", "the speed of the spring's end is not in the record: state one feed")
        )
    if block.has_force:
        if known_speed:
            _add(told, found, "axis.stiffness", [k])
            _add(told, found, "axis.mass", [lambda n: k(n) / w2(n)])
            _add(told, found, "axis.c", [lambda n: c_m(n) * k(n) / w2(n)])
        else:
            told.untold.append(
                ("axis.stiffness", "it is the slope of the force over the feed, which is not known")
            )
        _tell_forces(block, found, axis, gaps, singly, told)
    else:
        _tell_coefficients(block, found, axis, gaps, told)


def _doubt(axis: Axis | None, told: _Told) -> None:
    """Say where numbers are beyond all that is usual: a column has another unit."""
    value = {number.name: number.value for number in told.numbers}
    m, F_s = value.get("axis.mass"), value.get("friction.F_s")
    mu_s = F_s / (m * (axis.g if axis else 9.81)) if m and F_s else value.get("friction.mu_s")
    if mu_s is not None and not _USUAL[0] < mu_s < _USUAL[1]:
        told.faults.append(
            f"a static friction coefficient of {mu_s:.3g}: a column has another unit"
        )
    if axis and m and not 1.0 / _OFF < m / axis.m < _OFF:
        told.faults.append(
            f"the mass comes out {m / axis.m:.3g} times that of the axis file: "
            "a column has another unit"
        )


def _tell_forces(
    block: Block, found: Fitted, axis: Axis | None, gaps: list[Of], singly: bool, told: _Told
) -> None:
    def fall_by(gap: Of) -> Of:
        return lambda n: math.exp(n[2]) * gap(n)

    def level(at: int, by: float) -> Of:
        return lambda n: float(n[at]) + by

    def less(one: Of, other: Of) -> Of:
        return lambda n: one(n) - other(n)

    falls = [fall_by(gap) for gap in gaps]
    _add(told, found, "F_s - F_k", falls, singly)
    if "drift" in block.extras:
        told.untold += [
            (name, "the zero of the force drifts") for name in ("friction.F_s", "friction.F_k")
        ]
        return
    along = axis.along if axis else 0.0
    breaks = [level(place["F_b"], run.sign * along) for run, _, place in block.places()]
    why = "the zero of the force is taken as true"
    _add(told, found, "friction.F_s", breaks, singly, why)
    slides = [less(F, fall) for F, fall in zip(breaks, falls, strict=True)]
    _add(told, found, "friction.F_k", slides, singly, why)
    if axis is None or axis.along == 0.0:
        told.notes.append("a constant force along the way, if there is one, is in the friction")


def _tell_coefficients(
    block: Block, found: Fitted, axis: Axis | None, gaps: list[Of], told: _Told
) -> None:
    run, _, place = next(block.places())
    if run.start == -math.inf:
        why = "the position tells (F_s - F_k)/k; a load-up from a relaxed spring tells them apart"
        told.untold += [(name, why) for name in ("friction.mu_s", "friction.mu_k")]
        return
    g, load, m = (axis.g, axis.load, axis.m) if axis else (9.81, 0.0, 1.0)
    along = run.sign * axis.along / m if axis else 0.0

    def mu_s(n: Floats) -> float:
        way = run.speed * (float(n[place["t_break"]]) - run.start)
        return (math.exp(2.0 * n[0]) * way + along) / (g + load / m)

    def mu_k(n: Floats) -> float:
        return mu_s(n) - math.exp(2.0 * n[0]) * gaps[0](n) / (g + load / m)

    why = "the spring is taken as relaxed before the command begins"
    _add(told, found, "friction.mu_s", [mu_s], why=why)
    _add(told, found, "friction.mu_k", [mu_k], why=why)


def _gap_of(block: Block, run: Run, continued: bool, place: dict[str, int]) -> Of:
    def gap(n: Floats) -> float:
        s = block.solution(run, continued, place, n)
        return s.D + 2.0 * s.zeta * s.v / s.w

    return gap


def _add(
    told: _Told, found: Fitted, name: str, of: list[Of], singly: bool = False, why: str = ""
) -> None:
    """Add a number: the mean over runs, wider where they differ."""
    if len(of) == 1:
        told.numbers.append(number_of(name, *found.interval(of[0]), why))
        return
    values = np.array([one(found.value) for one in of])
    spread = np.array([max(found.deviation(one), 1e-300) for one in of])
    weight = np.ones(len(of)) if singly else spread**-2.0
    weight /= weight.sum()
    value, low, high = found.interval(
        lambda n: float(sum(w * one(n) for w, one in zip(weight, of, strict=True)))
    )
    half = 0.0
    if singly:
        half = float(student.ppf(0.975, len(of) - 1) * np.std(values, ddof=1) / math.sqrt(len(of)))
    elif chi2.sf(float(np.sum(((values - value) / spread) ** 2)), len(of) - 1) < 1e-3:
        half, why = float(np.max(np.abs(values - value))), "it differs from feed to feed"
    low, high = value - math.hypot(value - low, half), value + math.hypot(high - value, half)
    told.numbers.append(number_of(name, value, low, high, why))


def _tell_gaps(block: Block, found: Fitted, singly: bool, told: _Told) -> None:
    """Say how the gap goes with the feed, by Akaike's criterion for few numbers."""
    if singly or len(block.runs) < 2:
        return
    if len(block.runs) < 4:
        told.untold.append(
            ("how friction ages", "fewer than four feeds do not tell how the gap goes with them")
        )
        return
    of = [_gap_of(block, *one) for one in block.places()]
    gap = np.array([one(found.value) for one in of])
    weight = 1.0 / np.array([found.deviation(one) for one in of])
    motions = [block.solution(*one, found.value) for one in block.places()]
    rest = np.array([s.relief / s.v for s in motions])
    peak = np.array([s.v + s.w * s.swing() for s in motions])
    one = np.ones_like(gap)
    laws = {
        "the gap is the same at all feeds": [one],
        "the gap grows with the logarithm of the time at rest": [one, np.log(rest)],
        "the gap falls with the speed of the slip": [one, peak],
    }
    n, scores = gap.size, {}
    for law, columns in laws.items():
        X = np.stack(columns, axis=1) * weight[:, None]
        b, *_ = np.linalg.lstsq(X, gap * weight, rcond=None)
        p = len(columns)
        signed = p == 1 or (b[1] > 0.0) == ("grows" in law)
        square = float(np.sum((gap * weight - X @ b) ** 2))
        scores[law] = square + 2.0 * p + 2.0 * p * (p + 1) / (n - p - 1) if signed else math.inf
    best, following = sorted(scores, key=lambda law: scores[law])[:2]
    told.notes.append(best)
    if scores[following] - scores[best] < 4.0:
        told.untold.append(
            ("how friction ages", f"{best}, or {following}: these feeds do not tell")
        )


def _residual(block: Block, found: Fitted, faults: tuple[str, ...]) -> Residual:
    """Return what the fit leaves, of the force where there is one."""
    name = "F" if block.has_force else "x"
    names = [one for run in block.runs for one in shown(run)]
    of = [(r, m) for r, m, n in zip(found.residual, found.memory, names, strict=True) if n == name]
    _, memory = max(of, key=lambda one: one[0].size)
    step = float(np.median(np.diff(block.runs[0].t)))
    lag = max(memory.samples // 2, 1)
    rms = block.noise[name] * math.sqrt(float(np.mean(np.concatenate([one for one, _ in of]) ** 2)))
    return Residual(
        rms=rms, unit="N" if name == "F" else "m", memory=memory.samples * step,
        at=(lag * step, float(memory.correlation[lag - 1])) if memory.samples else (0.0, 0.0),
        faults=faults,
    )  # fmt: skip


_DRAWN: Final = 3000


def _traces(record: Record, block: Block, found: Fitted) -> tuple[Trace, ...]:
    traces = []
    every = slice(None, None, -(-record.t.size // _DRAWN))
    t = record.t[every]
    for name, column, unit in (("F", "force", "N"), ("x", "position", "m")):
        measured, drawn = getattr(record, column), np.full(t.size, math.nan)
        if measured is None:
            continue
        for run, continued, place in block.places():
            here = (t >= run.t[0]) & (t <= run.t[-1])
            some = [None if s is None else np.zeros(int(here.sum())) for s in (run.x, run.F)]
            at = replace(run, t=t[here], x=some[0], F=some[1])
            if here.any():
                seems = block.of_run(at, continued, place, found.value)
                drawn[here] = run.sign * seems[shown(run).index(name)]
        traces.append(Trace(name=column, unit=unit, t=t, measured=measured[every], fitted=drawn))
    return tuple(traces)


def _segments(block: Block, found: Fitted) -> tuple[tuple[float, float, str], ...]:
    segments = []
    for (run, _, place), (_, _, period) in zip(
        block.places(), _phases(block, found.value), strict=True
    ):
        if math.isnan(period):
            continue
        t_slip = block.solution(run, False, place, found.value).t_slip
        begin = float(found.value[place["t_break"]])
        for i in range(len(run.highs)):
            at = begin + i * period
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
    told = _Told(notes=list(record.notes))
    run = settled(run)
    if math.isnan(run.speed):
        speed = float(np.polyfit(run.t, run.x, 1)[0]) if run.x is not None else math.nan
        run = replace(run, speed=speed)
    loop = Loop(axis, run, noise_of(record, [run]))
    loop, found = fitted_loop(loop)
    names = shown(run)
    place = {name: i for i, name in enumerate(loop.names)}
    motion = loop.simulated(found.value)
    if motion is None:
        raise ValueError(
            "the axis as its file states it does not jump at this feed: nothing to fit"
        )
    told.faults += _faults([(run, run.t - found.value[place["t_break"]], motion.period)], found)
    slope, best = loop.slope_of_gap(found.value), motion.gap

    def log_gap(n: Floats) -> float:
        return best + float(slope @ (n - found.value))

    of: dict[str, Of] = {
        "k/m": lambda n: math.exp(n[1] - n[0]),
        "c/m": lambda n: 2.0 * float(n[2]) * math.exp(0.5 * (n[1] - n[0])),
        "gap": lambda n: math.exp(log_gap(n) - n[1]),
        "axis.stiffness": lambda n: math.exp(n[1]),
        "axis.mass": lambda n: math.exp(n[0]),
        "axis.c": lambda n: 2.0 * float(n[2]) * math.exp(0.5 * (n[1] + n[0])),
        "F_s - F_k": lambda n: math.exp(log_gap(n)),
    }
    if "F_0" not in place:
        why = "without the force of the motor its level is not in the record"
        told.untold += [(name, why) for name in ("friction.F_s", "friction.F_k")]
    else:
        of["friction.F_k"] = lambda n: axis.F_k + float(n[place["F_0"]])
        of["friction.F_s"] = lambda n: axis.F_k + float(n[place["F_0"]]) + math.exp(log_gap(n))
    for name, one in of.items():
        value, low, high = found.interval(one)
        if not math.isfinite(high - low):
            told.untold.append((name, "near these numbers the axis does not jump in rows"))
            continue
        # The simulation, and where between two samples of the drive a break-away falls.
        least = _MODEL * (math.exp(best) if name.startswith("friction") else abs(value))
        low, high = value - math.hypot(value - low, least), value + math.hypot(high - value, least)
        told.numbers.append(number_of(name, value, low, high))
    w = math.exp(0.5 * float(found.value[1] - found.value[0]))
    if w * float(np.median(np.diff(run.t))) > _SPARSE:
        told.faults.append("the samples are too far apart to show a slip")
    if not found.left_is_little:
        told.faults.append(
            "no motion of the loop is like the record: the search did not come to an end"
        )
    step = float(np.median(np.diff(run.t)))
    seen = zip(names, measured(run), found.residual, strict=True)
    traces = tuple(
        Trace(
            name={"x": "position", "F": "force"}[name], unit={"x": "m", "F": "N"}[name], t=run.t,
            measured=run.sign * s, fitted=run.sign * (s - loop.noise[name] * r),
        )
        for name, s, r in seen
    )  # fmt: skip
    residual = Residual(
        rms=loop.noise[names[-1]], unit="N" if names[-1] == "F" else "m",
        memory=found.memory[-1].samples * step, faults=tuple(told.faults),
    )  # fmt: skip
    return Identified(
        kind="stick-slip", reason=reason, numbers=tuple(told.numbers), untold=tuple(told.untold),
        residual=residual, traces=traces,
        segments=((float(run.t[0]), float(run.t[-1]), "settled jumps"),),
        notes=tuple(told.notes), following=_following(told, len(run.highs)),
    )  # fmt: skip
