"""The most likely cause of a curve, and the sentence that says what was seen.

One rule: explanations are tried from the simplest on. Each must leave no more of the curve than its
noise, its digits and the tolerance of a solver, and be known far better than what it explains.
What no law explains has a cause where the signature of one is seen; else no single cause is named.
"""

import math

import numpy as np

from stickslip_score.evidence import Evidence
from stickslip_score.fit import Fit
from stickslip_score.held import explained_by_drift
from stickslip_score.law import Law, root
from stickslip_score.phases import NO_GAP, Stick
from stickslip_score.read import Floats
from stickslip_score.result import Cause, Judgement, power, tolerance
from stickslip_score.sliding import another_slide, judge_sliding, rests_on
from stickslip_score.words import force, length, percent, signed_length, speed, time

_NO_CAUSE = "no single cause explains it"

_TYPED = 1e-5
"""Relative: nobody types a parameter so finely; a solver of a usual tolerance is off by more."""

_LOOSE = 1e-2
"""Relative: the error of an event that the loosest solvers in use, at a tolerance of 1e-3, make."""

_MARGIN = 20.0
"""Of Schwarz's criterion: odds of 20,000 to one."""

_CLEAR = 100.0
"""How much larger what a law explains is than what it leaves, where solver errors are left."""

_SEEN_STEPS = 0.05
"""Of a sample step: lateness that few slips must show to be that of steps."""

_EULER = 2.0
"""How much each slip of an explicit method of first order gains in it, pi/2 w h of the gap, and
a part for the slips that begin and end between steps."""

_FOLLOWS, _CLOSELY = 0.2, 0.05
"""Of the scatter of latenesses: what of it does not follow from the one before, in fixed steps. By
a tolerance latenesses scatter anyhow, and twice as much is left. Few or small ones may follow by
chance, and must do so closely."""

_FEW, _FINE = 3, 0.01
"""Latenesses that are few; and of a sample step, how far small ones differ at most."""

_LEAST_LATE = 0.03
"""Of a step: how little the first break-away may be off the lateness to which steps lead."""

_SAME_FORCE = 1e-6
"""Of the highest spring force: a break-away force nearer than that is the same, for any solver."""

_DEVIATIONS, _SURE, _OFFSETS = 3.0, 3.5, 5.0
"""Standard deviations of noise to which a number is said to be known; beyond which it is another;
and those of the mean of the samples that their offset may be: it hangs on the break-away as well.
"""

_LOST_PEAK = 0.99
"""Of the exact fall of the spring in a slip: less shows that the static peak is lost."""

_HIDES = 0.25
"""Of the swing: a gap known no better than this may be none."""

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
    """Return the most likely cause, and the sentence that says why.

    No solver is named for a record with noise.
    """
    if e.motion.mismatch:
        return Cause.OTHER, e.motion.mismatch
    if e.lies_on("exact"):
        return _on_the_exact_law(e)
    if e.exact is None and not e.chatters and (judged := judge_sliding(e)):
        return judged
    if e.lies_on("one coefficient"):
        return Cause.SINGLE_COEFFICIENT, one_coefficient(e)
    if e.chatters:
        return Cause.FIXED_STEP, (
            "the solver chatters in stick: friction acts in full now one way, now the other, "
            "instead of holding the mass at rest, because each step passes over its sign change"
        )
    if not e.motion.measured and e.motion.t.size < _TELLS_NOISE and not e.motion.rests():
        return Cause.NOISY, _too_few_for_noise(e)
    if judged := _another_block(e):
        return judged
    if explained_by_drift(e.fits):
        return Cause.OTHER, _drift(e)
    creeping = creeping_sticks(e)
    if (e.motion.measured or not creeping) and (drifting := _another_speed(e)):
        return Cause.OTHER, drifting
    return _of_no_law(e, creeping)


