"""What a record tells, in words and in pictures; and what the axis then does."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

from stickslip_units import EXACT, told
from stickslip_verification.report.svg import BLUE, GREY, ORANGE, STYLE

from ..axis import AxisError, AxisFile
from ..report.plots import LETTERS, NARROW, WIDE
from ..report.tables import Grid
from ..study import design
from ..verdict import feed_in_words, judder
from .model import Identified, Trace


def numbers(found: Identified) -> Grid:
    """Return the numbers with their intervals."""
    rows = []
    for one in found.numbers:
        cells = (told(value, one.unit, EXACT) for value in (one.value, one.low, one.high))
        width = f"{100.0 * one.width:.2g} %" if one.identified else "not identified"
        rows.append((one.name, one.meaning, *cells, width))
    head = ("number", "what it is", "value", "from", "to", "±")
    return Grid(head, rows, frozenset({2, 3, 4, 5}))


def explains(found: Identified) -> str:
    """Return whether the model explains the record, and what the fit leaves of it."""
    if found.faults:
        return f"The model does not explain the record: {'; '.join(found.faults)}."
    noise = told(found.noise, found.traces[-1].unit)
    return f"The model explains the record: it leaves noise of {noise}."


def sentence(file: AxisFile) -> str:
    """Return in a sentence what the axis of a file does, and what ends that; or what is missing.

    Shares are of 64 machines within the ± of the file, each value in it as likely as another. Of
    the measures it is the one that ends it most surely, and of those the one of least effort.
    """
    try:
        verdict = design(file)
    except AxisError as error:
        return f"These numbers are not enough for a verdict: {error.key} {error.reason}."
    worst, robustness = judder(verdict.points), verdict.robustness
    if robustness is None or not verdict.stable:
        return verdict.sentence
    even = 100 * robustness.clean // robustness.machines
    if worst is None:
        return f"With these numbers {even} % of machines within their ± move evenly at the feeds."
    ends = [(0, "no measure of the catalogue ends that")]
    for one in verdict.measures:
        if one.effort != "program" and one.robustness:
            share = 100 * one.robustness.clean // one.robustness.machines
            ends.append((share, f"{one.name} ({one.effort}) ends that in {share} %"))
    others = " or another of its feeds" * (len(verdict.points) > 1)
    return (
        f"With these numbers the axis {'jumps' if worst.jumps else 'swings'} at "
        f"{feed_in_words(worst.feed)}{others} in {100 - even} % of machines within their ±; "
        f"{max(ends, key=lambda end: end[0])[1]}."
    )


def picture(traces: Sequence[Trace], segments: Sequence[tuple[float, float, str]] = ()) -> Figure:
    """Draw measured values, the fit over them and what it leaves; segments of time are marked.

    A trace with a band is friction over the speed.
    """
    rows, names = len(traces), list(dict.fromkeys(name for _, _, name in segments))
    tones = mpl.colormaps["rainbow"](np.linspace(0.0, 1.0, len(names)), alpha=0.2)
    over = traces[0].band.size > 0
    with mpl.rc_context(STYLE):
        size = (NARROW, 1.9) if over else (WIDE, 1.2 + 1.4 * rows)
        page = Figure(figsize=size, layout="constrained")
        panels = page.subplots(2 * rows, sharex=True, height_ratios=[3.0, 1.2] * rows)
        for trace, main, rest in zip(traces, panels[::2], panels[1::2], strict=True):
            # A line ends where the direction changes, and where four samples or more are left out.
            steps = np.diff(np.sign(trace.at) if over else trace.at)
            cuts = 1 + np.flatnonzero(steps > 5.0 * np.median(steps))
            columns = (trace.at, trace.measured, trace.fitted, trace.band)[: 4 if over else 3]
            x, y, fitted, *bands = (np.insert(column, cuts, np.nan) for column in columns)
            main.plot(x, y, "o" if over else "-", color=GREY, ms=2.2, lw=1.6, label="measured")
            main.plot(x, fitted, color=BLUE, lw=0.9, label="fit")
            rest.plot(x, y - fitted, color=ORANGE, lw=0.7)
            name, ends = ("friction", None) if over else (trace.name, (trace.at[0], trace.at[-1]))
            for on, label, line in ((main, name, y), (rest, "residual", y - fitted)):
                on.set(ylabel=label, xlim=ends)
                on.yaxis.set_major_formatter(EngFormatter(trace.unit))
                for band in bands:
                    on.fill_between(x, line - band, line + band, color="#b9d6e8", label="95 %")
        for on in panels:
            for begin, end, name in segments:
                on.axvspan(begin, end, color=tones[names.index(name)], lw=0.0, label=name)
        page.align_ylabels()
        panels[-1].xaxis.set_major_formatter(EngFormatter("m/s" if over else "s"))
        panels[-1].locator_params(axis="x", nbins=4 if over else 10)
        looks = dict(zip(*panels[0].get_legend_handles_labels()[::-1], strict=True))
        page.legend(looks.values(), looks, loc="outside upper left", ncols=4, fontsize=LETTERS)
    return page
