"""A curve held against the law: as it should be, and as it might be instead."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip_score.fit import Fit, Samples, applied, fit, starts_in
from stickslip_score.law import Law, root
from stickslip_score.motion import Motion
from stickslip_score.phases import Phases
from stickslip_score.slide import Rest, rests_of

_COARSE = 0.2
"""Of a period: samples farther apart may have passed over a break-away before the first turn that
they show."""

_LEAST_SAMPLES = 5

_DRIFTS, _DRIFTS_IN_A_CYCLE = 8, 1.5
"""Degree of the polynomial that a sensor's zero may follow over a record, as it warms up, and the
most that a cycle may have of it, so that it is no motion."""


_DEVIATIONS = 3.0
"""Standard deviations that a gap must be off the exact one before damping is held to explain it."""

_LITTLE = 0.1
"""Of the distance from a law: what another explanation may leave of it."""


@dataclass(frozen=True)
class _Part:
    """Samples, a law, and the times between which its first break-away is [s].

    Where they are coarse, a mass and a gap together would explain anything.
    """

    samples: Samples
    law: Law
    window: tuple[float, float]
    coarse: bool = False

    def fit(self, law: Law, *free: str) -> Fit:
        return fit(self.samples, law, starts_in(self.samples, law, self.window), free)


def on_the_law(found: Fit, motion: Motion) -> bool:
    """Tell whether all samples lie on the law, to their digits or, where they have it, noise."""
    return found.by_digits or (motion.noise > 0.0 and found.white)


def hold_against(motion: Motion, phases: Phases, law: Law) -> dict[str, Fit]:
    """Hold the curve against the law: exact, one coefficient, free gap, gap and mass, damping.

    A curve on the exact law is held against the free gap besides; one that lies on a law
    with another gap is not held against another mass. A curve may start in a slip that no
    break-away began, or its samples may pass over its first cycle, so that the second turn of the
    spring may serve as well as the first, and cycles may have gone before. A curve that shows no
    turn, or hides its turns in noise, is searched whole. Where the law has no cycle, the spring
    need not turn, and the rests of the mass tell the break-away.
    """
    if math.isinf(law.t_slip):
        return _hold_without_cycle(motion, law)
    if phases.only_rests:
        return {}
    tried = []
    for alike in _alternatives(motion, phases, law):
        held = [(part.fit(part.law), part) for part in alike]
        tried += held
        # Noise hides a slip too many at either end, so that the nearer one is right.
        exact, part = min(held, key=lambda pair: pair[0].rms)
        if on_the_law(exact, motion):
            found = {"exact": exact, "gap": fit(part.samples, part.law, [exact.t_break], ["D"])}
            off = abs(found["gap"].law.D - law.D)
            if motion.noise and off > _DEVIATIONS * found["gap"].deviation("D"):
                found["damping"] = fit(part.samples, part.law, [exact.t_break], ["zeta"])
            return found
    if motion.noise:
        exact, part = min(tried, key=lambda pair: pair[0].rms)
        law = part.law
    else:
        parts = _parts(motion, phases, law)
        if not parts:
            return {}
        starts_at_rest = phases.sticks[0].begin is None if phases.sticks else False
        part = parts[0] if starts_at_rest else parts[-1]
        exact = part.fit(law)
    found = {"exact": exact}
    one = law.with_gap(-2.0 * law.zeta * law.v / law.w)
    found["one coefficient"] = part.fit(one)
    period = _period(phases)
    seeds = _seeds(law, period, "D", 1e-3 * law.v / law.w, 0.5 * law.v * period)
    found["gap"] = min((part.fit(seed, "D") for seed in seeds), key=_rms)
    lies = on_the_law(found["gap"], motion)
    if motion.noise or not (lies or part.coarse):
        damped = _seeds(law, period, "zeta", -0.3, 0.9)
        found["damping"] = min((part.fit(seed, "zeta") for seed in damped), key=_rms)
    if not (lies or part.coarse):
        seeds += _seeds(law, period, "w", 0.5 * law.w, 2.0 * law.w)[1:]
        found["gap and mass"] = min((part.fit(seed, "D", "w") for seed in seeds), key=_rms)
    if motion.from_force and not any(on_the_law(each, motion) for each in found.values()):
        found |= _with_drift(motion, part)
    return found


def _alternatives(motion: Motion, phases: Phases, law: Law) -> Iterator[list[_Part]]:
    """Give parts of the curve with the law as it may have begun there, the likeliest first.

    Noise may show turns where the spring has none, so that the whole comes first there.
    """
    before = replace(law, continued=True)
    period = law.quantities()["period"]
    t = motion.t
    first_turn = phases.high_times[0] if phases.high_times.size else t[-1]
    samples = _samples(motion, 0)
    whole = [
        _Part(samples, before, (float(t[0]) - period, float(t[0]))),
        _Part(samples, law, (float(t[0]), float(min(first_turn + period, t[-1])))),
    ]
    cut = [[part] for way in (law, before) for part in _parts(motion, phases, way)]
    yield from [whole, *cut] if motion.noise else [*cut, whole]


def _samples(motion: Motion, first: int) -> Samples:
    return Samples(motion.t[first:], motion.y[first:], motion.digits)


def _with_drift(motion: Motion, part: _Part) -> dict[str, Fit]:
    """Hold a curve that comes from the force against the exact law on a zero that drifts."""
    t = part.samples.t
    cycles = float(t[-1] - t[0]) / part.law.quantities()["period"]
    drifts = max(1, min(_DRIFTS, math.floor(_DRIFTS_IN_A_CYCLE * cycles)))
    drifting = replace(part, samples=replace(part.samples, drifts=drifts))
    ways = [replace(part.law, continued=way) for way in (False, True)]
    exact = min((drifting.fit(way) for way in ways), key=_rms)
    return {
        "drift": exact,
        "gap and drift": fit(drifting.samples, exact.law, [exact.t_break], ["D"]),
    }


def _hold_without_cycle(motion: Motion, law: Law) -> dict[str, Fit]:
    one = law.with_gap(-2.0 * law.zeta * law.v / law.w)
    found: dict[str, Fit] = {}
    for rest in rests_of(motion):
        exact = _departing(motion, rest, law)
        if exact is None:
            continue
        if on_the_law(exact, motion):
            return {"exact": exact, **_gap_beside(motion, rest, exact)}
        seeds = (_departing(motion, rest, seed, "D") for seed in (law, one))
        here = {
            "exact": exact,
            "one coefficient": _departing(motion, rest, one),
            "gap": min((fit for fit in seeds if fit), key=_rms, default=None),
        }
        for name, fitted in here.items():
            if fitted and (name not in found or fitted.rms < found[name].rms):
                found[name] = fitted
    return found


def _gap_beside(motion: Motion, rest: Rest, exact: Fit) -> dict[str, Fit]:
    """Hold a curve with noise against a free gap besides: noise may hide another one."""
    if not motion.noise:
        return {}
    return {"gap": fit(_samples(motion, rest.first), exact.law, [exact.t_break], ["D"])}


def _departing(motion: Motion, rest: Rest, law: Law, *free: str) -> Fit | None:
    """Fit a law that breaks away at the end of a rest; None where there is nothing to fit."""
    window = rest.window(motion, law)
    if window is None or motion.t.size - rest.first < _LEAST_SAMPLES:
        return None
    return _Part(_samples(motion, rest.first), law, window).fit(law, *free)


def explained_by_drift(fits: Mapping[str, Fit]) -> bool:
    """Tell whether a slow drift takes away nearly all distance from the exact law."""
    return "drift" in fits and fits["drift"].rms < _LITTLE * fits["exact"].rms


def _rms(found: Fit) -> float:
    return found.rms


def _parts(motion: Motion, phases: Phases, law: Law) -> Sequence[_Part]:
    """Return what begins before the first turns of the spring; empty where none is long enough."""
    highs = [index for index in range(min(phases.highs.size, 2)) if phases.high_samples[index] > 0]
    return [part for index in highs if (part := _part(motion, phases, law, index))]


def _part(motion: Motion, phases: Phases, law: Law, index: int) -> _Part | None:
    """Return the samples from the break-away before a turn on; None where they are too few."""
    high = max(int(np.searchsorted(motion.t, phases.high_times[index])), 1)
    begin = float(motion.t[high - 1]) - 1.5 * math.atan2(law.v, law.w * law.D) / law.w
    begin -= 2.0 * motion.blur
    period = law.quantities()["period"]
    coarse = float(np.median(np.diff(motion.t))) > _COARSE * period
    if coarse:
        begin -= period
    rested = _rested_since(phases, float(phases.highs[index]))
    first = int(np.searchsorted(motion.t, max(begin, rested)))
    if motion.t.size - first < _LEAST_SAMPLES:
        return None
    window = (begin, float(motion.t[min(high + 1, motion.t.size - 1)]) + motion.blur)
    return _Part(_samples(motion, first), law, window, coarse)


def _rested_since(phases: Phases, z_high: float) -> float:
    """Return from when on the mass rests before this turn [s]; minus infinity where unknown."""
    for stick in phases.sticks:
        if stick.z_high == z_high and stick.rests and stick.begin is not None:
            return stick.begin.high
    return -math.inf


def _period(phases: Phases) -> float:
    """Return the mean time between the turns of the spring [s]; NaN where there are not two."""
    times = phases.high_times
    return float(times[-1] - times[0]) / (times.size - 1) if times.size > 1 else math.nan


def _seeds(law: Law, period: float, name: str, low: float, high: float) -> list[Law]:
    """Return the law, and that with the number `name` between two that gives the period."""
    if math.isnan(period) or law.zeta >= 1.0:
        return [law]

    def longer(number: float) -> float:
        shown = applied(law, {name: number}).quantities()["period"]
        return -period if math.isnan(shown) else shown - period

    return [law, applied(law, {name: root(longer, low, high)})]
