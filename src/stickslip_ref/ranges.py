"""Ranges of the pulling velocity: where stick-slip ends."""

from __future__ import annotations

import math
from typing import NamedTuple

STICKS, SWINGS, EVEN = "sticks", "swings", "even"


class Interval(NamedTuple):
    """A range of the pulling velocity.

    Attributes
    ----------
    low, high : float
        Its ends [m/s].
    low_end, high_end : str
        The kind of each end: "eigenvalue", "grazing", "fold", "reversal", or "none" where the range
        ends only because the search does.
    """

    low: float
    high: float
    low_end: str
    high_end: str

    def __contains__(self, v: object) -> bool:
        return isinstance(v, float | int) and self.low <= abs(v) <= self.high


class CriticalVelocity(NamedTuple):
    """Where stick-slip ends, over the pulling velocity.

    Attributes
    ----------
    unstable : tuple of Interval
        Where steady sliding is unstable.
    cycle : tuple of Interval
        Where a cycle with a stick exists.
    between : tuple of two floats
        The range that was searched [m/s].
    proven : bool
        Whether nothing else exists, at any velocity. Else nothing else was found in the range, and
        nothing narrower than 1 % of v was looked for.
    reason : str
        Why no cycle exists at any velocity, where the friction law says it.

    Notes
    -----
    Intervals are disjoint and in order. Where a cycle exists and steady sliding is stable, both
    motions exist, and the start decides between them.
    """

    unstable: tuple[Interval, ...]
    cycle: tuple[Interval, ...]
    between: tuple[float, float]
    proven: bool
    reason: str = ""

    @property
    def highest(self) -> float:
        """The highest velocity [m/s] at which a cycle with a stick exists; 0 if none does."""
        return max((each.high for each in self.cycle), default=0.0)

    def motions(self, v: float) -> tuple[str, ...]:
        """Return which steady motions exist at a velocity [m/s].

        Of "sticks" (a cycle with a stick), "swings" (the mass swings and never sticks) and "even"
        (steady sliding is stable).

        Raises
        ------
        ValueError
            If the velocity is outside of the range that was searched.
        """
        low, high = self.between
        if not low <= abs(v) <= high:
            raise ValueError(
                f"v = {v:g} m/s is out of range; the velocities searched are {low:g} to {high:g} "
                "m/s"
            )
        sticks = any(v in each for each in self.cycle)
        even = not any(v in each for each in self.unstable)
        found = [STICKS] * sticks + [EVEN] * even
        return tuple(found) or (SWINGS,)


def merged(intervals: list[Interval]) -> tuple[Interval, ...]:
    """Return intervals in order, those that touch made one."""
    found: list[Interval] = []
    for each in sorted(intervals):
        if found and each.low <= found[-1].high * (1.0 + 4.0 * 2.0**-52):
            last = found.pop()
            high, high_end = max((last.high, last.high_end), (each.high, each.high_end))
            found.append(Interval(last.low, high, last.low_end, high_end))
        elif each.high > each.low and not math.isnan(each.low):
            found.append(each)
    return tuple(found)
