"""Outputs that say the same thing twice must agree: docs/theory.md (1), (2), (6), (10), (16)."""

import numpy as np

from stickslip_verification.judge.metrics.course import Course, Residual
from stickslip_verification.model.quantities import OUTPUT_NAMES

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
    left = np.sign(left) * np.maximum(np.abs(left) - rate * course.dating, 0.0)
    return course.residual(left, course.force_scale, "N")


def columns(course: Course) -> Residual:
    """How many outputs are missing, or have not one sample per communication point."""
    outputs, n = course.record.outputs, course.h.size
    wrong = sum(name not in outputs or outputs[name].size != n for name in OUTPUT_NAMES)
    return course.residual(np.full(n, float(wrong)), 1.0, "1")


def finite(course: Course) -> Residual:
    """How many outputs are no finite number, or are missing at the point."""
    count = np.zeros(course.h.size)
    for samples in course.record.outputs.values():
        count[samples.size :] += 1
        count[: samples.size] += ~np.isfinite(samples[: count.size])
    return course.residual(count, 1.0, "1")


def start(course: Course) -> Residual:
    """Largest deviation of an output after initialization, over the output's own scale."""
    got, exact = course.record.initial, course.exact
    off = np.array([abs(value - exact.initial[name]) for name, value in got.items()])
    scale = [max(np.max(np.abs(exact.outputs[n])), abs(exact.initial[n])) for n in got]
    worst = np.max(np.where(off == 0.0, 0.0, off / np.array(scale)))
    return Residual(np.full(course.h.size, worst), np.arange(course.h.size) == 0, 1.0, "1")
