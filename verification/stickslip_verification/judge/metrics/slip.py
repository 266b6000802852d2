"""The invariant of slip, (1) and (3): exact from sample to sample, friction against the motion."""

import numpy as np

from stickslip_verification.judge.metrics import propagation
from stickslip_verification.judge.metrics.course import Course, Residual

_POLISHES = 4
_PROBES = (*(0.5**n for n in range(30, 4, -1)), *(n / 16.0 for n in range(1, 17)))
"""Where the lowest velocity is looked for first, as parts of a step or of its first turn: evenly,
and near the beginning too, where a heavily damped motion has its only extreme."""


def extension_follows(course: Course) -> Residual:
    """Extension of the spring at the end of a step in slip, against the equation of slip."""
    return _spread(course, _missed(course, "z"), course.swing_length, "m")


def velocity_follows(course: Course) -> Residual:
    """Velocity at the end of a step in slip, against the equation of slip."""
    return _spread(course, _missed(course, "x_dot"), course.swing_speed, "m/s")


def friction_as_stated(course: Course) -> Residual:
    """Friction in slip, against ``-(s mu_k N + c x_dot)``."""
    s = course.settings
    stated = course.mode[1] * s["mu_k"] * course.normal_force + s["c"] * course.after("x_dot")
    left = course.after("F_friction") + stated
    drag = float(np.max(np.abs(s["c"])) * course.speed_scale)
    return Residual(left, course.mode[1] != 0.0, max(course.force_scale, drag), "N")


def never_past_rest(course: Course) -> Residual:
    """How far the velocity passes zero inside a step that reports no transition."""
    chosen = course.slip
    direction = course.mode[1][chosen]
    equations = propagation.slips(course, chosen, course.mode[1])
    begin = propagation.state(course, chosen)
    h = np.asarray(course.h[chosen], np.longdouble)
    # Minima rise towards the pull's speed or stay as they are, so the first is the lowest.
    with np.errstate(divide="ignore"):
        span = np.minimum(h, 2.0 * np.pi / equations.turning_rate)
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
    return _spread(course, np.maximum(-lowest, 0.0), course.swing_speed, "m/s")


def _missed(course: Course, name: str) -> propagation.Wide:
    """Return an output at the end of the steps in slip, less what the equation of slip gives."""
    chosen = course.slip
    equations = propagation.slips(course, chosen, course.mode[1])
    moved = equations.move(propagation.state(course, chosen), course.h[chosen])
    return np.asarray(course.after(name)[chosen] - getattr(moved, name))


def _spread(course: Course, left: propagation.Wide, scale: float, unit: str) -> Residual:
    """Return the residuals of the steps in slip at their places among all steps."""
    values = np.zeros(course.h.size)
    values[course.slip] = left
    return Residual(values, course.slip, scale, unit)
