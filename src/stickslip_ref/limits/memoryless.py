"""Where a cycle with a stick exists under friction that has no memory but the direction of slip.

Every slip from break-away starts alike. So a cycle exists at a pulling velocity if the slip from
break-away ends in a stick: it comes to rest, and the force there holds. A force beyond F_s turns it
round, and the slip back decides: orbits do not cross, so where it ends beyond F_s as well, the next
slip begins and ends at larger forces than the first one, and the motion never sticks. A slip that
comes to rest no more ends the range by grazing: its least speed touches 0.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from ..laws import FrictionLaw
from ..parameters import Parameters
from ..ranges import Interval, merged
from .first_slip import Calm, Floats, Friction, first_slips, follows_calmly

GRAZING, REVERSAL, NONE = "grazing", "reversal", "none"

_STEP = 0.01
"""Distance of the velocities looked at, relative."""

_ROUNDING = 64.0 * 2.0**-52
"""A stop so near F_s counts as none, relative."""

_SHORTEST = 1e-12
"""A shorter stick counts as none [1/w]."""

_SLOWER = 1e-3
"""Part of the velocities searched down to which the friction is looked at."""

_SHALLOW, _STRICT = 1e-5, 1e-13
"""A least speed nearer to 0, over v, hangs on the errors of the scan: its slip is followed again
with this tolerance."""

_NEAR, _LEAP = 0.01, 0.5
"""From this speed on, over v, a step is at most this part of the time in which the speed turns
within the layer of v_s."""

_PARTS, _ROUNDS = 16, 6
"""An end that is no root is found by dividing a step of the scan by 16, six times."""

_RTOL = 1e-12
_SLOWEST = 400.0
"""Longest slip that is followed for its least speed [1 / w], times 1 + zeta."""


def cycle_ranges(
    p: Parameters, law: FrictionLaw, between: tuple[float, float]
) -> tuple[Interval, ...]:
    """Return the pulling velocities at which a cycle with a stick exists.

    Parameters
    ----------
    p : Parameters
        Numbers only, completed by the friction law.
    law : FrictionLaw
        A friction law with a stick, without age or state.
    between : tuple of two floats
        The range of velocities searched [m/s]; no range narrower than 1 % of v is looked for.
    """
    low, high = between
    count = max(3, int(math.log(high / low) / _STEP) + 2)
    grid = np.geomspace(low, high, count)
    block = _Block(p, law, between)
    found: list[Interval] = []
    sticks = block.sticks(grid)
    start: tuple[float, str] | None = (low, NONE) if sticks[0] else None
    for number in np.flatnonzero(sticks[1:] != sticks[:-1]):
        edge = block.edge(grid, int(number), bool(sticks[number]))
        if start is None:
            start = edge
        else:
            found.append(Interval(start[0], edge[0], start[1], edge[1]))
            start = None
    if start is not None:
        found.append(Interval(start[0], high, start[1], NONE))
    return merged(found)


class _Block:
    """The block at many pulling velocities."""

    def __init__(self, p: Parameters, law: FrictionLaw, between: tuple[float, float]) -> None:
        self.p, self.law = p, law
        self.w, self.zeta, self.m = float(p.w), float(p.zeta), float(p.m)
        self.F_s = law.break_away_force(p)
        self.at_rest = min(law.slip_friction(p, 0.0), self.F_s)
        speeds = np.geomspace(1e-9, 1e3, 1000) * (self.F_s / (self.m * self.w))
        friction = law.friction_at(p, np.sort(np.concatenate([[0.0], law.knots(p), speeds])))
        self.never_rises = bool(np.all(np.diff(friction) <= _ROUNDING * self.F_s))
        low, high = between[0] * _SLOWER, between[1] + self.F_s / (self.m * self.w)
        count = int(math.log(high / low) / _STEP) + 2
        self.speeds = np.unique([0.0, *law.knots(p), *np.geomspace(low, high, count)])
        slope = np.diff(law.friction_at(p, self.speeds)) / np.diff(self.speeds)
        self.is_calm = float(p.c) + slope >= 2.0 * self.m * self.w

    def sticks(self, v: Floats) -> NDArray[np.bool_]:
        """Tell at which velocities [m/s] > 0 the slip from break-away ends in a stick."""
        unit = self.m * self.w * v
        result = np.zeros(v.size, dtype=bool)
        number = np.arange(v.size)
        net, pull = (self.F_s - self.at_rest) / unit, np.ones(v.size)
        for _ in ("forward", "back"):
            friction, calm = self._friction(v[number]), self._calm(v[number])
            slip = first_slips(net, pull, self.zeta, friction, calm)
            shallow = np.flatnonzero(np.abs(slip.least) < _SHALLOW)
            if shallow.size:
                there = v[number[shallow]]
                friction, calm = self._friction(there), self._calm(there)
                again = first_slips(net[shallow], pull[shallow], self.zeta, friction, calm, _STRICT)
                slip.least[shallow], slip.net[shallow] = again
            if np.isnan(slip.least).any():
                lost = float(v[number][np.isnan(slip.least)][0])
                raise RuntimeError(
                    f"the slip from break-away at v = {lost:g} m/s was not followed to its end: "
                    f"damping and friction change too fast with the speed, at the damping ratio "
                    f"{self.zeta:g}"
                )
            stops = slip.least < 0.0
            if number.size == v.size:
                stops |= self.surely_stops(v)
            # The net force counts along the slip: the spring pulls with it plus R(0).
            force = slip.net * unit[number] + self.at_rest
            holds = stops & (force > -self.F_s * (1.0 - _ROUNDING))
            result[number[holds]] = True
            on = stops & ~holds
            number, pull = number[on], -pull[on]
            net = (-force[on] - self.at_rest) / unit[number]
            if not number.size:
                break
        return result

    def surely_stops(self, v: Floats) -> NDArray[np.bool_]:
        """Tell at which velocities [m/s] the slip from break-away stops, however shallow.

        Without damping, friction that never rises feeds the motion as seen from the pull: it comes
        back to rest. What it gains is 0 to rounding where hardly any friction has fallen at 2 v.
        """
        fall = (self.F_s - self.law.friction_at(self.p, 2.0 * v)) / (self.m * self.w * v)
        result: NDArray[np.bool_] = (self.zeta == 0.0) & self.never_rises & (fall > _SHORTEST)
        return result

    def edge(self, grid: Floats, number: int, before: bool) -> tuple[float, str]:
        """Return the velocity between two of the grid at which a stick ends, and its kind.

        `before` tells whether it sticks below.
        """
        # The scan decides by less digits than the edge is found with.
        for reach in range(5):
            low = float(grid[max(number - reach, 0)])
            high = float(grid[min(number + 1 + reach, grid.size - 1)])
            at_low, at_high = self.least_speed(low), self.least_speed(high)
            if (at_low < 0.0) == before and (at_high < 0.0) != before:
                root = brentq(self.least_speed, low, high, xtol=1e-300, rtol=1e-13)
                return float(root), GRAZING
        low, high = float(grid[number]), float(grid[number + 1])
        for _ in range(_ROUNDS):
            parts = np.linspace(low, high, _PARTS + 1)
            changed = np.flatnonzero(self.sticks(parts[1:-1]) != before)
            end = int(changed[0]) + 1 if changed.size else _PARTS
            low, high = float(parts[end - 1]), float(parts[end])
        long, short = self.surely_stops(np.array([high, low]))
        return 0.5 * (low + high), REVERSAL if long == short else NONE

    def least_speed(self, v: float) -> float:
        """Return the least speed of the slip from break-away after its highest, over v.

        Below 0 where the slip stops: see `first_slip`.
        """
        unit = self.m * self.w * v
        two_zeta = 2.0 * self.zeta

        def rates(tau: float, y: Floats) -> tuple[float, float]:
            u, a = float(y[0]), float(y[1])
            dry = self.law.slip_friction(self.p, max(u, 0.0) * v) - self.at_rest
            return a - two_zeta * u - dry / unit, 1.0 - u

        def turn(tau: float, y: Floats) -> float:
            return 1.0 if tau == 0.0 else rates(tau, y)[0]

        calm = self._calm(np.array([v]))

        def settles(tau: float, y: Floats) -> float:
            rate = np.array([rates(tau, y)[0]])
            return 1.0 if follows_calmly(np.array([y[0]]), rate, *calm)[0] else -1.0

        def nears(tau: float, y: Floats) -> float:
            return float(y[0]) - _NEAR if tau > 0.0 else 1.0

        for event, direction in ((turn, 1), (settles, 0), (nears, -1)):
            event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
        y = [0.0, (self.F_s - self.at_rest) / unit]
        whole, longest = _SLOWEST * (1.0 + self.zeta), 0.5
        # Close to rest no step may leap over the layer of speeds in which friction falls.
        layer = max((each / v for each in self.law.speeds(self.p)), default=math.inf)
        for events in ((turn, settles, nears), (turn, settles)):
            solution = solve_ivp(
                rates,
                (0.0, whole),
                y,
                method="DOP853",
                events=events,
                rtol=_RTOL,
                atol=1e-14,
                first_step=1e-6,
                max_step=longest,
            )
            if len(events) < 3 or not solution.t_events[2].size:
                break
            y, longest = solution.y[:, -1], min(longest, _LEAP * math.sqrt(layer))
        return float(solution.y[0, -1])

    def _calm(self, v: Floats) -> Calm:
        """Return the speeds about `v` between which damping and friction are calm, over `v`."""
        begins = np.maximum.accumulate(np.where(self.is_calm, 0.0, self.speeds[1:]))
        ends = np.where(self.is_calm, np.inf, self.speeds[:-1])
        ends = np.minimum.accumulate(ends[::-1])[::-1]
        last = ends.size - 1
        below = np.minimum(np.searchsorted(self.speeds, v, "left") - 1, last)
        above = np.minimum(np.searchsorted(self.speeds, v, "right") - 1, last)
        return Calm(np.minimum(begins[below], v) / v, np.maximum(ends[above], v) / v)

    def _friction(self, v: Floats) -> Friction:
        unit = self.m * self.w * v

        def friction(u: Floats, number: NDArray[np.intp]) -> Floats:
            force = self.law.friction_at(self.p, u * v[number])
            result: Floats = (force - self.at_rest) / unit[number]
            return result

        return friction
