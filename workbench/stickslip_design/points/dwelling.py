"""Steady cycles where static friction grows with the time at rest; docs/theory.md (19) to (23).

Cycles without reversals are a curve in lambda, which says where they end and which one a pulling
velocity has: (21), (22). The exact block then gives the cycle. Where its stop reverses, sticks and
slips are followed from event to event until the sticks settle: (23).
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip_fmu.laws.named import COULOMB_NAME
from stickslip_ref import Parameters, critical_lambda, steady_cycle

from .columns import Floats
from .slips import (
    BESIDE,
    LEAST_STICK,
    REST_SLACK,
    Flags,
    Motion,
    Values,
    first_slips,
    taken,
)

_MOST_ROUNDS: Final = 60
"""Rounds of two cycles after which sticks that have not settled count as irregular."""

_MOST_SLIPS: Final = 1000
"""Slips between two sticks. With friction in slip each reversal takes 2 mu_k N of the force."""

_MOST_DOUBLINGS: Final = 2000
_SECTIONS: Final = 60
_BISECTIONS: Final = 60
"""Steps after which a range of logarithms is down to rounding."""

_GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)
_EPS: Final = 2.0**-52

_SETTLED: Final = 32.0 * 2.0**-52
"""Two sticks that differ by less, relative, are alike."""


_USED: Final = ("m", "g", "k", "c", "mu_s", "mu_k", "v", "load", "tau_s", "B", "t_0")


class _Cycle(NamedTuple):
    """One stick and the slips after it: where the next stick begins [m], and lengths [s]."""

    z: Floats
    t_stick: Floats
    t_slip: Floats


class _Cycles(NamedTuple):
    """Steady cycles; NaN where the sticks do not settle to one length."""

    sticks: Flags
    t_stick: Floats
    t_slip: Floats


class _Blocks:
    """A list of blocks pulled at ``v > 0``."""

    def __init__(self, values: Values) -> None:
        self.values = values
        shape = np.shape(values["v"])
        used = {name: np.broadcast_to(values[name], shape) for name in _USED}
        self.v, self.k = used["v"], used["k"]
        self.w = np.sqrt(self.k / used["m"])
        self.zeta = used["c"] / (2.0 * used["m"] * self.w)
        self.tau_s, self.t_0 = used["tau_s"], used["t_0"]
        N = used["m"] * used["g"] + used["load"]
        self.kinetic = used["mu_k"] * N
        self.rise, self.strength = (used["mu_s"] - used["mu_k"]) * N, used["B"] * N
        self.fresh = self.kinetic + np.where(self.tau_s > 0.0, 0.0, self.rise)

    def excess(self, age: Floats) -> Floats:
        """Return what sticks of these ages [s] hold beyond kinetic friction [N]; (19)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(self.tau_s > 0.0, -np.expm1(-age / self.tau_s), 1.0)
        return np.asarray(self.rise * share + self.strength * np.log1p(age / self.t_0))

    def rate(self, age: Floats) -> Floats:
        """Return the rate of `excess` [N/s]."""
        tau_s = np.where(self.tau_s > 0.0, self.tau_s, 1.0)
        rise = np.where(self.tau_s > 0.0, self.rise / tau_s * np.exp(-age / tau_s), 0.0)
        return np.asarray(rise + self.strength / (self.t_0 + age))

    def way(self, lambda_: Floats) -> Floats:
        """Return what the spring is loaded by in a cycle without reversals [v / w]; (13), (21)."""
        # Mass, stiffness, weight and pull of 1: the gap is lambda then.
        p = Parameters(m=1.0, k=1.0, g=1.0, c=2.0 * self.zeta, mu_s=lambda_, mu_k=0.0, v=1.0)
        loaded = np.asarray(steady_cycle(p).t_stick)
        # At the least lambda rounding may leave no slip that ends: it grazes.
        return np.where(np.isnan(loaded), lambda_, loaded)

    def speed(self, lambda_: Floats) -> Floats:
        """Return the pulling speeds [m/s] of the cycles without reversals; (21)."""
        held = self.excess(self.way(lambda_) / self.w)
        return np.asarray(self.w * held / (self.k * lambda_))

    def fastest(self) -> tuple[Floats, Floats]:
        """Return lambda and speed [m/s] where the cycles without reversals end; (20), (22)."""
        least = np.asarray(critical_lambda(self.zeta))
        damped = np.isfinite(least) & (least > 0.0)
        least = np.where(damped, least, 1.0)
        high = 2.0 * least
        for _ in range(_MOST_DOUBLINGS):
            rises = damped & (self.speed(2.0 * high) > self.speed(high))
            if not rises.any():
                break
            high = np.where(rises, 2.0 * high, high)
        # The speed over lambda has one maximum: it is halved in by golden section.
        low_x, high_x = np.log(8.0 * _EPS * least), np.log(2.0 * high - least)
        for _ in range(_SECTIONS):
            one = high_x - _GOLDEN * (high_x - low_x)
            other = low_x + _GOLDEN * (high_x - low_x)
            left = self.speed(least + np.exp(one)) > self.speed(least + np.exp(other))
            low_x, high_x = np.where(left, low_x, one), np.where(left, other, high_x)
        fold = least + np.exp(0.5 * (low_x + high_x))
        grazes = ~(self.speed(fold) > self.speed(least) * (1.0 + 8.0 * _EPS))
        top = np.where(grazes, least, fold)
        # Without damping: what a fresh stick holds has a cycle at any speed.
        undamped = np.where(
            self.fresh > self.kinetic, np.inf, 2.0 * self.rate(0.0 * self.k) / self.k
        )
        undamped = np.where(self.zeta == 0.0, undamped, 0.0)
        return np.where(damped, top, LEAST_STICK / 2.0), np.where(damped, self.speed(top), undamped)

    def lambda_of_cycle(self, low: Floats) -> Floats:
        """Return lambda of the stable cycles without reversals, above `low`, where there are any.

        The speed falls with lambda there.
        """
        high = 2.0 * low
        for _ in range(_MOST_DOUBLINGS):
            above = self.speed(high) > self.v
            if not above.any():
                break
            low, high = np.where(above, high, low), np.where(above, 2.0 * high, high)
        low_x, high_x = np.log(low), np.log(high)
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low_x + high_x)
            above = self.speed(np.exp(middle)) > self.v
            low_x, high_x = np.where(above, middle, low_x), np.where(above, high_x, middle)
        return np.exp(0.5 * (low_x + high_x))

    def cycle(self, z: Floats) -> _Cycle:
        """Follow the sticks that begin at these extensions [m] to the next ones; NaN if none."""
        end, t_stick, t_slip = (np.full(z.shape, np.nan) for _ in range(3))
        on = np.flatnonzero(np.isfinite(z))
        slip = first_slips({**taken(self.values, on), "z_start": z[on]}, COULOMB_NAME)
        t_stick[on], t_slip[on] = slip.t_stick, slip.t_slip
        end[on] = z[on] + self.v[on] * slip.t_stick - slip.spring_drop
        for _ in range(_MOST_SLIPS):
            force = np.abs(self.k * end)
            on = np.flatnonzero(force > self.fresh + REST_SLACK * (force + self.fresh))
            if not on.size:
                break
            back = first_slips({**taken(self.values, on), "z_start": end[on]}, COULOMB_NAME)
            t_slip[on] += back.t_slip
            end[on] -= back.spring_drop
        end[on] = np.nan
        return _Cycle(end, t_stick, t_slip)


