"""The line through a run's samples and events, as it is drawn.

Between two points the curve is the cubic with the slopes that the outputs give, so a slip is
smooth; a stick is the straight line it is, and the corners stay corners.
"""

import math
from typing import Final, NamedTuple

import numpy as np

from stickslip.run import Floats, Run

_POINTS_PER_STEP: Final = 8

_LONGEST_SMOOTH_STEP: Final = 2.0
"""Radians of the free oscillation in a step above which a cubic would invent a motion."""


class Curve(NamedTuple):
    """The motion drawn: arrays of one shape (n,), SI."""

    t: Floats
    x: Floats
    x_pull: Floats
    F: Floats


def points(run: Run) -> Curve:
    """Give the samples alone: all that is known of a run with hidden events.

    Parameters
    ----------
    run
        The run to draw.

    Returns
    -------
    Curve
        The samples, shape (n,), as `curve` gives them.
    """
    samples = run.samples
    return Curve(samples["time"], samples["x"], samples["x_pull"], samples["F"])


def curve(run: Run) -> Curve:
    """Give the curve through samples and events, exactly flat in stick.

    Parameters
    ----------
    run
        The run to draw; one without hidden events.

    Returns
    -------
    Curve
        Time [s], position of the mass and of the pulled end [m], and spring force [N], shape (n,).
    """
    samples = run.samples
    k, v = run.parameters["k"], run.parameters["v"]
    at_events = np.array([event.time for event in run.events])
    order = np.argsort(np.concatenate([samples["time"], at_events]), kind="stable")
    is_event = order >= len(samples)
    t = np.concatenate([samples["time"], at_events])[order]
    x = np.concatenate([samples["x"], [event.x for event in run.events]])[order]
    x_dot = np.concatenate([samples["x_dot"], np.zeros(len(run.events))])[order]

    h = np.diff(t)[:, None]
    rise = np.diff(x)[:, None]
    # From event to event a cubic is the best guess at any step; elsewhere a coarse step is drawn
    # straight.
    smooth = (h * math.sqrt(k / run.parameters["m"]) < _LONGEST_SMOOTH_STEP) | (
        is_event[:-1] & is_event[1:]
    )[:, None]
    slope_before = np.where(smooth, x_dot[:-1, None] * h, rise)
    slope_after = np.where(smooth, x_dot[1:, None] * h, rise)
    part = np.linspace(0.0, 1.0, _POINTS_PER_STEP, endpoint=False)[None, :]
    # Hermite's cubic as a departure from its first value: with equal ends at rest it stays there
    # to the last bit.
    cubic = x[:-1, None] + part * (
        slope_before
        + part
        * (
            3.0 * rise
            - 2.0 * slope_before
            - slope_after
            + part * (slope_before + slope_after - 2.0 * rise)
        )
    )
    t_drawn = np.append((t[:-1, None] + h * part).ravel(), t[-1])
    x_drawn = np.append(cubic.ravel(), x[-1])
    x_pull = float(samples["x_pull"][0]) + v * (t_drawn - float(samples["time"][0]))
    return Curve(t_drawn, x_drawn, x_pull, k * (x_pull - x_drawn))


def stick_phases(run: Run) -> list[tuple[float, float]]:
    """Give beginning and end [s] of every stick that the events of the run show."""
    begin = float(run.samples["time"][0]) if run.samples["mode"][0] == 0 else None
    phases = []
    for event in run.events:
        if event.kind == "break-away" and begin is not None:
            phases.append((begin, event.time))
            begin = None
        elif event.kind == "re-stick":
            begin = event.time
    if begin is not None and run.last["mode"] == 0:
        phases.append((begin, float(run.last["time"])))
    return phases
