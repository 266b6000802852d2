"""The most likely cause of a curve with noise: physics, or nothing that can be told."""

import math

import numpy as np

from stickslip_score.cause import (
    another_gap,
    another_mass,
    another_speed,
    creeping_sticks,
    drift,
    exact_law,
    gap_ratio,
    one_coefficient,
    without_a_slip,
)
from stickslip_score.departure import rests_of
from stickslip_score.evidence import Evidence
from stickslip_score.fit import Fit
from stickslip_score.held import explained_by_drift
from stickslip_score.result import Cause, Judgement
from stickslip_score.sliding import (
    another_slide,
    exact_slide,
    slide_of_one_coefficient,
    without_departure,
)
from stickslip_score.words import force, length, percent, speed

_HIDES = 0.25
"""Of the swing: a gap known no better than this may be none."""

_DEVIATIONS, _SURE = 3.0, 3.5
"""Standard deviations to which a gap is said to be known, and beyond which it is another one."""


def decide_measured(e: Evidence) -> Judgement:
    """Return the most likely cause of a curve with noise, and the sentence that says why.

    A solver's curve has no noise, so that no solver is named.
    """
    if e.motion.mismatch:
        return Cause.OTHER, e.motion.mismatch
    if e.lies_on("exact"):
        return _near_the_exact_law(e)
    if e.exact is None and (judged := _sliding(e)):
        return judged
    if e.lies_on("one coefficient"):
        return Cause.SINGLE_COEFFICIENT, one_coefficient(e)
    if e.lies_on("gap"):
        return _gap(e, e.fits["gap"])
    if explained_by_drift(e.fits):
        return Cause.OTHER, drift(e)
    if e.lies_on("gap and mass"):
        return another_mass(e)
    if e.phases.only_rests and e.motion.t[-1] - e.motion.t[0] > e.law.relief / e.law.v:
        return Cause.NOISY, (
            f"the {noise_in_words(e)}, hides the motion: the mass is not seen to leave its place, "
            f"and a jump of {length(e.law.quantities()['delta_x'])} is due"
        )
    if not e.fits:
        return without_a_slip(e)
    if said := another_speed(e):
        return Cause.OTHER, said
    return _departing(e)


def noise_in_words(e: Evidence) -> str:
    """Return the noise of the column from which the motion is known."""
    if not e.motion.noise:
        return f"digits of {e.motion.source}, {length(e.motion.digits)}"
    if e.motion.source == "x":
        return f"noise of x, {length(e.motion.noise)} rms"
    return f"noise of F, {force(e.p['k'] * e.motion.noise)} rms"


def _known(fit: Fit) -> float:
    return _DEVIATIONS * fit.deviation("D") + 2.0 * fit.spread["D"]


def _near_the_exact_law(e: Evidence) -> Judgement:
    if "gap" not in e.fits:
        return exact_law(e)
    gap = e.fits["gap"]
    known = _known(gap)
    swing = math.hypot(e.law.D, e.law.v / e.law.w)
    if not known < _HIDES * swing:
        return Cause.NOISY, _hidden(e, known / swing)
    if abs(gap.law.D - e.law.D) > _SURE / _DEVIATIONS * known:
        return _gap(e, gap)
    cause, said = exact_law(e)
    if cause is Cause.EXACT:
        said = (
            f"all {e.motion.t.size} samples lie on the exact solution, to the {noise_in_words(e)}; "
            f"the gap of (mu_s - mu_k) N is known to {100.0 * known / swing:.2g} %"
        )
    return cause, said


def _hidden(e: Evidence, share: float) -> str:
    if not math.isfinite(share):
        return f"the {noise_in_words(e)}, hides whether the motion is the exact one"
    less = share / (0.4 * _HIDES)
    return (
        f"the {noise_in_words(e)}, hides whether static friction is larger than kinetic: their "
        f"gap is known to {100.0 * share:.2g} % of the swing; a noise {less:.2g} times smaller or "
        f"{less**2:.2g} times as many samples would tell"
    )


def _gap(e: Evidence, gap: Fit) -> Judgement:
    swing = math.hypot(e.law.D, e.law.v / e.law.w)
    known = _known(gap)
    if not known < _HIDES * swing:
        return Cause.NOISY, _hidden(e, known / swing)
    cause, said = another_slide(e) if e.exact is None else another_gap(e)
    return cause, f"{said}; noise and digits leave {100.0 * known / swing:.2g} % open"


def _slow_noise(e: Evidence, gap: Fit) -> Judgement:
    """Judge a curve that is off the law by what is not alike from cycle to cycle."""
    known = _known(gap)
    swing = math.hypot(e.law.D, e.law.v / e.law.w)
    off = (
        f"the samples are off the law by {length(gap.rms)} rms, unlike from cycle to cycle, "
        f"and the {noise_in_words(e)} from sample to sample"
    )
    if abs(gap.law.D - e.law.D) > _SURE / _DEVIATIONS * known:
        return Cause.OTHER, (
            f"the gap is that of (mu_s - mu_k) N {percent(gap_ratio(e, gap.law.D))}; {off}"
        )
    return Cause.NOISY, (
        f"{off}: slow noise hides a cause below that; the gap of (mu_s - mu_k) N is the exact one "
        f"within {100.0 * known / swing:.2g} %; a noise of {length(0.25 * gap.rms)} would tell more"
    )


def _sliding(e: Evidence) -> Judgement | None:
    """Judge a curve at parameters without a cycle; None where it is off every slide."""
    if e.slide is not None and e.slide.on_the_law:
        return exact_slide(e)
    if e.lies_on("one coefficient"):
        return Cause.SINGLE_COEFFICIENT, slide_of_one_coefficient(e)
    if not e.fits:
        return without_departure(e, rests_of(e.motion)[0])
    return another_slide(e) if e.lies_on("gap") else None


def _departing(e: Evidence) -> Judgement:
    """Judge a curve that is off the law by more than its noise."""
    near = min(e.fits.values(), key=lambda fit: fit.rms)
    if "gap" in e.fits and not e.fits["gap"].repeats:
        return _slow_noise(e, e.fits["gap"])
    creeping = creeping_sticks(e)
    if creeping:
        creep = float(np.median([abs(stick.creep or 0.0) for stick in creeping]))
        return Cause.OTHER, (
            f"the mass creeps at {speed(creep)} where Coulomb friction would hold it at rest; "
            f"it is off the law by {length(near.rms)} rms, and the {noise_in_words(e)}"
        )
    return Cause.OTHER, (
        f"the motion is off every law of constant coefficients by {length(near.rms)} rms, more "
        f"than the {noise_in_words(e)}: friction varies, or another force acts"
    )
