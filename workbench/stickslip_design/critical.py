"""The critical feed of an axis, the highest that it reaches in jumps, and its jump at a feed."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final, NamedTuple

from stickslip_ref import coulomb_limit, critical_velocity, simulate, steady_cycle

from .axis import Axis
from .loop.jumps import limit_of_jumps
from .loop.stability import swing

_CYCLES: Final = 12
"""Cycles after which a jump under a law without a closed form is read."""
_BESIDE: Final = 1e-9
"""A range of feeds this narrow is one feed."""


def critical_feed(axis: Axis, highest: float = math.inf) -> float:
    """Return the highest feed that an axis reaches in jumps when the feed rises slowly [m/s].

    Parameters
    ----------
    axis
        The axis; with a drive its friction has constant coefficients.
    highest
        With a drive, where the search ends [m/s].

    Returns
    -------
    float
        0 where it never jumps; infinite where jumps have no end.
    """
    if axis.drive is None:
        return rigid_critical_feed(axis)
    return limit_of_jumps(axis, highest).feed


def rigid_critical_feed(axis: Axis) -> float:
    """Return the critical feed of an axis on a rigid drive [m/s], under its own friction law."""
    p = axis.block(1.0)
    if axis.friction.constant:
        return float(coulomb_limit(p))
    return critical_velocity(p, axis.friction.law, axis.friction.own).highest


def has_cycle(axis: Axis, feed: float) -> bool:
    """Return whether a cycle with a stick exists at a feed [m/s] on a rigid drive."""
    friction, beside = axis.friction, (feed * (1.0 - _BESIDE), feed)
    return bool(critical_velocity(axis.block(feed), friction.law, friction.own, beside).cycle)


def estimated_critical_feed(axis: Axis) -> float:
    """Return the quick estimate of the critical feed with a drive [m/s]; docs/theory.md (14).

    It is that of a rigid drive whose table is damped as the least damped swing of the sliding loop.
    """
    damping = swing(axis).damping
    if damping <= 0.0:
        return math.inf
    if damping >= 1.0:
        return 0.0
    return float(coulomb_limit(damped(axis, damping).block(1.0)))


def simplified_critical_feed(axis: Axis) -> float:
    """Return (mu_s - mu_k) N/sqrt(4 pi zeta k m) of the rigid drive [m/s]; infinite if c = 0."""
    zeta = axis.c / (2.0 * math.sqrt(axis.k * axis.m))
    if zeta == 0.0:
        return math.inf
    return (axis.F_s - axis.F_k) / math.sqrt(4.0 * math.pi * zeta * axis.k * axis.m)


class Jumps(NamedTuple):
    """The settled jumps at a feed: the way of the longest [m], and how many there are [1/s]."""

    way: float
    rate: float


def jumps_of(axis: Axis, feed: float) -> Jumps | None:
    """Return the jumps at a feed that an axis reaches in jumps [m/s].

    None where there is no even row of jumps: above the critical feed, and where a drive turns the
    table back between two jumps.
    """
    if axis.drive is not None:
        limit = limit_of_jumps(axis, highest=feed)
        if limit.jump is None or limit.feed < feed:
            return None
        return Jumps(limit.jump.way, limit.rate)
    p, friction = axis.block(feed), axis.friction
    if friction.constant:
        jump = float(steady_cycle(p).delta_x)
        return None if math.isnan(jump) else Jumps(jump, feed / jump)
    load_up = axis.F_s / (axis.k * feed)
    one = load_up + 2.0 * math.pi * math.sqrt(axis.m / axis.k)
    run = simulate(p, load_up + _CYCLES * one, law=friction.law, own=friction.own)
    return Jumps(run.cycles[-1].delta_x, 1.0 / run.cycles[-1].T) if run.cycles else None


def damped(axis: Axis, zeta: float) -> Axis:
    """Return the axis with another damping ratio of table and spring [-]."""
    return replace(axis, c=2.0 * zeta * math.sqrt(axis.k * axis.m))
