"""The parts of a verdict in words: what page and terminal show, each as a grid of texts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, Final, Literal, NamedTuple

from stickslip_units import EXACT, NONE, decibels, number, per_minute, scale_of, shown_in, told

from ..axis import Axis, Filter
from ..axis.keys import KEYS
from ..loop.stability import Cut
from ..measures.catalogue import catalogue
from ..verdict import AxisCure, AxisMeasure, Change, Robustness, Verdict, ranges_in_words

Tone = Literal["good", "warn", "bad"]
Motion = Literal["jumps", "both", "swings", "even"]

MOTIONS: Final[dict[Motion, str]] = {
    "jumps": "moves in jumps",
    "both": "jumps or even, by its start",
    "swings": "swings without a stop",
    "even": "moves evenly",
}
CUTS: Final[dict[Cut, str]] = {"force": "at the motor's force", "position": "at the position error"}
"""Where a loop is open, in words."""
FIRST: Final = 5
"""Measures on the first page, those of least effort."""


class Standing(NamedTuple):
    """The verdict in a few words, and how good it is."""

    word: str
    tone: Tone


class Range(NamedTuple):
    """Feeds between two limits [m/s] and the motion that exists there."""

    low: float
    high: float
    motion: Motion


class Grid(NamedTuple):
    """A table of texts; the first cell of a row names it, columns of `numbers` stand right."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: frozenset[int] = frozenset()

    def of(self, *places: int) -> Grid:
        """Return some of its columns, by their places; -1: the last one."""
        rows = [[row[place] for place in places] for row in self.rows]
        numbers = frozenset(n for n, place in enumerate(places) if place in self.numbers)
        return Grid([self.head[place] for place in places], rows, numbers)


def standing(verdict: Verdict) -> Standing:
    """Return the verdict in a few words; an unstable loop comes before anything else."""
    if not verdict.stable:
        return Standing("unstable", "bad")
    jumping = [point for point in verdict.points if point.jumps]
    if any(point.judders and not point.jumps for point in verdict.points):
        return Standing("judders" if jumping else "swings", "bad")
    if jumping and all(point.after_start is False for point in jumping):
        return Standing("depends on the start", "warn")
    if jumping:
        allowed = verdict.axis.demand.largest_jump or 0.0
        if all(point.jump is not None and point.jump <= allowed for point in jumping):
            return Standing("jumps within the limit", "warn")
        return Standing("judders", "bad")
    if not verdict.points and verdict.critical_feed > 0.0:
        low = math.isfinite(verdict.critical_feed)
        return Standing("jumps at low feed", "warn") if low else Standing("judders", "bad")
    if not verdict.points and verdict.unstable:
        return Standing("swings at some feeds", "warn")
    if verdict.hunting is not None:
        return Standing("hunts at a target", "warn")
    return Standing("clean", "good")


def motions(verdict: Verdict) -> tuple[Range, ...]:
    """Return where over the feed which motion exists; empty where the loop is unstable."""
    if not verdict.stable or math.isnan(verdict.critical_feed):
        return ()
    start = math.inf if verdict.from_rest is None else verdict.from_rest
    ends = {0.0, math.inf, start}
    ends |= {end for each in (*verdict.cycle, *verdict.unstable) for end in (each.low, each.high)}
    found: list[Range] = []
    for low, high in pairwise(sorted(ends)):
        inside = 0.5 * (low + high) if high < math.inf else 2.0 * low + 1.0
        motion: Motion = "even"
        if any(inside in each for each in verdict.cycle):
            motion = "jumps" if low < start else "both"
        elif any(inside in each for each in verdict.unstable):
            motion = "swings"
        if found and found[-1].motion == motion:
            low = found.pop().low
        found.append(Range(low, high, motion))
    return tuple(found)


def critical(verdict: Verdict) -> str:
    """Return the critical feed in words, with its range where it has one."""
    limit, unstable = verdict.critical_feed, verdict.unstable
    if not verdict.stable or math.isnan(limit):
        return "none: the loop is unstable"
    swings = f"; even motion is unstable {ranges_in_words(unstable)}" if unstable else ""
    if limit == 0.0:
        return f"none: the axis never jumps{swings}"
    if math.isinf(limit):
        return "none: the axis jumps at every feed"
    text = f"{told(limit, 'm/s')} ({told(limit, 'm/min')})"
    if len(verdict.cycle) > 1 or any(each.low_end != "none" for each in verdict.cycle):
        text += f"; it jumps {ranges_in_words(verdict.cycle)}"
    text += swings
    low, high = verdict.critical_range
    if low < high:
        text += f"; {shown_in(low, 'm/s')} to {told(high, 'm/s')} within the ± of the file"
    return text