def _of_no_law(e: Evidence, creeping: list[Stick]) -> Judgement:
    """Judge a curve that lies on no law by the signatures of causes."""
    gap = e.fits.get("gap")
    lasts = float(e.motion.t[-1] - e.motion.t[0])
    if e.motion.measured and e.phases.only_rests and lasts > e.law.relief / e.law.v:
        return Cause.NOISY, (
            f"the {noise_in_words(e)}, hides the motion: the mass is not seen to leave its place, "
            f"and a jump of {length(e.law.quantities()['delta_x'])} is due"
        )
    if e.motion.measured and not e.fits:
        return _without_a_slip(e)
    if e.motion.measured and gap and not gap.repeats:
        return _slow_noise(e, gap)
    paces = [stick.late_over_early for stick in creeping]
    pace = float(np.median([ratio for ratio in paces if not math.isnan(ratio)] or [math.nan]))
    if creeping and e.motion.from_force and abs(pace - 1.0) < _EVEN:
        return Cause.OTHER, _another_stiffness(e, creeping)
    # What a filter leaves of a slip dies out, while creep grows with the force or turns with it.
    if creeping and not 0.0 < pace < 1.0 - _EVEN:
        return _creeping(e, creeping)
    if not e.phases.high_samples:
        return _without_a_slip(e)
    if e.motion.measured:
        near = min(e.fits, key=lambda name: e.fits[name].rms)
        left = length(e.fits[near].rms)
        said = f"the law that comes nearest, {near}, leaves {left} rms, more than the"
        return Cause.OTHER, f"{_NO_CAUSE}: {said} {noise_in_words(e)}"
    if e.seen_gap < NO_GAP * e.law.D:
        return Cause.SINGLE_COEFFICIENT, one_coefficient(e)
    if e.exact is None:
        return Cause.OTHER, "no cycle exists at these parameters, yet the curve sticks and slips"
    if not e.measured.jumps:
        return Cause.NOISY, _too_few_for_noise(e)
    return _of_a_solver(e)


def _on_the_exact_law(e: Evidence) -> Judgement:
    if not e.motion.measured or "gap" not in e.fits:
        return _exact_law(e)
    gap = e.fits["gap"]
    known, off = _known(e, gap), abs(gap.law.D - e.law.D)
    if not known < _HIDES or off > _SURE / _DEVIATIONS * known * e.swing:
        return _another_block(e) or _gap(e, gap)
    cause, said = _exact_law(e)
    if cause is Cause.EXACT:
        said = (
            f"all {e.motion.t.size} samples lie on the exact solution, to the {noise_in_words(e)}; "
            f"the gap of (mu_s - mu_k) N is known to {100.0 * known:.2g} %"
        )
    return cause, said


def _exact_law(e: Evidence) -> Judgement:
    """Judge a curve on the exact law by the spring force at its break-away."""
    found = e.fits["exact"]
    extension = e.motion.extension(found.t_break, found.offset)
    step = float(np.max(np.diff(e.motion.t)))
    # Samples that pass over the slips tell a break-away only between two of them.
    when = found.spread["t_break"] if step * e.law.w < _SEES_SLIPS else step
    if e.motion.noise:
        # Noise hides whether a solver waited for a step.
        when = max(step, when + _DEVIATIONS * found.deviation("t_break"))
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


def noise_in_words(e: Evidence) -> str:
    """Return the noise of the column from which the motion is known."""
    if not e.motion.noise:
        return f"digits of {e.motion.source}, {length(e.motion.digits)}"
    if e.motion.source == "x":
        return f"noise of x, {length(e.motion.noise)} rms"
    return f"noise of F, {force(e.p['k'] * e.motion.noise)} rms"


def _known(e: Evidence, gap: Fit) -> float:
    """Return how well noise and digits let the gap be known, in parts of the swing."""
    return (_DEVIATIONS * gap.deviation("D") + 2.0 * gap.spread["D"]) / e.swing


