"""A run as a picture: the mass beside the pulled end, the spring force with its break-away line.

The line goes through the run's samples and events. Between two points it is the cubic with the
slopes that the outputs give, so a slip is smooth; a stick is the straight line it is, and the
corners stay corners.
"""

import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from scipy.interpolate import CubicHermiteSpline

from stickslip.files import check_drawable, write
from stickslip.runs import Floats, Run
from stickslip_ref import Interval
from stickslip_units import Scale, scale_for

_BLUE: Final = "#1b6ca8"
_GREY: Final = "#8d939c"
_ORANGE: Final = "#e2761b"
_SHADE: Final = "#edf0f4"
_INK: Final = "#2b2f36"
_ALARM: Final = "#b3261e"
_STYLE: Final[Any] = {
    "font.size": 10,
    "axes.edgecolor": _GREY,
    "axes.labelcolor": _INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": _INK,
    "xtick.color": _INK,
    "ytick.color": _INK,
    "legend.frameon": False,
    # A simplified path draws a creeping stick; this path is drawn as it is.
    "path.simplify": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "stickslip",
    "pdf.fonttype": 42,
}

_MOST_MARKED_EVENTS: Final = 100

_VISIBLE: Final = 0.005
"""Part of a panel's height that an eye tells from nothing: about the width of a line."""

_POINTS_PER_STEP: Final = 8

_LONGEST_SMOOTH_STEP: Final = 2.0
"""Radians of the free oscillation in a step above which a cubic would invent a motion."""


class Curve(NamedTuple):
    """The motion drawn: arrays of one shape (n,), SI."""

    t: Floats
    x: Floats
    x_pull: Floats
    F: Floats


def curve(run: Run) -> Curve:
    """Return the curve through samples and events, which is exactly flat in stick.

    Of a run with hidden events it is the samples alone: all that is known of it.
    """
    samples = run.samples
    if run.hidden_events:
        return Curve(*(samples[name] for name in ("time", "x", "x_pull", "F")))
    k, v = run.parameters.k, run.parameters.v
    at_events = np.array([event.time for event in run.events])
    times = np.concatenate([samples["time"], at_events])
    # An event at the time of a sample stands for both.
    t, chosen = np.unique(times[::-1], return_index=True)
    chosen = len(times) - 1 - chosen
    is_event = chosen >= len(samples)
    x = np.concatenate([samples["x"], [event.x for event in run.events]])[chosen]
    x_dot = np.concatenate([samples["x_dot"], np.zeros(len(run.events))])[chosen]

    h = np.diff(t)
    part = np.arange(_POINTS_PER_STEP) / _POINTS_PER_STEP
    t_drawn = np.append((t[:-1, None] + h[:, None] * part).ravel(), t[-1])
    # From event to event a cubic is the best guess at any step; elsewhere a coarse step is drawn
    # straight.
    smooth = h * math.sqrt(k / run.parameters.m) < _LONGEST_SMOOTH_STEP
    smooth |= is_event[:-1] & is_event[1:]
    x_drawn = np.interp(t_drawn, t, x)
    curved = np.append(np.repeat(smooth, _POINTS_PER_STEP), False)
    x_drawn[curved] = CubicHermiteSpline(t, x, x_dot)(t_drawn[curved])
    x_pull = float(samples["x_pull"][0]) + v * (t_drawn - float(samples["time"][0]))
    return Curve(t_drawn, x_drawn, x_pull, k * (x_pull - x_drawn))


def stick_phases(run: Run) -> list[tuple[float, float]]:
    """Return beginning and end [s] of every stick that the events of the run show.

    Where the law has none those of samples that show one.
    """
    if not run.parameters.sticks:
        shown = np.concatenate(([False], run.samples["sticking"], [False]))
        edges = np.flatnonzero(np.diff(shown.astype(int)))
        times = run.samples["time"][np.minimum(edges, len(run.samples) - 1)].tolist()
        return list(zip(times[::2], times[1::2], strict=True))
    begin = float(run.samples["time"][0]) if run.samples["mode"][0] == 0 else None
    phases = []
    for event in run.events:
        if event.kind == "break-away" and begin is not None:
            phases.append((begin, event.time))
            begin = None
        elif event.kind == "re-stick":
            begin = event.time
    if begin is not None and run.last["mode"] == 0:
        phases.append((begin, float(run.last["time"])))
    return phases


def write_plot(run: Run, target: Path, option: str = "file") -> None:
    """Draw `run` into `target`, which `option` named, whole or not at all; its suffix says how.

    `CommandError` if that is none of PNG, SVG and PDF, or the file cannot be written.
    """
    check_drawable(target, option)
    write_figure(figure(run), target, option)


