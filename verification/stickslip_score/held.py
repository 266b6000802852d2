"""A curve held against the law: as it should be, and as it might be instead."""

import math
from dataclasses import dataclass, replace

import numpy as np

from stickslip_score.curve import Floats
from stickslip_score.departure import Rest, rests_of
from stickslip_score.fit import ON_THE_LAW, Fit, fit
from stickslip_score.law import Law
from stickslip_score.motion import Motion
from stickslip_score.phases import Phases

_COARSE = 0.2
"""Of a period: samples farther apart may have passed over a break-away before the first turn that
they show."""

_LEAST_SAMPLES = 5


@dataclass(frozen=True)
class _Part:
    """The samples from about a break-away on, and the times between which it is [s].

    Where they are coarse, a mass and a gap together would explain anything.
    """

    t: Floats
    y: Floats
    allowed: Floats
    window: tuple[float, float]
    coarse: bool

    def fit(self, law: Law, *free: str) -> Fit:
        return fit(self.t, self.y, self.allowed, law, self.window, free)


def hold_against(motion: Motion, phases: Phases, law: Law) -> dict[str, Fit]:
    """Hold the curve against the law: exact, one coefficient, gap free, gap and mass free.

    A curve on the exact law is held against the free gap alone besides; one that lies on a law
    with another gap is not held against another mass. A curve may start in a slip that no
    break-away began, or its samples may pass over its first cycle, so that the second turn of the
    spring may serve as well as the first, and cycles may have gone before. Where the law has no
    cycle, the spring need not turn, and the rests of the mass tell the break-away.
    """
    if math.isinf(law.t_slip):
        return _hold_without_cycle(motion, law)
    parts = [part for high in _first_highs(phases) if (part := _part(motion, phases, law, high))]
    if not parts:
        return {}
    ways = [(part, replace(law, continued=way)) for way in (False, True) for part in parts]
    for part, way in ways:
        exact = part.fit(way)
        if exact.excess <= ON_THE_LAW:
            return {"exact": exact, "gap": part.fit(way, "D")}
    starts_at_rest = phases.sticks[0].begin is None if phases.sticks else False
    part = parts[0] if starts_at_rest else parts[-1]
    found = {"exact": part.fit(law)}
    one = law.with_gap(-2.0 * law.zeta * law.v / law.w)
    found["one coefficient"] = part.fit(one)
    period = _period(phases)
    seeds = [law, *_another_gap(law, period)]
    found["gap"] = min((part.fit(seed, "D") for seed in seeds), key=_excess)
    if found["gap"].excess > ON_THE_LAW and not part.coarse:
        seeds += _another_mass(law, period)
        found["gap and mass"] = min((part.fit(seed, "D", "w") for seed in seeds), key=_excess)
    return found


def _hold_without_cycle(motion: Motion, law: Law) -> dict[str, Fit]:
    one = law.with_gap(-2.0 * law.zeta * law.v / law.w)
    found: dict[str, Fit] = {}
    for rest in rests_of(motion):
        exact = _departing(motion, rest, law)
        if exact is None:
            continue
        if exact.excess <= ON_THE_LAW:
            return {"exact": exact}
        seeds = (_departing(motion, rest, seed, "D") for seed in (law, one))
        here = {
            "exact": exact,
            "one coefficient": _departing(motion, rest, one),
            "gap": min((fit for fit in seeds if fit), key=_excess, default=None),
        }
        for name, fitted in here.items():
            if fitted and (name not in found or fitted.excess < found[name].excess):
                found[name] = fitted
    return found


def _departing(motion: Motion, rest: Rest, law: Law, *free: str) -> Fit | None:
    """Fit a law that breaks away at the end of a rest; None where there is nothing to fit."""
    window = rest.window(motion, law)
    t, y = motion.t[rest.first :], motion.y[rest.first :]
    if window is None or t.size < _LEAST_SAMPLES:
        return None
    return fit(t, y, np.full(t.size, motion.allowed), law, window, free)


def _excess(fit: Fit) -> float:
    return fit.excess


def _first_highs(phases: Phases) -> list[int]:
    return [index for index in phases.high_samples[:2] if index > 0]


def _part(motion: Motion, phases: Phases, law: Law, high: int) -> _Part | None:
    """Return the samples from the break-away before a turn on; None where they are too few."""
    begin = float(motion.t[high - 1]) - 1.5 * math.atan2(law.v, law.w * law.D) / law.w
    period = law.quantities()["period"]
    coarse = float(np.median(np.diff(motion.t))) > _COARSE * period
    if coarse:
        begin -= period
    first = int(np.searchsorted(motion.t, max(begin, _rested_since(phases, motion.z[high]))))
    t, y = motion.t[first:], motion.y[first:]
    if t.size < _LEAST_SAMPLES:
        return None
    window = (begin, float(motion.t[min(high + 1, motion.t.size - 1)]))
    return _Part(t, y, np.full(t.size, motion.allowed), window, coarse)


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


def _another_gap(law: Law, period: float) -> list[Law]:
    """Return the law with the gap that gives the period, if there is one."""
    if math.isnan(period) or law.zeta >= 1.0:
        return []
    low, high = 1e-3 * law.v / law.w, 0.5 * law.v * period
    for _ in range(50):
        middle = 0.5 * (low + high)
        shown = law.with_gap(middle).quantities()["period"]
        if math.isnan(shown) or shown < period:
            low = middle
        else:
            high = middle
    return [law.with_gap(0.5 * (low + high))]


def _another_mass(law: Law, period: float) -> list[Law]:
    """Return the law with the frequency that gives the period about: fast slips follow 1/w."""
    own = law.quantities()["period"]
    if math.isnan(period) or math.isnan(own):
        return []
    return [replace(law, w=law.w * own / period)]
