"""The most likely cause of a curve at parameters without a cycle: one break-away, then sliding."""

import math

import numpy as np

from stickslip_score.evidence import Evidence
from stickslip_score.fit import Fit
from stickslip_score.phases import LOST, NO_GAP
from stickslip_score.result import Cause, Judgement, tolerance
from stickslip_score.slide import Rest, rests_of
from stickslip_score.words import force, length, percent, speed

_SEEN_STEPS, _LOOSE = 0.05, 1e-2
"""Of a sample step: lateness that is none of a fixed step; and of v/w: an error of a tolerance."""

_OF_ONE_COEFFICIENT = (
    "one friction coefficient: the mass leaves its rest as where break-away and kinetic friction "
    "are alike"
)

_LATE_STEPS = 2.0
"""Sample steps of motion by which fixed steps can set a slide off: the break-away is late by up to
one, and a method of first order is ahead or behind by up to another."""


def judge_sliding(e: Evidence) -> Judgement | None:
    """Return cause and sentence for a curve off the exact law; None where neither rest nor slide.

    The exact mass rests, breaks away once and slides for ever, and may do so slower than half the
    pulled end's speed for as long as damping takes: slowness alone is no creep. Creep is motion
    before the break-away of the law that comes nearest.
    """
    if e.slide is not None and e.slide.on_the_law:
        return _exact_slide(e)
    rest = rests_of(e.motion)[0]
    if e.lies_on("one coefficient"):
        return Cause.SINGLE_COEFFICIENT, _OF_ONE_COEFFICIENT
    if not e.fits:
        return _without_departure(e, rest)
    nearest = min(e.fits.values(), key=lambda fit: fit.excess)
    if not e.motion.measured and _creeps(e, rest, nearest):
        return _creep(e, nearest)
    late = (e.fits["gap"].law.D - e.law.D) / e.law.v
    step = float(np.max(np.diff(e.motion.t)))
    if e.lies_on("gap") and (e.motion.measured or not 0.0 < late <= step):
        return another_slide(e)
    return None if e.motion.measured else _of_a_solver(e, rest, nearest, late / step)


def _exact_slide(e: Evidence) -> Judgement:
    """Judge a curve on the arc of sliding by the spring force to which it tends."""
    assert e.slide is not None
    due = e.break_away - e.law.D
    digits = 2.0 * e.slide.spread + e.motion.z_allowed
    if e.motion.absolute and abs(e.slide.z_steady - due) > digits:
        seen = e.p["k"] * e.slide.z_steady
        return Cause.OTHER, (
            f"the motion is exact sliding, but the spring force tends to {seen:.6g} N instead of "
            f"{e.p['k'] * due:.6g} N: another force acts, or mu_k is wrong"
        )
    return Cause.EXACT, (
        "no steady cycle exists at these parameters, and the curve slides as the exact solution "
        f"does, to {length(e.slide.worst)}"
    )


def _without_departure(e: Evidence, rest: Rest) -> Judgement | None:
    """Judge a mass that rests to the last sample, by the force that the spring then has."""
    if rest.last + 1 < e.motion.t.size:
        return None
    # A slip that has just begun stays within the digits, while the spring is pulled on.
    return rests_on(e, e.break_away + e.law.v * e.law.time_to_move(4.0 * e.motion.allowed))


def rests_on(e: Evidence, highest: float) -> Judgement:
    """Judge a mass that rests by the highest extension [m] that the spring can have meanwhile."""
    reached = float(np.max(e.motion.z))
    if e.motion.absolute and reached > highest + 4.0 * e.motion.allowed:
        return Cause.OTHER, (
            f"the mass rests although the spring force reaches {force(e.p['k'] * reached)}, above "
            f"the break-away force {force(e.p['k'] * e.break_away)}"
        )
    return Cause.EXACT, "the mass rests as far as the curve goes: it shows no break-away to judge"


def _creeps(e: Evidence, rest: Rest, nearest: Fit) -> bool:
    t = e.motion.t
    before = nearest.t_break - float(t[rest.first])
    lost = before - float(t[rest.last] - t[rest.first])
    hidden = nearest.law.time_to_move(4.0 * e.motion.allowed)
    return lost > LOST * before + 2.0 * max(hidden, float(np.max(np.diff(t))))


def _creep(e: Evidence, nearest: Fit) -> Judgement:
    """Say how fast the mass creeps, over the middle half of the time before its break-away."""
    t, y, begin = e.motion.t, e.motion.y, float(e.motion.t[0])
    quarter = 0.25 * (nearest.t_break - begin)
    early, late = np.interp([begin + quarter, begin + 3.0 * quarter], t, y)
    creep = float(late - early) / (2.0 * quarter)
    return Cause.REGULARISED, (
        f"regularised friction: the stick phase creeps at {speed(abs(creep))}; at these parameters "
        "the exact mass slides on after its break-away"
    )


def another_slide(e: Evidence) -> Judgement:
    """Judge a curve that breaks away and slides as with another gap."""
    ratio = e.gap_ratio(e.fits["gap"].law.D)
    if ratio < NO_GAP:
        return Cause.SINGLE_COEFFICIENT, _OF_ONE_COEFFICIENT
    return Cause.OTHER, (
        "the curve breaks away and slides as the block does with another gap: "
        f"(mu_s - mu_k) N {percent(ratio)}"
    )


def _of_a_solver(e: Evidence, rest: Rest, nearest: Fit, late: float) -> Judgement | None:
    """Judge a slide whose break-away is late by parts of a sample step."""
    off = nearest.worst * e.law.w / e.law.v
    if abs(late) < _SEEN_STEPS and off < _LOOSE:
        return tolerance(off)
    top_speed = e.law.v * (1.0 + math.hypot(1.0, e.law.w * max(e.law.D, 0.0) / e.law.v))
    in_steps = _LATE_STEPS * float(np.max(np.diff(e.motion.t))) * top_speed
    if not e.lies_on("gap") and (rest.last == rest.first or nearest.worst > in_steps):
        return None
    return Cause.FIXED_STEP, (
        f"fixed steps: a break-away late by {abs(late):.2g} sample steps explains the motion to "
        f"{length(nearest.worst)}; so would a mass or damping that is a little off"
    )
