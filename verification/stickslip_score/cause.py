"""The score of a curve: its figures against the exact ones, its cause, what else is seen.

Explanations are tried from the simplest on. Each must leave no more of the curve than its noise,
its digits and the tolerance of a solver, and be known far better than what it explains. What no
solution explains has a cause where the signature of one is seen; else no single cause is named.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np

from stickslip_verification.truth import steady_cycle
from stickslip_verification.truth.parameters import complete, used_mu_k

from .figures import (
    COARSE,
    LOST,
    QUANTITIES,
    Figures,
    Motion,
    Phases,
    Solution,
    Stick,
    break_away,
    figures_of,
    find_phases,
    first_rest,
    is_turned,
    motion_of,
    normal_force,
    scatter_of,
    si,
    without_drift,
)
from .fit import Fit, Fits, Slide, explained_by_drift, fit_slide, fits_of, solved
from .read import Curve, CurveError, Floats

_NO_GAP = 0.25  # of the exact gap: a curve that shows less has one coefficient; steps only widen it
_TYPED = 1e-5  # relative: nobody types a parameter so finely; usual solvers are off by more
_LOOSE = 1e-2  # relative: error of an event by the loosest solvers, at a tolerance of 1e-3
_MARGIN = 20.0  # of Schwarz's criterion: odds of 20,000 to one
_CLEAR = 100.0  # how much more a solution explains than it leaves, where solver errors are left
_SEEN_STEPS = 0.05  # of a sample step: lateness that is one of a fixed step
_EULER = 2.0  # gain of a slip by explicit steps: pi/2 w h of the gap, more for its ends
_FOLLOWS, _CLOSELY = 0.2, 0.05
"""Of the scatter of latenesses: what of it does not follow from the one before, in fixed steps. By
a tolerance latenesses scatter anyhow, and twice as much is left. Few or small ones may follow by
chance, and must do so closely."""
_FEW, _FINE = 3, 0.01  # latenesses that are few; of a sample step: how far small ones differ
_LATE_STEPS = 2.0  # by which fixed steps can set a slide off: a late break-away, first order
_SAME_FORCE = 1e-6  # of the highest spring force: nearer, a break-away force is the same
_DEVIATIONS, _SURE, _OFFSETS = 3.0, 3.5, 5.0
"""Standard deviations of noise to which a number is said to be known; beyond which it is another;
and those of the mean of the samples that their offset may be: it hangs on the break-away as well.
"""
_LOST_PEAK = 0.99  # of the exact fall of the spring in a slip: less lost the static peak
_HIDES = 0.25  # of the swing: a gap known no better than this may be none
_TELLS_NOISE = 40  # fewer samples do not tell noise, unless the mass rests to its digits
_SEES_SLIPS = 0.5  # radians between samples up to which each slip, of pi or more, has six
_EVEN = 0.02  # how alike creep is early and late in stick where no smoothed friction makes it
_NEVER = 8.0  # times the highest extension of the spring that it never has
_HIGHS_OF_A_DRIFT = 4  # turns of the spring, and times their scatter, from which a drift is one

_NO_CAUSE = "no single cause explains it"
_TOO_FEW = "{} samples are too few to tell noise from a cause"
NO_CYCLE = "no steady cycle exists at these parameters"
_SAMPLES_OF_A_CYCLE = 6  # fewer do not tell the phases of a curve on no known solution


class Cause(StrEnum):
    """What most likely made a curve what it is."""

    EXACT = "exact"
    FIXED_STEP = "fixed_step"
    REGULARISED = "regularised"
    SINGLE_COEFFICIENT = "single_coefficient"
    SOLVER_TOLERANCE = "solver_tolerance"
    NOISY = "noisy"
    OTHER = "other"


Judgement = tuple[Cause, str]  # the cause, and the sentence that says why


@dataclass(frozen=True)
class Evidence:
    """All that is known of a curve when it is judged."""

    curve: Curve
    p: Mapping[str, float]  # all parameters, SI
    exact: Mapping[str, float] | None  # figures of a forward pull; None where no cycle exists
    solution: Solution  # the exact one
    motion: Motion
    phases: Phases
    figures: Figures
    fits: Fits
    slide: Slide | None  # sliding without end, from any start; None where a cycle exists

    def lies_on(self, name: str) -> bool:
        """Tell whether all samples lie on a fit, to their digits or their noise."""
        return name in self.fits and self.fits[name].lies

    @property
    def break_away(self) -> float:
        """Spring extension at which the mass breaks away, by the model [m]."""
        direction = math.copysign(1.0, self.p["v"])
        return (self.p["mu_s"] * normal_force(self.p) - direction * self.p["F_ext"]) / self.p["k"]

    @property
    def highest(self) -> float:
        """Highest extension of the spring, by the model [m]: a little beyond break-away."""
        gap = max(self.solution.D, 0.0)
        return self.break_away + math.hypot(gap, self.solution.v / self.solution.w) - gap

    def gap_ratio(self, D: float) -> float:
        """Return the gap of the friction forces that belongs to a D, over the exact one."""
        drag = 2.0 * self.solution.zeta * self.solution.v / self.solution.w
        gap = self.solution.D + drag
        return (D + drag) / gap if gap else math.inf

    @property
    def seen_gap(self) -> float:
        """The gap that the swing of the spring shows [m]; 0 for a swing of v/w alone."""
        lows = self.phases.lows
        if not lows.size:
            return self.solution.D
        return self.solution.seen_gap(float(np.median(self.phases.highs[: lows.size] - lows)))


def judge(e: Evidence) -> Judgement:
    """Return the likeliest cause of a curve, and why."""
    if e.motion.mismatch:
        return Cause.OTHER, e.motion.mismatch
    if e.lies_on("exact"):
        return _on_the_exact_solution(e)
    # In no motion of the model the spring keeps that much of the pull.
    if abs(e.motion.z[-1] - e.motion.z[0]) > _NEVER * e.highest and (judged := _another_speed(e)):
        return judged
    if e.exact is None and not e.motion.chatters and (judged := _sliding(e)):
        return judged
    if e.lies_on("one coefficient"):
        return _one_coefficient(e)
    if e.motion.chatters:
        return Cause.FIXED_STEP, "the solver chatters in stick: steps cross friction's sign change"
    if not e.motion.measured and e.motion.t.size < _TELLS_NOISE and not e.motion.rests():
        return Cause.NOISY, _TOO_FEW.format(e.motion.t.size)
    if judged := _another_block(e):
        return judged
    if explained_by_drift(e.fits):
        worst = si(e.p["k"] * e.fits["drift"].worst, "N")
        return Cause.OTHER, f"the zero of the force sensor drifts; else F is exact to {worst}"
    loading = [stick for stick in e.phases.sticks if stick.samples > 1]
    creeping = [stick for stick in loading if not stick.rests and stick.creep]
    # A mass that creeps in few of its sticks is disturbed.
    if 2 * len(creeping) < len(loading) and creeping[:1] != loading[:1]:
        creeping = []
    if (e.motion.measured or not creeping) and (judged := _another_speed(e)):
        return judged
    return _on_no_solution(e, creeping)


def _on_no_solution(e: Evidence, creeping: list[Stick]) -> Judgement:
    lasts = float(e.motion.t[-1] - e.motion.t[0])
    if e.motion.measured and e.phases.only_rests and lasts > e.solution.relief / e.solution.v:
        jump = si(e.solution.figures()["delta_x"], "m")
        return Cause.NOISY, f"the {_noise_in_words(e)}, hides the motion: a jump of {jump} is due"
    if e.motion.measured and not e.fits:
        return _without_a_slip(e)
    if e.motion.measured and not e.fits["gap"].repeats:
        return _slow_noise(e, e.fits["gap"])
    paces = [stick.late_over_early for stick in creeping]
    pace = float(np.median([ratio for ratio in paces if not math.isnan(ratio)] or [math.nan]))
    if creeping and e.motion.noises.keys() == {"F"} and abs(pace - 1.0) < _EVEN:
        due = e.p["k"] * e.solution.v
        seen = due - e.p["k"] * float(np.median([stick.creep or 0.0 for stick in creeping]))
        rises = f"in stick the spring force rises at {seen:.4g} N/s, where k v is {due:.4g} N/s"
        return Cause.OTHER, rises
    # What a filter leaves of a slip dies out, while creep grows with the force or turns with it.
    if creeping and not 0.0 < pace < 1.0 - _EVEN:
        return _creeping(e, creeping)
    if not e.phases.highs.size:
        return _without_a_slip(e)
    if e.motion.measured:
        near = min(e.fits, key=lambda name: e.fits[name].rms)
        left = f"{si(e.fits[near].rms, 'm')} rms, more than the {_noise_in_words(e)}"
        return Cause.OTHER, f"{_NO_CAUSE}: the nearest fit, {near}, leaves {left}"
    if e.seen_gap < _NO_GAP * e.solution.D:
        return _one_coefficient(e)
    if e.exact is None:
        return Cause.OTHER, "no cycle exists at these parameters, yet the curve sticks and slips"
    if not e.figures.jumps:
        return Cause.NOISY, _TOO_FEW.format(e.motion.t.size)
    return _of_a_solver(e, e.exact)


def _on_the_exact_solution(e: Evidence) -> Judgement:
    if not e.motion.measured or "gap" not in e.fits:
        return _exact(e)
    known, is_exact = _known(e, e.fits["gap"])
    if not (known < _HIDES and is_exact):
        return _another_block(e) or _block(e, "gap")
    cause, sentence = _exact(e)
    if cause is Cause.EXACT:
        sentence = f"all {e.motion.t.size} samples lie on the exact solution, to the "
        sentence += f"{_noise_in_words(e)}; (mu_s - mu_k) N is known to {100.0 * known:.2g} %"
    return cause, sentence


def _exact(e: Evidence) -> Judgement:
    fitted, motion, v = e.fits["exact"], e.motion, e.solution.v
    shift = float(motion.z[0] + motion.y[0])
    extension = v * (fitted.t_break - float(motion.t[0])) - fitted.offset + shift
    step = motion.widest_step
    # Samples that pass over the slips tell a break-away only between two of them.
    when = fitted.spread["t_break"] if step * e.solution.w < _SEES_SLIPS else step
    if motion.noise:
        # Noise hides whether a solver waited for a step.
        when = max(step, when + _DEVIATIONS * fitted.deviation("t_break"))
    digits = 4.0 * motion.digits + motion.z_allowed + v * when
    digits += _OFFSETS * motion.noise / math.sqrt(motion.t.size)
    absolute = "F" in motion.noises
    if absolute and abs(extension - e.break_away) > digits + _SAME_FORCE * e.highest:
        seen, due = e.p["k"] * extension, e.p["k"] * e.break_away
        return Cause.OTHER, (
            f"the motion is exact, but the spring force at break-away is {seen:.6g} N instead of "
            f"{due:.6g} N: another force acts, or both coefficients are shifted"
        )
    no_cycle = f"{NO_CYCLE}; " if e.exact is None else ""
    lie = f"all {motion.t.size} samples lie on the exact solution, to {si(fitted.worst, 'm')}"
    return Cause.EXACT, f"{no_cycle}{lie}"


def _noise_in_words(e: Evidence) -> str:
    motion, force = e.motion, e.motion.source == "F"
    if not motion.noise:
        return f"digits of {motion.source}, {si(motion.digits, 'm')}"
    noise = si(e.p["k"] * motion.noise, "N") if force else si(motion.noise, "m")
    return f"noise of {motion.source}, {noise} rms"


def _known(e: Evidence, gap: Fit) -> tuple[float, bool]:
    """Return how well noise and digits tell the gap, in parts of the swing, and if it is exact."""
    known = (_DEVIATIONS * gap.deviation("D") + 2.0 * gap.spread["D"]) / e.solution.swing()
    off = abs(gap.solution.D - e.solution.D)
    return known, not off > _SURE / _DEVIATIONS * known * e.solution.swing()


def _tolerance(off: float) -> Judgement:
    part = _power_of_ten(off)
    return Cause.SOLVER_TOLERANCE, f"solver tolerance, {part}: the curve is off by about this part"


def _power_of_ten(part: float) -> str:
    return f"1e{round(math.log10(max(part, 1e-16)))}"


def _percent(ratio: float) -> str:
    if not math.isfinite(ratio):
        return "where there should be none"
    return f"{abs(100.0 * (ratio - 1.0)):.3g} % {'larger' if ratio > 1.0 else 'smaller'}"


def _another_block(e: Evidence) -> Judgement | None:
    """Judge a curve on the solution of another block, chosen by Schwarz's criterion, or on none."""
    lying = [name for name in ("gap", "damping", "gap and mass") if e.lies_on(name)]
    if not lying:
        return None
    unlikely = {name: e.fits[name].criterion for name in lying}
    name, *others = sorted(lying, key=lambda name: unlikely[name])
    cause, sentence = _block(e, name)
    rivals = [other for other in others if unlikely[other] - unlikely[name] < _MARGIN]
    if cause is not Cause.OTHER or e.exact is None or not rivals:
        return cause, sentence
    causes = "; or ".join([sentence, *(_named(e, other)[1] for other in rivals)])
    return Cause.OTHER, f"{_NO_CAUSE}: {causes.replace(f'{_NO_CAUSE}: ', '')}"


