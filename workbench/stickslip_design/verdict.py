"""Will this axis judder, and what cures it? The answer for one axis, as numbers.

`design` makes it from an `axis.Axis`. Feeds are speeds of the table [m/s].
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from .axis import Axis
from .loop.hunting import Hunting
from .loop.response import Response
from .loop.stability import GainLimits, Swing
from .record import Record

WORTHWHILE: Final = 10.0
"""A change by more than this factor is no cure worth naming first."""


@dataclass(frozen=True)
class OperatingPoint:
    """What the axis does at one feed.

    Attributes
    ----------
    feed
        The feed [m/s].
    margin
        The feed over the critical feed [-]; infinite where the axis never jumps.
    jumps
        Whether a motion in jumps exists at the feed.
    from_rest
        Whether the axis jumps there after a start from rest; None where no acceleration is stated,
        or the drive is rigid.
    jump, frequency
        Way [m] of a jump, and jumps a second [1/s]; None where there are none.
    simplified_jump, simplified_frequency
        The same by the familiar formulas of a rigid drive.
    hunts
        Whether the drive turns the table back between two jumps, so that there is no even row of
        them: the feed is slower than the integral of the drive.
    """

    feed: float
    margin: float
    jumps: bool
    from_rest: bool | None
    jump: float | None
    frequency: float | None
    simplified_jump: float
    simplified_frequency: float
    hunts: bool = False


@dataclass(frozen=True)
class AxisCure:
    """One number of an axis changed, all others held.

    Attributes
    ----------
    name
        What is changed, in words: "stiffer", "less gap", "more damping", "K_v higher" ...
    number
        The number that is changed, by its name in the axis file.
    unit
        Its SI unit, to be shown as engineers write it.
    now, then
        Its value now, and the one from which on the aim is met, SI; None where none does.
    effort
        The factor of the change, above 1; by it the cures are ranked. Infinite where none does.
    aim
        "no jump at the slowest feed", or "a jump that is allowed".
    held
        What is held while it changes, in words; empty where nothing needs saying.
    note
        What else must be known, in words; why none does, where none does.
    """

    name: str
    number: str
    unit: str
    now: float
    then: float | None
    effort: float
    aim: str
    held: str = ""
    note: str = ""


@dataclass(frozen=True)
class Verdict:
    """The answer for an axis.

    Attributes
    ----------
    axis
        The axis.
    stable
        Whether the loop is stable; a rigid drive is.
    critical_feed
        The highest feed that is reached in jumps [m/s]; 0: it never jumps, infinite: at every feed.
    critical_range
        The lowest and the highest critical feed within the ± of the axis and along its screw [m/s].
    rigid_critical_feed
        The critical feed on a rigid drive [m/s].
    estimated_critical_feed
        The quick estimate of the critical feed: the closed form of a rigid drive with the damping
        of the sliding loop [m/s]; None on a rigid drive.
    simplified_critical_feed
        The familiar formula (mu_s - mu_k) N/sqrt(4 pi zeta k m), of a rigid drive [m/s].
    from_rest
        The feed above which a start from rest ends in even motion [m/s]; None where no
        acceleration is stated or the drive is rigid.
    sliding, stuck
        The least damped swing with the table sliding, and with it stuck; None on a rigid drive.
    gains
        Up to which gains the loop is stable; None on a rigid drive.
    points
        The operating points, the slowest feed first.
    hunting
        The cycle about a target; None where the axis comes to rest, or on a rigid drive.
    responses
        Open loops; empty on a rigid drive.
    cures
        What ends the jump at the slowest feed, the cheapest first; empty where there is none.
    before, after
        The motion after a break-away at the slowest feed, as it is, and beyond the cheapest cure;
        None where nothing judders, and where nothing cures it.
    sentence
        The answer in words.
    unanswered
        What the answer leaves out, a sentence each.
    """

    axis: Axis
    stable: bool
    critical_feed: float
    critical_range: tuple[float, float]
    rigid_critical_feed: float
    estimated_critical_feed: float | None
    simplified_critical_feed: float
    from_rest: float | None
    sliding: Swing | None
    stuck: Swing | None
    gains: GainLimits | None
    points: tuple[OperatingPoint, ...]
    hunting: Hunting | None
    responses: tuple[Response, ...]
    cures: tuple[AxisCure, ...]
    before: Record | None
    after: Record | None
    sentence: str
    unanswered: tuple[str, ...]

    @property
    def cheapest(self) -> tuple[AxisCure, ...]:
        """The cheapest cure of each aim, without those that are none to name."""
        return cheapest(self.cures)


def cheapest(cures: Iterable[AxisCure]) -> tuple[AxisCure, ...]:
    """Return the cheapest cure of each aim, of cures that are in order.

    A faster feed is none, since the feed is what is asked for, and none is a number that must
    change by more than a factor of `WORTHWHILE`.
    """
    found: dict[str, AxisCure] = {}
    for cure in cures:
        if cure.then is not None and cure.number != "feeds" and cure.effort <= WORTHWHILE:
            found.setdefault(cure.aim, cure)
    return tuple(found.values())
