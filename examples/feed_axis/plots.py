"""The pictures of the how-to."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from stickslip_design.loop.jumps import jump_at, limit_of_jumps
from stickslip_verification.report.svg import BASE

from .axis import Axis
from .coupling import Run
from .designed import designed

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Told apart by the colour-blind too: M. Okabe and K. Ito, Color Universal Design, 2008.
BLUE: Final = "#0072b2"
ORANGE: Final = "#d55e00"
GREEN: Final = "#009e73"
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

_WIDTH: Final = 7.0

Array = NDArray[np.float64]


def styled() -> Any:
    """Return the context in which the figures here are made and saved."""
    import matplotlib

    return matplotlib.rc_context(_STYLE)


def creeping(run: Run, axis: Axis, start: float, length: float) -> Figure:
    """Draw an axis at constant feed: position against command, speed, spring force."""
    page, panels = _stacked(3, (4, 3, 3), 5.6)
    part = _window(run, start, start + length)
    t = (part["time"] - start) * 1e3
    away = part["x_command"][0]
    where, fast, force = panels
    _shade(panels, part, start, 1e3)
    where.plot(t, (part["x_command"] - away) * 1e6, color=GREY, label="command")
    where.plot(t, (part["x"] - away) * 1e6, color=BLUE, label="table")
    where.set_ylabel("position [µm]")
    _legend(where)
    fast.plot(t, part["x_dot"] * 1e3, color=BLUE)
    fast.axhline(axis.feed * 1e3, color=GREY, lw=1.0)
    fast.set_ylabel("speed [mm/s]")
    _force(force, t, part["F"], axis, (1,))
    force.set_xlabel("time [ms]")
    force.set_xlim(0.0, length * 1e3)
    return page


def holding(run: Run, axis: Axis, start: float, length: float) -> Figure:
    """Draw an axis that holds its target: position of table and motor, spring force."""
    page, (where, force) = _stacked(2, (4, 3), 4.6)
    part = _window(run, start, start + length)
    t = part["time"] - start
    target = part["x_command"][-1]
    _shade((where, force), part, start, 1.0)
    where.axhline(0.0, color=GREY, lw=1.0)
    where.plot(t, (part["x_motor"] - target) * 1e6, color=ORANGE, label="motor")
    where.plot(t, (part["x"] - target) * 1e6, color=BLUE, label="table")
    where.set_ylabel("distance from target [µm]")
    _legend(where)
    _force(force, t, part["F"], axis, (-1, 1))
    force.set_xlabel("time [s]")
    force.set_xlim(0.0, length)
    return page


def small_multiples(
    runs: Mapping[str, Run], start: float | None, length: float, unit: tuple[float, str]
) -> Figure:
    """Draw what the table is off its command by, one panel a variant, all to the same scale.

    Parameters
    ----------
    runs
        Runs by the names of their variants.
    start, length
        What to show of each [s]; where start is None, its end.
    unit
        Size [s] and symbol of the unit of time.
    """
    from matplotlib.figure import Figure

    columns = 3
    rows = -(-len(runs) // columns)
    page = Figure(figsize=(_WIDTH, 1.55 * rows + 0.3), layout="constrained")
    panels = page.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for panel, (name, run) in zip(panels.ravel(), runs.items(), strict=False):
        begin = float(run["time"][-1]) - length if start is None else start
        part = _window(run, begin, begin + length)
        t = (part["time"] - begin) / unit[0]
        panel.axhline(0.0, color=GREY, lw=0.8)
        panel.plot(t, (part["x"] - part["x_command"]) * 1e6, color=BLUE)
        panel.set_title(name.replace("µ_s", "$\\mu_s$").replace("K_v", "$K_v$"))
        panel.set_xlim(0.0, length / unit[0])
    for panel in panels.ravel()[len(runs) :]:
        panel.set_visible(False)
    page.supxlabel(f"time [{unit[1]}]", fontsize=9.0, color=INK)
    page.supylabel("table less command [µm]", fontsize=9.0, color=INK)
    return page


def convergence(
    steps: Sequence[float], errors: Mapping[str, Sequence[float]], jump: float
) -> Figure:
    """Draw the largest error of the table's position over the communication step.

    Parameters
    ----------
    steps
        Communication steps [s].
    errors
        Errors [m] at these steps, by the way of coupling.
    jump
        A jump [m], for scale.
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    page = Figure(figsize=(_WIDTH, 3.4), layout="constrained")
    panel = page.subplots()
    x = np.array(steps) * 1e6
    for (name, values), colour in zip(errors.items(), (BLUE, ORANGE, GREEN), strict=False):
        y = np.array(values) * 1e6
        panel.loglog(x, y, color=colour, marker="o", ms=4.5, label=name)
    panel.axhline(jump * 1e6, color=INK, lw=1.0, ls=(0, (5, 3)))
    panel.annotate("one jump", (x[-1], jump * 1e6), va="bottom", xytext=(0, 3),
                   textcoords="offset points")  # fmt: skip
    panel.xaxis.set_major_locator(FixedLocator(x.tolist()))
    panel.xaxis.set_minor_locator(NullLocator())
    panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    panel.set_xlabel("communication step [µs]")
    panel.set_ylabel("largest error of the table [µm]")
    panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return page