def _shift(e: Evidence, name: str) -> float:
    """Return how far the numbers of a fit are from the exact ones, in parts of them."""
    fitted, exact = e.fits[name].solution, e.solution
    return max(
        abs(fitted.D - exact.D) / exact.swing(),
        abs(fitted.w / exact.w - 1.0),
        2.0 * math.pi * abs(fitted.zeta - exact.zeta),
    )


def _named(e: Evidence, name: str) -> Judgement:
    fitted = e.fits[name].solution
    number = f"(mu_s - mu_k) N {_percent(e.gap_ratio(fitted.D))}"
    if name == "damping":
        c = 2.0 * fitted.zeta * e.p["m"] * fitted.w
        if c < 0.0:
            steps = f"or in explicit steps of about {si(-c / e.p['k'], 's')}"
            return Cause.OTHER, f"{_NO_CAUSE}: slips gain energy, as with c = {c:.3g} N s/m {steps}"
        number = f"c = {c:.4g} N s/m instead of {e.p['c']:.4g}"
    elif fitted.D < _NO_GAP * e.solution.D:
        return _one_coefficient(e)
    if name == "gap and mass":
        number = f"k/m is {_percent((fitted.w / e.solution.w) ** 2)}, for this k {number}"
    solver = ", or of a solver off by as much" if e.motion.measured else ""
    return Cause.OTHER, f"the curve is a clean stick-slip motion of another block{solver}: {number}"