def write_figure(page: Figure, target: Path, option: str = "file") -> None:
    """Write a picture as `write_plot` does."""
    check_drawable(target, option)
    suffix = target.suffix.lower().removeprefix(".")
    # The file says what was run, not when: the same run gives the same bytes.
    metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(suffix)
    picture = io.BytesIO()
    with mpl.rc_context(_STYLE):
        page.savefig(picture, format=suffix, dpi=160, metadata=metadata)
    write(target, picture.getvalue(), option)


@mpl.rc_context(_STYLE)
def figure(run: Run) -> Figure:
    """Draw `run`: position above, spring force below, stick phases shaded, events marked.

    A run with hidden events is drawn as its samples only: what lies between them is not known.
    """
    page = Figure(figsize=(10.0, 6.4), layout="constrained")
    drawn = curve(run)
    start, stop = float(run.samples["time"][0]), float(run.last["time"])
    time = scale_for(max(abs(start), abs(stop)), "s", 0.1)
    upper, lower = page.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    for panel in (upper, lower):
        for begin, end in () if run.hidden_events else stick_phases(run):
            panel.axvspan(begin / time.size, end / time.size, color=_SHADE, lw=0, zorder=0)
    _draw_motion(upper, run, drawn, time)
    _draw_force(lower, run, drawn, time)
    lower.set_xlim(start / time.size, stop / time.size)
    lower.set_xlabel(f"time  [{time.symbol}]")
    page.suptitle(_title(run), x=0.012, ha="left", fontsize=11)
    page.align_ylabels()
    return page


@mpl.rc_context(_STYLE)
def bars(
    rows: Mapping[str, Sequence[Interval]],
    between: tuple[float, float],
    of: str = "pulling velocity",
) -> Figure:
    """Draw intervals of the pulling velocity [m/s], a row each, in the range searched."""
    page = Figure(figsize=(10.0, 2.4), layout="constrained")
    panel = page.add_subplot()
    highest = [each.high for row in rows.values() for each in row if each.high < np.inf]
    # A closed form answers for all velocities.
    most = between[1] if between[1] < np.inf else 1.5 * max(highest, default=1.0)
    scale = scale_for(most, "m/s")
    low, high = between[0] / scale.size, most / scale.size
    for row, intervals in enumerate(rows.values()):
        for each in intervals:
            begin = max(each.low / scale.size, low)
            panel.barh(row, min(each.high / scale.size, high) - begin, 0.5, begin, color=_BLUE)
    panel.set(xlim=(low, high), ylim=(len(rows) - 0.5, -0.5), yticks=range(len(rows)))
    panel.set_yticklabels(rows)
    panel.set_xlabel(f"{of}  [{scale.symbol}]")
    return page


@mpl.rc_context(_STYLE)
def panels(time: Floats, columns: Mapping[str, Floats | None], title: str) -> Figure:
    """Draw columns [SI] over time [s], a panel each."""
    drawn = {name: column for name, column in columns.items() if column is not None}
    page = Figure(figsize=(10.0, 3.2 * len(drawn)), layout="constrained")
    axes = page.subplots(len(drawn), 1, sharex=True, squeeze=False)[:, 0]
    for panel, (name, column) in zip(axes, drawn.items(), strict=True):
        scale = scale_for(float(np.max(np.abs(column))), "m" if name == "x" else "N")
        panel.plot(time, column / scale.size, color=_BLUE)
        panel.set_ylabel(f"{name}  [{scale.symbol}]")
    axes[-1].set_xlabel("time  [s]")
    page.suptitle(title, x=0.012, ha="left", fontsize=11)
    return page


def _draw_motion(panel: Axes, run: Run, drawn: Curve, time: Scale) -> None:
    length = scale_for(float(np.max(np.abs([drawn.x, drawn.x_pull]))), "m", 2.0)
    t, pulled = drawn.t / time.size, drawn.x_pull / length.size
    look = _look(run, 1.2, 1.6)
    panel.plot(t, pulled, color=_GREY, label=r"pulled end $x_\mathrm{pull}$", **look)
    panel.plot(t, drawn.x / length.size, color=_BLUE, label="mass $x$", **_look(run, 1.8))
    _mark(panel, run, time, [event.x / length.size for event in run.events], _BLUE)
    panel.set_ylabel(f"position  [{length.symbol}]")
    handles, _ = panel.get_legend_handles_labels()
    if run.hidden_events:
        note = "more events than samples: points only, choose a shorter interval"
        panel.set_title(note, loc="right", fontsize=10, color=_ALARM, weight="bold")
    else:
        handles.append(Patch(color=_SHADE, label="stick"))
    panel.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=6, borderpad=0)


