"""The invariant of stick, (1): the force on a resting mass stays within break-away."""

import numpy as np

from stickslip_verification.judge.metrics.course import SLACK, Course, Residual


def within_break_away(course: Course) -> Residual:
    """By how much the force on a resting mass exceeds F_s, beyond the slack of the rest test."""
    s = course.settings
    spring, push = s["k"] * course.after("z"), s["F_ext"]
    threshold, rate = course.static_friction(course.age)
    slack = SLACK * (np.abs(spring) + np.abs(push) + threshold) + rate * course.dating
    excess = np.maximum(np.abs(spring + push) - threshold - slack, 0.0)
    return Residual(excess, course.rests, course.force_scale, "N")
