"""The transitions, (1), (4), (5): where a slip begins, where it ends, and that both phases join."""

from __future__ import annotations

import numpy as np

from stickslip_verification.metrics import propagation
from stickslip_verification.metrics.course import SLACK, Course, Mask
from stickslip_verification.metrics.residual import Residual
from stickslip_verification.record import Series


def break_away_at_threshold(course: Course) -> Residual:
    """Force at a break-away inside a step, less F_s."""
    force, threshold, at_once = _at_break_away(course)
    inside = np.asarray(course.break_away & ~at_once)
    return Residual(np.abs(force) - threshold, inside, _force(course), "N")


def break_away_beyond_threshold(course: Course) -> Residual:
    """By how much the force falls short of F_s where a change let the mass go at once."""
    force, threshold, at_once = _at_break_away(course)
    short = np.maximum(threshold - np.abs(force), 0.0)
    return Residual(short, np.asarray(course.break_away & at_once), _force(course), "N")


def break_away_along_force(course: Course) -> Residual:
    """Force against the direction in which the mass breaks away."""
    force, threshold, _ = _at_break_away(course)
    against = np.maximum(-course.mode[1] * force, 0.0)
    slack = SLACK * (np.abs(force) + threshold)
    return Residual(np.maximum(against - slack, 0.0), course.break_away, _force(course), "N")


def rest_at_re_stick(course: Course) -> Residual:
    """Velocity that the equation of slip gives at the time of a reported re-stick."""
    chosen = course.re_stick
    equations = propagation.slips(course, chosen, course.mode[0])
    length = np.asarray(course.since_begin[chosen], np.longdouble)
    left = equations.move(propagation.state(course, chosen), length).x_dot
    return Residual(_spread(course, chosen, left), chosen, _speed(course), "m/s")


def spring_joined(course: Course) -> Residual:
    """Extension at the end of a step with one transition, against both phases joined at it."""
    values = np.zeros(course.h.size)
    v = course.settings["v"]
    began, ended = course.break_away, course.re_stick
    first, rest = course.since_begin, course.h - course.since_begin
    slipped = propagation.slips(course, began, course.mode[1])
    loaded = course.before("z")[began] + v[began] * first[began]
    start = propagation.State(
        np.asarray(loaded, np.longdouble), np.zeros(loaded.size, np.longdouble)
    )
    joined = slipped.move(start, np.asarray(rest[began], np.longdouble)).z
    values[began] = course.after("z")[began] - joined
    stopping = propagation.slips(course, ended, course.mode[0])
    stopped = stopping.move(
        propagation.state(course, ended), np.asarray(first[ended], np.longdouble)
    ).z
    values[ended] = course.after("z")[ended] - (stopped + v[ended] * rest[ended])
    dating = course.speed_scale * float(np.max(np.abs(course.record.times)))
    return Residual(values, np.asarray(began | ended), course.length_scale + dating, "m")


def _at_break_away(course: Course) -> tuple[Series, Series, Mask]:
    """Give force and threshold [N] at each break-away, and whether its step begins with it."""
    s = course.settings
    wait = course.since_begin
    at_once = wait <= 4.0 * np.spacing(np.abs(course.begins))
    force = s["k"] * (course.before("z") + s["v"] * np.where(at_once, 0.0, wait)) + s["F_ext"]
    return force, s["mu_s"] * course.normal_force, np.asarray(at_once)


def _force(course: Course) -> float:
    """Scale of a force at a time that is known to the rounding of absolute time [N]."""
    rate = np.max(course.settings["k"]) * np.max(np.abs(course.settings["v"]))
    return course.force_scale + float(rate * np.max(course.record.times))


def _speed(course: Course) -> float:
    """Scale of a velocity at a time that is known to the rounding of absolute time [m/s]."""
    pull = course.force_scale / float(np.min(course.settings["m"]))
    drag = float(np.max(course.settings["c"] / course.settings["m"])) * course.speed_scale
    return course.speed_scale + (pull + drag) * float(np.max(course.record.times))


def _spread(course: Course, chosen: Mask, left: propagation.Wide) -> Series:
    values = np.zeros(course.h.size)
    values[chosen] = left
    return values
