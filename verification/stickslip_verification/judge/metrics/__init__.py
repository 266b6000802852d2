"""Residuals of the equations of motion, of energy and between outputs, from the samples."""

from stickslip_verification.judge.metrics import energy, events, outputs, slip, stick
from stickslip_verification.judge.metrics.course import Course, MissingOutputError
from stickslip_verification.judge.metrics.residual import Metric, Residual

__all__ = ["METRICS", "Course", "Metric", "MissingOutputError", "Residual"]

METRICS: dict[str, Metric] = {
    f"{module.__name__.rpartition('.')[2]}.{metric.__name__}": metric
    for module, metrics in (
        (
            stick,
            (
                stick.position_held,
                stick.at_rest,
                stick.within_break_away,
                stick.friction_balances,
            ),
        ),
        (
            slip,
            (
                slip.extension_follows,
                slip.velocity_follows,
                slip.friction_as_stated,
                slip.friction_against_motion,
                slip.direction_is_mode,
                slip.never_past_rest,
            ),
        ),
        (
            events,
            (
                events.break_away_at_threshold,
                events.break_away_beyond_threshold,
                events.break_away_along_force,
                events.rest_at_re_stick,
                events.spring_joined,
            ),
        ),
        (
            energy,
            (
                energy.balance,
                energy.heat_never_falls,
                energy.heat_of_dry_friction,
                energy.work_of_the_pull,
            ),
        ),
        (
            outputs,
            (
                outputs.finished,
                outputs.columns,
                outputs.finite,
                outputs.start,
                outputs.spring_force,
                outputs.extension,
                outputs.pulled_end,
                outputs.period,
                outputs.jump,
                outputs.frequency,
                outputs.mode_and_sticking,
                outputs.break_away_force,
                outputs.clamped_coefficient,
            ),
        ),
    )
    for metric in metrics
}
"""What an invariant can name as ``metric``: module and function."""