def margin(verdict: Verdict) -> str:
    """Return the least margin of the feeds in words; empty where no feed was asked for."""
    if not verdict.points:
        return ""
    least = min(verdict.points, key=lambda point: point.margin)
    which = "the slowest feed" if least is verdict.points[0] else "the feed"
    at = f"{told(least.feed, 'm/s', EXACT)} ({told(least.feed, 'm/min', EXACT)})"
    return f"{number(least.margin)} at {which}, {at}"


def robust(verdict: Verdict) -> str:
    """Return in how many machines the axis as it is is clean, and what varies; empty: no feeds."""
    found = verdict.robustness
    if found is None:
        return ""
    varied = ", ".join(
        f"{name} ± {100.0 * part:.2g} %{' assumed' * (name in verdict.varied_by_default)}"
        for name, part in verdict.varied.items()
    )
    count = f"{found.clean} of {found.machines} with {varied}"
    decides = f"; the {found.decides} decides most" if found.decides else ""
    return f"clean in {_clean_in(found)} of machines ({count}){decides}"


def _clean_in(found: Robustness | None) -> str:
    return NONE if found is None else f"{100 * found.clean // found.machines} %"


def change(moved: AxisCure | Change) -> str:
    """Return how a number changes: now → then."""
    if isinstance(moved.now, str) or isinstance(moved.then, str):
        return f"{moved.now} → {moved.then}"
    now = told(moved.now, moved.unit, EXACT)
    if moved.then is None:
        return f"now {now}; none found"
    value_then = float(f"{moved.then:.3g}") if isinstance(moved, Change) else moved.then
    then = told(value_then, moved.unit, EXACT)
    value, _, symbol = now.partition(" ")
    return f"{value if symbol == then.partition(' ')[2] else now} → {then}"


def operating_points(verdict: Verdict) -> Grid:
    """Return what the axis does at each feed, exact beside the familiar formulas."""
    return Grid(
        (
            scale_of("m/s").label("feed"), scale_of("m/min").label(), "margin",
            "what the axis does", scale_of("m").label("jump"), scale_of("m").label("familiar"),
            "frequency [1/s]", "familiar [1/s]",
            "settles in [s]", "damping [%]",
        ),
        [
            (
                shown_in(point.feed, "m/s", EXACT),
                per_minute(point.feed, EXACT),
                number(point.margin),
                point.regime.words,
                shown_in(point.jump, "m"),
                shown_in(point.simplified_jump, "m"),
                number(point.frequency),
                number(point.simplified_frequency),
                NONE if point.judders else number(point.regime.settling),
                number(100.0 * point.regime.damping),
            )
            for point in verdict.points
        ],
        frozenset({0, 1, 2, 4, 5, 6, 7, 8, 9}),
    )  # fmt: skip


def critical_feeds(verdict: Verdict) -> Grid:
    """Return the critical feed beside the simpler ways to it."""
    rigid = verdict.axis.drive is None
    first = "as it jumps, on a rigid drive" if rigid else "as it jumps, in its loop"
    found: list[tuple[str, float | None]] = [(first, verdict.critical_feed)]
    if not rigid:
        start = verdict.axis.demand.acceleration
        reached = "" if start is None else f", at {told(start, 'm/s2', EXACT)}"
        found += [
            (f"from rest{reached}", verdict.from_rest),
            ("quick estimate: rigid drive, damping of the loop", verdict.estimated_critical_feed),
            ("on a rigid drive", verdict.rigid_critical_feed),
        ]
    found.append(("familiar formula, rigid drive", verdict.simplified_critical_feed))
    return Grid(
        ("critical feed", *(scale_of(u).label() for u in ("m/s", "m/min")), "against the first"),
        [
            (
                name,
                "not stated" if value is None else shown_in(value, "m/s"),
                per_minute(value),
                _against(value, verdict.critical_feed) if place else "",
            )
            for place, (name, value) in enumerate(found)
        ],
        frozenset({1, 2, 3}),
    )


def _against(value: float | None, first: float) -> str:
    if value is None or not (0.0 < first < math.inf and math.isfinite(value)):
        return NONE
    return f"{100.0 * (value / first - 1.0):+.0f} %".replace("-", "\N{MINUS SIGN}")


