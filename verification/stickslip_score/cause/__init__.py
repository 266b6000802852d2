"""The score of a curve: its figures against the exact ones, its cause, what else is seen.

Explanations are tried from the simplest on. Each must leave no more of the curve than its noise,
its digits and the tolerance of a solver, and be known far better than what it explains. What no
solution explains has a cause where the signature of one is seen; else no single cause is named.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from stickslip_score.cause.judgement import NO_CYCLE, Cause, Evidence, judge
from stickslip_score.figures import Figures, Phases, break_away, figures_of, find_phases, first_rest
from stickslip_score.figures.motion import COARSE, Motion, is_turned, motion_of, scatter_of, si
from stickslip_score.figures.solution import QUANTITIES, Solution, normal_force
from stickslip_score.fit import Fit, Fits, Slide, explained_by_drift, fit_slide, fits_of
from stickslip_score.read import Curve, CurveError, Floats
from stickslip_verification.truth import steady_cycle
from stickslip_verification.truth.parameters import complete, used_mu_k

_SAMPLES_OF_A_CYCLE = 6  # fewer do not tell the phases of a curve on no known solution


@dataclass(frozen=True)
class Compared:
    """A quantity of the cycle as the curve has it and as it is, SI.

    An error within the resolution is no evidence against the curve.
    """

    got: float | None  # mean over the complete cycles (or slips); None where there is none
    exact: float | None  # of the steady cycle; None where none exists
    error: float | None  # got - exact
    resolution: float | None  # how far `got` may be off for want of samples and digits


@dataclass(frozen=True)
class Score:
    """The verdict on a curve."""

    period: Compared  # [s], from break-away to break-away
    t_stick: Compared  # [s]
    t_slip: Compared  # [s]
    delta_x: Compared  # jump of the mass [m], with the sign of v
    cause: Cause  # what most likely made the curve what it is
    explanation: str  # the same as a sentence with figures
    findings: tuple[str, ...]  # what else was seen, one sentence each
    cycles: int  # complete ones, from break-away to break-away, behind the figures
    x_noise: float | None = None  # standard deviation [m]; None where x is not in the curve
    F_noise: float | None = None  # standard deviation [N]; None where F is not in the curve


def as_json(score: Score) -> dict[str, Any]:
    """Return the score as what JSON can hold; null where a figure is missing."""
    fields = asdict(score)
    noise = {"x": fields.pop("x_noise"), "F": fields.pop("F_noise")}
    unit = {"period": "s", "t_stick": "s", "t_slip": "s", "delta_x": "m"}
    units = {**unit, "noise": {"x": "m", "F": "N"}}
    return {**fields, "findings": list(score.findings), "noise": noise, "unit": units}


def score(curve: Curve, parameters: Mapping[str, float]) -> Score:
    """Judge a curve against the exact steady cycle, docs/theory.md (7) to (10), (13).

    The figures are means over all complete cycles, from break-away to break-away. Where all samples
    lie on the solution of a block with some gap, to their digits or their noise, they are read off
    that one; else each event is known between two samples. A v of the wrong sign is turned, and a
    finding says so. `parameters` are m g k c mu_s mu_k v load F_ext, SI; what is missing takes its
    start value. `ValueError` for one that is unknown or out of range; `CurveError` if v is 0, so
    that nothing is pulled, or x or F is a power of 1000 too large or too small.
    """
    try:
        with np.errstate(over="raise"):
            return _score(curve, complete(parameters))
    except (OverflowError, ZeroDivisionError, FloatingPointError):
        raise CurveError(
            "the figures of the curve or of the block leave the range of numbers"
        ) from None


def _score(curve: Curve, p: Mapping[str, float]) -> Score:
    if p["v"] == 0.0:
        raise CurveError("v = 0: nothing is pulled, so there is no cycle to compare with")
    cycle = steady_cycle({**p, "v": abs(p["v"])}, digits=30)
    exact = cycle and {n: float(cycle["T" if n == "period" else n]) for n in QUANTITIES}
    turned = is_turned(curve, p, exact)
    p = {**p, "v": -p["v"]} if turned else p
    w, v = math.sqrt(p["k"] / p["m"]), abs(p["v"])
    gap = (p["mu_s"] - used_mu_k(p["mu_s"], p["mu_k"])) * normal_force(p) / p["k"]
    solution = Solution(w, p["c"] / (2.0 * p["m"] * w), v, gap - p["c"] * v / p["k"])
    motion, phases, fits = _look(motion_of(curve, p, solution), solution)
    slide = None if exact else fit_slide(motion, solution)
    figures = _figures(motion, phases, fits, slide, solution)
    evidence = Evidence(curve, p, exact, solution, motion, phases, figures, fits, slide)
    cause, explanation = judge(evidence)
    against = f"the mass is pulled against the given v: judged with v = {p['v']:g} m/s"
    compared = {}
    for name in QUANTITIES:
        sign = math.copysign(1.0, p["v"] if name == "delta_x" else 1.0)
        true = sign * exact[name] if exact else None
        value, resolution = figures.values.get(name, (None, None))
        got = None if value is None else sign * value
        error = None if got is None or true is None else got - true
        compared[name] = Compared(got, true, error, resolution)
    noise = motion.noises
    return Score(
        **compared,
        cause=cause,
        explanation=explanation,
        findings=(*([against] if turned else []), *_findings(evidence)),
        cycles=figures.cycles,
        x_noise=noise.get("x"),
        F_noise=p["k"] * noise["F"] if "F" in noise else None,
    )


def _look(motion: Motion, solution: Solution) -> tuple[Motion, Phases, dict[str, Fit]]:
    """Return the motion with its noise, its phases and fits.

    Coarse samples scatter for the motion as well: there the fits show the noise.
    """

    def seen(motion: Motion) -> tuple[Motion, Phases, dict[str, Fit]]:
        phases = find_phases(motion.smoothed(solution), solution)
        fits = fits_of(motion, phases, solution)
        if motion.noise:
            # A solution on which the samples lie leaves their noise.
            left = [fit.rms for fit in fits.values() if fit.white]
            motion = motion.with_noise(min([motion.noise, *left]))
        return motion, phases, fits

    if motion.step * solution.w < COARSE:
        return seen(motion)
    computed = seen(motion.with_noise(0.0))
    exact = computed[2].get("exact")
    if exact is not None and exact.by_digits:
        return computed
    noise = motion.noise or max(motion.digits, scatter_of(motion.t, motion.y))
    measured = seen(motion.with_noise(noise))
    if any(fit.white for fit in measured[2].values()) and not measured[0].rests():
        return measured
    if motion.noise and not motion.rests():
        return motion.with_noise(noise), *measured[1:]
    return computed


def _figures(
    motion: Motion, phases: Phases, fits: Fits, slide: Slide | None, solution: Solution
) -> Figures:
    if slide is not None and slide.lies:
        return Figures({}, 0)
    names = ("gap", "gap and drift", "damping", *(["gap and mass"] if motion.noise else []))
    free = [fits[name] for name in names if name in fits]
    nearest = [fit for fit in free or fits.values() if fit.lies]
    if explained_by_drift(fits):
        nearest.append(fits["gap and drift"])
    # Noise that neighbouring samples share is off every solution, but not alike in all cycles.
    if motion.noise and "gap" in fits and not fits["gap"].repeats:
        nearest.append(fits["gap"])
    if nearest:
        return nearest[0].figures(float(motion.t[-1]))
    times = phases.high_times
    if times.size > 1:
        between = (motion.t >= times[0]) & (motion.t <= times[-1])
        if np.count_nonzero(between) < _SAMPLES_OF_A_CYCLE * (times.size - 1):
            return Figures({}, 0)
    return figures_of(phases.sticks, motion.smoothed(solution).allowed)


def _findings(e: Evidence) -> list[str]:
    seen = [] if e.exact else [NO_CYCLE]
    if not e.figures.cycles:
        seen.append("the curve shows no complete cycle, from one break-away to the next")
    elif e.figures.cycles == 1:
        seen.append("the figures come from one cycle only")
    step = e.motion.widest_step
    if e.exact and 2.0 * step > e.exact["t_slip"]:
        doubt = ": is t in ms?" if step > e.exact["period"] else ""
        slip = f"where a slip takes {si(e.exact['t_slip'], 's')}{doubt}"
        seen.append(f"coarse samples: up to {si(step, 's')} apart, {slip}")
    if e.motion.drift:
        seen.append(f"F drifts by {si(e.motion.drift, 'N')} against k (v t - x)")
    for name, unit, size in (("x", "m", 1.0), ("F", "N", e.p["k"])):
        if noise := size * e.motion.noises.get(name, 0.0):
            seen.append(f"{name} has a noise of {si(noise, unit)} rms")
    if e.motion.shared and e.motion.noise:
        seen.append("x and F share their noise: one was made from the other")
    return seen if e.curve.x_dot is None else [*seen, *_moving_at_rest(e, e.curve.x_dot)]


def _moving_at_rest(e: Evidence, x_dot: Floats) -> list[str]:
    """Report a velocity column that is not 0 where the position rests beyond doubt."""
    t = e.motion.t
    inner = np.zeros(t.size, dtype=bool)
    if math.isinf(e.solution.t_slip):
        window = break_away(e.motion, e.solution, first_rest(e.motion))
        inner = (t > t[0]) & (t < (window[0] if window else t[-1]))
    else:
        for stick in (stick for stick in e.phases.sticks if stick.rests):
            begin = stick.begin.high if stick.begin else t[0]
            inner |= (t > begin) & (t < (stick.end.low if stick.end else t[-1]))
    moving = float(np.median(np.abs(x_dot[inner]))) if inner.any() else 0.0
    if moving <= 1e-6 * e.solution.v + 2.0 * e.curve.x_dot_rounding:
        return []
    return [f"the velocity column shows {si(moving, 'm/s')} where the position rests"]
