"""The line through a run's samples and events, as it is drawn.

Between two points the curve is the cubic with the slopes that the outputs give, so a slip is
smooth; a stick is the straight line it is, and the corners stay corners.
"""

import math
from typing import Final, NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from stickslip.runs.run import Floats, Run

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
    """Return the samples alone: all that is known of a run with hidden events.

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
    """Return the curve through samples and events, exactly flat in stick.

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
    k, v = run.parameters.k, run.parameters.v
    at_events = np.array([event.time for event in run.events])
    times = np.concatenate([samples["time"], at_events])
    # An event at the time of a sample stands for both.
    t, chosen = np.unique(times[::-1], return_index=True)
    chosen = len(times) - 1 - chosen
    is_event = chosen >= len(samples)
    x = np.concatenate([samples["x"], [event.x for event in run.events]])[chosen]
    x_dot = np.concatenate([samples["x_dot"], np.zeros(len(run.events))])[chosen]

    h = np.diff(t)
    part = np.arange(_POINTS_PER_STEP) / _POINTS_PER_STEP
    t_drawn = np.append((t[:-1, None] + h[:, None] * part).ravel(), t[-1])
    # From event to event a cubic is the best guess at any step; elsewhere a coarse step is drawn
    # straight.
    smooth = h * math.sqrt(k / run.parameters.m) < _LONGEST_SMOOTH_STEP
    smooth |= is_event[:-1] & is_event[1:]
    x_drawn = np.interp(t_drawn, t, x)
    curved = np.append(np.repeat(smooth, _POINTS_PER_STEP), False)
    x_drawn[curved] = CubicHermiteSpline(t, x, x_dot)(t_drawn[curved])
    x_pull = float(samples["x_pull"][0]) + v * (t_drawn - float(samples["time"][0]))
    return Curve(t_drawn, x_drawn, x_pull, k * (x_pull - x_drawn))


def stick_phases(run: Run) -> list[tuple[float, float]]:
    """Return beginning and end [s] of every stick that the events of the run show."""
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