def _draw_force(panel: Axes, run: Run, drawn: Curve, time: Scale) -> None:
    lines = _break_away_lines(run)
    low = min(0.0, *drawn.F, *lines.values())
    high = max(0.0, *drawn.F, *lines.values())
    force = scale_for(max(high, -low), "N")
    panel.plot(drawn.t / time.size, drawn.F / force.size, color=_ORANGE, **_look(run, 1.8))
    for line in lines.values():
        panel.axhline(line / force.size, color=_INK, lw=1.0, ls=(0, (5, 3)), zorder=1.5)
    k = run.parameters.k
    _mark(panel, run, time, [k * event.z / force.size for event in run.events], _ORANGE)
    panel.set_ylabel(f"spring force $F$  [{force.symbol}]")
    height = (high - low) or 1.0
    # Head room on the sides where a line carries its name.
    above = 0.28 if 1 in lines else 0.05
    below = 0.28 if -1 in lines else 0.05
    panel.set_ylim((low - below * height) / force.size, (high + above * height) / force.size)
    for sign, line in lines.items():
        overshoot = 0.0 if run.hidden_events else _overshoot(run, drawn, sign)
        at = f"{_signed(line / force.size)} {force.symbol}"
        note = f"break-away force {_line_name(run, sign)} = {at}"
        if overshoot > _VISIBLE * height:
            note += (
                f";  $F$ passes it by {overshoot / force.size:.2g} {force.symbol}: "
                "the pulled end still moves while the mass starts"
            )
        panel.annotate(
            note,
            (0.0, (high if sign > 0 else low) / force.size),
            xycoords=("axes fraction", "data"),
            xytext=(6, 6 * sign),
            textcoords="offset points",
            va="bottom" if sign > 0 else "top",
            fontsize=9,
        )


def _break_away_lines(run: Run) -> dict[int, float]:
    """Return the spring force [N] of break-away for each direction in which this run slips."""
    F_s, F_ext = float(run.last["F_s"]), run.parameters.F_ext
    modes = {event.mode for event in run.events} | set(run.samples["mode"].tolist())
    signs = modes - {0} or {-1 if run.parameters.v < 0.0 else 1}
    return {sign: sign * F_s - F_ext for sign in sorted(signs)}


def _line_name(run: Run, sign: int) -> str:
    external = r" - F_\mathrm{ext}" if run.parameters.F_ext else ""
    return f"${'-' if sign < 0 else ''}F_s{external}$"


def _overshoot(run: Run, drawn: Curve, sign: int) -> float:
    """Return how far F rises above its value at a break-away in the slip that follows [N]."""
    ends = [event.time for event in run.events[1:]] + [float(drawn.t[-1])]
    furthest = 0.0
    for event, end in zip(run.events, ends, strict=False):
        if event.kind == "break-away" and event.mode == sign:
            slip = drawn.F[(drawn.t >= event.time) & (drawn.t <= end)]
            furthest = max(furthest, *(sign * (slip - run.parameters.k * event.z)))
    return furthest


def _mark(panel: Axes, run: Run, time: Scale, heights: list[float], color: str) -> None:
    if run.hidden_events or len(run.events) > _MOST_MARKED_EVENTS:
        return
    size = 26.0 if len(run.events) <= 30 else 12.0
    look: Any = {"edgecolor": color, "linewidth": 1.2, "zorder": 3, "clip_on": False}
    for kind, face in (("break-away", color), ("re-stick", "white"), ("reversal", _INK)):
        chosen = [n for n, event in enumerate(run.events) if event.kind == kind]
        if chosen:
            times = [run.events[n].time / time.size for n in chosen]
            marked = [heights[n] for n in chosen]
            panel.scatter(times, marked, size, facecolor=face, label=kind, **look)


def _look(run: Run, width: float, factor: float = 1.0) -> dict[str, Any]:
    """Return the look of a line, or of points where events are hidden: smaller where many are."""
    if not run.hidden_events:
        return {"lw": width}
    size = 4.0 if len(run.samples) <= 300 else 1.5
    return {"ls": "none", "marker": "o", "ms": factor * size, "mew": 0.0}


def _title(run: Run) -> str:
    p = run.parameters
    stiffness = scale_for(p.k, "N/m")
    speed = scale_for(abs(p.v), "m/s")
    words = [
        f"$m$ = {_signed(p.m)} kg",
        f"$k$ = {_signed(p.k / stiffness.size)} {stiffness.symbol}",
        f"$v$ = {_signed(p.v / speed.size)} {speed.symbol}",
    ]
    if "mu_k_used" in (run.samples.dtype.names or ()):
        words += [f"$\\mu_s$ = {_signed(p.mu_s)}"]
        words += [f"$\\mu_k$ = {_signed(float(run.last['mu_k_used']))}"]
    words += [f"$c$ = {_signed(p.c)} N·s/m"] if p.c else []
    words += [f"load = {_signed(p.load)} N"] if p.load else []
    words += [f"$F_\\mathrm{{ext}}$ = {_signed(p.F_ext)} N"] if p.F_ext else []
    return f"Stick-slip ({run.engine}):  " + ",  ".join(words)


def _signed(value: float) -> str:
    """Write a number with four digits and the minus sign that the axes have."""
    return f"{value:.4g}".replace("-", "\N{MINUS SIGN}")
