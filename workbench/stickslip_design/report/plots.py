"""The pictures of a verdict: which motion exists at which feed, and the open loops."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from typing import Any, Final, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import (
    FixedLocator,
    FuncFormatter,
    MultipleLocator,
    NullFormatter,
    NullLocator,
)

from stickslip_units import EXACT, number, scale_of, shown_in
from stickslip_verification.report.svg import BLUE, INK, ORANGE, STYLE

from ..loop.stability import Cut, Response
from ..verdict import Verdict, in_its_units
from .tables import CUTS, MOTIONS, Motion, Range, motions

WIDE: Final = 7.0
NARROW: Final = 3.5
"""Widths of a picture on a page, and on a phone or of two side by side [in]."""

_FILLS: Final[dict[Motion, tuple[str, str]]] = {
    "jumps": (ORANGE, ""),
    "both": ("#f6d3b8", "////"),
    "swings": ("#e9c46a", "...."),
    "even": ("#a9d3ea", ""),
}
"""Colour and hatch of a motion: told apart with every colour vision, and in grey."""

_MS: Final = 1e3
"""A second in ms."""

LETTERS: Final = 8.5
_LETTER: Final = 0.58 * LETTERS
"""Size of a label and width of a letter of it [pt]."""
_PAPER: Final[Any] = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}
"""What a label stands on, so that no line crosses it."""
_LINE: Final = 12.0
_BAR: Final = 18.0
_MARGIN: Final = 8.0
"""Height of a line of labels and of the bar, and what is left free at the sides [pt]."""

_MOTION: Final = 150.0
"""Height of the picture of a motion over time [pt]."""
_SETTLED: Final = slice(-200, None)
"""Points of a record whose mean is its zero, the last ones."""
_TITLE: Final = 46
"""Letters in a line above it."""
_ROOM: Final = 1.08
"""Part of the largest value that its scale has."""

_HEIGHT, _PANEL = 240.0, 92.0
_LEFT, _BOTTOM = 48.0, 34.0
"""Height of the picture of an open loop and of each panel, room for the labels [pt]."""

_LEAST_GAIN, _MOST_GAIN = -60.0, 80.0
"""Gains beyond these are not drawn [dB]."""
_LEAST_PHASE: Final = -540.0
"""Phases below this are not drawn [degrees]."""
_FREE: Final = 0.1
"""What is left free beyond a line at least, in steps of the limits."""
_LOOKS: Final = {True: (BLUE, "-", "table sliding"), False: (ORANGE, (0, (5, 2)), "table stuck")}
"""Colour, line and name of an open loop, by whether the table slides."""


@in_its_units
def feeds(verdict: Verdict, width: float = WIDE) -> Figure | None:
    """Draw over the feed where the axis jumps, where it depends on the start, where it is even.

    A bar over the feed [mm/s; of a rotary table °/s], `width` [in]: above it the feeds that were
    asked for, below it the limits. None where the loop is unstable, or there is neither a feed nor
    a limit to draw.
    """
    found, size = motions(verdict), scale_of("m/s").size
    asked = [point.feed / size for point in verdict.points]
    named = (("critical", verdict.critical_feed), ("even from rest above", verdict.from_rest))
    limits = [
        (value / size, f"{name} {shown_in(value, 'm/s')}")
        for name, value in named
        if value is not None and 0.0 < value < math.inf
    ]
    spread = [each / size for each in verdict.critical_range if 0.0 < each < math.inf]
    spread = spread if len(spread) == 2 and spread[0] < spread[1] else []
    places = [*asked, *(at for at, _ in limits), *spread]
    if not found or not places:
        return None
    low, high = min(places) / 2.5, max(places) * 2.5
    inner = 72.0 * width - 2.0 * _MARGIN
    rows = _rows(asked, low, inner / math.log(high / low))
    above = _LINE * (1 + max(rows, default=-1)) + 6.0
    below = _LINE * len(limits) + 6.0
    handles = _handles(found, spread=bool(spread))
    columns = 4 if width > 5.0 else 1
    head = _LINE * math.ceil(len(handles) / columns) + 8.0
    middle = above + _BAR + below
    height = head + middle + 32.0
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(width, height / 72.0))
        on = page.add_axes(
            (_MARGIN / (72.0 * width), 32.0 / height, inner / (72.0 * width), middle / height)
        )
        on.set_ylim(-below, _BAR + above)
        _feed_axis(on, low, high)
        for feeds_of in found:
            begin, end = max(feeds_of.low / size, low), min(feeds_of.high / size, high)
            if end > begin:
                on.fill_between([begin, end], 0.0, _BAR, **_look(feeds_of.motion))
        if spread:
            on.plot(spread, [0.5 * _BAR] * 2, color="white", lw=4.0, solid_capstyle="butt")
            on.plot(spread, [0.5 * _BAR] * 2, color=INK, lw=1.4, marker="|", ms=9.0, mew=1.4)
        for at, row in zip(asked, rows, strict=True):
            top = _BAR + 3.0 + _LINE * row
            on.plot([at, at], [0.0, top], color=INK, lw=1.2, solid_capstyle="butt")
            on.text(
                at, top, number(at, EXACT), ha="center", va="bottom", fontsize=LETTERS, bbox=_PAPER
            )
        for row, (at, name) in enumerate(limits):
            _limit(on, at, name, -_LINE * (row + 1), row == 0, inner)
        page.legend(
            handles=handles, loc="upper left", bbox_to_anchor=(0.0, 1.0), ncols=columns,
            fontsize=LETTERS, handlelength=1.6, columnspacing=1.4, labelspacing=0.3,
            borderaxespad=0.2,
        )  # fmt: skip
    return page


@in_its_units
def motion(verdict: Verdict, which: Literal["before", "after"]) -> Figure | None:
    """Draw x - v t after a break-away at the slowest feed that judders: as it is, or cured.

    How far the table is ahead of an even motion [um; °] over the time [ms]; both pictures have the
    same scales. None where nothing judders, or no measure is enough.
    """
    scale = scale_of("m")
    records = {"before": verdict.before, "after": verdict.after}
    ways = {
        name: (_MS * record.time, (record.ahead - record.ahead[_SETTLED].mean()) / scale.size)
        for name, record in records.items()
        if record is not None and np.isfinite(record.ahead).all()
    }
    if which not in ways:
        return None
    time, ahead = ways[which]
    measure = verdict.best if which == "after" else None
    name = f"with {measure.name}" if measure else "as it is"
    most = _ROOM * max(float(np.abs(way).max()) for _, way in ways.values())
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(NARROW, _MOTION / 72.0))
        left, right = (_LEFT + 12.0) / (72.0 * NARROW), _MARGIN / (72.0 * NARROW)
        low, high = _BOTTOM / _MOTION, (2.0 * _LINE + 4.0) / _MOTION
        on = page.add_axes(
            (left, low, 1.0 - left - right, 1.0 - low - high),
            xlim=(0.0, float(time[-1])), ylim=(-most, most), ylabel=scale.label("x − v t "),
        )  # fmt: skip
        on.axhline(0.0, color=INK, lw=0.8)
        on.plot(time, ahead, color=ORANGE if which == "before" else BLUE, lw=1.5)
        on.set_xlabel("time  [ms]", loc="right", labelpad=1.0)
        on.set_title(textwrap.fill(name, _TITLE), loc="left", fontsize=LETTERS, linespacing=1.1)
    return page


def responses(verdict: Verdict, cut: Cut, width: float = NARROW) -> Figure | None:
    """Draw the open loops of one cut over the frequency, the table sliding and stuck.

    Gain [dB] and phase [degrees] over the frequency [Hz], with a ring where each margin of a stable
    loop is read. None where there is no such loop.
    """
    found = [each for each in verdict.responses if each.cut == cut and each.passes]
    if not found:
        return None
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(width, _HEIGHT / 72.0))
        # Fixed: a layout that measures every label takes ten times as long to draw.
        inner = 1.0 - (_LEFT + _MARGIN) / (72.0 * width)
        upper, lower = (
            page.add_axes((_LEFT / (72.0 * width), bottom / _HEIGHT, inner, _PANEL / _HEIGHT))
            for bottom in (_BOTTOM + _PANEL + _MARGIN, _BOTTOM)
        )
        upper.tick_params(labelbottom=False)
        for each in found:
            _draw(upper, lower, each, rings=verdict.stable)
        for on, line in ((upper, 0.0), (lower, -180.0)):
            on.axhline(line, color=INK, lw=0.8, zorder=1.5)
            on.grid(visible=True)
            on.set_axisbelow(True)
        upper.set_ylim(*_limits(upper, _LEAST_GAIN, _MOST_GAIN, 20.0))
        lower.set_ylim(*_limits(lower, _LEAST_PHASE, 90.0, 90.0))
        upper.yaxis.set_major_locator(MultipleLocator(40.0))
        lowest, highest = lower.get_ylim()
        lower.yaxis.set_major_locator(MultipleLocator(90.0 if highest - lowest < 400.0 else 180.0))
        for on in (upper, lower):
            on.set_xscale("log")
            on.set_xlim(found[0].frequency[0], found[0].frequency[-1])
            on.xaxis.set_minor_locator(NullLocator())
            on.xaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value, EXACT)))
        upper.set_ylabel("gain  [dB]")
        lower.set_ylabel("phase  [°]")
        lower.set_xlabel("frequency  [Hz]")
        upper.set_title(f"Open {CUTS[cut]}", loc="left", fontsize=9.0)
        for on in (upper, lower):
            on.yaxis.set_label_coords(-(_LEFT - 10.0) / (72.0 * width * inner), 0.5)
        lower.legend(loc="lower left", fontsize=LETTERS, handlelength=2.2, borderaxespad=0.2)
    return page


def _rows(places: Sequence[float], low: float, scale: float) -> list[int]:
    """Return for each label of a feed the lowest line in which it covers none before it.

    `scale` is the way [pt] in which the feed grows e times.
    """
    ends: list[float] = []
    rows = []
    for each in places:
        middle, half = scale * math.log(each / low), 0.5 * _LETTER * (len(number(each, EXACT)) + 1)
        row = next((n for n, end in enumerate(ends) if end <= middle - half), len(ends))
        ends[row : row + 1] = [middle + half]
        rows.append(row)
    return rows


def _limit(on: Axes, at: float, name: str, bottom: float, right: bool, inner: float) -> None:
    """Draw a limit down to its name, which stands on its right or left, as there is room."""
    low, high = on.get_xlim()
    share, needed = math.log(at / low) / math.log(high / low), _LETTER * len(name) / inner
    right = share + needed < 1.0 if right else share < needed
    on.plot([at, at], [_BAR, bottom], color=INK, lw=1.0, ls=(0, (2, 1.5)))
    on.annotate(
        name, (at, bottom), xytext=(3.0 if right else -3.0, 0.0), textcoords="offset points",
        ha="left" if right else "right", va="bottom", fontsize=LETTERS,
        bbox=_PAPER,
    )  # fmt: skip


def _look(motion: Motion) -> dict[str, Any]:
    colour, hatch = _FILLS[motion]
    return {"facecolor": colour, "hatch": hatch, "edgecolor": ORANGE, "linewidth": 0.0}


def _handles(found: Sequence[Range], *, spread: bool) -> list[Patch | Line2D]:
    shown: list[Patch | Line2D] = [
        Patch(label=MOTIONS[each.motion], **_look(each.motion)) for each in found
    ]
    if spread:
        look: Any = {"color": INK, "lw": 1.4, "marker": "|", "ms": 7.0, "mew": 1.4}
        shown.append(Line2D([], [], label="critical within ±", **look))
    return shown


def _feed_axis(on: Axes, low: float, high: float) -> None:
    on.set_xscale("log")
    on.set_xlim(low, high)
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    factors = (1, 2, 5) if len(decades) <= 4 else (1,)
    ticks = [factor * 10.0**power for power in decades for factor in factors]
    on.xaxis.set_major_locator(FixedLocator([each for each in ticks if low <= each <= high]))
    on.xaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value, EXACT)))
    on.xaxis.set_minor_formatter(NullFormatter())
    on.set_yticks([])
    on.spines["left"].set_visible(False)
    on.set_xlabel(scale_of("m/s").label("feed "), loc="right", labelpad=1.0)


def _draw(upper: Axes, lower: Axes, found: Response, *, rings: bool) -> None:
    colour, line, name = _LOOKS[found.sliding]
    gain = 20.0 * np.log10(np.maximum(np.abs(found.gain), 1e-300))
    phase = np.degrees(np.unwrap(np.angle(found.gain)))
    # A loop with two integrals and a spring begins near -270 degrees, not at +90.
    phase -= 360.0 * math.ceil((phase[0] - 45.0) / 360.0)
    upper.plot(found.frequency, gain, color=colour, ls=line, lw=1.5, label=name)
    lower.plot(found.frequency, phase, color=colour, ls=line, lw=1.5, label=name)
    if not rings:
        return
    for on, values, margin, at in (
        (upper, gain, found.gain_margin, found.gain_margin_at),
        (lower, phase, found.phase_margin, found.phase_margin_at),
    ):
        if math.isnan(at):
            continue
        height = -20.0 * math.log10(margin)
        if on is lower:
            height = math.degrees(margin) - 180.0
            drawn = float(np.interp(at, found.frequency, values))
            height += 360.0 * round((drawn - height) / 360.0)
        on.plot([at], [height], "o", ms=4.5, mfc="white", mec=colour, mew=1.3, zorder=4)


def _limits(on: Axes, least: float, most: float, step: float) -> tuple[float, float]:
    """Return limits around the lines, rounded to steps, within `least` and `most`."""
    seen = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in on.lines])
    low = step * math.floor(seen.min() / step - _FREE)
    high = step * math.ceil(seen.max() / step + _FREE)
    return max(low, least), min(high, most)
