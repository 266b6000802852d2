"""Residuals of the equations of motion, of energy and between outputs, from the samples."""

from typing import Final

import numpy as np

from ..model.quantities import OUTPUT_NAMES
from ..model.verdict import Series
from .course import SLACK, Course, Mask, Metric, Residual, State, Wide, slips

_POLISHES = 4
_PROBES = (*(0.5**n for n in range(30, 4, -1)), *(n / 16.0 for n in range(1, 17)))
"""Where the lowest velocity is looked for first, as parts of a step or of its first turn: evenly,
and near the beginning too, where a heavily damped motion has its only extreme."""


def friction_as_stated(course: Course) -> Residual:
    """Friction in slip, against ``-(s mu_k N + c x_dot)``."""
    s = course.settings
    stated = course.mode[1] * s["mu_k"] * course.normal_force + s["c"] * course.after("x_dot")
    left = course.after("F_friction") + stated
    drag = float(np.max(np.abs(s["c"])) * course.scale["m/s"])
    return Residual(left, course.mode[1] != 0.0, max(course.scale["N"], drag), "N")


def never_past_rest(course: Course) -> Residual:
    """How far the velocity passes zero inside a step that reports no transition."""
    chosen = course.slip
    direction = course.mode[1][chosen]
    equations, begin = slips(course, chosen, course.mode[1])
    h = np.asarray(course.h[chosen], np.longdouble)
    # Zero where damping lets nothing swing.
    square = equations.k / equations.m - (equations.c / (2.0 * equations.m)) ** 2
    turning_rate = np.sqrt(np.maximum(square, 0.0))
    # Minima rise towards the pull's speed or stay as they are, so the first is the lowest.
    with np.errstate(divide="ignore"):
        span = np.minimum(h, 2.0 * np.pi / turning_rate)
    lowest, at = np.full(h.shape, np.inf, np.longdouble), np.zeros_like(h)
    for part in _PROBES:
        speed = direction * equations.move(begin, span * part).x_dot
        at = np.where(speed < lowest, span * part, at)
        lowest = np.minimum(speed, lowest)
    for _ in range(_POLISHES):
        here = equations.move(begin, at)
        jerk = equations.jerk(here)
        with np.errstate(divide="ignore", invalid="ignore"):
            stride = np.where(jerk == 0.0, 0.0, equations.acceleration(here) / jerk)
        at = np.clip(at - np.clip(stride, -at / 2.0, at / 2.0), 0.0, span)
        lowest = np.minimum(direction * equations.move(begin, at).x_dot, lowest)
    return _spread(course, np.maximum(-lowest, 0.0), course.scale["slip m/s"], "m/s")


def _missed(course: Course, name: str) -> Wide:
    chosen = course.slip
    equations, begin = slips(course, chosen, course.mode[1])
    moved = equations.move(begin, course.h[chosen])
    return np.asarray(course.after(name)[chosen] - getattr(moved, name))


def _spread(course: Course, left: Wide, scale: float, unit: str) -> Residual:
    """Return the residuals of the steps in slip at their places among all steps."""
    values = np.zeros(course.h.size)
    values[course.slip] = left
    return Residual(values, course.slip, scale, unit)


def break_away_at_threshold(course: Course) -> Residual:
    """Force at a break-away inside a step, less F_s."""
    force, threshold, at_once = _at_break_away(course)
    inside = np.asarray(course.break_away & ~at_once)
    rate = course.settings["k"] * np.abs(course.settings["v"])
    left = _beyond(np.abs(force) - threshold, rate * course.dating)
    return Residual(left, inside, course.scale["N"], "N")


def break_away_beyond_threshold(course: Course) -> Residual:
    """By how much the force falls short of F_s where a change let the mass go at once."""
    force, threshold, at_once = _at_break_away(course)
    short = np.maximum(threshold - np.abs(force), 0.0)
    return Residual(short, np.asarray(course.break_away & at_once), course.scale["N"], "N")


def break_away_along_force(course: Course) -> Residual:
    """Force against the direction in which the mass breaks away."""
    force, threshold, _ = _at_break_away(course)
    against = np.maximum(-course.mode[1] * force, 0.0)
    slack = SLACK * (np.abs(force) + threshold)
    left = np.maximum(against - slack, 0.0)
    return Residual(left, course.break_away, course.scale["N"], "N")


def rest_at_re_stick(course: Course) -> Residual:
    """Velocity that the equation of slip gives at the time of a reported re-stick."""
    chosen = course.re_stick
    equations, begin = slips(course, chosen, course.mode[0])
    stopped = equations.move(begin, course.since_begin[chosen])
    rate = np.abs(np.asarray(equations.acceleration(stopped), np.float64))
    values = np.zeros(course.h.size)
    values[chosen] = _beyond(np.asarray(stopped.x_dot, np.float64), rate * course.dating[chosen])
    return Residual(values, chosen, course.scale["slip m/s"], "m/s")


