"""The most likely cause of a curve, and the sentence that says what was seen."""

import math

import numpy as np

from stickslip_score.evidence import Evidence
from stickslip_score.held import explained_by_drift
from stickslip_score.law import Law, root
from stickslip_score.phases import NO_GAP, Stick
from stickslip_score.result import Cause, Judgement
from stickslip_score.sliding import judge_sliding
from stickslip_score.words import force, length, percent, signed_length, signed_time, speed, time

_LEAST_STEP = 1e-6
"""Part of a period: no solver steps so finely, and no reader of its curve would mind."""

_LATE_STEPS = 4.0
"""Sample steps by which fixed steps can lengthen a period: a break-away late by up to one step
relieves the spring twice as much, which takes two more to load, and a re-stick is late by one."""

_SAME_FORCE = 1e-6
"""Of the highest spring force: a break-away force nearer than that is the same, for any solver."""

_HIDDEN = 8.0
"""Half units of the last digit within which jumps that vary are not told from equal ones: two for
either level, at either end of their range."""

_DEVIATIONS, _OFFSETS = 3.0, 5.0
"""Standard deviations of noise that a break-away may be off, and those of the mean of the samples
that their offset may be: it hangs on the break-away as well."""

_TELLS_NOISE = 40
"""Samples below which noise is not told from a departure, unless the mass rests to its digits."""

_SEES_SLIPS = 0.5
"""Radians of the oscillation between samples up to which each slip, of pi or more, has six."""

_EVEN = 0.02
"""How alike creep must be early and late in stick to be no friction's. The force that drives a
smoothed friction changes by the factor mu_s/(2 mu_k - mu_s) meanwhile."""

_HIGHS_OF_A_DRIFT = 4
"""Turns of the spring, and times their scatter, from which on a drift is one."""


def decide(e: Evidence) -> Judgement:
    """Return the most likely cause, and the sentence that says why."""
    if e.motion.mismatch:
        return Cause.OTHER, e.motion.mismatch
    if e.lies_on("exact"):
        return exact_law(e)
    if e.exact is None and not e.chatters and (judged := judge_sliding(e)):
        return judged
    if e.lies_on("one coefficient"):
        return Cause.SINGLE_COEFFICIENT, one_coefficient(e)
    if e.chatters:
        return Cause.FIXED_STEP, (
            "the solver chatters in stick: friction acts in full now one way, now the other, "
            "instead of holding the mass at rest, because each step passes over its sign change"
        )
    creeping = creeping_sticks(e)
    if e.motion.t.size < _TELLS_NOISE and not e.motion.rests():
        return Cause.NOISY, _too_few_for_noise(e)
    if explained_by_drift(e.fits):
        return Cause.OTHER, drift(e)
    if creeping and e.motion.from_force and _is_even(creeping):
        return Cause.OTHER, _another_stiffness(e, creeping)
    if creeping:
        return _creeping(e, creeping)
    if not e.phases.high_samples:
        return without_a_slip(e)
    if drifting := another_speed(e):
        return Cause.OTHER, drifting
    if e.lies_on("gap"):
        return _late_by_a_step(e) or another_gap(e)
    if e.lies_on("gap and mass"):
        return another_mass(e)
    if e.seen_gap < NO_GAP * e.law.D:
        return Cause.SINGLE_COEFFICIENT, one_coefficient(e)
    return _unlawful(e)


def creeping_sticks(e: Evidence) -> list[Stick]:
    """Return the sticks in which the mass creeps; none where it creeps in few of them."""
    loading = [stick for stick in e.phases.sticks if stick.samples > 1]
    creeping = [stick for stick in loading if not stick.rests and bool(stick.creep)]
    first = creeping and creeping[0] is loading[0]
    return creeping if first or 2 * len(creeping) >= len(loading) else []


def exact_law(e: Evidence) -> Judgement:
    """Judge a curve on the exact law by the spring force at its break-away."""
    found = e.fits["exact"]
    extension = e.motion.extension(found.t_break, found.offset)
    step = float(np.max(np.diff(e.motion.t)))
    # Samples that pass over the slips tell a break-away only between two of them.
    when = found.spread["t_break"] if step * e.law.w < _SEES_SLIPS else step
    if e.motion.noise:
        when += _DEVIATIONS * found.deviation("t_break")
    digits = 4.0 * e.motion.digits + e.motion.z_allowed + e.law.v * when
    digits += _OFFSETS * e.motion.noise / math.sqrt(e.motion.t.size)
    if e.motion.absolute and abs(extension - e.break_away) > digits + _SAME_FORCE * e.highest:
        seen, due = e.p["k"] * extension, e.p["k"] * e.break_away
        return Cause.OTHER, (
            f"the motion is the exact one, but the spring force at break-away is {seen:.6g} N "
            f"instead of {due:.6g} N: another force acts, or both coefficients are shifted"
        )
    if e.exact is None:
        return Cause.EXACT, (
            "no steady cycle exists at these parameters, and after its break-away the curve slides "
            f"as the exact solution does, to {length(found.worst)}"
        )
    return Cause.EXACT, (
        f"all {e.motion.t.size} samples lie on the exact solution, to {length(found.worst)}"
    )