def loop(verdict: Verdict) -> Grid:
    """Return how the loop swings and what gains it bears; without rows on a rigid drive."""
    rows: list[tuple[str, str]] = []
    for name, swing in (("sliding fast", verdict.sliding), ("stuck", verdict.stuck)):
        if swing is not None:
            swings = "does not swing"
            if math.isfinite(swing.damping) and swing.w > 0.0:
                damping = f"{number(100.0 * swing.damping)} %"
                swings = f"{told(swing.frequency, 'Hz')}, damping ratio {damping}"
            rows.append((f"least damped swing, table {name}", swings))
    drive, gains = verdict.axis.drive, verdict.gains
    if drive is not None and gains is not None:
        rows.append(("stable up to K_v, all else held", _borne(drive.K_v, gains.K_v, "1/s")))
        name = "stable up to a bandwidth, K_v and T_n times the bandwidth held"
        rows.append((name, _borne(drive.bandwidth, gains.bandwidth, "rad/s")))
    return Grid(("loop", ""), rows)


def _borne(now: float, limit: float, unit: str) -> str:
    if limit == 0.0:
        return f"no stable value found; now {told(now, unit, EXACT)}"
    if math.isinf(limit):
        return f"no limit found; now {told(now, unit, EXACT)}"
    apart = decibels(max(limit / now, now / limit)) if now > 0.0 else NONE
    side = "below" if now < limit else "above"
    return f"{told(limit, unit)}; now {told(now, unit, EXACT)}, {apart} dB {side}"


def margins(verdict: Verdict) -> Grid:
    """Return gain and phase margin of each open loop; an unstable one has none."""
    return Grid(
        ("open loop", "table", "gain margin [dB]", "phase margin [°]"),
        [
            (
                CUTS[each.cut],
                "sliding" if each.sliding else "stuck",
                decibels(each.gain_margin) if each.passes else NONE,
                shown_in(each.phase_margin, "rad") if each.passes else NONE,
            )
            for each in verdict.responses
            if verdict.stable
        ],
        frozenset({2, 3}),
    )


def hunting(verdict: Verdict) -> tuple[str, ...]:
    """Return in sentences what the axis does at a target that it holds."""
    if verdict.axis.drive is None:
        return ("A rigid drive has no loop that could hunt.",)
    if not verdict.stable:
        return ("Not asked: the loop is unstable.",)
    found = verdict.hunting
    if found is None:
        return ("It comes to rest: it does not hunt.",)
    said = [
        f"It hunts: it jumps {told(found.jump, 'm')} there and back again in "
        f"{told(found.period, 's')}.",
        f"The smallest dead band that ends it is {told(found.dead_band, 'm')}; the table may then "
        "rest that far from the target.",
    ]
    allowed = verdict.axis.demand.largest_error
    if allowed is not None:
        kept = "no more" if found.dead_band <= allowed else "more"
        said.append(f"That is {kept} than the {told(allowed, 'm', EXACT)} allowed at rest.")
    if verdict.presliding is None or verdict.presliding.refused:
        said.append(
            "Presliding, the elastic give of the contact before it breaks away, is left out; it "
            "can end the hunting (0.5 µm did in a computation apart)."
        )
    return tuple(said)


def measures(verdict: Verdict) -> Grid:
    """Return the measures that are enough, the least effort first; the last column in full."""
    return Grid(
        (
            "measure",
            "effort",
            "moves",
            "clean in",
            "margin",
            "at a target",
            "needs, costs, no help",
        ),
        [
            (
                one.name,
                one.effort,
                "; ".join(_moves(one)) or "the way to the feed",
                _clean_in(one.robustness),
                _margin(one),
                _at_target(verdict, one),
                " ".join(
                    (
                        *(f"Needs: {need}." for need in one.needs),
                        *(f"Costs: {cost}" for cost in one.costs),
                        *(f"No help: {idle}" for idle in one.idle),
                    )
                ),
            )
            for one in verdict.measures
            if one.enough
        ],
        frozenset({3, 4}),
    )


def _moves(one: AxisMeasure) -> Iterator[str]:
    names = [change.number for change in one.changes]
    for moved in one.changes:
        name = moved.number.partition(".")[2]
        # Coefficients say it, where both are moved.
        if not (name in ("F_s", "F_k") and f"friction.mu_{name[-1]}" in names):
            yield f"{name} {change(moved)}"


def _margin(one: AxisMeasure) -> str:
    jumps = one.margin is not None and one.margin < 1.0
    return number(one.margin) + (", allowed" if jumps else "")


