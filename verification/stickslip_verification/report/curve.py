"""The line through an exact motion: samples and events, straight in stick, curved in slip."""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

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


def samples(motion: Motion) -> Curve:
    """Return the samples of the exact motion alone, the start included."""
    t, columns = _with_start(motion)
    return Curve(t, columns["x"], columns["x_pull"], columns["F"], joined=False)


def curve(motion: Motion) -> Curve:
    """Return the line through the exact motion, or its samples alone where they are too coarse.

    An event between two samples is a corner at its exact time: in stick the mass does not move, so
    its position there is that of the neighbouring sample. In slip the line is the cubic through
    positions and velocities. The pulled end moves straight between two samples.
    """
    nodes = list(_nodes(motion))
    span = nodes[-1].t - nodes[0].t if nodes else 0.0
    if not nodes or span <= 0.0 or not _faithful(nodes):
        return samples(motion)
    rows = [(nodes[0].t, nodes[0].x, nodes[0].x_pull, nodes[0].k)]
    for left, right in itertools.pairwise(nodes):
        if right.k != left.k:
            rows.append((left.t, left.x, left.x_pull, right.k))
        # Two events may be at one time: there is no slip between them.
        if left.slips and right.t > left.t:
            pieces = max(2, round(PIECES * (right.t - left.t) / span))
            s = np.arange(1, pieces) / pieces
            inside = left.t + s * (right.t - left.t)
            moved = left.x_pull + s * (right.x_pull - left.x_pull)
            cubic = _cubic([left, right])(inside)
            rows += zip(inside, cubic, moved, itertools.repeat(right.k), strict=False)
        rows.append((right.t, right.x, right.x_pull, right.k))
    t, x, x_pull, k = np.array(rows).T
    return Curve(t, x, x_pull, k * (x_pull - x), joined=True)


def _with_start(motion: Motion) -> tuple[Series, dict[str, Series]]:
    record = motion.exact
    columns = {
        name: np.concatenate(([record.initial[name]], record.outputs[name]))
        for name in ("x", "x_dot", "x_pull", "z", "F", "mode")
    }
    return np.concatenate(([0.0], record.times)), columns


def _nodes(motion: Motion) -> Iterator[_Node]:
    """Yield samples and events in order of time; nothing if an interval holds more than two."""
    t, at = _with_start(motion)
    near = SAME_TIME * float(t[-1])
    stiffness = _stiffness(at["F"], at["z"])
    events = np.asarray(motion.event_times, dtype=np.float64)
    nodes = []
    for i in range(len(t)):
        struck = bool(np.any(np.abs(events - t[i]) <= near))
        slips = bool(at["mode"][i] != 0) or struck
        nodes.append(_node(at, i, float(t[i]), slips, float(stiffness[i])))
        if i + 1 == len(t):
            break
        inside = events[(events > t[i] + near) & (events < t[i + 1] - near)]
        if len(inside) > 2:
            return
        ends = (at["mode"][i + 1] != 0, float(t[i + 1]), at["x"][i + 1], at["x_dot"][i + 1])
        for n, time in enumerate(inside):
            left, last = nodes[-1], n + 1 == len(inside)
            x = _turning_point(left, float(time), *ends) if last else _ahead(left, float(time))
            share = (time - t[i]) / (t[i + 1] - t[i])
            x_pull = at["x_pull"][i] + share * (at["x_pull"][i + 1] - at["x_pull"][i])
            # The last event of an interval leads into what the next sample shows.
            slips = bool(ends[0]) if last else not left.slips or not ends[0]
            nodes.append(_Node(float(time), x, 0.0, float(x_pull), float(stiffness[i + 1]), slips))
    yield from nodes


def _node(at: dict[str, Series], i: int, t: float, slips: bool, k: float) -> _Node:
    return _Node(t, float(at["x"][i]), float(at["x_dot"][i]), float(at["x_pull"][i]), k, slips)


def _stiffness(F: Series, z: Series) -> Series:
    """Return k = F/z at each sample [N/m]; where z is 0, k of the nearest sample with z not 0."""
    told = np.flatnonzero(z != 0.0)
    if not len(told):
        return np.zeros_like(z)
    k = F[told] / z[told]
    nearest = np.clip(np.searchsorted(told, np.arange(len(z))), 0, len(told) - 1)
    # A quotient of doubles differs in its last digit from sample to sample; no stiffness does.
    return np.array([float(f"{value:.12g}") for value in k[nearest]])


def _ahead(left: _Node, time: float) -> float:
    """Return x where the mass comes to rest at `time`, its velocity falling straight to 0."""
    return left.x + 0.5 * left.x_dot * (time - left.t) if left.slips else left.x


def _turning_point(
    left: _Node, time: float, slips: bool, t_next: float, x_next: float, x_dot_next: float
) -> float:
    """Return x at an event between the node `left` and the next sample."""
    if not slips:
        return x_next
    if not left.slips:
        return left.x
    return 0.5 * (_ahead(left, time) + x_next - 0.5 * x_dot_next * (t_next - time))


def _cubic(nodes: Sequence[_Node]) -> CubicHermiteSpline:
    """Return the cubics with the positions and velocities of nodes, as a function of time [s]."""
    t, x, x_dot = np.array([(node.t, node.x, node.x_dot) for node in nodes]).T
    return CubicHermiteSpline(t, x, x_dot)


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
            missed = abs(_cubic([first, last])(middle.t) - middle.x)
            if missed * max(gaps) ** 4 > 16.0 * (gaps[0] * gaps[1]) ** 2 * seen:
                return False
    # A slip without a sample inside shows where it ends, not how it goes.
    long = AT_ONCE * (nodes[-1].t - nodes[0].t)
    return not any(
        a.slips and a.x_dot == 0.0 and b.x_dot == 0.0 and b.t - a.t > long and a.x != b.x
        for a, b in itertools.pairwise(nodes)
    )