def _block(e: Evidence, name: str) -> Judgement:
    is_gap, measured, known = name == "gap", e.motion.measured, 0.0
    if is_gap and measured and not (known := _known(e, e.fits["gap"])[0]) < _HIDES:
        return Cause.NOISY, (
            f"the {_noise_in_words(e)}, hides whether static friction is larger than kinetic: "
            f"their gap is known to {100.0 * known:.2g} % of the swing; a noise "
            f"{known / (0.4 * _HIDES):.2g} times smaller would tell"
        )
    slides = is_gap and e.exact is None
    if not (slides or measured) and _shift(e, name) < _TYPED:
        return _tolerance(_shift(e, name))
    cause, sentence = _another_slide(e) if slides else _named(e, name)
    if is_gap and measured:
        sentence += f"; noise and digits leave {100.0 * known:.2g} % open"
    return cause, sentence


def _slow_noise(e: Evidence, gap: Fit) -> Judgement:
    known, is_exact = _known(e, gap)
    off = f"samples are off by {si(gap.rms, 'm')} rms, unlike from cycle to cycle, and the "
    off += f"{_noise_in_words(e)} from sample to sample"
    if not is_exact:
        ratio = _percent(e.gap_ratio(gap.solution.D))
        return Cause.OTHER, f"{_NO_CAUSE}: (mu_s - mu_k) N is {ratio} on average, and {off}"
    return Cause.NOISY, f"{off}: slow noise; (mu_s - mu_k) N is exact within {100.0 * known:.2g} %"


