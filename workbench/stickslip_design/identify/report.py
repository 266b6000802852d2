"""What a record tells, in words and in pictures; and what the axis then does."""

from __future__ import annotations

from typing import Final

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

from stickslip_units import scale_for, scale_of, told
from stickslip_verification.report.svg import BLUE, GREY, INK, ORANGE, STYLE

from ..axis import AxisError, AxisFile
from ..report.plots import LETTERS, NARROW, WIDE
from ..report.tables import Grid
from ..study import design
from ..verdict import feed_in_words, judder
from .axis_text import shown
from .model import Identified

_GAP: Final = 5.0
"""Steps of time that are longer than so many others are gaps."""


def numbers(found: Identified) -> Grid:
    """Return the numbers with their intervals."""
    rows = []
    for one in found.numbers:
        half = 0.5 * (one.high - one.low)
        cells = shown(one.unit, half, one.value, one.low, one.high)
        value, low, high, unit = (cell.replace("-", "−").replace("inf", "∞") for cell in cells)
        width = f"{100.0 * one.width:.2g} %" if one.identified else "not identified"
        rows.append((one.name, one.meaning, f"{value} {unit}".strip(), low, high, width))
    head = ("number", "what it is", "value", "from", "to", "±")
    return Grid(head, rows, frozenset({2, 3, 4, 5}))


def explains(found: Identified) -> str:
    """Return whether the model explains the record, and what the fit leaves of it."""
    if found.faults:
        return f"The model does not explain the record: {'; '.join(found.faults)}."
    lag, correlation = found.correlation
    memory = f"its correlation is {correlation:.2f} at {told(lag, 's')}" if lag else "white"
    noise = scale_for(found.noise, found.traces[-1].unit).told(found.noise)
    return f"The model explains the record: it leaves noise of {noise}, {memory}."


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
    does, share = "moves evenly at its feeds", 100 * robustness.clean // robustness.machines
    if worst is not None:
        others = " or another of its feeds" * (len(verdict.points) > 1)
        does = f"{'jumps' if worst.jumps else 'swings'} at {feed_in_words(worst.feed)}{others}"
        share = 100 - share
    said = f"With these numbers the axis {does} in {share} % of machines within their ±"
    enough = [
        (100 * found.clean // found.machines, f"{one.name} ({one.effort}) ends that in")
        for one in verdict.measures
        if one.effort != "program" and (found := one.robustness)
    ]
    if worst is None or not enough:
        return f"{said}{'; no measure of the catalogue ends that' * (worst is not None)}."
    share, name = max(enough, key=lambda one: one[0])
    return f"{said}; {name} {share} %."


def courses(found: Identified) -> Figure:
    """Draw each trace of the record with segments marked, the fit over it, and what is left."""
    rows, names = len(found.traces), list(dict.fromkeys(name for _, _, name in found.segments))
    tones = mpl.colormaps["rainbow"](np.linspace(0.0, 1.0, len(names)), alpha=0.2)
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(WIDE, 1.2 + 1.4 * rows), layout="constrained")
        panels = page.subplots(2 * rows, sharex=True, height_ratios=[3.0, 1.2] * rows)
        for trace, main, rest in zip(found.traces, panels[::2], panels[1::2], strict=True):
            # A line ends where samples are left out.
            steps = np.diff(trace.at, append=trace.at[-1])
            t = np.where(steps > _GAP * np.median(steps), np.nan, trace.at)
            main.plot(t, trace.measured, color=GREY, lw=1.6, label="measured")
            main.plot(t, trace.fitted, color=BLUE, lw=0.9, label="fit")
            rest.plot(t, trace.measured - trace.fitted, color=ORANGE, lw=0.7)
            main.set(ylabel=trace.name, xlim=(trace.at[0], trace.at[-1]))
            rest.set(ylabel="residual")
            for on in (main, rest):
                on.yaxis.set_major_formatter(EngFormatter(trace.unit))
        for on in panels:
            for begin, end, name in found.segments:
                tone = tones[names.index(name)]
                on.axvspan(begin, end, color=tone, lw=0.0, zorder=0, label=name)
        page.align_ylabels()
        panels[-1].set_xlabel("time  [s]", loc="right", labelpad=1.0)
        looks = dict(zip(*panels[0].get_legend_handles_labels()[::-1], strict=True))
        page.legend(looks.values(), looks, loc="outside upper left", ncols=5, fontsize=LETTERS)
    return page


def friction(found: Identified) -> Figure | None:
    """Draw friction over the speed with its band, and the law that explains it best."""
    curve, slow = found.friction, scale_of("m/s")
    if curve is None:
        return None
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(NARROW, 1.9), layout="constrained")
        on = page.subplots()
        # No line goes from one direction to the other.
        between = np.searchsorted(curve.at, 0.0)
        columns = (curve.at / slow.size, curve.measured, curve.band, curve.fitted)
        u, F, half, fitted = (np.insert(column, between, np.nan) for column in columns)
        on.fill_between(u, F - half, F + half, color="#b9d6e8", lw=0.0)
        on.plot(u, F, "o", color=INK, ms=2.2, label="measured, 95 %")
        on.plot(u, fitted, color=BLUE, lw=1.2, label="best law")
        on.axhline(0.0, color=GREY, lw=0.6)
        on.set_xlabel(slow.label("speed "), loc="right", labelpad=1.0)
        on.set_ylabel("friction")
        on.yaxis.set_major_formatter(EngFormatter("N"))
        on.legend(loc="upper left", fontsize=LETTERS, handlelength=1.4)
    return page
