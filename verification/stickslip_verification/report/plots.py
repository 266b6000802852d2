"""The pictures of the report as SVG: the motion of a case, and an observed order."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator
from numpy.typing import NDArray

from ..model.verdict import (
    SEQUENCE,
    CheckResult,
    Measure,
    Motion,
    ObservedOrder,
    Run,
    Series,
    Verdict,
)
from .svg import BLUE, GREY, INK, ORANGE, SOFT, STYLE, as_part

PIECES = 400
"""Straight pieces over the whole time that a slip is drawn with: about one per point of width."""
SAME_TIME = 1e-12  # part of the run's length within which an event is at a communication point
FAITHFUL = 0.015
"""Part of the plotted range by which a cubic may miss the motion: about the width of the line."""
UNEVEN = 10.0  # ratio of two neighbouring gaps above which the shorter tells nothing of the longer
AT_ONCE = 0.005  # part of the run's length below which a slip is drawn as a jump


@dataclass(frozen=True)
class Curve:
    """What is drawn of a motion: time [s], positions [m] and spring force [N], ``(n,)`` each.

    ``joined`` tells whether lines may join the points: it is False where more happens between two
    samples than they can tell.
    """

    t: Series
    x: Series
    x_pull: Series
    F: Series
    joined: bool


def curve(motion: Motion) -> Curve:
    """Return the line through samples and events of the exact motion, straight in stick.

    In slip it is the cubic through positions and velocities. The pulled end moves straight between
    two samples. Where the samples are too coarse, it is the samples alone.
    """
    exact = motion.exact
    at = {name: np.append(exact.initial[name], exact.outputs[name]) for name in exact.initial}
    times, x, x_pull, F, z = np.append(0.0, exact.times), at["x"], at["x_pull"], at["F"], at["z"]
    near = SAME_TIME * times[-1]
    events = [each for each in motion.events if np.min(np.abs(times - each.time)) > near]
    t, order = np.unique([*times, *(each.time for each in events)], return_index=True)
    places, speeds = [*x, *(each.x for each in events)], [*at["x_dot"], *np.zeros(len(events))]
    nodes = np.array((t, np.array(places)[order], np.array(speeds)[order]))
    slips = np.any(nodes[2:, 1:] != 0.0, axis=0) | np.any(nodes[1:, :-1] != nodes[1:, 1:], axis=0)
    if not _faithful(nodes, slips, np.ptp(z)):
        return Curve(times, x, x_pull, F, joined=False)
    pieces = np.where(slips, np.maximum(2, np.round(PIECES * np.diff(t) / t[-1])), 1).astype(int)
    left, right = (np.repeat(each, pieces + 1, axis=1) for each in (nodes[:, :-1], nodes[:, 1:]))
    gaps = zip(t, t[1:], pieces + 1, strict=False)
    drawn = np.concatenate([np.linspace(*each) for each in gaps])
    line, pull = _cubic(left, right, drawn), np.interp(drawn, times, x_pull)
    # The stiffness up to a sample; where the spring is slack, that of the next one.
    taut = np.flatnonzero(z)
    next_taut = np.searchsorted(taut, np.searchsorted(times, right[0])).clip(max=taut.size - 1)
    k = (F[taut] / z[taut])[next_taut] if taut.size else 0.0
    return Curve(drawn, line, pull, k * (pull - line), joined=True)


def _cubic(left: Series, right: Series, t: Series) -> Series:
    """Return x at times on the cubics between nodes: rows of time, position and velocity."""
    gap = right[0] - left[0]
    s = (t - left[0]) / gap
    rise = s * s * (3.0 - 2.0 * s)
    bent = gap * s * (1.0 - s) * ((1.0 - s) * left[2] - s * right[2])
    return np.asarray((1.0 - rise) * left[1] + rise * right[1] + bent)


def _faithful(nodes: Series, slips: NDArray[np.bool_], swing: float) -> bool:
    """Tell whether the cubics are the motion.

    The error of a cubic at s h of a gap h goes with ``(s (1 - s))^2 h^4``. A cubic over two gaps
    that leaves out the node between them shows it there, and so what it is within one gap.
    """
    gaps = np.diff(nodes[0])
    if not gaps.size:
        return False
    before, middle, after = nodes[:, :-2], nodes[:, 1:-1], nodes[:, 2:]
    missed = np.abs(_cubic(before, after, middle[0]) - middle[1])
    long, short = (choose(gaps[:-1], gaps[1:]) for choose in (np.maximum, np.minimum))
    inner = slips[:-1] & slips[1:] & (middle[2] != 0.0) & (long < UNEVEN * short)
    seen = 16.0 * (gaps[:-1] * gaps[1:]) ** 2 * FAITHFUL * min(float(np.ptp(nodes[1])), swing)
    # A slip without a sample inside shows where it ends, not how it goes.
    jumps = slips & (nodes[2, :-1] == 0.0) & (nodes[2, 1:] == 0.0)
    known = not np.any(jumps & (gaps > AT_ONCE * nodes[0, -1]))
    return known and not np.any(inner & (missed * long**4 > seen))


SIDES: Final = (("fmu", "FMU", BLUE, "o", 4.0), ("reference", "reference", ORANGE, "x", 3.4))

MARKS: Final = 40  # markers of a side in a panel: more hide the line that they lie on
NOTHING: Final = 1e-18
"""Where an error of exactly 0 is drawn: below half a rounding of the scale, 1.1e-16."""
TOLERANCES_APART: Final = 30.0
"""Ratio of two tolerances from which their lines have room for a name each."""
HOPELESS: Final = 1e6  # the largest error, as part of the scale, that the panel makes room for
FARTHEST: Final = 3
SIZE: Final = (480.0, 412.0)  # width and height of the picture of a case [pt]

_DASHED: Final = (0, (5, 3))
_PREFIXES: Final = ((1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"))


def draw_cases(verdict: Verdict) -> dict[str, str]:
    """Draw the motion of every case that the report shows, by case; see `draw_case`.

    Of the random sequences these are the ones that failed. Of a numerical solution, whose report is
    made over and over while it is mended, they are those that failed and the `FARTHEST` ones.
    """
    failed = {result.case for result in verdict.checks if result.failed}
    drawn = {motion.case: motion for motion in verdict.motions}
    if verdict.questions:
        ordered = sorted(verdict.checks, key=lambda result: result.margin or 0.0, reverse=True)
        farthest = list(dict.fromkeys(of.case for of in ordered if of.case in drawn))[:FARTHEST]
        drawn = {case: of for case, of in drawn.items() if case in failed | {"default", *farthest}}
    return {
        case: draw_case(motion, _course_tolerances(verdict.checks, case))
        for case, motion in drawn.items()
        if case in failed or not case.startswith(SEQUENCE)
    }


def figure_of(verdict: Verdict) -> Figure | None:
    """Draw the first case that failed, else the first one; None where no motion was compared."""
    failed = {result.case for result in verdict.checks if result.failed}
    shown = sorted(verdict.motions, key=lambda motion: motion.case not in failed)
    return next((_case(of, _course_tolerances(verdict.checks, of.case)) for of in shown), None)


def draw_case(motion: Motion, tolerances: Mapping[str, float]) -> str:
    """Draw a case as SVG: positions, spring force, and the errors of both sides below.

    The exact motion is the line, the sides are markers on it. The lowest panel has the errors of x
    and F, each over the largest magnitude of the exact course, on a logarithmic scale, with the
    `tolerances` of the course of x by side.
    """
    with mpl.rc_context(STYLE):
        page = _case(motion, tolerances)
        return as_part(page, f"plot-{motion.case}", f"{motion.case}: motion, force and errors")


def _case(motion: Motion, tolerances: Mapping[str, float]) -> Figure:
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(SIZE[0] / 72.0, SIZE[1] / 72.0))
        place = {"left": 0.112, "right": 0.94, "bottom": 0.088, "top": 0.942, "hspace": 0.16}
        panels = page.subplots(
            3, 1, sharex=True, height_ratios=(5.0, 4.0, 4.5), gridspec_kw=place
        ).tolist()
        line = curve(motion)
        time, prefix = _scale(float(line.t[-1]), 0.1)
        line = replace(line, t=line.t / time)
        motion = replace(motion, exact=replace(motion.exact, times=motion.exact.times / time))
        end = float(line.t[-1]) or 1.0
        # Single points at the ends stand free of the frame.
        panels[0].set_xlim(*((0.0, end) if line.joined else (-0.015 * end, 1.015 * end)))
        for panel in panels:
            panel.grid(visible=True, axis="y")
            panel.set_axisbelow(True)
        _draw_positions(panels[0], motion, line)
        _draw_force(panels[1], motion, line)
        _draw_errors(panels[2], motion, tolerances)
        panels[2].set_xlabel(f"time  [{prefix}s]", loc="left", labelpad=2.0)
        count, every = len(motion.exact.times), _every(motion)
        said = f"{count} sample{'s' if count > 1 else ''}"
        said = said if every == 1 else f"markers: 1 in {every} of {said}"
        said += "" if line.joined else "; more happens between samples than they tell"
        page.text(place["right"], 0.012, said, ha="right", fontsize=8.0, color=SOFT)
        return page


def draw_order(order: ObservedOrder, number: int) -> str:
    """Draw the error of the reference over its tolerance, with the slope that the method promises.

    ``number`` tells this picture from the others on the page.
    """
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(3.6, 2.5))
        panel = page.add_axes((0.19, 0.17, 0.77, 0.77))
        levels, errors = np.array(order.tolerances, float), np.array(order.errors, float)
        usable = np.isfinite(errors) & (errors > 0.0)
        panel.loglog(levels[usable], errors[usable], color=BLUE, marker="o", ms=4.5, lw=1.2)
        if usable.any():
            # Through the middle of the points, so that it shows the slope and no offset.
            offset = np.mean(np.log(errors[usable]) - order.expected * np.log(levels[usable]))
            promised = np.exp(offset) * levels**order.expected
            panel.loglog(levels, promised, color=INK, lw=1.0, ls=_DASHED)
            promise = f"- - -  order {order.expected:.2g}"
            panel.text(0.03, 0.93, promise, transform=panel.transAxes, va="top")
        _label_decades(panel.xaxis)
        _label_decades(panel.yaxis)
        panel.grid(visible=True)
        panel.set_xlabel("tolerance of the integration", labelpad=2.0)
        panel.set_ylabel(f"error of {order.quantity}", labelpad=3.0)
        title = f"{order.case}: error of {order.quantity} over the tolerance"
        return as_part(page, f"plot-order-{number}", title)


def _course_tolerances(checks: Sequence[CheckResult], case: str) -> dict[str, float]:
    return {
        result.side: result.tolerance
        for result in checks
        if (result.case, result.check, result.measure) == (case, "x-course", Measure.OF_SCALE)
    }


def _draw_positions(panel: Axes, motion: Motion, line: Curve) -> None:
    length, name = _scale(float(np.max(np.abs([line.x, line.x_pull]))))
    panel.set_ylabel(f"position  [{name}m]")
    _range(panel, np.concatenate((line.x, line.x_pull)) / length)
    _draw_line(panel, line, line.x_pull / length, GREY, 1.0, "x_pull")
    _draw_line(panel, line, line.x / length, INK, 1.6, "x, exact")
    _mark_sides(panel, motion, "x", length)
    _legend(panel)


def _draw_force(panel: Axes, motion: Motion, line: Curve) -> None:
    exact = motion.exact
    F_s = np.append(exact.initial["F_s"], exact.outputs["F_s"])
    force, prefix = _scale(float(np.max(np.abs(np.concatenate((line.F, F_s))))))
    signs = sorted({float(np.sign(F)) for F in line.F if F != 0.0}) or [1.0]
    reached = [sign for sign in signs if np.max(sign * line.F) > 0.3 * np.min(F_s)] or signs
    limits = {"F_s" if sign > 0.0 else "\N{MINUS SIGN}F_s": sign * F_s / force for sign in reached}
    _range(panel, np.concatenate((line.F / force, *limits.values())), above=0.16)
    low, high = panel.get_ylim()
    for limit in limits.values():
        panel.step(np.append(0.0, exact.times), limit, where="pre", color=INK, lw=0.9, ls=_DASHED)
    if len(limits) > 1 and 2.0 * F_s[-1] / force < 0.1 * (high - low):
        # Two names would lie on one another.
        limits = {"\N{PLUS-MINUS SIGN}F_s": limits["F_s"]}
    for name, limit in limits.items():
        right = panel.get_yaxis_transform()
        panel.text(1.008, limit[-1], name, fontsize=8.0, transform=right, va="center")
    _draw_line(panel, line, line.F / force, INK, 1.6, "F")
    _mark_sides(panel, motion, "F", force)
    panel.set_ylabel(f"spring force F  [{prefix}N]")


def _draw_errors(panel: Axes, motion: Motion, tolerances: Mapping[str, float]) -> None:
    panel.set_yscale("log")
    known = {side: tolerance for side, tolerance in tolerances.items() if tolerance > 0.0}
    # Nearer to each other, the names of the two lines would lie on one another.
    alike = len(known) > 1 and max(known.values()) < TOLERANCES_APART * min(known.values())
    marked = len(motion.exact.times) <= MARKS
    largest = max([1e-14, *known.values()])
    for side, name, color, *_ in SIDES:
        for quantity, style, marker in (("F", (0, (1, 1.2)), "s"), ("x", "-", "o")):
            errors = _errors(motion.exact, motion.records.get(side), quantity)
            if errors is None:
                continue
            largest = max([largest, *errors[np.isfinite(errors)]])
            panel.plot(
                motion.exact.times[: len(errors)],
                np.clip(errors, NOTHING, 1e3 * HOPELESS),
                color=color,
                lw=0.9,
                ls=style,
                marker=marker if marked else "",
                ms=3.0,
                label=f"{name} {quantity}",
            )
        if side in known:
            panel.axhline(known[side], color=color, lw=1.0, ls=_DASHED)
        if side in known and (side == "fmu" or not alike):
            panel.annotate(
                "tolerance, both" if alike else f"tolerance, {name}",
                (1.0, known[side]), (0.0, 2.5), color=INK if alike else color,
                xycoords=panel.get_yaxis_transform(), textcoords="offset points", fontsize=8.0,
                ha="right", va="bottom",
            )  # fmt: skip
    panel.set_ylim(0.3 * NOTHING, 100.0 * min(largest, HOPELESS))
    panel.set_ylabel("error / scale")
    _label_decades(panel.yaxis)
    if panel.get_legend_handles_labels()[0]:
        _legend(panel)


def _errors(exact: Run, run: Run | None, quantity: str) -> Series | None:
    if run is None or quantity not in run.outputs:
        return None
    truth = exact.outputs[quantity]
    got = run.outputs[quantity][: len(truth)]
    scale = float(np.max(np.abs(truth))) or 1.0
    with np.errstate(over="ignore", invalid="ignore"):
        return np.abs(got - truth[: len(got)]) / scale


def _draw_line(panel: Axes, line: Curve, y: Series, color: str, width: float, name: str) -> None:
    if line.joined:
        panel.plot(line.t, y, color=color, lw=width, label=name, solid_joinstyle="miter")
    else:
        size = width + (2.6 if len(y) <= 300 else 1.0)
        panel.plot(line.t, y, "o", color=color, ms=size, mew=0.0, label=name)


def _mark_sides(panel: Axes, motion: Motion, output: str, unit: float) -> None:
    every = _every(motion)
    for n, (side, name, color, marker, size) in enumerate(SIDES):
        run = motion.records.get(side)
        if run is None or output not in run.outputs:
            continue
        # The sides are marked in turn, or the one drawn later would hide the other.
        chosen = slice(n * every // 2, len(motion.exact.times), every)
        with np.errstate(over="ignore"):
            values = run.outputs[output][chosen] / unit
        times = motion.exact.times[chosen][: len(values)]
        # What lies beyond the panel is marked at its edge.
        panel.plot(times, np.clip(values, *panel.get_ylim()), marker, color=color, ms=size,
                   mew=1.1, mfc="none", clip_on=False, label=name)  # fmt: skip


def _every(motion: Motion) -> int:
    return max(1, -(-len(motion.exact.times) // MARKS))


def _legend(panel: Axes) -> None:
    place: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (-0.01, 0.99), "ncols": 4}
    panel.legend(**place, borderpad=0.0, borderaxespad=0.2, columnspacing=1.4, handlelength=1.7)


def _range(panel: Axes, values: Series, above: float = 0.07) -> None:
    low, high = float(np.min(values)), float(np.max(values))
    height = (high - low) or abs(high) or 1.0
    panel.set_ylim(low - 0.07 * height, high + above * height)


def _scale(largest: float, above: float = 2.0) -> tuple[float, str]:
    for size, prefix in _PREFIXES:
        if largest >= above * size and (size <= 1.0 or largest >= 1e4):
            return size, prefix
    return 1.0, ""


def _label_decades(axis: Axis) -> None:
    """Label five decades at most, and none of the lines between them."""
    axis.set_major_locator(LogLocator(numticks=6))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(lambda value, _: f"1e{round(float(np.log10(value)))}")
