"""A series of machines in pictures, and a page that asks for nothing outside itself."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from stickslip_fmu.release import VERSION
from stickslip_units import EXACT, number
from stickslip_verification.report.files import environment, text_of
from stickslip_verification.report.svg import BLUE, GREY, INK, ORANGE, STYLE

from ..points.columns import Floats, Regime
from ..report.page import drawn, plain
from . import words
from .statistics import interval
from .study import Scatter
from .words import feed, name_of

_COLOURS: Final = (BLUE, ORANGE, "#009e73")
_LINES: Final[Any] = ("-", (0, (5, 2)), (0, (1, 1.5)))
"""Colour and line of a feed: Okabe and Ito's blue, vermillion and green, and told apart in grey."""
_BAND: Final = 0.22
"""Opacity of a band of confidence."""
_LOOKS: Final = 240
"""Feeds or sizes of the sample at which a curve is drawn."""
_FIRST: Final = 10
"""Size of the sample at which convergence begins to be drawn."""
_FEW_DECADES: Final = 300.0
"""Ratio of the ends of a logarithmic axis up to which 2 and 5 are labelled too."""
_MICRO: Final = 1e6
_MM: Final = 1e3

Draw = Callable[[Axes, Scatter], bool]


def draw_probability(on: Axes, found: Scatter) -> bool:
    """Draw the share of machines that jump over the feed [mm/s], with its band."""
    count = found.question.count
    limits = found.columns["critical_feed"].astype(np.float64)
    asked = np.array(found.question.feeds)
    if _ends_at_limit(found, limits):
        within = limits[(limits > 0.0) & np.isfinite(limits)]
        ends = np.concatenate([asked, np.quantile(within, [0.001, 0.999])])
        looks = np.geomspace(ends.min() / 1.3, ends.max() * 1.3, _LOOKS)
        hits = count - np.searchsorted(np.sort(limits), looks, side="left").astype(np.float64)
        low, high = interval(hits, np.full(_LOOKS, float(count)))
        on.fill_between(_MM * looks, 100.0 * low, 100.0 * high, color=BLUE, alpha=_BAND, lw=0.0)
        on.plot(_MM * looks, 100.0 * hits / count, color=BLUE, lw=1.5)
        on.set_xlim(_MM * looks[0], _MM * looks[-1])
    for outcome in found.outcomes:
        value, low_end, high_end = (100.0 * each for each in outcome.jumps)
        on.errorbar(
            [_MM * outcome.feed], [value], yerr=[[value - low_end], [high_end - value]],
            color=INK, marker="o", ms=4.5, capsize=3.0, lw=1.2, zorder=3, clip_on=False,
        )  # fmt: skip
    _log_axis(on)
    on.set(ylim=(0.0, 100.0), title="How many jump")
    on.set(xlabel="feed  [mm/s]", ylabel="machines that jump  [%]")
    on.grid(visible=True)
    return True


def _ends_at_limit(found: Scatter, limits: Floats) -> bool:
    """Return whether each machine jumps at all feeds up to its critical one, and some at none.

    Under a friction that falls with the speed jumps may also end at slow feeds.
    """
    axis = found.question.population.file.axis()
    falls = axis.drive is None and axis.friction.law != "coulomb"
    ends = np.any((limits > 0.0) & np.isfinite(limits)) and not np.isnan(limits).any()
    return bool(ends) and not falls


def draw_jumps(on: Axes, found: Scatter) -> bool:
    """Draw median and 5 to 95 % of the jump [um] at each feed; False where none jumps."""
    shown = [each for each in found.outcomes if not math.isnan(each.jump[1])]
    for place, each in enumerate(shown):
        low, middle, high = (_MICRO * jump for jump in each.jump)
        on.plot([low, high], [place, place], color=BLUE, lw=2.2, marker="|", ms=9.0, mew=2.0)
        on.plot([middle], [place], "o", color=ORANGE, ms=6.0)
    on.set_yticks(range(len(shown)), [feed(each.feed) for each in shown])
    on.set_ylim(-0.6, max(len(shown), 1) - 0.4)
    on.set_xlim(left=0.0)
    words = "jump of those that jump: 5 %, median, 95 %  [µm]"
    on.set(xlabel=words, title="How far they jump")
    on.grid(visible=True, axis="x")
    return bool(shown)


