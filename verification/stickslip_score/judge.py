"""The score of a curve: what it shows, beside the exact cycle, and the most likely cause."""

import math
from collections.abc import Mapping

import numpy as np

from stickslip_score.cause import decide
from stickslip_score.chatter import chatters
from stickslip_score.evidence import Evidence
from stickslip_score.findings import findings
from stickslip_score.fit import Fit
from stickslip_score.given import check_units, pulled_as
from stickslip_score.held import explained_by_drift, hold_against, on_the_law
from stickslip_score.law import Law
from stickslip_score.measure import QUANTITIES, Measured, from_fit, from_sticks
from stickslip_score.motion import COARSE, Motion, motion_of
from stickslip_score.noise import scatter_of
from stickslip_score.phases import Phases, find_phases
from stickslip_score.read import Curve, CurveError
from stickslip_score.result import Compared, Score
from stickslip_score.slide import Slide, fit_slide
from stickslip_verification.truth import steady_cycle
from stickslip_verification.truth.parameters import complete, used_mu_k

_SAMPLES_OF_A_CYCLE = 6
"""Below so many per cycle the phases of a curve that obeys no known law cannot be told."""


def score(curve: Curve, parameters: Mapping[str, float]) -> Score:
    """Judge a curve against the exact steady cycle, docs/theory.md (7) to (10), (13).

    The noise of the columns is estimated first. The figures are means over all complete cycles,
    which begin and end with a break-away, so that the first load-up is none. Where all samples lie
    on the law of the block with some gap, to their digits or their noise, they are read off that
    law; else each event is known between two samples. Resolutions follow from digits, noise and
    sampling. A v of the wrong sign is turned, and a finding says so.

    Parameters
    ----------
    curve
        The samples.
    parameters
        m g k c mu_s mu_k v load F_ext, SI; what is missing takes its start value.

    Raises
    ------
    ValueError
        A parameter is unknown or out of range; the message names it.
    CurveError
        v is 0, so that nothing is pulled, or x or F is a power of 1000 too large or too small.
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
    given_v = p["v"]
    p = {**p, "v": pulled_as(curve, p)}
    exact = _exact(p)
    law = _law(p)
    check_units(curve, p, exact)
    motion = motion_of(curve, p, law)
    chattering = chatters(motion, law, p)
    if chattering:
        motion = motion.with_noise(0.0)
    motion, phases, fits = _look(motion, law)
    slide = fit_slide(motion, law) if exact is None else None
    measured = _measured(motion, phases, fits, slide, law)
    evidence = Evidence(p, exact, law, motion, phases, measured, fits, chattering, slide)
    cause, explanation = decide(evidence)
    found = findings(evidence)
    if p["v"] != given_v:
        found.insert(0, f"the mass is pulled against the given v: judged with v = {p['v']:g} m/s")
    sign = math.copysign(1.0, p["v"])
    compared = {
        name: _compare(measured, exact, name, sign if name == "delta_x" else 1.0)
        for name in QUANTITIES
    }
    return Score(
        **compared,
        cause=cause,
        explanation=explanation,
        findings=tuple(found),
        cycles=measured.cycles,
        x_noise=motion.noises.get("x"),
        F_noise=p["k"] * motion.noises["F"] if "F" in motion.noises else None,
    )


def _look(motion: Motion, law: Law) -> tuple[Motion, Phases, dict[str, Fit]]:
    """Return the motion, with noise where it has some, its phases and fits.

    Samples that do not resolve the oscillation scatter for the motion as well, so that noise is
    told by how they lie about the law.
    """
    if motion.step * law.w < COARSE:
        motion, phases, fits = _seen(motion, law)
        return _refined(motion, fits), phases, fits
    computed = _seen(motion.with_noise(0.0), law)
    exact = computed[2].get("exact")
    if exact is not None and exact.by_digits:
        return computed
    noise = motion.noise or max(motion.digits, scatter_of(motion.t, motion.y))
    measured = _seen(motion.with_noise(noise), law)
    known = _refined(measured[0], measured[2])
    if any(fit.white for fit in measured[2].values()) and not known.rests():
        return (known, *measured[1:])
    return measured if motion.noise and not motion.rests() else computed


def _refined(motion: Motion, fits: Mapping[str, Fit]) -> Motion:
    """Return the motion with the noise that a law leaves on which its samples lie."""
    white = [fit.rms for fit in fits.values() if fit.white]
    return motion.with_noise(min([motion.noise, *white])) if motion.noise else motion


def _seen(motion: Motion, law: Law) -> tuple[Motion, Phases, dict[str, Fit]]:
    phases = find_phases(motion.smoothed(law), law)
    return motion, phases, hold_against(motion, phases, law)


def _exact(p: Mapping[str, float]) -> dict[str, float] | None:
    """Return the exact cycle of a forward pull; None where there is none."""
    cycle = steady_cycle({**p, "v": abs(p["v"])}, digits=30)
    if cycle is None:
        return None
    names = {"period": "T", "t_stick": "t_stick", "t_slip": "t_slip", "delta_x": "delta_x"}
    return {name: float(cycle[symbol]) for name, symbol in names.items()}


def _law(p: Mapping[str, float]) -> Law:
    N = max(p["m"] * p["g"] + p["load"], 0.0)
    gap = (p["mu_s"] - used_mu_k(p["mu_s"], p["mu_k"])) * N / p["k"]
    w, v = math.sqrt(p["k"] / p["m"]), abs(p["v"])
    return Law(w, p["c"] / (2.0 * p["m"] * w), v, gap - p["c"] * v / p["k"])


def _measured(
    motion: Motion, phases: Phases, fits: Mapping[str, Fit], slide: Slide | None, law: Law
) -> Measured:
    if slide is not None and slide.on_the_law:
        return Measured({}, 0)
    found = _lawful(motion, fits)
    if found is not None:
        return from_fit(found, float(motion.t[-1]), motion.noise > 0.0)
    if phases.high_times.size > 1:
        between = (motion.t >= phases.high_times[0]) & (motion.t <= phases.high_times[-1])
        if np.count_nonzero(between) < _SAMPLES_OF_A_CYCLE * (phases.high_times.size - 1):
            return Measured({}, 0)
    return from_sticks(phases.sticks, motion.smoothed(law).allowed)


def _lawful(motion: Motion, fits: Mapping[str, Fit]) -> Fit | None:
    """Return the law off which figures are read; None where the curve lies on none."""
    names = ("gap", "gap and drift", "damping", *(["gap and mass"] if motion.noise else []))
    found = [fits[name] for name in names if name in fits]
    if not found:
        found = list(fits.values())
    for each in found:
        if on_the_law(each, motion):
            return each
    if explained_by_drift(fits):
        return fits["gap and drift"]
    # Noise that neighbouring samples share is off every law, but not alike in all cycles.
    slow = motion.noise > 0.0 and "gap" in fits and not fits["gap"].repeats
    return fits["gap"] if slow else None


def _compare(
    measured: Measured, exact: Mapping[str, float] | None, name: str, sign: float
) -> Compared:
    true = None if exact is None else sign * exact[name]
    if name not in measured.values:
        return Compared(None, true, None, None)
    got, resolution = measured.values[name]
    got *= sign
    return Compared(got, true, None if true is None else got - true, resolution)