def motion(values: dict[str, float | Floats]) -> Motion:
    """Return the steady motions of a list of blocks; arguments as of `falling.motion`."""
    v = np.asarray(values["v"])
    cycles, top, reverses = _cycles(values)
    with np.errstate(divide="ignore", invalid="ignore"):
        at_limit = np.abs(v / top - 1.0) <= BESIDE
    # Stops that reverse have limits of their own: (23).
    places = np.flatnonzero(reverses)
    for factor in (1.0 - BESIDE, 1.0 + BESIDE):
        beside = {**taken(values, places), "v": v[places] * factor}
        at_limit[places] |= _cycles(beside)[0].sticks != cycles.sticks[places]
    # Steady sliding under constant friction in slip is stable.
    return Motion(*cycles, np.zeros(v.shape, bool), at_limit)


def _cycles(values: Values) -> tuple[_Cycles, Floats, Flags]:
    """Return cycles, the speeds [m/s] at which those without reversals end, and which reverse."""
    v = np.asarray(values["v"])
    found = _Cycles(np.zeros(v.shape, bool), *(np.full(v.shape, np.nan) for _ in range(2)))
    reverses = np.zeros(v.shape, bool)
    low, top = _Blocks(values).fastest()
    places = np.flatnonzero((v > 0.0) & (v < top))
    blocks = _Blocks(taken(values, places))
    some = blocks.speed(low[places]) > blocks.v
    places = places[some]
    if not places.size:
        return found, top, reverses
    blocks = _Blocks(taken(values, places))
    lambda_ = blocks.lambda_of_cycle(low[places])
    way = blocks.way(lambda_)
    stop = blocks.kinetic - blocks.k * blocks.v / blocks.w * (way - lambda_)
    back = -stop > blocks.fresh + REST_SLACK * (np.abs(stop) + blocks.fresh)
    reverses[places[back]] = True
    ahead = np.flatnonzero(~back & (way >= LEAST_STICK))
    blocks = _Blocks(taken(values, places[ahead]))
    # The stick that follows is nearer to the cycle than the root of a sum that was rounded.
    cycle = blocks.cycle(blocks.cycle(stop[ahead] / blocks.k).z)
    found.sticks[places[ahead]] = np.isfinite(cycle.z)
    found.t_stick[places[ahead]], found.t_slip[places[ahead]] = cycle.t_stick, cycle.t_slip
    held = np.maximum(stop[back], -_Blocks(taken(values, places[back])).fresh)
    _settle(values, places[back], held, found)
    return found, top, reverses


