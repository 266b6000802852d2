"""The invariant of stick, (1): x constant, force within break-away, friction holds the balance."""

import numpy as np

from stickslip_verification.judge.metrics.course import SLACK, Course, Residual


def position_held(course: Course) -> Residual:
    """How far the mass moves in a stick."""
    return Residual(course.change("x"), course.stick, course.length_scale, "m")


def at_rest(course: Course) -> Residual:
    """Velocity in a stick."""
    rests = course.mode[1] == 0.0
    return Residual(course.after("x_dot"), rests, course.speed_scale, "m/s")


def within_break_away(course: Course) -> Residual:
    """By how much the force on a resting mass exceeds F_s, beyond the slack of the rest test."""
    s = course.settings
    spring, push = s["k"] * course.after("z"), s["F_ext"]
    threshold, rate = course.static_friction(course.age)
    slack = SLACK * (np.abs(spring) + np.abs(push) + threshold) + rate * course.dating
    excess = np.maximum(np.abs(spring + push) - threshold - slack, 0.0)
    return Residual(excess, course.mode[1] == 0.0, course.force_scale, "N")


def friction_balances(course: Course) -> Residual:
    """Sum of F, F_ext and friction on a resting mass."""
    force = course.settings["k"] * course.after("z") + course.settings["F_ext"]
    left = course.after("F_friction") + force
    return Residual(left, course.mode[1] == 0.0, course.force_scale, "N")
