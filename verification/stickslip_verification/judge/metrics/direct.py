"""Residuals of stick, and those that one expression makes of a run, by the name of the metric."""

from typing import Final

import numpy as np

from stickslip_verification.judge.metrics.course import SLACK, Course, Metric, Residual


def _within_break_away(c: Course) -> Residual:
    """By how much the force on a resting mass exceeds F_s, beyond the slack of the rest test."""
    spring, push = c.settings["k"] * c.after("z"), c.settings["F_ext"]
    threshold, rate = c.static_friction(c.age)
    slack = SLACK * (np.abs(spring) + np.abs(push) + threshold) + rate * c.dating
    excess = np.maximum(np.abs(spring + push) - threshold - slack, 0.0)
    return Residual(excess, c.rests, c.force_scale, "N")


DIRECT: Final[dict[str, Metric]] = {
    "stick.position_held": lambda c: c.residual(c.change("x"), c.length_scale, "m", c.stick),
    "stick.at_rest": lambda c: c.residual(c.after("x_dot"), c.speed_scale, "m/s", c.rests),
    "stick.friction_balances": lambda c: c.residual(
        c.after("F_friction") + (c.settings["k"] * c.after("z") + c.settings["F_ext"]),
        c.force_scale,
        "N",
        c.rests,
    ),
    "stick.within_break_away": _within_break_away,
    "slip.friction_against_motion": lambda c: c.residual(
        np.maximum(c.after("F_friction") * np.sign(c.after("x_dot")), 0.0),
        c.force_scale,
        "N",
        ~c.rests,
    ),
    "slip.direction_is_mode": lambda c: c.residual(
        np.maximum(-c.mode[1] * c.after("x_dot"), 0.0), c.speed_scale, "m/s", ~c.rests
    ),
    "energy.heat_never_falls": lambda c: c.residual(
        np.maximum(-c.change("Q_friction"), 0.0), c.energy_scale, "J"
    ),
    "outputs.spring_force": lambda c: c.residual(
        c.after("F") - c.settings["k"] * c.after("z"), c.force_scale, "N"
    ),
    "outputs.extension": lambda c: c.residual(
        c.after("z") - (c.after("x_pull") - c.after("x")), c.length_scale, "m"
    ),
    "outputs.pulled_end": lambda c: c.residual(
        c.change("x_pull") - c.settings["v"] * c.h, c.length_scale, "m"
    ),
    "outputs.frequency": lambda c: c.residual(
        c.after("f") * c.after("T") - (c.after("T") > 0.0), 1.0, "1"
    ),
    "outputs.mode_and_sticking": lambda c: c.residual(
        1.0 * ((c.after("mode") == 0.0) != (c.after("sticking") != 0.0)), 1.0, "1"
    ),
    "outputs.clamped_coefficient": lambda c: c.residual(
        c.after("mu_k_used") - c.settings["mu_k"], float(np.max(c.settings["mu_s"])) or 1.0, "1"
    ),
    # Communication points that were not reached.
    "outputs.finished": lambda c: c.residual(
        np.full(c.h.size, abs(float(c.h.size - c.record.times.size))), 1.0, "1"
    ),
}