def _too_few_for_noise(e: Evidence) -> str:
    said = f"{e.motion.t.size} samples are too few to tell noise from a cause"
    if not e.fits:
        return said
    off = min(fit.rms for fit in e.fits.values())
    return f"{said}; they are off the exact solution by {length(off)} rms"


def _is_even(creeping: list[Stick]) -> bool:
    """Tell whether the creep does not follow the force, as that of smoothed friction does."""
    return abs(float(np.nanmedian([stick.late_over_early for stick in creeping])) - 1.0) < _EVEN


def _another_stiffness(e: Evidence, creeping: list[Stick]) -> str:
    rise = e.p["k"] * e.law.v
    seen = e.p["k"] * (e.law.v - float(np.median([stick.creep or 0.0 for stick in creeping])))
    return (
        f"in stick the spring force rises at {seen:.4g} N/s, where k v is {rise:.4g} N/s: "
        "k or v differs from the given value"
    )


def another_speed(e: Evidence) -> str:
    """Say so where the mass does not keep up with the pulled end over the cycles."""
    times, highs = e.phases.high_times, e.phases.highs
    if times.size < _HIGHS_OF_A_DRIFT:
        return ""
    drift = float(highs[-1] - highs[0]) / float(times[-1] - times[0])
    scatter = float(np.ptp(highs - drift * times)) + e.law.v * float(np.max(np.diff(e.motion.t)))
    if abs(drift) * float(times[-1] - times[0]) < _HIGHS_OF_A_DRIFT * scatter:
        return ""
    return (
        f"the mass advances at {speed(e.law.v - drift)} on average, but the given speed of the "
        f"pulled end is {speed(e.law.v)}"
    )


def one_coefficient(e: Evidence) -> str:
    """Say which gap is left of that between break-away and kinetic friction."""
    gap = e.seen_gap
    return (
        "one friction coefficient: the spring shows a gap between break-away and kinetic friction "
        f"of {length(gap)} instead of {length(e.law.D)}; the mass swings about the pulled end's "
        "speed and does not come to rest for a load-up"
    )


def _creeping(e: Evidence, creeping: list[Stick]) -> Judgement:
    creep = float(np.median([abs(stick.creep or 0.0) for stick in creeping]))
    said = f"regularised friction: the stick phase creeps at {speed(creep)}"
    return Cause.REGULARISED, f"{said}; {_peak(e)}"


def _peak(e: Evidence) -> str:
    """Say what became of the static peak."""
    if e.exact is None:
        return "at these parameters the exact mass slides on after its break-away"
    if e.motion.absolute:
        top = float(np.median(e.phases.highs)) if e.phases.highs.size else float(max(e.motion.z))
        if e.highest - top > 0.01 * e.law.D:
            return (
                f"the static peak is lost: the spring force peaks at {force(top * e.p['k'])} "
                f"instead of {force(e.highest * e.p['k'])}"
            )
        return "the static peak is kept"
    if not e.measured.cycles or not e.phases.highs.size:
        return "the static peak is lost: no stick-slip follows"
    share = e.phases.fall / (2.0 * math.hypot(e.law.D, e.law.v / e.law.w))
    if share < 0.99:
        return (
            f"the static peak is lost: the spring falls by {100.0 * share:.3g} % of what it should"
        )
    return "the static peak is kept"


def without_a_slip(e: Evidence) -> Judgement:
    """Judge a curve in which the spring does not turn."""
    resting = [stick for stick in e.phases.sticks if stick.rests]
    if not resting:
        if e.exact is None:
            return Cause.EXACT, "the mass slides steadily, and no cycle exists at these parameters"
        return Cause.SINGLE_COEFFICIENT, "the mass slides steadily and never comes to rest"
    rest = resting[-1]
    over = e.motion.absolute and float(np.max(e.motion.z)) > e.highest + 4.0 * e.motion.allowed
    if over and rest.end is None:
        return Cause.OTHER, (
            f"the mass rests although the spring force reaches "
            f"{force(e.p['k'] * float(np.max(e.motion.z)))}, above the break-away force "
            f"{force(e.p['k'] * e.break_away)}"
        )
    return Cause.EXACT, "the mass rests as far as the curve goes: it shows no break-away to judge"