def _at_target(verdict: Verdict, one: AxisMeasure) -> str:
    if verdict.axis.drive is None or one.effort == "program":
        return NONE
    return "rests" if one.hunts is None else f"hunts {told(one.hunts, 'm')}"


def helping(verdict: Verdict) -> tuple[str, ...]:
    """Return in sentences which measures are not enough alone, and which are left out and why."""
    some = [
        one.name + ("" if one.critical_feed is None else f" (to {told(one.critical_feed, 'm/s')})")
        for one in verdict.measures
        if not one.enough
    ]
    said = [f"Help, but not enough alone: {'; '.join(some)}."] if some else []
    said += [
        f"{reason.capitalize()}: {'; '.join(catalogue()[name].name for name in names)}."
        for reason, names in verdict.left_out.items()
    ]
    return tuple(said)


def others(verdict: Verdict) -> str:
    """Return how many measures are not among the first, by what they do; empty where none is."""
    enough = sum(one.enough for one in verdict.measures)
    counts = {
        "enough": enough - FIRST,
        "not enough alone": len(verdict.measures) - enough,
        "left out": sum(map(len, verdict.left_out.values())),
    }
    return ", ".join(f"{count} {words}" for words, count in counts.items() if count > 0)


def cures(verdict: Verdict) -> Grid:
    """Return how far each number would have to go alone, the smallest change first."""
    return Grid(
        ("one number", "number", "now → then", "factor", "aim", "held, and what else to know"),
        [
            (
                cure.name,
                cure.number,
                change(cure),
                NONE if math.isinf(cure.effort) else f"{number(cure.effort)} ×",
                cure.aim,
                "; ".join(filter(None, (cure.held and f"held: {cure.held}", cure.note))),
            )
            for cure in verdict.cures
        ],
        frozenset({3}),
    )


def assumed(verdict: Verdict) -> Grid:
    """Return what the file did not state, what was taken for it, and why."""
    found = verdict.axis.assumed + (verdict.presliding.assumed if verdict.presliding else ())
    return Grid(("not in the file", "taken", "why"), [tuple(each) for each in found])


def numbers(axis: Axis) -> Grid:
    """Return the numbers of an axis as its file names them, with their ±."""
    return Grid(("number", "value", "±"), list(_numbers(axis)))


def _numbers(axis: Axis) -> Iterator[tuple[str, str, str]]:
    spread = dict(axis.spread)
    for key in (key.of(axis.kind) for key in KEYS.values()):
        part = axis if key.section == "axis" else getattr(axis, key.section, None)
        value: Any = getattr(part, key.symbol, None) if key.symbol and key.units else None
        if value is None or isinstance(value, tuple):
            continue
        unit = KEYS[key.path].units[0]
        # The friction of a rotary table are torques; coefficients may stand for them.
        if not (axis.turns and key.section == "friction"):
            width = spread.pop(key.path, None)
            around = "" if width is None else told(width, unit, EXACT)
            yield key.path, told(value, unit, EXACT), around
        if key.symbol == "k" and axis.stiffest is not None:
            yield "stiffness at the stiffest position", told(axis.stiffest, unit, EXACT), ""
        if key.symbol == "c":
            zeta = 0.5 * axis.c / math.sqrt(axis.k * axis.m)
            yield "damping ratio, drive held fast", f"{number(100.0 * zeta)} %", ""
        if key.symbol == "mu_k":
            forces = f"{told(axis.F_s, 'N', EXACT)}, {told(axis.F_k, 'N', EXACT)}"
            what = "torque" if axis.turns else "force"
            yield f"break-away {what}, kinetic friction", forces, ""
    law = axis.friction.law
    own = ", ".join(f"{name} = {number(value, EXACT)}" for name, value in axis.friction.own.items())
    yield "friction law", f"{law} ({own}; SI)" if own else law, ""
    if axis.drive is None:
        yield "drive", "rigid", ""
    else:
        yield "position is measured", "on the table" if axis.drive.on_table else "on the motor", ""
        for of_force in axis.drive.filters:
            yield "filter of the motor's force", _filter(of_force), ""
    for name, width in spread.items():
        yield name, "", f"{number(width, EXACT)} (SI)"


def _filter(found: Filter) -> str:
    text = f"{found.kind}, {told(found.frequency, 'Hz', EXACT)}"
    if math.isfinite(found.damping):
        text += f", damping ratio {number(found.damping, EXACT)}"
    return text + (f", leaves {number(found.depth, EXACT)}" if found.kind == "notch" else "")
