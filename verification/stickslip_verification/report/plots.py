"""The picture of a case: positions, spring force and the errors of both sides, as SVG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip_verification.model.run import Run, Series
from stickslip_verification.model.verdict import (
    SEQUENCE,
    CheckResult,
    Measure,
    Motion,
    Verdict,
)
from stickslip_verification.report import curve
from stickslip_verification.report.house_style import (
    BLUE,
    GREY,
    INK,
    ORANGE,
    SOFT,
    STYLE,
    label_decades,
)
from stickslip_verification.report.svg import as_part

SIDES: Final = (("fmu", "FMU", BLUE, "o", 4.0), ("reference", "reference", ORANGE, "x", 3.4))

MARKS: Final = 40
"""Markers of a side in a panel: more hide the line that they lie on."""

NOTHING: Final = 1e-18
"""Where an error of exactly 0 is drawn: below half a rounding of the scale, 1.1e-16."""

TOLERANCES_APART: Final = 30.0
"""Ratio of two tolerances from which their lines have room for a name each."""

HOPELESS: Final = 1e6
"""The largest error, as part of the scale, that the panel makes room for."""

_SIZE: Final = (480.0, 412.0)
_LEFT, _RIGHT, _BOTTOM, _TOP = 54.0, 29.0, 36.0, 24.0
_GAPS: Final = (9.0, 21.0)
_HEIGHTS: Final = (5.0, 4.0, 4.5)
"""Page, margins, gaps [pt] and relative heights of the panels of a case."""

_PREFIXES: Final = ((1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"))


def draw_cases(verdict: Verdict) -> dict[str, str]:
    """Draw the motion of every case that the report shows, by case; see `draw_case`.

    Of the random sequences these are the ones that failed.
    """
    failed = {result.case for result in verdict.checks if result.failed}
    return {
        motion.case: draw_case(motion, course_tolerances(verdict.checks, motion.case))
        for motion in verdict.motions
        if motion.case in failed or not motion.case.startswith(SEQUENCE)
    }


def course_tolerances(checks: Sequence[CheckResult], case: str) -> dict[str, float]:
    """Return the tolerance of the course of x on each side of a case, as part of its scale."""
    return {
        result.side: result.tolerance
        for result in checks
        if (result.case, result.check, result.measure) == (case, "x-course", Measure.OF_SCALE)
    }


def draw_case(motion: Motion, tolerances: Mapping[str, float]) -> str:
    """Draw a case as SVG: positions, spring force, and the errors of both sides below.

    The exact motion is the line, the sides are markers on it. The lowest panel has the errors of x
    and F, each over the largest magnitude of the exact course, on a logarithmic scale.

    Parameters
    ----------
    motion
        What was driven.
    tolerances
        For each side, the tolerance of the course of x as part of its scale, where there is one.
    """
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(_SIZE[0] / 72.0, _SIZE[1] / 72.0))
        upper, middle, lower = _panels(page)
        drawn = curve.curve(motion)
        time, t_name = _scale(float(drawn.t[-1]), 0.1)
        for panel in (upper, middle, lower):
            end = float(drawn.t[-1]) / time or 1.0
            # Single points at the ends stand free of the frame.
            panel.set_xlim(*((0.0, end) if drawn.joined else (-0.015 * end, 1.015 * end)))
            panel.grid(visible=True, axis="y")
            panel.set_axisbelow(True)
        _draw_positions(upper, motion, drawn, time)
        _draw_force(middle, motion, drawn, time)
        _draw_errors(lower, motion, tolerances, time)
        for panel in (upper, middle):
            panel.tick_params(labelbottom=False)
        lower.set_xlabel(f"time  [{t_name}s]", loc="left", labelpad=2.0)
        page.text(
            1.0 - _RIGHT / _SIZE[0], 5.0 / _SIZE[1], _what_is_marked(motion, drawn), ha="right",
            fontsize=8.0, color=SOFT,
        )  # fmt: skip
        return as_part(page, f"plot-{motion.case}", f"{motion.case}: motion, force and errors")


def _panels(page: Figure) -> list[Axes]:
    width, height = _SIZE
    free = height - _TOP - _BOTTOM - sum(_GAPS)
    panels, top = [], height - _TOP
    for share, gap in zip(_HEIGHTS, (*_GAPS, 0.0), strict=True):
        tall = free * share / sum(_HEIGHTS)
        box = (_LEFT / width, (top - tall) / height, 1 - (_LEFT + _RIGHT) / width, tall / height)
        panels.append(page.add_axes(box))
        top -= tall + gap
    return panels


def _draw_positions(panel: Axes, motion: Motion, drawn: curve.Curve, time: float) -> None:
    length, name = _scale(float(np.max(np.abs([drawn.x, drawn.x_pull]))))
    panel.set_ylabel(f"position  [{name}m]")
    _range(panel, np.concatenate((drawn.x, drawn.x_pull)) / length)
    _line(panel, drawn, drawn.x_pull / length, time, GREY, 1.0, "x_pull")
    _line(panel, drawn, drawn.x / length, time, INK, 1.6, "x, exact")
    _mark_sides(panel, motion, "x", length, time)
    _legend(panel)


def _draw_force(panel: Axes, motion: Motion, drawn: curve.Curve, time: float) -> None:
    record = motion.exact
    F_s = np.concatenate(([record.initial["F_s"]], record.outputs["F_s"]))
    times = np.concatenate(([0.0], record.times))
    force, prefix = _scale(float(np.max(np.abs(np.concatenate((drawn.F, F_s))))))
    signs = sorted({float(np.sign(F)) for F in drawn.F if F != 0.0}) or [1.0]
    reached = [sign for sign in signs if np.max(sign * drawn.F) > 0.3 * np.min(F_s)] or signs
    lines = [sign * F_s / force for sign in reached]
    _range(panel, np.concatenate((drawn.F / force, *lines)), above=0.16)
    low, high = panel.get_ylim()
    together = abs(lines[-1][-1] - lines[0][-1]) < 0.1 * (high - low)
    for n, (sign, line) in enumerate(zip(reached, lines, strict=True)):
        panel.step(times / time, line, where="pre", color=INK, lw=0.9, ls=(0, (5, 3)))
        label = "F_s" if sign > 0.0 else "\N{MINUS SIGN}F_s"
        if together and len(lines) > 1:
            label = "\N{PLUS-MINUS SIGN}F_s" if n == 0 else ""
        panel.text(
            1.008, line[-1], label, fontsize=8.0,
            transform=panel.get_yaxis_transform(), ha="left", va="center",
        )  # fmt: skip
    _line(panel, drawn, drawn.F / force, time, INK, 1.6, "F")
    _mark_sides(panel, motion, "F", force, time)
    panel.set_ylabel(f"spring force F  [{prefix}N]")


def _draw_errors(panel: Axes, motion: Motion, tolerances: Mapping[str, float], time: float) -> None:
    panel.set_yscale("log")
    largest = max([1e-14, *tolerances.values()])
    found = {}
    for side, *_ in SIDES:
        for quantity in ("x", "F"):
            errors = _errors(motion.exact, motion.records.get(side), quantity)
            if errors is not None:
                found[side, quantity] = errors
                largest = max([largest, *errors[np.isfinite(errors)]])
    panel.set_ylim(0.3 * NOTHING, 100.0 * min(largest, HOPELESS))
    panel.set_ylabel("error / scale")
    few = len(motion.exact.times) <= 30
    # Nearer to each other, the names of the two lines would lie on one another.
    known = [tolerance for tolerance in tolerances.values() if tolerance > 0.0]
    alike = len(known) > 1 and max(known) < TOLERANCES_APART * min(known)
    for side, name, color, *_ in SIDES:
        for quantity, look in (("F", (0, (1, 1.2))), ("x", "-")):
            errors = found.get((side, quantity))
            if errors is None:
                continue
            times = motion.exact.times[: len(errors)] / time
            seen = np.clip(errors, NOTHING, 1e3 * HOPELESS)
            marker = ("o" if quantity == "x" else "s") if few else ""
            panel.plot(times, seen, color=color, lw=0.9, ls=look,
                       label=f"{name} {quantity}", marker=marker, ms=3.0)  # fmt: skip
        if side in tolerances and tolerances[side] > 0.0:
            panel.axhline(tolerances[side], color=color, lw=1.0, ls=(0, (5, 3)))
            if alike and side != "fmu":
                continue
            panel.annotate(
                "tolerance, both" if alike else f"tolerance, {name}",
                (1.0, tolerances[side]), (0.0, 2.5), color=INK if alike else color,
                xycoords=panel.get_yaxis_transform(), textcoords="offset points", fontsize=8.0,
                ha="right", va="bottom",
            )  # fmt: skip
    label_decades(panel.yaxis, panel.get_ylim(), 5)
    if found:
        _legend(panel)


def _legend(panel: Axes) -> None:
    """Name the lines in the strip above the panel."""
    panel.legend(
        loc="lower left",
        bbox_to_anchor=(-0.01, 0.99),
        ncols=4,
        borderpad=0.0,
        borderaxespad=0.2,
        columnspacing=1.4,
        handlelength=1.7,
        handletextpad=0.5,
    )


def _errors(exact: Run, record: Run | None, quantity: str) -> Series | None:
    if record is None or quantity not in record.outputs:
        return None
    truth = exact.outputs[quantity]
    got = record.outputs[quantity][: len(truth)]
    scale = float(np.max(np.abs(truth))) or 1.0
    with np.errstate(over="ignore", invalid="ignore"):
        return np.abs(got - truth[: len(got)]) / scale


def _line(
    panel: Axes, drawn: curve.Curve, y: Series, time: float, color: str, width: float, name: str
) -> None:
    if drawn.joined:
        panel.plot(drawn.t / time, y, color=color, lw=width, label=name, solid_joinstyle="miter")
    else:
        size = width + (2.6 if len(y) <= 300 else 1.0)
        panel.plot(
            drawn.t / time, y, color=color, ls="none", marker="o", ms=size, mew=0.0, label=name
        )


def _mark_sides(panel: Axes, motion: Motion, output: str, unit: float, time: float) -> None:
    every = _every(motion)
    for n, (side, name, color, marker, size) in enumerate(SIDES):
        record = motion.records.get(side)
        if record is None or output not in record.outputs:
            continue
        # The sides are marked in turn, or the one drawn later would hide the other.
        chosen = slice(n * every // 2, len(motion.exact.times), every)
        with np.errstate(over="ignore"):
            values = record.outputs[output][chosen] / unit
        panel.plot(
            motion.exact.times[chosen][: len(values)] / time,
            # What lies beyond the panel is marked at its edge.
            np.clip(values, *panel.get_ylim()),
            color=color,
            ls="none",
            marker=marker,
            ms=size,
            mew=1.1,
            mfc="none",
            clip_on=False,
            label=name,
        )


def _every(motion: Motion) -> int:
    return max(1, -(-len(motion.exact.times) // MARKS))


def _what_is_marked(motion: Motion, drawn: curve.Curve) -> str:
    count, every = len(motion.exact.times), _every(motion)
    what = f"{count} sample{'s' if count > 1 else ''}"
    marked = what if every == 1 else f"markers: 1 in {every} of {what}"
    return marked if drawn.joined else f"{marked}; more happens between samples than they tell"


def _range(panel: Axes, values: Series, above: float = 0.07) -> None:
    low, high = float(np.min(values)), float(np.max(values))
    height = (high - low) or abs(high) or 1.0
    panel.set_ylim(low - 0.07 * height, high + above * height)


def _scale(largest: float, above: float = 2.0) -> tuple[float, str]:
    """Return the size of the unit that makes `largest` a handy number, and its SI prefix."""
    for size, prefix in _PREFIXES:
        if largest >= above * size and (size <= 1.0 or largest >= 1e4):
            return size, prefix
    return 1.0, ""
