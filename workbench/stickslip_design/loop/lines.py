"""The friction of a slip over its speed, as straight lines from knot to knot."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from stickslip_ref import STRIBECK, Shape

from ..axis import Axis

_LINES: Final = 24
"""Lines of a smooth fall: within 0.2 % of its drop."""
_LOOKS: Final = 4000
_SLOWEST, _FASTEST = 1e-3, 1e3
"""Speeds at which a smooth fall is looked at, over v_s."""


class Line(NamedTuple):
    """Dry friction from one speed to the next."""

    low: float
    high: float
    """The speeds [m/s]; the last line goes to infinity."""
    force: float
    """Friction at the lower speed [N]."""
    slope: float
    """How it rises with the speed [N.s/m]."""


def lines_of(axis: Axis) -> tuple[Line, ...]:
    """Return the dry friction of the guideway in slip, without its viscous part.

    One line for constant coefficients; those between the points of a measured curve; of a smooth
    fall lines whose distance from it is alike everywhere.
    """
    friction = axis.friction
    if friction.law != "stribeck" or (friction.mu_s == friction.mu_k and not friction.is_curve):
        return (Line(0.0, math.inf, axis.F_k, 0.0),)
    p = STRIBECK.complete(axis.block(1.0), friction.own)
    if p.own["shape"] == Shape.CURVE:
        speeds = np.array([0.0, *STRIBECK.knots(p)])
    else:
        v_s = p.own["v_s"]
        looks = np.concatenate([[0.0], np.geomspace(_SLOWEST * v_s, _FASTEST * v_s, _LOOKS)])
        force = STRIBECK.friction_at(p, looks)
        slope = np.diff(force) / np.diff(looks)
        # The bend of each place, so that lines are short where the friction bends.
        bend = np.sqrt(np.abs(np.diff(slope)) * 0.5 * (looks[2:] - looks[:-2]))
        share = np.concatenate([[0.0, 0.0], np.cumsum(bend)])
        speeds = np.interp(np.linspace(0.0, share[-1], _LINES + 1), share, looks[: share.size])
        speeds[0] = 0.0
    forces = STRIBECK.friction_at(p, speeds)
    lines = [
        Line(low, high, force, (following - force) / (high - low))
        for low, high, force, following in zip(
            speeds[:-1].tolist(), speeds[1:].tolist(), forces[:-1].tolist(), forces[1:].tolist(),
            strict=True,
        )
    ]  # fmt: skip
    return (*lines, Line(float(speeds[-1]), math.inf, float(forces[-1]), 0.0))


def line_at(axis: Axis, feed: float) -> Line:
    """Return the dry friction of the guideway about a feed [m/s]: the line that touches it."""
    friction = axis.friction
    if friction.law != "stribeck" or friction.is_curve:
        return next(line for line in lines_of(axis) if feed <= line.high)
    p = STRIBECK.complete(axis.block(1.0), friction.own)
    return Line(feed, math.inf, STRIBECK.slip_friction(p, feed), STRIBECK.slope(p, feed))