def _late_by_a_step(e: Evidence) -> Judgement | None:
    """Return fixed steps where late break-aways explain a gap that is a little too wide."""
    D = e.fits["gap"].law.D
    step = 2.0 * (D - e.law.D) / e.law.v
    # Late by none to one step, jumps vary by up to twice what they are off on average.
    if 0.0 < step <= float(np.max(np.diff(e.motion.t))) and _HIDDEN * e.motion.allowed > 4.0 * (
        D - e.law.D
    ):
        return Cause.FIXED_STEP, (
            f"fixed steps: break-aways that are late by up to {time(step)} explain the period and "
            "the jump; the digits do not tell them from "
            f"(mu_s - mu_k) N {percent(gap_ratio(e, D))}"
        )
    return None


def another_gap(e: Evidence) -> Judgement:
    """Judge a curve that lies on the law of another gap."""
    D = e.fits["gap"].law.D
    if D < NO_GAP * e.law.D:
        return Cause.SINGLE_COEFFICIENT, one_coefficient(e)
    return Cause.OTHER, (
        "the curve is a clean stick-slip motion of another gap: the spring relief is that of "
        f"(mu_s - mu_k) N {percent(gap_ratio(e, D))}"
    )


def drift(e: Evidence) -> str:
    """Say so where a slow drift of the force is all that is off the exact solution."""
    return (
        "apart from a slow drift of the spring force the samples lie on the exact solution, to "
        f"{force(e.p['k'] * e.fits['drift'].worst)}: the zero of the force sensor drifts, or k or "
        "v differ a little from the given values"
    )


def another_mass(e: Evidence) -> Judgement:
    """Judge a curve that lies on the law of another gap and another mass."""
    law = e.fits["gap and mass"].law
    if law.D < NO_GAP * e.law.D:
        return Cause.SINGLE_COEFFICIENT, one_coefficient(e)
    return Cause.OTHER, (
        "the curve is a clean stick-slip motion of another oscillator: k/m is "
        f"{percent((law.w / e.law.w) ** 2)} and (mu_s - mu_k) N/k {percent(gap_ratio(e, law.D))}"
    )


def gap_ratio(e: Evidence, D: float) -> float:
    """Return the gap of the friction forces that belongs to a D, over the given one."""
    drag = 2.0 * e.law.zeta * e.law.v / e.law.w
    gap = e.law.D + drag
    return (D + drag) / gap if gap else math.inf


def _unlawful(e: Evidence) -> Judgement:
    """Judge a curve that rests in stick, and whose slips no Coulomb friction explains."""
    if e.exact is None:
        return Cause.OTHER, "no cycle exists at these parameters, yet the curve sticks and slips"
    if not e.measured.cycles:
        return _too_few(e)
    late = e.measured.values["period"][0] - e.exact["period"]
    if _solver_step(e) < _LEAST_STEP * e.exact["period"]:
        return Cause.EXACT, "the deviation is smaller than a solver's step: digits of the curve"
    resolution = e.measured.values["period"][1]
    step = float(np.max(np.diff(e.motion.t)))
    jumps = e.measured.jumps
    uneven = float(np.ptp(jumps)) if len(jumps) > 1 else 0.0
    said = (
        f"the period is {signed_time(late)} from the exact one, the jump "
        f"{signed_length(e.measured.values['delta_x'][0] - e.exact['delta_x'])}"
    )
    if abs(late) - resolution > _LATE_STEPS * step:
        return Cause.OTHER, f"{said}: more than late events at solver steps can cause"
    alike = (
        f"slips differ by up to {length(uneven)}, where exact ones are all the same"
        if uneven > 8.0 * e.motion.allowed
        else "its slips are no arc of the exact motion"
    )
    return Cause.FIXED_STEP, (
        f"fixed steps: the mass rests in stick, but events wait for the next step of the solver; "
        f"{said}, as from steps of about {time(_solver_step(e))}; {alike}"
    )


def _solver_step(e: Evidence) -> float:
    """Return about the step that explains the jumps [s].

    A break-away late by tau finds the spring wider by v tau: half a step on average, and from
    none to a whole one.
    """
    jumps = e.measured.jumps
    gaps = [_gap_of_jump(e.law, jump) for jump in (min(jumps), max(jumps))]
    mean = _gap_of_jump(e.law, e.measured.values["delta_x"][0])
    return max(2.0 * abs(mean - e.law.D), gaps[1] - gaps[0]) / e.law.v


def _gap_of_jump(law: Law, jump: float) -> float:
    """Return the gap with which a slip jumps so far [m]."""

    def farther(gap: float) -> float:
        shown = law.with_gap(gap).quantities()["delta_x"]
        return -jump if math.isnan(shown) else shown - jump

    return root(farther, 0.0, jump)


def _too_few(e: Evidence) -> Judgement:
    """Judge samples too few to tell the events: what is off the law may be noise."""
    return Cause.NOISY, _too_few_for_noise(e)