def _another_block(e: Evidence) -> Judgement | None:
    """Judge a curve that lies on the law of another block; None where it lies on none.

    Schwarz's criterion chooses between laws that noise allows, if by a clear margin.
    """
    lying = [name for name in ("gap", "damping", "gap and mass") if e.lies_on(name)]
    likely = {name: -e.fits[name].criterion(e.motion.digits) for name in lying}
    lying.sort(key=lambda name: -likely[name])
    if not lying:
        return None
    name = lying[0]
    if name == "gap":
        cause, said = _gap(e, e.fits["gap"])
    elif _shift(e, name) < _TYPED and not e.motion.measured:
        return tolerance(_shift(e, name))
    else:
        cause, said = _named(e, name)
    rivals = [
        other
        for other in lying[1:]
        if likely[name] - likely[other] < _MARGIN and (other != "damping" or _may_be_damped(e))
    ]
    if cause is not Cause.OTHER or e.exact is None or not (rivals or _may_be_a_solver(e, name)):
        return cause, said
    also = [_named(e, other)[1] for other in rivals] or ["a solver is off by as little"]
    return Cause.OTHER, f"{_NO_CAUSE}: {'; or '.join([said, *also]).replace(f'{_NO_CAUSE}: ', '')}"


def _may_be_damped(e: Evidence) -> bool:
    """Tell whether a damping is one of a block, or that which explicit steps of the samples put in.

    A step h of an explicit method of first order adds -k h to it.
    """
    law, step = e.fits["damping"].law, float(np.max(np.diff(e.motion.t)))
    added = 2.0 * (e.law.zeta - law.zeta) / (law.w * step)
    return law.zeta >= 0.0 or abs(added - 1.0) < 0.5


def _may_be_a_solver(e: Evidence, name: str) -> bool:
    """Tell whether noise hides a solver's tolerance, or steps as long as those of the samples.

    Break-aways are late by up to one, by others from slip to slip, less and less so; arcs are off
    in w by the second power of a step at most.
    """
    law, step = e.fits[name].law, float(np.max(np.diff(e.motion.t)))
    if name == "damping" or not e.motion.measured:
        return False
    cycles = max(e.measured.cycles, 1)
    left = _next_late(e.law) ** (2.0 * np.arange(cycles))
    differ = _LEAST_LATE * e.law.v * step * math.sqrt(float(np.mean(left)))
    hidden = differ < 2.0 * _OFFSETS * e.motion.noise * math.sqrt(cycles / e.motion.t.size)
    late = abs(law.D - e.law.D) < e.law.v * step
    in_steps = hidden and late and abs(law.w / e.law.w - 1.0) <= (e.law.w * step) ** 2
    return in_steps or _shift(e, name) < 0.1 * _LOOSE


def _shift(e: Evidence, name: str) -> float:
    """Return how far the numbers of a law are from the given ones, in parts of them."""
    law = e.fits[name].law
    return max(
        abs(law.D - e.law.D) / e.swing,
        abs(law.w / e.law.w - 1.0),
        2.0 * math.pi * abs(law.zeta - e.law.zeta),
    )


def _named(e: Evidence, name: str) -> Judgement:
    """Name the numbers of the block with which a law differs from the given ones."""
    law = e.fits[name].law
    if name != "damping" and law.D < NO_GAP * e.law.D:
        return Cause.SINGLE_COEFFICIENT, one_coefficient(e)
    if name == "gap":
        return Cause.OTHER, (
            "the curve is a clean stick-slip motion of another gap: the spring relief is that of "
            f"(mu_s - mu_k) N {percent(e.gap_ratio(law.D))}"
        )
    if name == "gap and mass":
        return Cause.OTHER, (
            "the curve is a clean stick-slip motion of another oscillator: k/m is "
            f"{percent((law.w / e.law.w) ** 2)} and (mu_s - mu_k) N/k "
            f"{percent(e.gap_ratio(law.D))}"
        )
    c = 2.0 * law.zeta * e.p["m"] * law.w
    if c < 0.0:
        return Cause.OTHER, (
            f"{_NO_CAUSE}: slips gain energy, as with a damping of {c:.3g} N s/m, which no block "
            f"has, or in explicit steps of about {time(-c / e.p['k'])}"
        )
    return Cause.OTHER, (
        "the curve is a clean stick-slip motion of another damping: that of "
        f"c = {c:.4g} N s/m instead of {e.p['c']:.4g}"
    )