def _another_speed(e: Evidence) -> Judgement | None:
    phases, t, z, v, trend = e.phases, e.motion.t, e.motion.z, e.solution.v, 0.0
    if phases.highs.size < _HIGHS_OF_A_DRIFT:
        # Under a pull that is stated too slow the spring falls on and on: its turns hide in that.
        level = without_drift(t, z, 1)
        trend = float((z - level)[-1] - (z - level)[0]) / float(t[-1] - t[0])
        phases = find_phases(replace(e.motion, z=level).smoothed(e.solution), e.solution)
    times, highs = phases.high_times, phases.highs + trend * phases.high_times
    if times.size < _HIGHS_OF_A_DRIFT:
        return None
    drift = float(highs[-1] - highs[0]) / float(times[-1] - times[0])
    scatter = float(np.ptp(highs - drift * times)) + v * e.motion.widest_step
    if abs(drift) * float(times[-1] - times[0]) < _HIGHS_OF_A_DRIFT * scatter:
        return None
    advances = f"the mass advances at {si(v - drift, 'm/s')} on average"
    return Cause.OTHER, f"{advances}, the pulled end at {si(v, 'm/s')}"


def _one_coefficient(e: Evidence) -> Judgement:
    gap = f"a gap of {si(e.seen_gap, 'm')} instead of {si(e.solution.D, 'm')}"
    return Cause.SINGLE_COEFFICIENT, f"one friction coefficient: the spring shows {gap}"


