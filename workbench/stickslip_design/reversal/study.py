"""Circles and reversal values of two axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..axis import Assumed, Axis
from .circle import Circle, circle, reversal_value
from .follower import Follower, assumed


class AxisValue(NamedTuple):
    """The reversal value of an axis: ISO 230-2."""

    axis: str
    """What the axis is called."""
    B: float
    """Where it rests from below, less from above [m]; negative where it stays behind."""
    feed: float
    """Feed at which it came to its target [m/s]."""


class Reversals(NamedTuple):
    """What axes do where they reverse."""

    circles: tuple[Circle, ...]
    """By radius, feed and part that is fed forward."""
    values: tuple[AxisValue, ...]
    """Of each axis that differs."""
    assumed: tuple[Assumed, ...]
    """What the axes do not state."""


def study(
    axes: Sequence[Axis], feeds: Sequence[float], radii: Sequence[float], shares: Sequence[float]
) -> Reversals:
    """Run each feed [m/s] on each radius [m], with each part of Coulomb friction fed forward.

    The first of one or two axes is that of the angle 0, the last one that across it. On a rigid
    drive no force can be fed forward: it has the circles without. ValueError if a loop is unstable.
    """
    followers = [Follower(axis) for axis in axes]
    if not all(axis.drive for axis in axes):
        shares = [0.0]
    circles = tuple(
        circle(followers[0], followers[-1], feed, radius, share)
        for radius in radii
        for feed in feeds
        for share in shares
    )
    slowest = min(feeds)
    values = tuple(
        AxisValue(axis.name, reversal_value(each, slowest, axis.demand.acceleration), slowest)
        for axis, each in zip(axes, followers, strict=True)
    )
    taken = [
        each._replace(key=f"{axis.name}, {each.key}") if len(axes) > 1 else each
        for axis in axes
        for each in assumed(axis)
    ]
    return Reversals(circles, values, tuple(taken))
