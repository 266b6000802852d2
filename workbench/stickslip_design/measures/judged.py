"""Which measures of the catalogue end the judder of an axis: each is applied, the axis judged anew.

Cheap questions come first: whether a measure applies, whether the loop stays stable, which side of
the limit each feed is on. Limits are computed of what is enough alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import combinations
from typing import Final, NamedTuple

from stickslip_ref import CriticalVelocity

from ..axis import Axis, AxisError
from ..axis.keys import KEYS
from ..loop.critical import critical_feed, estimated_critical_feed, is_allowed, is_clean, limits_of
from ..loop.rest import Hunting, hunting
from ..loop.stability import is_stable
from ..one_thread import one_thread
from ..verdict import EFFORTS, AxisMeasure, Change, OperatingPoint, judder, margin_of
from .catalogue import Measure, catalogue
from .moving import applies, number_of, with_measure
from .robust import Series

_SURE: Final = 0.9
"""Of machines: more are as good, and a milder step of a measure that is clean in fewer is not
taken."""
_BETTER: Final = 0.95
"""A measure helps if it takes the critical feed below this part."""
_PAIRS: Final = 2
_TRIED: Final = 12
"""Pairs that are sought, and that are judged at most."""
_HOPE: Final = 1.5
"""A pair is judged if the product of what its two do alone comes below this times the feed."""
_WORSE: Final = 1.15
"""A measure whose estimate rises by this factor is not judged further."""
_NO_HELP: Final = "no help"


class Found(NamedTuple):
    """A measure and the axis with it."""

    measure: AxisMeasure
    axis: Axis


@dataclass(frozen=True)
class _Tried:
    """Measures at their steps, and the axis with them."""

    taken: tuple[Measure, ...]
    axis: Axis
    enough: bool
    reach: float
    """The critical feed with them [m/s], perhaps estimated; NaN where it is not asked for."""
    limits: CriticalVelocity | None = None
    """The limits of the axis with them, where they are enough at its feeds."""

    @property
    def effort(self) -> int:
        return max(EFFORTS.index(measure.effort) for measure in self.taken)


@one_thread
def measures(
    series: Series, points: Sequence[OperatingPoint], critical: float, rest: Hunting | None
) -> tuple[tuple[Found, ...], dict[str, tuple[str, ...]]]:
    """Return the measures that help the axis of a series, and the names of the others, by reason.

    `points` are its operating points, `critical` its critical feed [m/s], `rest` its cycle about a
    target. Where a feed judders the aim is that none does; else that it does not hunt at a target.
    First those that are enough, by effort, share of clean machines up to `_SURE` and order of the
    catalogue, what changes the task and not the axis last; then those that help and are not enough.
    Of two together the best pairs are among the first, if nothing less than a rebuild is enough
    alone.
    """
    unknown = [name for name in series.axis.without if name not in catalogue()]
    if unknown:
        near = get_close_matches(unknown[0], catalogue(), 3, 0.3)
        remedy = f"nearest: {', '.join(near)}" if near else "docs/cures.md lists them"
        raise AxisError("is no measure of the catalogue", "limits.without", unknown[0], "", remedy)
    if judder(points) is None and rest is None:
        return (), {}
    verdict = {"critical_feed": critical, "hunting.dead_band": rest.dead_band if rest else 0.0}
    judge = _Judge(series, points, verdict)
    tried = [judge.tried(measure) for measure in catalogue().values()]
    alone = [one for one in tried if isinstance(one, _Tried)]
    found = [one for one in alone if one.enough]
    helping = [one for one in alone if not one.enough]
    # Two parts are less than a rebuild.
    if not any(one.taken[0].effort in ("setting", "part") for one in found):
        none = all(one.taken[0].effort == "program" for one in found)
        found += judge.pairs([o for o in helping if none or o.taken[0].effort != "rebuild"])
    left_out: dict[str, list[str]] = {}
    for measure, one in zip(catalogue().values(), tried, strict=True):
        if isinstance(one, str):
            left_out.setdefault(one, []).append(measure.id)
    shown = sorted(map(judge.shown, found), key=_rank)
    shown += map(judge.shown, sorted(helping, key=lambda one: one.reach))
    return tuple(shown), {reason: tuple(names) for reason, names in left_out.items()}


class _Judge:
    """What is asked of an axis, and whether a changed one meets it."""

    def __init__(
        self, series: Series, points: Sequence[OperatingPoint], verdict: Mapping[str, float]
    ) -> None:
        self._series, self._axis, self._verdict = series, series.axis, verdict
        self._points = [point for point in points if point.judders]
        self._reach = self._reached(self._axis)
        estimate = estimated_critical_feed(self._axis)
        self._scale = self._reach / estimate if 0.0 < estimate < math.inf else 0.0

    def tried(self, measure: Measure) -> _Tried | str:
        """Return the mildest step of a measure that is surely enough, else the best; why none."""
        if measure.id in self._axis.without:
            return "excluded by [limits]"
        if not applies(measure, self._axis):
            return "does not apply"
        if measure.creeps:
            enough = bool(self._points) and all(point.regime.even for point in self._points)
            return _Tried((measure,), self._axis, True, math.nan) if enough else _NO_HELP
        steps = [
            changed
            for step in range(measure.steps)
            if (changed := with_measure(self._axis, measure, step, self._verdict)) is not None
        ]
        allowed = [axis for axis in steps if not any(axis.beyond_limits())]
        borne = [axis for axis in allowed if is_stable(axis)]
        if not borne:
            reason = "makes the loop unstable" if allowed else "beyond [limits]"
            return reason if steps else "does not apply"
        # The estimate says which step is the best; a milder one may be enough too.
        best = min(borne, key=estimated_critical_feed) if self._points else borne[-1]
        one = self._judged((measure,), best)
        if one is not None and one.enough:
            for milder in borne[: borne.index(best)]:
                other = self._judged((measure,), milder)
                if other is not None and other.enough and self._is_sure(milder):
                    return other
        return one or _NO_HELP

    def _is_sure(self, axis: Axis) -> bool:
        """Return whether nearly all machines of the series are clean with a measure."""
        found = self._series.robustness(axis)
        return found is None or found.clean >= _SURE * found.machines

    def _judged(self, taken: tuple[Measure, ...], axis: Axis) -> _Tried | None:
        """Return measures that are enough, or help; None where they do not.

        The quick estimate comes first, scaled to the exact value of the axis as it is.
        """
        if not self._points:
            if hunting_of(axis) is not None or not is_clean(axis):
                return None
            limits = limits_of(axis, critical_feed(axis)) if axis.friction.constant else None
            return _Tried(taken, axis, True, limits.highest if limits else math.nan, limits)
        if self._scale * estimated_critical_feed(axis) > _WORSE * self._reach:
            return None
        reach = self._reached(axis)
        if is_clean(axis):
            limits = limits_of(axis, reach if axis.friction.constant else critical_feed(axis))
            # Jumps carried up from slower feeds may exist where a break-away does not end in them.
            if all(margin_of(limits, f) > 1.0 or is_allowed(axis, f) for f in axis.demand.feeds):
                return _Tried(taken, axis, True, limits.highest, limits)
        return _Tried(taken, axis, False, reach) if reach < _BETTER * self._reach else None

    def _reached(self, axis: Axis) -> float:
        """Return the critical feed; with a law without a closed form its estimate."""
        return critical_feed(axis) if axis.friction.constant else estimated_critical_feed(axis)

    def pairs(self, helping: Sequence[_Tried]) -> list[_Tried]:
        """Return the best pairs that are enough, of measures that are not enough alone."""
        feed = min((point.feed for point in self._points), default=0.0)
        hopes = []
        for one, other in combinations(helping, 2):
            hope = one.reach * other.reach / self._reach if self._reach < math.inf else 0.0
            if one.taken[0].kind != other.taken[0].kind and hope < _HOPE * feed:
                efforts = one.effort, other.effort
                hopes.append((max(efforts), sum(efforts), hope, one, other))
        found: list[_Tried] = []
        for *_, one, other in sorted(hopes, key=lambda row: row[:3])[:_TRIED]:
            (second,) = other.taken
            # The second at its strongest.
            changed = with_measure(one.axis, second, second.steps - 1, self._verdict)
            possible = changed and not any(changed.beyond_limits()) and is_stable(changed)
            both = self._judged((*one.taken, second), changed) if changed and possible else None
            if both is not None and both.enough:
                found.append(both)
            if len(found) == _PAIRS:
                break
        return found

    def shown(self, one: _Tried) -> Found:
        """Return what is told of measures: what they change, and what the axis then does."""
        axis, margin, hunts, robustness = one.axis, None, None, None
        known = not one.enough and axis.friction.constant
        critical = limits_of(axis).highest if known else None
        if one.limits is not None:
            critical, feeds = one.limits.highest, axis.demand.feeds
            margin = min((margin_of(one.limits, feed) for feed in feeds), default=None)
            # Where no feed judders that it rests is what it is for.
            hunts = hunting_of(axis) if self._points else None
            robustness = self._series.robustness(axis)
        return Found(
            AxisMeasure(
                ids=tuple(measure.id for measure in one.taken),
                name=" + ".join(measure.name for measure in one.taken),
                effort=EFFORTS[one.effort],
                enough=one.enough,
                changes=tuple(_changes(self._axis, axis, one.taken)),
                critical_feed=critical,
                margin=margin,
                robustness=robustness,
                hunts=hunts.jump if hunts else None,
                needs=tuple(measure.needs for measure in one.taken if measure.needs),
                costs=tuple(measure.costs for measure in one.taken),
                idle=tuple(measure.idle for measure in one.taken),
                sources=tuple(dict.fromkeys(m.source for each in one.taken for m in each.moves)),
            ),
            axis,
        )


def hunting_of(axis: Axis) -> Hunting | None:
    """Return the cycle about a target; None where an axis comes to rest, or on a rigid drive."""
    if axis.drive is None or axis.F_s == 0.0:
        return None
    found = hunting(axis)
    return None if found is None or found.dead_band <= axis.drive.dead_band else found


def _rank(found: Found) -> tuple[int, int, float]:
    """Return the rank: by effort, one before two, by clean machines; of equals the order stays."""
    one, stands = found.measure, found.measure.robustness
    clean = stands.clean / stands.machines if stands else 0.0
    return EFFORTS.index(one.effort), len(one.ids), -min(clean, _SURE)


def _changes(before: Axis, after: Axis, taken: Sequence[Measure]) -> Iterator[Change]:
    """Yield the numbers that measures change, by the keys of the axis file."""
    for path in dict.fromkeys(move.key for measure in taken for move in measure.moves):
        if before.turns and before.friction.in_newtons:
            path = path.replace(".mu_", ".F_")
        now, then, key = number_of(before, path), number_of(after, path), KEYS[path]
        if isinstance(now, tuple):
            now, then = min(now), min(then)
        if now != then:
            name = path.replace(".F_", ".T_") if before.turns else path
            yield Change(name, key.units[0] if key.units else "", now, then)
