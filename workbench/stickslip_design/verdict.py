"""Will this axis judder, and what cures it? The answer for one axis, as numbers and in words.

`design` makes it from an `axis.Axis`. Feeds are speeds of the table [m/s].
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Concatenate, Final, Literal, NamedTuple, ParamSpec, TypeVar, get_args

from stickslip_ref import EVEN, CriticalVelocity, Interval, Regime, merged
from stickslip_units import EXACT, number, shown_in, told, turning

from .axis import Axis
from .loop.critical import Record
from .loop.presliding import AtFeed, Presliding
from .loop.rest import Hunting
from .loop.stability import GainLimits, Response, Swing, gain_limits

Effort = Literal["setting", "part", "rebuild", "program"]
EFFORTS: Final[tuple[Effort, ...]] = get_args(Effort)
"""Kinds of effort, the least first; a "program" changes what is asked of the axis."""


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


class Robustness(NamedTuple):
    """How an axis stands when numbers vary; each value within a ± is as likely as another."""

    clean: int
    """Machines at which every feed asked for is even, or jumps no more than allowed."""
    machines: int
    decides: str | None
    """The number whose lower and upper half differ most in that; None where none stands out."""


class Change(NamedTuple):
    """A number of an axis that a measure changes."""

    number: str
    """Its name in the axis file."""
    unit: str
    """Its SI unit, at the slide; empty: it is a text."""
    now: float | str
    then: float | str
    """Its value now, and with the measure, SI."""


@dataclass(frozen=True)
class AxisMeasure:
    """A measure of the catalogue, or two together, and the axis with it."""

    ids: tuple[str, ...]
    """Its names in the catalogue; two of a pair."""
    name: str
    """What is ordered or set, in words."""
    effort: Effort
    """What it takes: a setting, a part, a rebuild; or another program for the axis."""
    enough: bool
    """Whether it is enough: every feed asked for is even, or jumps no more than allowed; where none
    judders anyway, the axis comes to rest at a target."""
    changes: tuple[Change, ...]
    """The numbers that it moves."""
    critical_feed: float | None
    """The critical feed with it [m/s]; None where it is not computed: friction without a closed
    form, and a measure that is not enough."""
    margin: float | None
    """The least margin of the feeds with it [-], as of `OperatingPoint`; None where it is not
    enough, or does not change the axis."""
    robustness: Robustness | None
    """How it stands when numbers vary; None as `margin`, and without feeds."""
    hunts: float | None
    """The jump at a target with it [m]; None where it comes to rest, or is not enough."""
    needs: tuple[str, ...]
    """What must be so, and no axis file says."""
    costs: tuple[str, ...]
    """What it costs elsewhere."""
    idle: tuple[str, ...]
    """What it does not help."""
    sources: tuple[str, ...]
    """Names of the sources of its numbers, docs/cures.md; "estimate" where there is none."""


@dataclass(frozen=True)
class AxisCure:
    """How far one number of an axis would have to go, all others held."""

    name: str
    """What is changed, in words: "stiffer", "smaller gap" ..."""
    number: str
    """The number that is changed, by its name in the axis file."""
    unit: str
    """Its SI unit, to be shown as engineers write it."""
    now: float
    then: float | None
    """Its value now, and the one from which on the aim is met, SI; None: beyond what exists."""
    effort: float
    """The factor of the change, above 1; by it the rows are ranked. Infinite where none does."""
    aim: str
    """What it is for: "no jump at the slowest feed", "even motion" at the slowest feed that
    judders, or "a jump that is allowed"."""
    held: str = ""
    """What is held while it changes, in words; empty where nothing needs saying."""
    note: str = ""
    """Why there is no value, in words, where there is none."""


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
    robustness: Robustness | None
    """How the axis as it is stands when numbers vary; None without feeds."""
    varied: Mapping[str, float]
    """The ± of these numbers, relative [-]: gap of the friction, stiffness, damping, mass."""
    varied_by_default: tuple[str, ...]
    """Those of them whose ± the file does not state."""
    hunting: Hunting | None
    """The cycle about a target; None where the axis comes to rest, or on a rigid drive."""
    responses: tuple[Response, ...]
    """Open loops; empty on a rigid drive."""
    measures: tuple[AxisMeasure, ...]
    """Measures that help, those that are enough first, by effort, clean machines and weight of the
    work; two together where none is; then those that are not enough. Empty where nothing judders
    or hunts."""
    left_out: Mapping[str, tuple[str, ...]]
    """The other measures of the catalogue, by the reason why they are not offered."""
    cures: tuple[AxisCure, ...]
    """How far one number would have to go to make the slowest feed that judders even, within what
    exists, the smallest change first."""
    before: Record | None
    after: Record | None
    """The motion after a break-away at that feed, as it is, and with the best measure; None where
    nothing judders; the second also where no measure is enough."""
    sentence: str
    """The answer in words."""
    unanswered: tuple[str, ...]
    """What the answer leaves out, a sentence each."""
    presliding: Presliding | None = None
    """What presliding makes of it; None where that was not asked."""

    @property
    def best(self) -> AxisMeasure | None:
        """The first measure that is enough and leaves the task as it is; None where none is."""
        return best(self.measures)

    @property
    def with_presliding(self) -> tuple[str, ...]:
        """What presliding makes of it in sentences; empty where that was not asked."""
        found = self.presliding
        if found is None or found.refused:
            return (f"Presliding is not judged: {found.refused}.",) if found else ()
        both = zip(found.feeds, self.points, strict=True)
        # `judders` is None where it is open.
        spoken = [at for at, point in both if point.judders or at.judders not in (at.falls, False)]
        said = "; it ".join(_yielding(at) for at in (*spoken, found.target) if at)
        usual = [each.reason for each in found.assumed if each.key == "friction.presliding"]
        way = ", ".join([told(found.way, "m", EXACT), *usual])
        falls = ", ".join(feed_in_words(at.feed) for at in found.feeds if at.falls)
        because = "as friction falls over a speed and not at once, with presliding or without"
        first = f"With presliding of {way}: it {said or 'does not judder either'}."
        return (first, f"It judders at {falls} {because}.") if falls else (first,)


def best(measures: Iterable[AxisMeasure]) -> AxisMeasure | None:
    """Return the first measure that is enough and leaves the task as it is."""
    return next((one for one in measures if one.enough and one.effort != "program"), None)


def judder(points: Iterable[OperatingPoint]) -> OperatingPoint | None:
    """Return the slowest of some points, in order, at which the axis judders."""
    return next((point for point in points if point.judders), None)


def margin_of(limits: CriticalVelocity, feed: float) -> float:
    """Return the factor by which a feed is away from those that judder; `OperatingPoint`."""
    judders = merged([*limits.cycle, *limits.unstable])
    inside = [interval for interval in judders if feed in interval]
    if inside:
        return feed / inside[0].high
    below = [feed / interval.high for interval in judders if interval.high < feed]
    above = [interval.low / feed for interval in judders if interval.low > feed]
    return min([*below, *above], default=math.inf)


_P = ParamSpec("_P")
_T = TypeVar("_T")
_Judged = TypeVar("_Judged", Axis, Verdict)


def in_its_units(
    say: Callable[Concatenate[_Judged, _P], _T],
) -> Callable[Concatenate[_Judged, _P], _T]:
    """Let a function on an axis or a verdict show numbers in its units: of a rotary table in °."""

    @wraps(say)
    def said(judged: _Judged, /, *args: _P.args, **named: _P.kwargs) -> _T:
        axis = judged.axis if isinstance(judged, Verdict) else judged
        with turning(axis.turns):
            return say(judged, *args, **named)

    return said


_SLOW: Final = 1e-3
"""Feeds below this are given in mm/min [m/s]."""


def feed_in_words(feed: float) -> str:
    """Return a feed [m/s]: in mm/min where it is slow, else in mm/s."""
    return told(feed, "m/min" if feed < _SLOW else "m/s", EXACT)


@in_its_units
def in_words(
    axis: Axis,
    limits: CriticalVelocity,
    points: Sequence[OperatingPoint],
    measures: Sequence[AxisMeasure],
    *,
    stable: bool,
) -> str:
    """Return the answer for an axis in a few sentences; points and measures as of `Verdict`."""
    if not stable:
        return _unstable(axis)
    worst, ends = judder(points), _ends(axis, limits)
    if worst is not None:
        said = [f"{_judder(worst)}; {ends}.", _start(axis, worst), _best(measures)]
        return " ".join(filter(None, said))
    if not limits.cycle and not limits.unstable:
        return "This axis does not jump at any feed, and moves evenly at each."
    if not points:
        return f"This axis can judder; {ends}."
    least = min(points, key=lambda point: point.margin)
    return (
        f"At the feeds asked for this axis moves evenly; {_where(limits)}. "
        f"The least margin is {number(least.margin)}, at {feed_in_words(least.feed)}."
    )


def ranges_in_words(ranges: Sequence[Interval]) -> str:
    """Return ranges of the feed in words: up to 3.95 mm/s, from 4.26 to 56.6 mm/s."""
    return " and ".join(_range(interval) for interval in ranges)


def _where(limits: CriticalVelocity) -> str:
    """Return where an axis jumps and swings."""
    said = [f"it jumps {ranges_in_words(limits.cycle)}"] if limits.cycle else []
    if limits.unstable:
        said.append(f"even motion is unstable {ranges_in_words(limits.unstable)}")
    return "; ".join(said)


def _range(interval: Interval) -> str:
    endless = math.isinf(interval.high)
    if interval.low_end == "none":
        return "at every feed" if endless else f"up to {told(interval.high, 'm/s')}"
    if endless:
        return f"from {told(interval.low, 'm/s')} on"
    return f"from {shown_in(interval.low, 'm/s')} to {told(interval.high, 'm/s')}"


def _ends(axis: Axis, limits: CriticalVelocity) -> str:
    """Return where jumps and swings end."""
    said = []
    if limits.cycle:
        critical = limits.highest
        if math.isinf(critical):
            said.append("without damping the jumps have no end at any feed")
            if axis.drive is None and axis.c == 0.0:
                said[0] += ": state c or zeta of the axis"
        elif len(limits.cycle) == 1 and limits.cycle[0].low_end == "none":
            said.append(f"from {told(critical, 'm/s')} on it cannot")
        else:
            return _where(limits)
    said += [_where(limits._replace(cycle=()))] if limits.unstable else []
    return "; ".join(said)


def _unstable(axis: Axis) -> str:
    gains = gain_limits(axis)
    cures = [
        f"{name} below {told(limit, '1/s')}"
        for name, limit in (("K_v", gains.K_v), ("a bandwidth", gains.bandwidth))
        if 0.0 < limit < math.inf
    ]
    bears = f" It bears {' or '.join(cures)}, all else held." if cures else ""
    return (
        "The loop of this axis is unstable: with these gains it swings by itself, whatever the "
        f"friction.{bears} Nothing else is answered before that is mended."
    )


def _judder(point: OperatingPoint) -> str:
    at = feed_in_words(point.feed)
    cycle, swings = point.regime.stick_slip, point.regime.swings
    if cycle is None and swings:
        swing = swings[0]
        return (
            f"At {at} this axis swings by ± {number(100.0 * swing.amplitude, 2)} % of the feed, "
            f"{number(swing.frequency)} times a second, and never stops"
        )
    if cycle is None:
        return f"At {at} even motion of this axis is unstable"
    if point.jump is None or point.frequency is None:
        return f"At {at} this axis hunts along the way: the drive turns it back between two jumps"
    often = f"{number(point.frequency, 2)} times a second"
    back = ", turning back between them" if cycle.reverses else ""
    return f"At {at} this axis jumps {told(point.jump, 'm')}, {often}{back}"


def _yielding(at: AtFeed) -> str:
    where = f"at {feed_in_words(at.feed)}" if at.feed else "at a target"
    on = f"from {told(at.turns_at, 'm')} on" if at.turns_at else ""
    if at.judders is None:
        return f"had not settled {where} when it was no longer followed"
    if not at.judders:
        return f"{'moves evenly' if at.feed else 'does not hunt'} {where}" + (on and f", as {on}")
    worst = max(at.from_rest, at.from_jumps, key=lambda motion: motion[1:])
    does = "swings" if worst.period else "does not stay even"
    if worst.jump:
        does = f"jumps {told(worst.jump, 'm')}, {number(1.0 / worst.period, 2)} times a second,"
    bump = ", though not after a start from rest" if at.from_rest.kind == "even" else ""
    return f"{does} {where}{bump}" + (on and f", and {on} no more")


def _start(axis: Axis, point: OperatingPoint) -> str:
    if point.after_start is not False:
        return ""
    return (
        f"After a start from rest with {told(axis.demand.acceleration, 'm/s2', EXACT)} it moves "
        "evenly there, but a shove or a slower start makes it jump."
    )


def _best(measures: Sequence[AxisMeasure]) -> str:
    found = best(measures)
    if found is None:
        return "No measure of the catalogue ends that, nor two together."
    first = "No measure alone is enough; two" if len(found.ids) > 1 else "Least effort"
    return f"{first}: {found.name} ({found.effort})."
