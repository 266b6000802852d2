"""The pictures of the how-to and of a run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from stickslip_design.axis import Axis
from stickslip_design.loop.jumps import jump_at, limit_of_jumps
from stickslip_verification.report.svg import BASE

from .runs import Array, Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Told apart by the colour-blind too: M. Okabe and K. Ito, Color Universal Design, 2008.
BLUE: Final = "#0072b2"
ORANGE: Final = "#d55e00"
GREY: Final = "#8d939c"
INK: Final = "#2b2f36"
_SHADE: Final = "#edf0f4"

_STYLE: Final[Any] = BASE | {
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.labelsize": 9.0,
    "axes.linewidth": 0.8,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 9.0,
    "figure.facecolor": "white",
    "font.size": 9.0,
    "legend.frameon": False,
    "lines.linewidth": 1.5,
    "text.color": INK,
    "xtick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.color": GREY,
    "ytick.labelcolor": INK,
}


def styled() -> Any:
    """Return the context in which the figures here are made and saved."""
    import matplotlib

    return matplotlib.rc_context(_STYLE)


def creeping(run: Run, feed: float, F_s: float, start: float, length: float) -> Figure:
    """Draw an axis at constant feed: position against command, speed, spring force."""
    page, (where, fast, force) = _page(5.6, (4, 3, 3))
    part = _window(run, start, start + length)
    t = (part["time"] - start) * 1e3
    away = part["x_command"][0]
    _shade((where, fast, force), part["x"], t)
    where.plot(t, (part["x_command"] - away) * 1e6, color=GREY, label="command")
    where.plot(t, (part["x"] - away) * 1e6, color=BLUE, label="table")
    where.set_ylabel("position [µm]")
    _legend(where)
    fast.plot(t, part["x_dot"] * 1e3, color=BLUE)
    fast.axhline(feed * 1e3, color=GREY, lw=1.0)
    fast.set_ylabel("speed [mm/s]")
    _force(force, t, part["F"], F_s, (1,))
    force.set_xlabel("time [ms]")
    force.set_xlim(0.0, length * 1e3)
    return page


def holding(run: Run, F_s: float, start: float, length: float) -> Figure:
    """Draw an axis that holds its target: position of table and motor, spring force."""
    page, (where, force) = _page(4.6, (4, 3))
    part = _window(run, start, start + length)
    t = part["time"] - start
    target = part["x_command"][-1]
    _shade((where, force), part["x"], t)
    where.axhline(0.0, color=GREY, lw=1.0)
    where.plot(t, (part["x_motor"] - target) * 1e6, color=ORANGE, label="motor")
    where.plot(t, (part["x"] - target) * 1e6, color=BLUE, label="table")
    where.set_ylabel("distance from target [µm]")
    _legend(where)
    _force(force, t, part["F"], F_s, (-1, 1))
    force.set_xlabel("time [s]")
    force.set_xlim(0.0, length)
    return page


def rising(feeds: Array, found: Array, axis: Axis) -> Figure:
    """Draw jumps [m] of a run whose feed rises slowly over the feed [m/s], and the computed."""
    page, (panel,) = _page(3.0, (1,))
    limit = limit_of_jumps(axis)
    of_tool = limit.feed * np.linspace(0.07, 1.0, 40)
    cycles = [*(jump_at(axis, float(each)) for each in of_tool[:-1]), limit.jump]
    jumps = [each.way * 1e6 if each else np.nan for each in cycles]
    panel.plot(of_tool * 1e3, jumps, color=ORANGE, label="design tool")
    found = found * 1e6
    panel.plot(feeds * 1e3, found, "o", ms=4.5, color=BLUE, label="co-simulation")
    panel.legend(loc="lower right")
    panel.set_xlim(0.0, 1.3e3 * limit.feed)
    panel.set_ylim(0.0, 1.15 * float(found.max()))
    panel.set_xlabel("feed [mm/s]")
    panel.set_ylabel("jump [µm]")
    return page


def _page(height: float, heights: tuple[int, ...]) -> tuple[Figure, list[Axes]]:
    from matplotlib.figure import Figure

    page = Figure(figsize=(7.0, height), layout="constrained")
    panels = page.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)
    page.align_ylabels()
    return page, panels.ravel().tolist()


def _window(run: Run, start: float, end: float) -> Mapping[str, Array]:
    rounding = 1e-9
    inside = (run["time"] >= start - rounding) & (run["time"] <= end + rounding)
    return {name: column[inside] for name, column in run.items()}


def _shade(panels: Iterable[Axes], x: Array, t: Array) -> None:
    """Shade where the table sticks: where it does not move by a single bit."""
    rests = np.diff(x, append=x[-1]) == 0.0
    edges = np.flatnonzero(np.diff(np.concatenate(([False], rests, [False]))))
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        for panel in panels:
            last = float(t[min(end, len(t) - 1)])
            panel.axvspan(float(t[begin]), last, color=_SHADE, lw=0, zorder=0)


def _force(panel: Axes, t: Array, F: Array, F_s: float, signs: tuple[int, ...]) -> None:
    panel.plot(t, F, color=ORANGE)
    for sign in signs:
        panel.axhline(sign * F_s, color=INK, lw=1.0, ls=(0, (5, 3)))
    panel.annotate("break-away force", (0.0, F_s), xycoords=("axes fraction", "data"),
                   xytext=(4, 3), textcoords="offset points", va="bottom")  # fmt: skip
    low = min(0.0, float(F.min()), *(sign * F_s for sign in signs))
    panel.set_ylim(1.1 * low, 1.32 * F_s)
    panel.set_ylabel("spring force [N]")


def _legend(panel: Axes) -> None:
    from matplotlib.patches import Patch

    handles, _ = panel.get_legend_handles_labels()
    handles.append(Patch(color=_SHADE, label="table sticks"))
    panel.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4,
                 borderaxespad=0.2)  # fmt: skip