def _gap(e: Evidence, gap: Fit) -> Judgement:
    known = _known(e, gap)
    if e.motion.measured and not known < _HIDES:
        return Cause.NOISY, _hidden(e, known)
    if e.exact is None:
        cause, said = another_slide(e)
    elif not e.motion.measured and _shift(e, "gap") < _TYPED:
        return tolerance(_shift(e, "gap"))
    else:
        cause, said = _named(e, "gap")
    if e.motion.measured:
        said = f"{said}; noise and digits leave {100.0 * known:.2g} % open"
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


def _slow_noise(e: Evidence, gap: Fit) -> Judgement:
    """Judge a curve that is off the law by what is not alike from cycle to cycle."""
    known = _known(e, gap)
    off = (
        f"the samples are off the law by {length(gap.rms)} rms, unlike from cycle to cycle, "
        f"and the {noise_in_words(e)} from sample to sample"
    )
    if abs(gap.law.D - e.law.D) > _SURE / _DEVIATIONS * known * e.swing:
        return Cause.OTHER, (
            f"{_NO_CAUSE}: the gap is on average that of (mu_s - mu_k) N "
            f"{percent(e.gap_ratio(gap.law.D))}, and {off}"
        )
    return Cause.NOISY, (
        f"{off}: slow noise hides a cause below that; the gap of (mu_s - mu_k) N is the exact one "
        f"within {100.0 * known:.2g} %; a noise of {length(0.25 * gap.rms)} would tell more"
    )


def _drift(e: Evidence) -> str:
    """Say so where a slow drift of the force is all that is off the exact solution."""
    return (
        "apart from a slow drift of the spring force the samples lie on the exact solution, to "
        f"{force(e.p['k'] * e.fits['drift'].worst)}: the zero of the force sensor drifts, or k or "
        "v differ a little from the given values"
    )


def _another_stiffness(e: Evidence, creeping: list[Stick]) -> str:
    rise = e.p["k"] * e.law.v
    seen = e.p["k"] * (e.law.v - float(np.median([stick.creep or 0.0 for stick in creeping])))
    return (
        f"in stick the spring force rises at {seen:.4g} N/s, where k v is {rise:.4g} N/s: "
        "k or v differs from the given value"
    )


def _another_speed(e: Evidence) -> str:
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


def creeping_sticks(e: Evidence) -> list[Stick]:
    """Return the sticks in which the mass creeps; none where it creeps in few of them."""
    loading = [stick for stick in e.phases.sticks if stick.samples > 1]
    creeping = [stick for stick in loading if not stick.rests and bool(stick.creep)]
    first = creeping and creeping[0] is loading[0]
    return creeping if first or 2 * len(creeping) >= len(loading) else []


def _creeping(e: Evidence, creeping: list[Stick]) -> Judgement:
    creep = speed(float(np.median([abs(stick.creep or 0.0) for stick in creeping])))
    if not e.motion.measured:
        said = f"regularised friction: the stick phase creeps at {creep}"
        return Cause.REGULARISED, f"{said}; {_peak(e)}"
    near = min(fit.rms for fit in e.fits.values())
    return Cause.OTHER, (
        f"the mass creeps at {creep} where Coulomb friction would hold it at rest; "
        f"it is off the law by {length(near)} rms, and the {noise_in_words(e)}"
    )


def _peak(e: Evidence) -> str:
    """Say what became of the static peak."""
    if e.exact is None:
        return "at these parameters the exact mass slides on after its break-away"
    share = e.phases.fall / (2.0 * e.swing) if e.phases.highs.size else 0.0
    if share < _LOST_PEAK:
        said = f"the spring falls by {100.0 * share:.3g} % of what it should"
        return f"the static peak is lost: {said}"
    return "the static peak is kept"


def _without_a_slip(e: Evidence) -> Judgement:
    """Judge a curve in which the spring does not turn."""
    resting = [stick for stick in e.phases.sticks if stick.rests]
    if not resting:
        if e.exact is None:
            return Cause.EXACT, "the mass slides steadily, and no cycle exists at these parameters"
        return Cause.SINGLE_COEFFICIENT, "the mass slides steadily and never comes to rest"
    return rests_on(e, e.highest if resting[-1].end is None else math.inf)


