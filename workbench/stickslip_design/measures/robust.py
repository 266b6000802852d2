"""Robust or by luck: in which share of machines an axis is clean when four of its numbers vary."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Final

import numpy as np
from scipy.stats import qmc

from stickslip_ref import steady_cycle

from ..axis import Axis, AxisFile, Number
from ..loop.critical import estimated_critical_feed, is_clean
from ..loop.stability import is_stable
from ..verdict import Robustness
from .moving import with_number

MACHINES: Final = 64
"""A power of two, which fills the ± evenly: a share is known to 5 %."""
_USUAL: Final = {"gap": 0.2, "stiffness": 0.1, "damping": 0.1, "mass": 0.1}
"""The ± of what varies, relative, where the file states none."""
_ALIKE: Final = 6
"""After so many machines in a row that do as foretold the others are taken to do so too."""


class Series:
    """The machines of a series, the same with each measure; a file has the ± of their axis."""

    def __init__(self, axis: Axis, file: AxisFile | None) -> None:
        parts = {
            path.partition("[")[0]: number.spread / number.value
            for path, number in (file.values.items() if file else ())
            if isinstance(number, Number) and number.value
        }

        def part(*paths: str) -> float:
            return next((parts[path] for path in paths if path in parts), 0.0)

        friction, gap = axis.friction, axis.friction.mu_s - axis.friction.mu_k
        static = friction.mu_s * part("friction.mu_s", "friction.F_s", "friction.T_s")
        kinetic = friction.mu_k * part("friction.mu_k", "friction.F_k", "friction.T_k")
        stated = {
            "gap": (static + kinetic) / gap if gap > 0.0 else 0.0,
            "stiffness": part("axis.stiffness"),
            "damping": part("axis.c", "axis.zeta"),
            "mass": part("axis.inertia", "axis.mass"),  # of a rotary table its inertia
        }
        self.axis, self._holds_zeta = axis, "axis.zeta" in parts
        self.varied = {name: part or _USUAL[name] for name, part in stated.items()}
        self.assumed = tuple(name for name, part in stated.items() if not part)
        shares = qmc.Sobol(5, scramble=False).random(MACHINES)
        points = 2.0 * ((shares + np.random.default_rng(0).random(5)) % 1.0) - 1.0
        if stated["gap"]:
            points[:, 0] = (static * points[:, 0] - kinetic * points[:, 4]) / (static + kinetic)
        self._deviations = points[:, :4] * list(self.varied.values())

    def robustness(self, axis: Axis) -> Robustness | None:
        """Return how an axis stands, with a measure or without; None where it is asked no feed.

        A loop that is unstable, or a table lifted off its way, is not clean. In the order of the
        estimate the others turn from clean to not about a place that is found by halving. From
        there on each is judged until `_ALIKE` in a row are as foretold.
        """
        if not axis.demand.feeds:
            return None
        axes = [self._machine(axis, row) for row in self._deviations.tolist()]
        clean = np.array([each.normal_force > 0.0 and is_stable(each) for each in axes])
        order = sorted(np.flatnonzero(clean).tolist(), key=lambda place: _estimate(axes[place]))
        is_bad = cache(lambda place: not is_clean(axes[order[place]]))
        turn = bisect_left(range(len(order)), True, key=is_bad)
        clean[order[turn:]] = False
        for places in (range(turn)[::-1], range(turn, len(order))):
            alike = 0
            for place in places:
                clean[order[place]] = not is_bad(place)
                alike = alike + 1 if is_bad(place) is (place >= turn) else 0
                if alike == _ALIKE:
                    break
        lower, upper = np.split(np.argsort(self._deviations, axis=0), 2)
        apart = np.abs(clean[lower].sum(axis=0) - clean[upper].sum(axis=0))
        (most,) = np.nonzero(apart == apart.max())
        decides = [*self.varied][most[0]] if len(most) == 1 else None
        return Robustness(int(clean.sum()), MACHINES, decides)

    def _machine(self, axis: Axis, deviations: Sequence[float]) -> Axis:
        """Return the axis with its numbers off by so much, relative."""
        gap, stiffness, damping, mass = deviations
        friction, own = axis.friction, dict(axis.friction.own)
        factor, mu_k = max(1.0 + gap, 0.0), friction.mu_k
        # Growth at rest and the points of a measured curve go with the gap.
        for name in [name for name in own if name == "B" or name.startswith("mu_")]:
            least = 0.0 if name == "B" else mu_k
            own[name] = least + (own[name] - least) * factor
        varied = replace(friction, mu_s=mu_k + (friction.mu_s - mu_k) * factor, own=own)
        c = axis.c * (1.0 + damping)
        if self._holds_zeta:
            c *= math.sqrt((1.0 + stiffness) * (1.0 + mass))
        changed = replace(axis, k=axis.k * (1.0 + stiffness), c=c, friction=varied)
        return with_number(changed, "axis.mass", axis.m * (1.0 + mass))


def _estimate(axis: Axis) -> float:
    """Return how far an axis is from clean, by closed forms of a rigid drive: high is bad."""
    limit, largest = estimated_critical_feed(axis), axis.demand.largest_jump
    if not largest:
        return limit
    blocks = [replace(axis, c=0.0).block(feed) for feed in axis.demand.feeds]
    return float(max(min(limit / p.v, steady_cycle(p).delta_x / largest) for p in blocks))