def rising(run: Run, axis: Axis) -> Figure:
    """Draw the jumps of a run whose feed rises slowly, over the feed."""
    from matplotlib.figure import Figure

    page = Figure(figsize=(_WIDTH, 3.0), layout="constrained")
    panel = page.subplots()
    ends = np.flatnonzero(np.diff(run["delta_x"])) + 1
    feed = np.gradient(run["x_command"], run["time"])[ends] * 1e3
    computed = designed(axis)
    limit = limit_of_jumps(computed)
    feeds = limit.feed * np.linspace(0.07, 1.0, 40)
    cycles = [*(jump_at(computed, float(each)) for each in feeds[:-1]), limit.jump]
    jumps = [each.way * 1e6 if each else np.nan for each in cycles]
    panel.plot(feeds * 1e3, jumps, color=ORANGE, label="design tool")
    found = run["delta_x"][ends] * 1e6
    panel.plot(feed, found, ls="none", marker="o", ms=4.5, color=BLUE, label="co-simulation")
    panel.legend(loc="lower right")
    panel.set_xlim(0.0, 1.3e3 * limit.feed)
    panel.set_ylim(0.0, 1.15 * float(found.max()))
    panel.set_xlabel("feed [mm/s]")
    panel.set_ylabel("jump [µm]")
    return page


def _stacked(
    count: int, heights: tuple[int, ...], height: float
) -> tuple[Figure, tuple[Axes, ...]]:
    from matplotlib.figure import Figure

    page = Figure(figsize=(_WIDTH, height), layout="constrained")
    panels = tuple(page.subplots(count, 1, sharex=True, height_ratios=heights))
    page.align_ylabels()
    return page, panels


def _window(run: Run, start: float, end: float) -> dict[str, Array]:
    rounding = 1e-9
    inside = (run["time"] >= start - rounding) & (run["time"] <= end + rounding)
    return {name: column[inside] for name, column in run.items()}


def _shade(panels: Iterable[Axes], part: Mapping[str, Array], start: float, scale: float) -> None:
    """Shade where the table sticks: where it does not move by a single bit."""
    rests = np.diff(part["x"], append=part["x"][-1]) == 0.0
    edges = np.flatnonzero(np.diff(np.concatenate(([False], rests, [False]))))
    t = (part["time"] - start) * scale
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        for panel in panels:
            last = t[min(end, len(t) - 1)]
            panel.axvspan(float(t[begin]), float(last), color=_SHADE, lw=0, zorder=0)


def _force(panel: Axes, t: Array, F: Array, axis: Axis, signs: tuple[int, ...]) -> None:
    panel.plot(t, F, color=ORANGE)
    F_s = axis.F_s
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