def _creeping(e: Evidence, creeping: list[Stick]) -> Judgement:
    creep = si(float(np.median([abs(stick.creep or 0.0) for stick in creeping])), "m/s")
    if e.motion.measured:
        near = si(min(fit.rms for fit in e.fits.values()), "m")
        away = f"it is off the exact solution by {near} rms, and the {_noise_in_words(e)}"
        return Cause.OTHER, f"the mass creeps at {creep}; {away}"
    creeps = f"regularised friction: the stick phase creeps at {creep}"
    share = e.phases.fall / (2.0 * e.solution.swing()) if e.phases.highs.size else 0.0
    if e.exact and share < _LOST_PEAK:
        creeps += f"; the static peak is lost: the spring falls by {100.0 * share:.3g} % of its due"
    return Cause.REGULARISED, creeps


def _without_a_slip(e: Evidence) -> Judgement:
    resting = [stick for stick in e.phases.sticks if stick.rests]
    if resting:
        return _resting(e, e.highest if resting[-1].end is None else math.inf)
    if e.exact is None:
        return Cause.EXACT, "the mass slides steadily, and no cycle exists at these parameters"
    return Cause.SINGLE_COEFFICIENT, "the mass slides steadily and never comes to rest"


def _resting(e: Evidence, highest: float) -> Judgement:
    """Judge a mass that rests by the highest extension [m] that the spring can have meanwhile."""
    reached = float(np.max(e.motion.z))
    if "F" in e.motion.noises and reached > highest + 4.0 * e.motion.allowed:
        force, most = (si(e.p["k"] * extension, "N") for extension in (reached, e.break_away))
        beyond = f"although the spring force reaches {force}, above the break-away force {most}"
        return Cause.OTHER, f"the mass rests {beyond}"
    return Cause.EXACT, "the mass rests as far as the curve goes: it shows no break-away to judge"