def spring_joined(course: Course) -> Residual:
    """Extension at the end of a step with one transition, against both phases joined at it."""
    v, z = course.settings["v"], course.after("z")
    began, ended = course.break_away, course.re_stick
    first, rest = course.since_begin, course.h - course.since_begin
    values = np.zeros(course.h.size)
    loaded = np.asarray(course.before("z") + v * first, np.longdouble)[began]
    start = State(loaded, np.zeros_like(loaded))
    slipped = slips(course, began, course.mode[1])[0].move(start, rest[began])
    values[began] = z[began] - slipped.z
    stopping, begin = slips(course, ended, course.mode[0])
    stopped = stopping.move(begin, first[ended])
    values[ended] = z[ended] - (stopped.z + v[ended] * rest[ended])
    left = _beyond(values, course.scale["m/s"] * course.dating)
    return Residual(left, np.asarray(began | ended), course.scale["slip m"], "m")


def _at_break_away(course: Course) -> tuple[Series, Series, Mask]:
    """Return force and threshold [N] at each break-away, and whether its step begins with it."""
    s = course.settings
    wait = course.since_begin
    # At the beginning of the first step, and after changes, something may let the mass go.
    reset = np.any(np.array([np.diff(of, prepend=np.nan) for of in s.values()]) != 0.0, axis=0)
    at_once = (wait <= 4.0 * np.spacing(np.abs(course.begins))) & reset
    force = s["k"] * (course.before("z") + s["v"] * np.where(at_once, 0.0, wait)) + s["F_ext"]
    age = None
    if course.grows:
        first = np.where(course.before("n_slips") == 0.0, s["age_start"], 0.0)
        age = course.after("t_stick") + first
    return force, course.static_friction(age)[0], np.asarray(at_once)


def _beyond(left: Series, allowed: Series) -> Series:
    return np.sign(left) * np.maximum(np.abs(left) - allowed, 0.0)


def balance(course: Course) -> Residual:
    """W_pull + W_k + work of F_ext - Q_friction less the change of stored energy, since start."""
    s = course.settings
    pushed = np.cumsum(np.asarray(s["F_ext"] * course.change("x"), np.longdouble))
    supplied = course.after("W_pull") + course.after("W_k") + pushed - course.after("Q_friction")
    stored = 0.5 * s["k"] * course.after("z") ** 2 + 0.5 * s["m"] * course.after("x_dot") ** 2
    before = course.case.start
    z, x_dot = (course.before(name)[0] for name in ("z", "x_dot"))
    at_start = 0.5 * before["k"] * z**2 + 0.5 * before["m"] * x_dot**2
    left = np.asarray(supplied - (stored - at_start), np.float64)
    return course.residual(left, "J")


def heat_of_dry_friction(course: Course) -> Residual:
    """Heat of an undamped step without a transition, less kinetic friction times travel."""
    s = course.settings
    friction = np.where(course.mode[1] == 0.0, 0.0, s["mu_k"] * course.normal_force)
    left = course.change("Q_friction") - friction * np.abs(course.change("x"))
    undamped = s["c"] == 0.0
    return Residual(left, np.asarray(course.eventless & undamped), course.scale["J"], "J")


def work_of_the_pull(course: Course) -> Residual:
    """Work of the pulling end over a step without a transition, against the momentum it gave.

    In stick the spring loads up evenly; in slip the balance of momentum gives the mean of k z.
    """
    s = course.settings
    h, v = course.h, s["v"]
    even = s["k"] * (course.before("z") + 0.5 * v * h) * h
    friction = course.mode[1] * s["mu_k"] * course.normal_force
    impulse = (
        s["m"] * course.change("x_dot") + s["c"] * course.change("x") + (friction - s["F_ext"]) * h
    )
    work = v * np.where(course.mode[1] == 0.0, even, impulse)
    momentum = course.scale["m/s"] * np.max(np.abs(s["v"])) * np.max(s["m"])
    drag = np.max(s["c"]) * course.scale["m"] * np.max(np.abs(s["v"]))
    left = course.change("W_pull") - work
    return Residual(left, course.eventless, course.scale["J"] + float(momentum + drag), "J")


_STEADY = 1e-12
"""Where the exact motion itself keeps delta_x = v T to this part, the cycle is steady."""


def period(course: Course) -> Residual:
    """T less t_stick + t_slip, from a break-away to the end of its slip.

    Where a cycle held a reversal, or T is not written yet, the meter's rules do not say so.
    """
    exact = course.exact.outputs
    parts = exact["t_stick"] + exact["t_slip"]
    applies = (exact["T"] > 0.0) & (np.abs(exact["T"] - parts) <= _STEADY * exact["T"])
    applies &= course.in_phase & (course.mode[1] != 0.0)
    left = course.after("T") - (course.after("t_stick") + course.after("t_slip"))
    return Residual(left, np.asarray(applies), exact["T"], "s")


def jump(course: Course) -> Residual:
    """delta_x less v T, where the exact cycle is steady."""
    exact = course.exact.outputs
    v = course.settings["v"]
    way = v * exact["T"]
    applies = (exact["T"] > 0.0) & (np.abs(exact["delta_x"] - way) <= _STEADY * np.abs(way))
    applies &= course.in_phase
    left = course.after("delta_x") - v * course.after("T")
    return Residual(left, np.asarray(applies), np.abs(way), "m")


