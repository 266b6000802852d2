"""The pictures of what a record tells: the record with its fit, and friction over the speed."""

from __future__ import annotations

from typing import Final

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from stickslip_units import scale_for, scale_of
from stickslip_verification.report.svg import BLUE, GREY, INK, ORANGE, STYLE

from ..report.plots import LETTERS, NARROW, WIDE
from .model import Identified

_FILL: Final = 0.2
"""How strong the colours of segments are."""
_GAP: Final = 5.0
"""Steps of time that are longer than so many others are gaps."""


def courses(found: Identified) -> Figure:
    """Draw each trace of the record with segments marked, the fit over it, and what is left."""
    rows = len(found.traces)
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(WIDE, 1.2 + 1.4 * rows), layout="constrained")
        heights = [3.0, 1.2] * rows
        panels = page.subplots(2 * rows, 1, sharex=True, squeeze=False, height_ratios=heights)
        for trace, (main, rest) in zip(found.traces, panels.reshape(rows, 2), strict=True):
            left, steps = trace.measured - trace.fitted, np.diff(trace.t, append=trace.t[-1])
            # A line ends where samples are left out.
            t = np.where(steps > _GAP * np.median(steps), np.nan, trace.t)
            scale, fine = (
                scale_for(float(np.nanmax(np.abs(part), initial=0.0)), trace.unit)
                for part in (trace.measured, left)
            )
            main.plot(t, trace.measured / scale.size, color=GREY, lw=1.6, label="measured")
            main.plot(t, trace.fitted / scale.size, color=BLUE, lw=0.9, label="fit")
            rest.plot(t, left / fine.size, color=ORANGE, lw=0.7)
            main.set(ylabel=scale.label(f"{trace.name} "), xlim=(trace.t[0], trace.t[-1]))
            rest.set_ylabel(fine.label("residual\n"))
        names = {
            name: n for n, name in enumerate(dict.fromkeys(part[2] for part in found.segments))
        }
        colours = mpl.colormaps["rainbow"](np.linspace(0.0, 1.0, len(names)), alpha=_FILL)
        for on in panels.flat:
            for begin, end, name in found.segments:
                on.axvspan(begin, end, color=colours[names[name]], lw=0.0, zorder=0, label=name)
        page.align_ylabels()
        panels.flat[-1].set_xlabel("time  [s]", loc="right", labelpad=1.0)
        handles, labels = panels.flat[0].get_legend_handles_labels()
        looks = dict(zip(labels, handles, strict=True))
        page.legend(
            looks.values(),
            looks,
            loc="outside upper left",
            ncols=5,
            fontsize=LETTERS,
            handlelength=1.4,
        )
    return page


def friction(found: Identified) -> Figure | None:
    """Draw friction over the speed with its band, and the law that explains it best."""
    curve, slow = found.curve, scale_of("m/s")
    if curve is None:
        return None
    scale = scale_for(float(np.nanmax(np.abs(curve.force))), "N")
    force, band, fitted = (x / scale.size for x in (curve.force, curve.band, curve.fitted))
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(NARROW, 1.9), layout="constrained")
        on = page.subplots()
        for side, label in ((curve.speed < 0.0, None), (curve.speed > 0.0, "best law")):
            u, F, half = curve.speed[side] / slow.size, force[side], band[side]
            on.fill_between(u, F - half, F + half, color="#b9d6e8", lw=0.0)
            on.plot(u, F, "o", color=INK, ms=2.2, label=label and "measured, 95 %")
            on.plot(u, fitted[side], color=BLUE, lw=1.2, label=label)
        on.axhline(0.0, color=GREY, lw=0.6)
        on.set_xlabel(slow.label("speed "), loc="right", labelpad=1.0)
        on.set_ylabel(scale.label("friction "))
        on.legend(loc="upper left", fontsize=LETTERS, handlelength=1.4, borderaxespad=0.2)
    return page