def _of_a_solver(e: Evidence, exact: Mapping[str, float]) -> Judgement:
    """Judge a computed curve that rests in stick, and whose slips no solution fits to its digits.

    Events that wait for the next step are late by up to one, and differ. A solver's tolerance makes
    slips that are alike, and off by as little as their arcs are.
    """
    jumps, swing = e.figures.jumps, e.solution.swing()
    gaps = [solved(e.solution, "delta_x", jump, "D", 0.0, jump).D for jump in jumps]
    late = (np.array(gaps) - e.solution.D) / e.solution.v
    off = float(np.max(np.abs(np.array(jumps) / exact["delta_x"] - 1.0)))
    left = min(fit.rms for fit in e.fits.values()) / swing if e.fits else 0.0
    error = e.figures.values["delta_x"][0] - exact["delta_x"]
    sign, differ = "+" if error >= 0 else "−", si(float(np.ptp(jumps)), "m")
    sentence = f"jumps are off by {sign}{si(abs(error), 'm')} and differ by up to {differ}"
    if _in_steps(e, late):
        wait = f"events wait for steps of {si(float(np.ptp(late)), 's')} or more"
        return Cause.FIXED_STEP, f"fixed steps: {wait}; {sentence}"
    for name in ("gap", "damping", "gap and mass"):
        if name in e.fits and e.fits[name].rms * _CLEAR < min(_shift(e, name), _LOOSE) * swing:
            cause, named = _named(e, name)
            return cause, f"{named}, to a solver tolerance of {_power_of_ten(left)}"
    alike = off < 0.1 * _LOOSE or np.std(late) < 0.5 * np.ptp([0, *late])
    if off < left / _CLEAR:
        if left < 0.1 * _LOOSE:
            filtered = f"slips are off by {si(left * swing, 'm')} rms: interpolated or filtered"
            return Cause.EXACT, f"jumps and times at rest are the exact ones; {filtered}"
    elif alike and max(off, left) < _LOOSE:
        return _tolerance(max(off, left))
    nearest = f"the samples are off the nearest fit by {si(left * swing, 'm')} rms"
    return Cause.OTHER, f"{_NO_CAUSE}: {sentence}, and {nearest}"


def _in_steps(e: Evidence, late: Floats) -> bool:
    """Tell whether latenesses of break-aways [s] are those of fixed steps.

    Each follows from the one before, as a break-away that is late by tau moves the next one by
    `_next_late` tau, and as much as is lacking to a whole step. The step is not known.
    """
    step = e.motion.widest_step
    gained = _EULER * step * (1.0 + e.solution.w * e.solution.D / e.solution.v)
    if abs(float(np.mean(late))) > gained + step:
        return False
    if late.size <= 2:
        return float(np.min(late)) > _SEEN_STEPS * step
    damped = e.fits["damping"].solution if "damping" in e.fits else e.solution
    solution = min(e.solution, damped, key=lambda solution: solution.zeta)
    lacking = late[1:] + _next_late(solution) * late[:-1]
    doubts = (float(np.ptp(late)) <= _FINE * step) + (late.size == _FEW)
    return _apart(lacking, step) < (_FOLLOWS, _CLOSELY, 0.0)[doubts] * _apart(late)


def _apart(times: Floats, step: float = math.inf) -> float:
    """Return how far two of some times are apart in the median, up to a step [s]."""
    apart = np.abs(times - times[:, None])[np.triu_indices(times.size, 1)]
    return float(np.median(np.minimum(apart, np.abs(apart - step))))


