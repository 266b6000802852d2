"""The energy account, (15)."""

import numpy as np

from stickslip_verification.judge.metrics.course import Course, Residual


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
    return course.residual(left, course.energy_scale, "J")


def heat_of_dry_friction(course: Course) -> Residual:
    """Heat of an undamped step without a transition, less kinetic friction times travel."""
    s = course.settings
    friction = np.where(course.mode[1] == 0.0, 0.0, s["mu_k"] * course.normal_force)
    left = course.change("Q_friction") - friction * np.abs(course.change("x"))
    undamped = s["c"] == 0.0
    return Residual(left, np.asarray(course.eventless & undamped), course.energy_scale, "J")


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
    momentum = course.speed_scale * np.max(np.abs(s["v"])) * np.max(s["m"])
    drag = np.max(s["c"]) * course.length_scale * np.max(np.abs(s["v"]))
    left = course.change("W_pull") - work
    return Residual(left, course.eventless, course.energy_scale + float(momentum + drag), "J")