def _settle(values: Values, places: NDArray[np.intp], force: Floats, found: _Cycles) -> None:
    """Follow sticks and slips that reverse until the sticks settle; docs/theory.md (23).

    `force` is where the first stick begins [N].
    """
    z = force / _Blocks(taken(values, places)).k
    for _ in range(_MOST_ROUNDS):
        if not places.size:
            return
        blocks = _Blocks(taken(values, places))
        first = blocks.cycle(z)
        second = blocks.cycle(first.z)
        rounding = _SETTLED * (first.t_stick + blocks.fresh / (blocks.k * blocks.v))
        settled = np.abs(second.t_stick - first.t_stick) <= rounding
        found.sticks[places[settled]] = True
        steady = np.flatnonzero(settled)
        steady = steady[_attract(_Blocks(taken(values, places[steady])), second, steady)]
        found.t_stick[places[steady]] = second.t_stick[steady]
        found.t_slip[places[steady]] = second.t_slip[steady]
        go_on = np.flatnonzero(~settled & np.isfinite(second.z))
        guess = _extrapolated(z, first.z, second.z)
        following = blocks.cycle(guess).z
        z = np.where(np.isfinite(following), following, second.z)[go_on]
        places = places[go_on]
    found.sticks[places] = True


def _extrapolated(z: Floats, first: Floats, second: Floats) -> Floats:
    """Return where a sequence of three extensions [m] leads, by Steffensen's step.

    A sequence with reversals may jump, so the step stays between those seen.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        guess = z - (first - z) ** 2 / (second - 2.0 * first + z)
    low, high = (each(each(z, first), second) for each in (np.minimum, np.maximum))
    return np.where((guess >= low) & (guess <= high), guess, second)


def _attract(blocks: _Blocks, cycle: _Cycle, places: NDArray[np.intp]) -> Flags:
    """Tell whether sticks near a steady one come nearer to it."""
    z, t_stick = cycle.z[places], cycle.t_stick[places]
    off = 1e-6 * blocks.v * t_stick
    near = [np.abs(blocks.cycle(z + side * off).z - z) < off for side in (-1.0, 1.0)]
    return near[0] & near[1]