def _of_a_solver(e: Evidence) -> Judgement:
    """Judge a computed curve that rests in stick, and whose slips no law explains to its digits.

    Events that wait for the next step are late by none to one; one that is late by tau widens the
    spring by v tau, takes as long from the next stick, and so makes the next one late by less. A
    solver's tolerance makes slips that are alike, and off by as little as their arcs are.
    """
    assert e.exact is not None
    widened = np.array([_gap_of_jump(e.law, jump) for jump in e.measured.jumps]) - e.law.D
    late = widened / e.law.v
    off = float(np.max(np.abs(np.array(e.measured.jumps) / e.exact["delta_x"] - 1.0)))
    left = min(fit.rms for fit in e.fits.values()) / e.swing if e.fits else 0.0
    said = (
        f"the jump is {signed_length(e.measured.values['delta_x'][0] - e.exact['delta_x'])} from "
        f"the exact one, and jumps differ by up to {length(float(np.ptp(e.measured.jumps)))}"
    )
    if _in_steps(e, late):
        return Cause.FIXED_STEP, (
            "fixed steps: the mass rests in stick, but events wait for the next step of the "
            f"solver, as from steps of {time(float(np.ptp(late)))} or more; {said}"
        )
    for name in ("gap", "damping", "gap and mass"):
        if name in e.fits and e.fits[name].rms * _CLEAR < min(_shift(e, name), _LOOSE) * e.swing:
            cause, named = _named(e, name)
            return cause, f"{named}, to a solver tolerance of {power(left)}"
    if off < left / _CLEAR:
        if left < 0.1 * _LOOSE:
            return Cause.EXACT, (
                "jumps and times at rest are the exact ones; the samples of slips are off the "
                f"exact solution by {length(left * e.swing)} rms: interpolated or filtered"
            )
    elif max(off, left) < _LOOSE and (
        off < 0.1 * _LOOSE or np.std(late) < 0.5 * np.ptp([0, *late])
    ):
        return tolerance(max(off, left))
    return Cause.OTHER, (
        f"{_NO_CAUSE}: {said}, and the samples are off the law that comes nearest "
        f"by {length(left * e.swing)} rms"
    )


def _in_steps(e: Evidence, late: Floats) -> bool:
    """Tell whether latenesses of break-aways [s] are those of fixed steps.

    Each follows from the one before, as a break-away that is late by tau moves the next one by
    `_next_late` tau, and as much as is lacking to a whole step. The step is not known.
    """
    step = float(np.max(np.diff(e.motion.t)))
    gained = _EULER * step * (1.0 + e.law.w * e.law.D / e.law.v)
    if abs(float(np.mean(late))) > gained + step:
        return False
    if late.size <= 2:
        return float(np.min(late)) > _SEEN_STEPS * step
    damped = e.fits.get("damping")
    law = damped.law if damped and damped.law.zeta < e.law.zeta else e.law
    lacking = late[1:] + _next_late(law) * late[:-1]
    fine, few = float(np.ptp(late)) <= _FINE * step, late.size == _FEW
    if fine and few:
        return False
    follows = _CLOSELY if fine or few else _FOLLOWS
    return _apart(lacking, step) < follows * _apart(late)


def _apart(times: Floats, step: float = math.inf) -> float:
    """Return how far two of some times are apart in the median, up to a step [s]."""
    apart = np.abs(times - times[:, None])[np.triu_indices(times.size, 1)]
    return float(np.median(np.minimum(apart, np.abs(apart - step))))


def _next_late(law: Law) -> float:
    """Return by how much earlier a break-away makes the next one due that is late by 1 [-].

    (lambda^2 - 1)/(lambda^2 + 1) without damping.
    """
    longer, D = 1e-6 * (law.D + law.v / law.w), law.D
    periods = [law.with_gap(gap).quantities()["period"] for gap in (D, D + longer)]
    return law.v * (periods[1] - periods[0]) / longer - 1.0


def _gap_of_jump(law: Law, jump: float) -> float:
    """Return the gap with which a slip jumps so far [m]."""

    def farther(gap: float) -> float:
        shown = law.with_gap(gap).quantities()["delta_x"]
        return -jump if math.isnan(shown) else shown - jump

    return root(farther, 0.0, jump)
