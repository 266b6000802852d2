"""The numbers of an axis that can be moved, one at a time, and how far to end its jumps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Final

from scipy.optimize import brentq

from .axis import Axis, Drive
from .loop.critical import (
    critical_feed,
    damped,
    estimated_critical_feed,
    judders,
    jumps_of,
    rigid_critical_feed,
)
from .loop.jumps import limit_of_jumps
from .loop.stability import is_stable
from .verdict import AxisCure

_FARTHEST: Final = 30.0
"""The largest factor by which a number is moved."""
_APART: Final = 4.0
"""What the bandwidth of the velocity loop is above the position gain at least."""
_FINER: Final = 1.08
"""From factor to factor of the search by the estimate."""
_COARSE: Final = 1.5
_CLOSE_BY_SIDE: Final = 1e-7
"""The same, and how close the factor is found, where a law has no closed form."""
_CLOSE: Final = 2e-3
"""How close the factor with a drive is found, relative."""
_MOST: Final = 12
_BEYOND: Final = 1.5
"""How far above the feed a critical feed is looked for; beyond it is only "too high"."""

_HEAVY: Final = 1.25
"""A mass changed by more than this, 20 % less, is a change that hardly an axis allows."""

END: Final = "no jump at the slowest feed"
BELOW: Final = "a jump that is allowed"


@dataclass(frozen=True)
class Lever:
    """A number of an axis that can be moved in one direction; names as of `verdict.AxisCure`."""

    name: str
    number: str
    unit: str
    up: bool
    """Whether it grows."""
    now: float
    """Its value, SI, above 0."""
    moved: Callable[[float], Axis]
    """Returns the axis with another value."""
    held: str = ""
    lowest: float = 0.0
    """The end of its range downwards."""
    farthest: float = _FARTHEST
    """The largest factor by which it is moved."""

    def at(self, factor: float) -> Axis:
        """Return the axis with the number moved by a factor above 1, up or down."""
        return self.moved(self.value(factor))

    def value(self, factor: float) -> float:
        """Return the number moved by a factor above 1, up or down."""
        if self.up:
            return self.now * factor
        return self.lowest + (self.now - self.lowest) / factor

    def cure(self, factor: float | None, aim: str) -> AxisCure:
        """Return the cure by a factor; None: by no factor that it is moved by."""
        note = "" if factor is not None else f"not by a factor of {self.farthest:.3g}"
        then = None if factor is None else self.value(factor)
        effort = math.inf if factor is None else factor
        what = self.name, self.number, self.unit, self.now
        return AxisCure(*what, then, effort, aim, self.held, note)


def levers(axis: Axis) -> Iterator[Lever]:
    """Return the numbers of an axis that are worth moving."""
    zeta = axis.c / (2.0 * math.sqrt(axis.k * axis.m))
    friction, normal, newtons = axis.friction, axis.normal_force, axis.friction.in_newtons

    def static(value: float) -> Axis:
        return replace(axis, friction=replace(friction, mu_s=value / normal if newtons else value))

    def mass(m: float) -> Axis:
        lighter = replace(axis, m=m)
        less = normal / lighter.normal_force if newtons else 1.0
        held = replace(friction, mu_s=friction.mu_s * less, mu_k=friction.mu_k * less)
        return replace(lighter, friction=held)

    # The static friction of a measured curve is bound to its first point.
    if not friction.is_curve:
        number, unit = ("F_s", "N") if newtons else ("mu_s", "1")
        now, least = (axis.F_s, axis.F_k) if newtons else (friction.mu_s, friction.mu_k)
        yield Lever("smaller gap", number, unit, False, now, static, "kinetic friction", least)
    stiffer = Lever("stiffer", "stiffness", "N/m", True, axis.k, lambda k: replace(axis, k=k), "c")
    yield stiffer
    if zeta > 0.0:
        yield replace(stiffer, moved=lambda k: damped(stiffer.moved(k), zeta), held="zeta")
        yield Lever("more damping", "c", "N.s/m", True, axis.c, lambda c: replace(axis, c=c))
    held = "c, load and friction" if newtons else "c and load"
    yield Lever("lighter", "mass", "kg", False, axis.m, mass, held)
    if axis.drive is not None:
        yield from _levers_of_drive(axis, axis.drive)


def _levers_of_drive(axis: Axis, drive: Drive) -> Iterator[Lever]:
    shape = drive.T_n * drive.bandwidth
    # Position and velocity loop stay apart, where they are.
    apart = drive.bandwidth / (_APART * drive.K_v) if drive.K_v > 0.0 else math.inf
    near = min(apart, _FARTHEST) if apart > 1.0 else _FARTHEST

    def with_drive(**changes: float) -> Axis:
        return replace(axis, drive=replace(drive, **changes))  # type: ignore[arg-type]

    held = "T_n times the bandwidth" if shape > 0.0 else ""
    position = Lever("position gain", "K_v", "1/s", True, drive.K_v, lambda g: with_drive(K_v=g))
    velocity = Lever(
        "bandwidth", "bandwidth", "1/s", True, drive.bandwidth,
        lambda w: with_drive(bandwidth=w, T_n=shape / w), held,
    )  # fmt: skip
    integral = Lever("integral time", "T_n", "s", True, drive.T_n, lambda T_n: with_drive(T_n=T_n))
    for lever, up, word, farthest in (
        (position, False, "lower", _FARTHEST),
        (velocity, False, "lower", near),
        (position, True, "higher", near),
        (velocity, True, "higher", _FARTHEST),
        (integral, False, "shorter", _FARTHEST),
        (integral, True, "longer", _FARTHEST),
    ):
        if lever.now > 0.0:
            yield replace(lever, name=f"{word} {lever.name}", up=up, farthest=farthest)


def cures(axis: Axis, feed: float, now: float, aim: str = END) -> tuple[AxisCure, ...]:
    """Return how far each number must move till an axis moves evenly at a feed.

    Where a largest jump is asked for, also how far to bring the jump down to it. The axis jumps or
    swings at the feed [m/s], above 0, and up to `now` [m/s]; `aim` says what the changes are for.

    The smallest change first; those that do not help last, and before them a mass that hardly an
    axis allows. Of a number that could move both ways or be held in two ways, each is there.
    """
    # Jumps at slow feeds are carried up to the feed; others are followed there.
    servo = axis.drive is not None and axis.friction.law == "coulomb"
    carried = servo and limit_of_jumps(axis, feed).feed >= feed
    found = [lever.cure(_end(lever, feed, now, carried), aim) for lever in levers(axis)]
    then, note = (now, "") if now < math.inf else (None, "without damping the jumps have no end")
    found.append(AxisCure("faster", "feeds", "m/s", feed, then, now / feed, aim, note=note))
    largest = axis.demand.largest_jump
    if largest is not None and (jumps := jumps_of(axis, feed)) and jumps.way > largest:
        for lever, end in zip(levers(axis), list(found), strict=False):
            factor = _factor_below(lever, feed, largest, end.effort)
            if factor is not None:
                found.append(lever.cure(factor, BELOW))
    # A faster feed is no cure of the axis.
    return tuple(sorted(found, key=_rank))


def _rank(cure: AxisCure) -> tuple[bool, bool, float]:
    heavy = cure.number == "mass" and _HEAVY < cure.effort < math.inf
    return cure.number == "feeds", heavy or cure.then is None, cure.effort


def cured(axis: Axis, cure: AxisCure, more: float = 1.0) -> Axis:
    """Return an axis with a cure, its factor times another one."""
    same = cure.name, cure.number, cure.held
    (lever,) = (lever for lever in levers(axis) if (lever.name, lever.number, lever.held) == same)
    return lever.at(cure.effort * more)


def _end(lever: Lever, feed: float, now: float, carried: bool) -> float | None:
    """Return the factor at which jumping ends at the feed; None where it does not, or unstable."""
    axis = lever.at(1.0)
    if axis.drive is None and axis.friction.constant:
        # The closed form.
        return _first(lambda factor: rigid_critical_feed(lever.at(factor)), feed, 1.0)
    if carried:
        way = _factor_of_servo(lever, feed, now)
    else:
        # Not the limit, which takes a search, but on which side of it the feed is.
        def side(factor: float) -> float:
            return feed * (2.0 if judders(lever.at(factor), feed) else 0.5)

        close = _CLOSE_BY_SIDE if axis.drive is None else _CLOSE
        way = _first(side, feed, 1.0, finer=_COARSE, close=close)
    if way is not None and not is_stable(lever.at(way)):
        return None
    return way


def _factor_below(lever: Lever, feed: float, largest: float, end: float) -> float | None:
    """Return the factor that brings the jump down to the largest allowed.

    None where no factor does, or where jumping ends at once from a larger jump.
    """

    def excess(log_factor: float) -> float:
        axis = lever.at(math.exp(log_factor))
        if not is_stable(axis):
            return math.inf
        jumps = jumps_of(axis, feed)
        return -1.0 if jumps is None else math.log(jumps.way / largest)

    high = math.log(min(end / (1.0 + _CLOSE), lever.farthest))
    if high <= 0.0 or not excess(high) <= 0.0:
        return None
    return math.exp(float(brentq(excess, 0.0, high, xtol=_CLOSE)))


def _first(
    limit: Callable[[float], float],
    feed: float,
    least: float,
    finer: float = _FINER,
    close: float = 1e-14,
) -> float | None:
    """Return the first factor from `least` on at which a limit falls to the feed; None without."""

    def excess(log_factor: float) -> float:
        value = limit(math.exp(log_factor))
        return max(min(math.log(value / feed), 1e3), -1e3) if value > 0.0 else -1e3

    low = math.log(least)
    step, most = math.log(finer), math.log(_FARTHEST)
    if excess(low) <= 0.0:
        return least
    while low < most:
        high = min(low + step, most)
        if excess(high) <= 0.0:
            return math.exp(float(brentq(excess, low, high, xtol=close, rtol=1e-13)))
        low = high
    return None


def _factor_of_servo(lever: Lever, feed: float, now: float) -> float | None:
    """Return the least factor found at which the loop no longer jumps at the feed.

    The estimate, scaled to the last exact value, says where to look; the exact limit decides.
    """
    exact = {1.0: now}

    def estimate(factor: float) -> float:
        return estimated_critical_feed(lever.at(factor))

    def jumps(factor: float) -> bool:
        axis = lever.at(factor)
        if factor not in exact:
            stable = is_stable(axis)
            exact[factor] = critical_feed(axis, _BEYOND * feed) if stable else math.inf
        return exact[factor] > feed

    low, high = 1.0, lever.farthest
    if not jumps(low):
        return low
    known = False
    scale = exact[low] / estimate(low)
    for _ in range(_MOST):
        guess = _first(estimate, feed / scale, low) or high
        if not low < guess < high:
            guess = math.sqrt(low * high) if known else high
        # A little beyond, so that both sides come close.
        guess = min(guess * (1.0 + 0.3 * _CLOSE), high)
        if jumps(guess):
            if guess >= high:
                return None
            low = guess
        else:
            high, known = guess, True
        limit = exact[guess]
        if 0.0 < limit < _BEYOND * feed:
            scale = limit / estimate(guess)
        if known and high <= low * (1.0 + _CLOSE):
            break
        if known and low < guess <= high and limit > 0.0 and abs(limit / feed - 1.0) < 2e-3:
            break
    return high if known else None
