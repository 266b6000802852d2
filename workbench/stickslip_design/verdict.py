"""Will this axis judder, and what cures it? The answer for one axis, as numbers.

`design` makes it from an `axis.Axis`. Feeds are speeds of the table [m/s].
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from stickslip_ref import EVEN, Interval, Regime

from .axis import Axis
from .loop.hunting import Hunting
from .loop.response import Response
from .loop.stability import GainLimits, Swing
from .record import Record

WORTHWHILE: Final = 10.0
"""A change by more than this factor is no cure worth naming first."""


@dataclass(frozen=True)
class OperatingPoint:
    """What the axis does at one feed."""

    regime: Regime
    """What happens there."""
    margin: float
    """The factor by which the feed is away from feeds at which the axis judders [-]: the feed over
    their upper end, below 1 where it judders; their lower end over the feed where it is slower than
    they are. Infinite where there are none."""
    after_start: bool | None
    """Whether the axis jumps there after a start from rest; None where no acceleration is stated,
    or the drive is rigid."""
    simplified_jump: float
    simplified_frequency: float
    """Way [m] of a jump, and jumps a second [1/s], by the familiar formulas of a rigid drive."""

    @property
    def feed(self) -> float:
        """The feed [m/s]."""
        return self.regime.speed

    @property
    def jumps(self) -> bool:
        """Whether a motion in jumps exists at the feed."""
        return self.regime.stick_slip is not None

    @property
    def judders(self) -> bool:
        """Whether a motion that is not even exists at the feed: it jumps, or swings."""
        return self.regime.kinds != (EVEN,) or not self.regime.even

    @property
    def jump(self) -> float | None:
        """Way of a jump [m]; None where there is none, or no even row of them."""
        cycle = self.regime.stick_slip
        return None if cycle is None else _finite(cycle.jump)

    @property
    def frequency(self) -> float | None:
        """Jumps, or swings, a second [1/s]; None as `jump`."""
        if self.regime.stick_slip is not None:
            return _finite(1.0 / self.regime.stick_slip.period)
        return self.regime.swings[0].frequency if self.regime.swings else None


def _finite(value: float) -> float | None:
    return None if math.isnan(value) else value


@dataclass(frozen=True)
class AxisCure:
    """One number of an axis changed, all others held."""

    name: str
    """What is changed, in words: "stiffer", "less gap", "more damping", "K_v higher" ..."""
    number: str
    """The number that is changed, by its name in the axis file."""
    unit: str
    """Its SI unit, to be shown as engineers write it."""
    now: float
    then: float | None
    """Its value now, and the one from which on the aim is met, SI; None where none does."""
    effort: float
    """The factor of the change, above 1; by it the cures are ranked. Infinite where none does."""
    aim: str
    """What it is for: "no jump at the slowest feed", "even motion" at the slowest feed that
    judders, or "a jump that is allowed"."""
    held: str = ""
    """What is held while it changes, in words; empty where nothing needs saying."""
    note: str = ""
    """What else must be known, in words; why none does, where none does."""


@dataclass(frozen=True)
class Verdict:
    """The answer for an axis."""

    axis: Axis
    stable: bool
    """Whether the loop is stable with a table that slides fast; a rigid drive is."""
    cycle: tuple[Interval, ...]
    unstable: tuple[Interval, ...]
    """The feeds [m/s] at which a cycle with jumps exists, and at which even motion is unstable."""
    critical_feed: float
    """The highest feed that is reached in jumps [m/s]; 0: it never jumps, infinite: at every
    feed."""
    critical_range: tuple[float, float]
    """The lowest and the highest critical feed within the ± of the axis and along its screw
    [m/s]."""
    rigid_critical_feed: float
    """The critical feed on a rigid drive [m/s]."""
    estimated_critical_feed: float | None
    """The quick estimate of the critical feed: the closed form of a rigid drive with the damping of
    the sliding loop [m/s]; None on a rigid drive."""
    simplified_critical_feed: float
    """The familiar formula (mu_s - mu_k) N/sqrt(4 pi zeta k m), of a rigid drive [m/s]."""
    from_rest: float | None
    """The feed above which a start from rest ends in even motion [m/s]; None where no acceleration
    is stated or the drive is rigid."""
    sliding: Swing | None
    stuck: Swing | None
    """The least damped swing with the table sliding, and with it stuck; None on a rigid drive."""
    gains: GainLimits | None
    """Up to which gains the loop is stable; None on a rigid drive."""
    points: tuple[OperatingPoint, ...]
    """The operating points, the slowest feed first."""
    hunting: Hunting | None
    """The cycle about a target; None where the axis comes to rest, or on a rigid drive."""
    responses: tuple[Response, ...]
    """Open loops; empty on a rigid drive."""
    cures: tuple[AxisCure, ...]
    """What makes the slowest feed that judders even, the smallest change first; empty where none
    does."""
    before: Record | None
    after: Record | None
    """The motion after a break-away at that feed, as it is, and beyond the smallest change; None
    where nothing judders, and where nothing cures it."""
    sentence: str
    """The answer in words."""
    unanswered: tuple[str, ...]
    """What the answer leaves out, a sentence each."""

    @property
    def smallest(self) -> tuple[AxisCure, ...]:
        """The smallest change of each aim, without those that are none to name."""
        return smallest(self.cures)

    @property
    def judder(self) -> OperatingPoint | None:
        """The slowest feed at which the axis judders; None where it does at none."""
        return judder(self.points)


def judder(points: Iterable[OperatingPoint]) -> OperatingPoint | None:
    """Return the slowest of some points, in order, at which the axis judders."""
    return next((point for point in points if point.judders), None)


def smallest(cures: Iterable[AxisCure]) -> tuple[AxisCure, ...]:
    """Return the smallest change of each aim, of cures that are in order.

    A faster feed is none, since the feed is what is asked for, and none is a number that must
    change by more than a factor of `WORTHWHILE`.
    """
    found: dict[str, AxisCure] = {}
    for cure in cures:
        if cure.then is not None and cure.number != "feeds" and cure.effort <= WORTHWHILE:
            found.setdefault(cure.aim, cure)
    return tuple(found.values())