def _next_late(solution: Solution) -> float:
    """Advance of the next break-away per lateness; undamped (lambda^2 - 1)/(lambda^2 + 1)."""
    longer, D = 1e-6 * (solution.D + solution.v / solution.w), solution.D
    periods = [replace(solution, D=gap).figures()["period"] for gap in (D, D + longer)]
    return solution.v * (periods[1] - periods[0]) / longer - 1.0


def _sliding(e: Evidence) -> Judgement | None:
    """Judge a curve at parameters without a cycle; None where neither rest nor slide.

    A damped slide may long be slow, so that creep is motion before the break-away of the nearest
    solution.
    """
    if e.slide is not None and e.slide.lies:
        return _exact_slide(e, e.slide)
    last, t = first_rest(e.motion), e.motion.t
    if e.lies_on("one coefficient"):
        return _ONE_COEFFICIENT
    if not e.fits:
        if last + 1 < t.size:
            return None
        # A slip that has just begun stays within the digits, while the spring is pulled on.
        hidden = e.solution.time_to_move(4.0 * e.motion.allowed)
        return _resting(e, e.break_away + e.solution.v * hidden)
    nearest = min(e.fits.values(), key=lambda fit: fit.worst)
    begin, before = float(t[0]), nearest.t_break - float(t[0])
    hidden = max(nearest.solution.time_to_move(4.0 * e.motion.allowed), e.motion.widest_step)
    lost = nearest.t_break - float(t[last])
    if not e.motion.measured and lost > LOST * before + 2.0 * hidden:
        # Over the middle half of the time before the break-away.
        low, high = np.interp([begin + 0.25 * before, begin + 0.75 * before], t, e.motion.y)
        creep = si(abs(float(high - low) / (0.5 * before)), "m/s")
        return Cause.REGULARISED, f"regularised friction: the stick phase creeps at {creep}"
    late = (e.fits["gap"].solution.D - e.solution.D) / e.solution.v
    if e.lies_on("gap") and (e.motion.measured or not 0.0 < late <= e.motion.widest_step):
        return _another_slide(e)
    return None if e.motion.measured else _late_slide(e, nearest, late, rests=last > 0)


_ONE_COEFFICIENT = Cause.SINGLE_COEFFICIENT, "one friction coefficient: a slide without a gap"


def _exact_slide(e: Evidence, slide: Slide) -> Judgement:
    due = e.break_away - e.solution.D
    digits = 2.0 * slide.spread + e.motion.z_allowed
    if "F" in e.motion.noises and abs(slide.z_steady - due) > digits:
        tends = f"{e.p['k'] * slide.z_steady:.6g} N instead of {e.p['k'] * due:.6g} N"
        return Cause.OTHER, f"the spring force tends to {tends}: another force acts, or mu_k is off"
    worst = si(slide.worst, "m")
    return Cause.EXACT, f"{NO_CYCLE}, and the curve slides as the exact solution does, to {worst}"


def _another_slide(e: Evidence) -> Judgement:
    ratio = e.gap_ratio(e.fits["gap"].solution.D)
    if ratio < _NO_GAP:
        return _ONE_COEFFICIENT
    return Cause.OTHER, f"the mass slides as with another gap: (mu_s - mu_k) N {_percent(ratio)}"


def _late_slide(e: Evidence, nearest: Fit, late: float, *, rests: bool) -> Judgement | None:
    w, v, step = e.solution.w, e.solution.v, e.motion.widest_step
    off = nearest.worst * w / v
    if abs(late / step) < _SEEN_STEPS and off < _LOOSE:
        return _tolerance(off)
    top_speed = v * (1.0 + math.hypot(1.0, w * max(e.solution.D, 0.0) / v))
    if not e.lies_on("gap") and (not rests or nearest.worst > _LATE_STEPS * step * top_speed):
        return None
    reason = f"a break-away late by {abs(late / step):.2g} sample steps explains the motion"
    return Cause.FIXED_STEP, f"fixed steps: {reason} to {si(nearest.worst, 'm')}"


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
