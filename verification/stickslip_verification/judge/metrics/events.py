"""The transitions, (1), (4), (5): where a slip begins, where it ends, and that both phases join."""

import numpy as np

from stickslip_verification.judge.metrics import propagation
from stickslip_verification.judge.metrics.course import SLACK, Course, Mask, Residual
from stickslip_verification.model.run import Series


def break_away_at_threshold(course: Course) -> Residual:
    """Force at a break-away inside a step, less F_s."""
    force, threshold, at_once = _at_break_away(course)
    inside = np.asarray(course.break_away & ~at_once)
    rate = course.settings["k"] * np.abs(course.settings["v"])
    left = _beyond(np.abs(force) - threshold, rate * course.dating)
    return Residual(left, inside, course.force_scale, "N")


def break_away_beyond_threshold(course: Course) -> Residual:
    """By how much the force falls short of F_s where a change let the mass go at once."""
    force, threshold, at_once = _at_break_away(course)
    short = np.maximum(threshold - np.abs(force), 0.0)
    return Residual(short, np.asarray(course.break_away & at_once), course.force_scale, "N")


def break_away_along_force(course: Course) -> Residual:
    """Force against the direction in which the mass breaks away."""
    force, threshold, _ = _at_break_away(course)
    against = np.maximum(-course.mode[1] * force, 0.0)
    slack = SLACK * (np.abs(force) + threshold)
    left = np.maximum(against - slack, 0.0)
    return Residual(left, course.break_away, course.force_scale, "N")


def rest_at_re_stick(course: Course) -> Residual:
    """Velocity that the equation of slip gives at the time of a reported re-stick."""
    chosen = course.re_stick
    equations = propagation.slips(course, chosen, course.mode[0])
    stopped = equations.move(propagation.state(course, chosen), course.since_begin[chosen])
    rate = np.abs(np.asarray(equations.acceleration(stopped), np.float64))
    values = np.zeros(course.h.size)
    values[chosen] = _beyond(np.asarray(stopped.x_dot, np.float64), rate * course.dating[chosen])
    return Residual(values, chosen, course.swing_speed, "m/s")


def spring_joined(course: Course) -> Residual:
    """Extension at the end of a step with one transition, against both phases joined at it."""
    v, z = course.settings["v"], course.after("z")
    began, ended = course.break_away, course.re_stick
    first, rest = course.since_begin, course.h - course.since_begin
    values = np.zeros(course.h.size)
    loaded = np.asarray(course.before("z") + v * first, np.longdouble)[began]
    start = propagation.State(loaded, np.zeros_like(loaded))
    slipped = propagation.slips(course, began, course.mode[1]).move(start, rest[began])
    values[began] = z[began] - slipped.z
    stopping = propagation.slips(course, ended, course.mode[0])
    stopped = stopping.move(propagation.state(course, ended), first[ended])
    values[ended] = z[ended] - (stopped.z + v[ended] * rest[ended])
    left = _beyond(values, course.speed_scale * course.dating)
    return Residual(left, np.asarray(began | ended), course.swing_length, "m")


def _at_break_away(course: Course) -> tuple[Series, Series, Mask]:
    """Return force and threshold [N] at each break-away, and whether its step begins with it."""
    s = course.settings
    wait = course.since_begin
    at_once = (wait <= 4.0 * np.spacing(np.abs(course.begins))) & course.reset_at_begin
    force = s["k"] * (course.before("z") + s["v"] * np.where(at_once, 0.0, wait)) + s["F_ext"]
    return force, course.static_friction(course.age_at_break_away)[0], np.asarray(at_once)


def _beyond(left: Series, allowed: Series) -> Series:
    """Return what of a residual is more than the dating of an event may leave over."""
    return np.sign(left) * np.maximum(np.abs(left) - allowed, 0.0)