def break_away_force(course: Course) -> Residual:
    """F_s less mu_s N, at the age of the stick where mu_s grows."""
    threshold, rate = course.static_friction(course.age)
    left = course.after("F_s") - threshold
    left = _beyond(left, rate * course.dating)
    return course.residual(left, "N")


def columns(course: Course) -> Residual:
    """How many outputs are missing, or have not one sample per communication point."""
    outputs, n = course.record.outputs, course.h.size
    wrong = sum(name not in outputs or outputs[name].size != n for name in OUTPUT_NAMES)
    return course.residual(np.full(n, float(wrong)), "1")


def finite(course: Course) -> Residual:
    """How many outputs are no finite number, or are missing at the point."""
    count = np.zeros(course.h.size)
    for samples in course.record.outputs.values():
        count[samples.size :] += 1
        count[: samples.size] += ~np.isfinite(samples[: count.size])
    return course.residual(count, "1")


def start(course: Course) -> Residual:
    """Largest deviation of an output after initialization, over the output's own scale."""
    got, exact = course.record.initial, course.exact
    off = np.array([abs(value - exact.initial[name]) for name, value in got.items()])
    scale = [max(np.max(np.abs(exact.outputs[n])), abs(exact.initial[n])) for n in got]
    worst = np.max(np.where(off == 0.0, 0.0, off / np.array(scale)))
    return Residual(np.full(course.h.size, worst), np.arange(course.h.size) == 0, 1.0, "1")


def _within_break_away(c: Course) -> Residual:
    """By how much the force on a resting mass exceeds F_s, beyond the slack of the rest test."""
    spring, push = c.settings["k"] * c.after("z"), c.settings["F_ext"]
    threshold, rate = c.static_friction(c.age)
    slack = SLACK * (np.abs(spring) + np.abs(push) + threshold) + rate * c.dating
    excess = np.maximum(np.abs(spring + push) - threshold - slack, 0.0)
    return c.residual(excess, "N", c.rests)


DIRECT: Final[dict[str, Metric]] = {
    "stick.position_held": lambda c: c.residual(c.change("x"), "m", c.stick),
    "stick.at_rest": lambda c: c.residual(c.after("x_dot"), "m/s", c.rests),
    "stick.friction_balances": lambda c: c.residual(
        c.after("F_friction") + (c.settings["k"] * c.after("z") + c.settings["F_ext"]), "N", c.rests
    ),
    "stick.within_break_away": _within_break_away,
    "slip.extension_follows": lambda c: _spread(c, _missed(c, "z"), c.scale["slip m"], "m"),
    "slip.velocity_follows": lambda c: _spread(c, _missed(c, "x_dot"), c.scale["slip m/s"], "m/s"),
    "slip.friction_against_motion": lambda c: c.residual(
        np.maximum(c.after("F_friction") * np.sign(c.after("x_dot")), 0.0), "N", ~c.rests
    ),
    "slip.direction_is_mode": lambda c: c.residual(
        np.maximum(-c.mode[1] * c.after("x_dot"), 0.0), "m/s", ~c.rests
    ),
    "energy.heat_never_falls": lambda c: c.residual(np.maximum(-c.change("Q_friction"), 0.0), "J"),
    "outputs.spring_force": lambda c: c.residual(
        c.after("F") - c.settings["k"] * c.after("z"), "N"
    ),
    "outputs.extension": lambda c: c.residual(
        c.after("z") - (c.after("x_pull") - c.after("x")), "m"
    ),
    "outputs.pulled_end": lambda c: c.residual(c.change("x_pull") - c.settings["v"] * c.h, "m"),
    "outputs.frequency": lambda c: c.residual(
        c.after("f") * c.after("T") - (c.after("T") > 0.0), "1"
    ),
    "outputs.mode_and_sticking": lambda c: c.residual(
        1.0 * ((c.after("mode") == 0.0) != (c.after("sticking") != 0.0)), "1"
    ),
    "outputs.clamped_coefficient": lambda c: c.residual(
        c.after("mu_k_used") - c.settings["mu_k"],
        "1",
        scale=float(np.max(c.settings["mu_s"])) or 1.0,
    ),
    # Communication points that were not reached.
    "outputs.finished": lambda c: c.residual(
        np.full(c.h.size, abs(float(c.h.size - c.record.times.size))), "1"
    ),
}


METRICS: dict[str, Metric] = DIRECT | {
    f"{part}.{metric.__name__}": metric
    for part, metrics in {
        "slip": (friction_as_stated, never_past_rest),
        "events": (
            break_away_at_threshold,
            break_away_beyond_threshold,
            break_away_along_force,
            rest_at_re_stick,
            spring_joined,
        ),
        "energy": (balance, heat_of_dry_friction, work_of_the_pull),
        "outputs": (period, jump, break_away_force, columns, finite, start),
    }.items()
    for metric in metrics
}
"""What an invariant can name as ``metric``."""
