"""The line through an exact motion: samples and events, straight in stick, curved in slip."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stickslip_verification.model.run import Series
from stickslip_verification.model.verdict import Motion

PIECES = 400
"""Straight pieces over the whole time that a slip is drawn with: about one per point of width."""

SAME_TIME = 1e-12
"""Part of the run's length within which an event is at a communication point."""

FAITHFUL = 0.015
"""Part of the plotted range by which a cubic may miss the motion: about the width of the line."""

UNEVEN = 10.0
"""Ratio of two neighbouring gaps above which the shorter tells nothing of the longer."""

AT_ONCE = 0.005
"""Part of the run's length below which a slip is drawn as a jump."""


@dataclass(frozen=True)
class Curve:
    """What is drawn of a motion: time [s], positions [m] and spring force [N], ``(n,)`` each.

    ``joined`` tells whether lines may join the points: it is False where more happens between two
    samples than they can tell.
    """

    t: Series
    x: Series
    x_pull: Series
    F: Series
    joined: bool


@dataclass(frozen=True)
class _Node:
    """A moment with known position x [m] and velocity x_dot [m/s] of the mass.

    ``k`` [N/m] holds from the node before up to here; ``slips`` tells whether the mass moves after
    this node.
    """

    t: float
    x: float
    x_dot: float
    x_pull: float
    k: float
    slips: bool


def curve(motion: Motion) -> Curve:
    """Return the line through the exact motion, or its samples alone where they are too coarse.

    An event between two samples is a corner at its exact time: in stick the mass does not move, so
    its position there is that of the neighbouring sample. In slip the line is the cubic through
    positions and velocities. The pulled end moves straight between two samples.
    """
    exact = motion.exact
    sampled = {
        name: np.concatenate(([exact.initial[name]], exact.outputs[name]))
        for name in ("x", "x_dot", "x_pull", "z", "F", "mode")
    }
    times = np.concatenate(([0.0], exact.times))
    nodes = list(_nodes(times, sampled, np.asarray(motion.event_times, dtype=np.float64)))
    if not nodes or times[-1] <= 0.0 or not _faithful(nodes):
        return Curve(times, sampled["x"], sampled["x_pull"], sampled["F"], joined=False)
    rows = [(nodes[0].t, nodes[0].x, nodes[0].x_pull, nodes[0].k)]
    for left, right in itertools.pairwise(nodes):
        if right.k != left.k:
            rows.append((left.t, left.x, left.x_pull, right.k))
        # Two events may be at one time: there is no slip between them.
        if left.slips and right.t > left.t:
            pieces = max(2, round(PIECES * (right.t - left.t) / times[-1]))
            for share in np.arange(1, pieces) / pieces:
                t = left.t + share * (right.t - left.t)
                x_pull = left.x_pull + share * (right.x_pull - left.x_pull)
                rows.append((t, _cubic(left, right, t), x_pull, right.k))
        rows.append((right.t, right.x, right.x_pull, right.k))
    t, x, x_pull, k = np.array(rows).T
    return Curve(t, x, x_pull, k * (x_pull - x), joined=True)


def _nodes(t: Series, at: dict[str, Series], events: Series) -> Iterator[_Node]:
    """Yield samples and events in order of time; nothing if an interval holds more than two."""
    near = SAME_TIME * float(t[-1])
    k = _stiffness(at["F"], at["z"])
    nodes: list[_Node] = []
    for i, time in enumerate(t):
        if i > 0:
            inside = events[(events > t[i - 1] + near) & (events < time - near)]
            if len(inside) > 2:
                return
            ahead = _Node(
                time, at["x"][i], at["x_dot"][i], at["x_pull"][i], k[i], at["mode"][i] != 0
            )
            before = nodes[-1]
            for event in inside:
                left, last = nodes[-1], event == inside[-1]
                # The last event of an interval leads into what the next sample shows.
                slips = ahead.slips if last else not left.slips or not ahead.slips
                x = _turning_point(left, event, ahead) if last else _stop(left, event)
                share = (event - before.t) / (time - before.t)
                x_pull = before.x_pull + share * (ahead.x_pull - before.x_pull)
                nodes.append(_Node(event, x, 0.0, x_pull, k[i], slips))
        slips = bool(at["mode"][i] != 0 or np.any(np.abs(events - time) <= near))
        nodes.append(_Node(time, at["x"][i], at["x_dot"][i], at["x_pull"][i], k[i], slips))
    yield from nodes


def _stiffness(F: Series, z: Series) -> Series:
    """Return k = F/z at each sample [N/m]; where z is 0, k of the nearest sample with z not 0."""
    known = np.flatnonzero(z != 0.0)
    if not len(known):
        return np.zeros_like(z)
    k = F[known] / z[known]
    nearest = np.clip(np.searchsorted(known, np.arange(len(z))), 0, len(known) - 1)
    # A quotient of doubles differs in its last digit from sample to sample; no stiffness does.
    return np.array([float(f"{value:.12g}") for value in k[nearest]])


def _stop(left: _Node, time: float) -> float:
    """Return x where the mass comes to rest at `time`, its velocity falling straight to 0."""
    return left.x + 0.5 * left.x_dot * (time - left.t) if left.slips else left.x


def _turning_point(left: _Node, time: float, right: _Node) -> float:
    """Return x at an event between the node `left` and the next sample."""
    if not right.slips:
        return right.x
    if not left.slips:
        return left.x
    return 0.5 * (_stop(left, time) + right.x - 0.5 * right.x_dot * (right.t - time))


def _cubic(left: _Node, right: _Node, t: float) -> float:
    """Return x at `t` [s] on the cubic with the positions and velocities of two nodes."""
    gap = right.t - left.t
    s = (t - left.t) / gap
    bent = gap * s * (1.0 - s) * ((1.0 - s) * left.x_dot - s * right.x_dot)
    return left.x + s * s * (3.0 - 2.0 * s) * (right.x - left.x) + bent


def _faithful(nodes: list[_Node]) -> bool:
    """Tell whether the cubics are the motion.

    The error of a cubic at s h of a gap h goes with ``(s (1 - s))^2 h^4``. A cubic over two gaps
    that leaves out the node between them shows it there, and so what it is within one gap.
    """
    x = np.array([node.x for node in nodes])
    z = np.array([node.x_pull for node in nodes]) - x
    seen = FAITHFUL * min(np.ptp(x), np.ptp(z))
    for first, middle, last in zip(nodes, nodes[1:], nodes[2:], strict=False):
        gaps = middle.t - first.t, last.t - middle.t
        inner = first.slips and middle.slips and middle.x_dot != 0.0
        if inner and 0.0 < max(gaps) < UNEVEN * min(gaps):
            missed = abs(_cubic(first, last, middle.t) - middle.x)
            if missed * max(gaps) ** 4 > 16.0 * (gaps[0] * gaps[1]) ** 2 * seen:
                return False
    # A slip without a sample inside shows where it ends, not how it goes.
    long = AT_ONCE * (nodes[-1].t - nodes[0].t)
    return not any(
        a.slips and a.x_dot == 0.0 and b.x_dot == 0.0 and b.t - a.t > long and a.x != b.x
        for a, b in itertools.pairwise(nodes)
    )