def draw_convergence(on: Axes, found: Scatter) -> bool:
    """Draw the share of machines that jump over the size of the sample, with its band."""
    count = found.question.count
    open_ones = [n for n, each in enumerate(found.outcomes, 1) if 0.0 < each.jumps.value < 1.0]
    chosen = (open_ones or [1])[: len(_COLOURS)]
    sizes = np.unique(np.geomspace(min(_FIRST, count), count, _LOOKS).round().astype(np.int64))
    for place, colour, line in zip(chosen, _COLOURS, _LINES, strict=False):
        hits = np.cumsum(found.columns[f"regime {place}"] == Regime.STICKS)[sizes - 1].astype(
            np.float64
        )
        low, high = interval(hits, sizes.astype(np.float64))
        on.fill_between(sizes, 100.0 * low, 100.0 * high, color=colour, alpha=_BAND, lw=0.0)
        name = feed(found.question.feeds[place - 1])
        on.plot(sizes, 100.0 * hits / sizes, color=colour, ls=line, lw=1.4, label=name)
    _log_axis(on)
    on.set(xlabel="machines drawn", ylabel="machines that jump  [%]", title="Convergence")
    on.legend(loc="best", fontsize=8.5)
    on.grid(visible=True)
    return True


def draw_indices(on: Axes, found: Scatter) -> bool:
    """Draw the Sobol indices of the first result that has some; False where none has."""
    if not found.indices:
        return False
    result, each = next(iter(found.indices.items()))
    names = list(found.question.population.varied)
    order = np.argsort(each.total)
    places = np.arange(len(names), dtype=np.float64)
    for values, ends, shift, colour, name in (
        (each.total, each.total_range, 0.2, BLUE, "total"),
        (each.first, each.first_range, -0.2, "#a9d3ea", "alone"),
    ):
        on.barh(places + shift, values[order], 0.38, color=colour, label=name)
        on.hlines(places + shift, ends[order, 0], ends[order, 1], color=INK, lw=1.2)
    on.set_yticks(places, [names[place] for place in order])
    on.set_xlim(left=min(0.0, float(each.first_range.min())))
    on.axvline(0.0, color=GREY, lw=0.7)
    scatters = f"What the {name_of(found, result)} scatters with"
    on.set(xlabel="part of the variance", title=scatters)
    on.legend(loc="lower right", fontsize=8.5)
    on.grid(visible=True, axis="x")
    return True


PICTURES: Final[dict[str, Draw]] = {
    "probability": draw_probability,
    "jumps": draw_jumps,
    "convergence": draw_convergence,
    "indices": draw_indices,
}
"""The pictures by name."""


def picture(found: Scatter, names: Sequence[str] = tuple(PICTURES)) -> Figure | None:
    """Return one picture, or four on a page; None where there is nothing to draw."""
    side = math.isqrt(len(names))
    with mpl.rc_context(STYLE | {"axes.titlelocation": "left"}):
        page = Figure(figsize=(5.2 * side, 3.4 * side), layout="constrained")
        for place, name in enumerate(names, 1):
            on = page.add_subplot(side, side, place)
            on.set_axisbelow(True)
            on.set_visible(PICTURES[name](on, found))
    return page if any(on.get_visible() for on in page.axes) else None


def _log_axis(on: Axes) -> None:
    """Make a logarithmic axis with plain numbers: 1, 2 and 5 of each decade, or 1 alone."""
    on.set_xscale("log")
    low, high = on.get_xlim()
    subs = (1.0, 2.0, 5.0) if high < _FEW_DECADES * low else (1.0,)
    on.xaxis.set_major_locator(LogLocator(subs=subs))
    on.xaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value, EXACT)))
    on.xaxis.set_minor_formatter(NullFormatter())


_HERE: Final = Path(__file__).parent
_STYLES: Final = _HERE.parent / "report" / "templates"


def html(found: Scatter) -> str:
    """Return the page; the same answer gives the same text."""
    asked = found.question
    pictures = [drawn(picture(found, [name]), name, f"Scatter: {name}") for name in PICTURES]
    return environment(_HERE / "templates").get_template("scatter.html.j2").render(
        name=asked.population.file.axis().name,
        sentences=list(words.sentences(found)),
        pictures=[*filter(None, pictures)],
        feeds=words.feeds(found),
        parts=words.parts(found),
        numbers=words.numbers(found),
        correlations=words.correlations(found),
        count=asked.count,
        seed=asked.population.seed,
        version=VERSION,
        digest=found.provenance["inputs_digest"],
        style=text_of("report.css", _STYLES),
    )  # fmt: skip


def data(found: Scatter) -> dict[str, Any]:
    """Return the answer without the machines as what JSON knows; SI."""
    asked = found.question
    return {
        "about": "How likely an axis jumps where its numbers vary; SI units",
        "sentences": list(words.sentences(found)),
        "samples": asked.count,
        "feeds": plain(found.outcomes),
        "clamped": found.clamped,
        "sobol": {
            "numbers": list(asked.population.varied),
            "results": plain(found.indices),
        },
        "solved": plain(found.solved),
        "varied": plain(asked.population.varied),
        **found.provenance,
    }
