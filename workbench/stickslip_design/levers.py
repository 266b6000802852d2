"""The numbers of an axis that can be moved, one at a time, and how far to end its jumps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Final

from .axis import Axis, Demand
from .loop.critical import damped, is_allowed, is_clean, jumps_of
from .loop.stability import is_stable
from .measures.moving import with_number
from .verdict import AxisCure

_GAP: Final = 10.0
_STIFFER: Final = 3.0
_ZETA: Final = 0.2
_LIGHTER: Final = 1.25
"""The largest factors of gap, stiffness and mass (20 % less), and the largest damping ratio: beyond
them nothing exists that could be ordered."""
_CLOSE: Final = 5e-3
_CLOSE_BY_SIDE: Final = 1e-7
"""How close a factor is found, relative, with a drive and on a rigid one."""

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
    farthest: float = _GAP
    """The largest factor by which it is moved."""
    end: str = ""
    """What that is, in words."""

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
        note = "" if factor is not None else f"beyond what exists: {self.end}"
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

    mass = "inertia" if axis.turns else "mass"
    # The static friction of a measured curve is bound to its first point.
    if not friction.is_curve:
        number, unit = ("T_s" if axis.turns else "F_s", "N") if newtons else ("mu_s", "1")
        now, least = (axis.F_s, axis.F_k) if newtons else (friction.mu_s, friction.mu_k)
        yield Lever(
            "smaller gap", number, unit, False, now, static, "kinetic friction", least,
            end=f"a gap {_GAP:g} times smaller",
        )  # fmt: skip
    stiffer = Lever(
        "stiffer", "stiffness", "N/m", True, axis.k, lambda k: replace(axis, k=k), "c",
        farthest=_STIFFER, end=f"{_STIFFER:g} times the stiffness",
    )  # fmt: skip
    lighter = Lever(
        "lighter", mass, "kg", False, axis.m, lambda m: with_number(axis, "axis.mass", m),
        "c, load and friction" if newtons else "c and load",
        farthest=_LIGHTER, end="20 % less mass",
    )  # fmt: skip
    stiffer = limited(stiffer, *axis.limits.get("k", (0.0, math.inf)))
    yield stiffer
    if zeta > 0.0:
        yield replace(stiffer, moved=lambda k: damped(stiffer.moved(k), zeta), held="zeta")
    if 0.0 < zeta < _ZETA:
        more = Lever("more damping", "c", "N.s/m", True, axis.c, lambda c: replace(axis, c=c))
        yield replace(more, farthest=_ZETA / zeta, end=f"a damping ratio of {100.0 * _ZETA:g} %")
    yield limited(lighter, *axis.limits.get("m", (0.0, math.inf)))


def limited(lever: Lever, low: float, high: float) -> Lever:
    """Return a lever that ends at the `[limits]` of an axis, where they are nearer."""
    farthest = high / lever.now if lever.up else lever.now / low if low > 0.0 else math.inf
    if farthest >= lever.farthest:
        return lever
    return replace(lever, farthest=max(farthest, 1.0), end="the [limits] of the file")


def cures(axis: Axis, feed: float, aim: str = END) -> tuple[AxisCure, ...]:
    """Return how far each number must move till an axis moves evenly at a feed.

    Where a largest jump is asked for, also how far to bring the jump down to it. The axis jumps or
    swings at the feed [m/s], above 0; `aim` says what the changes are for. The smallest change
    first; those that do not help within what exists last.
    """
    close = _CLOSE_BY_SIDE if axis.drive is None else _CLOSE

    def even(axis: Axis) -> bool:
        return is_clean(replace(axis, demand=Demand(feeds=(feed,))))

    def allowed(axis: Axis) -> bool:
        return is_stable(axis) and is_allowed(axis, feed)

    found = [lever.cure(_least(lever, even, math.inf, close), aim) for lever in levers(axis)]
    largest = axis.demand.largest_jump
    if largest is not None and (jumps := jumps_of(axis, feed)) and jumps.way > largest:
        for lever, end in zip(levers(axis), list(found), strict=False):
            # From a larger jump jumping may also end at once.
            factor = _least(lever, allowed, end.effort / (1.0 + 2.0 * _CLOSE), _CLOSE)
            if factor is not None:
                found.append(lever.cure(factor, BELOW))
    return tuple(sorted(found, key=lambda cure: (cure.then is None, cure.effort)))


def _least(lever: Lever, holds: Callable[[Axis], bool], below: float, close: float) -> float | None:
    """Return the least factor from which on an axis meets an aim, by halving; None if none does.

    It lies below a factor, and within what exists.
    """
    low, high = 1.0, min(below, lever.farthest)
    if high <= low or not holds(lever.at(high)):
        return None
    while high > low * (1.0 + close):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if holds(lever.at(middle)) else (middle, high)
    return high
