"""The curves: flat where it sticks, with corners at the events at every zoom, and their meaning."""

from __future__ import annotations

import math
import re
from itertools import pairwise
from typing import TYPE_CHECKING

import pytest

from stickslip_ref import Parameters, steady_cycle
from tests.page import drawing
from tests.page.drawing import PIXEL, Phase, TimeAxis
from tests.page.settings import presets
from tests.page.using import drawn, look, pause, set_values

if TYPE_CHECKING:
    from playwright.sync_api import Page


def check_curves(page: Page) -> list[Phase]:
    """Hold what is drawn against the page's events: sticks, corners and bands, on both charts."""
    axis, seen = drawing.time_axis(page), drawing.phases(page)
    assert drawing.time_axis(page, "F-chart") == axis
    position = drawing.curve(page, "#x-chart .curve.mass")
    force = drawing.curve(page, "#F-chart .curve.force")
    for phase in seen:
        left, right = axis.place(phase.start), axis.place(phase.end)
        if right - left < 4 * PIXEL:
            continue
        if phase.kind == "stick":
            check_stick(position, left, right, flat=True)
            check_stick(force, left, right, flat=False)
        else:
            check_slip(position, left, right)
            check_slip(force, left, right)
    check_bands(page, axis, seen)
    return seen


def check_stick(path: list[drawing.Piece], left: float, right: float, flat: bool) -> None:
    """Hold that one straight piece spans a stick, from corner to corner, without any slope in x."""
    spanning = [each for each in drawing.lines(path) if near(each, left, right)]
    assert len(spanning) == 1, f"no line from {left} to {right} px"
    (line,) = spanning
    if flat:
        assert line.start[1] == line.end[1]
    else:
        assert line.start[1] >= line.end[1]


def check_slip(path: list[drawing.Piece], left: float, right: float) -> None:
    """Hold that a slip is curves alone, which begin and end at its corners."""
    inside = [
        each
        for each in path
        if left - PIXEL <= each.start[0] and each.end[0] <= right + PIXEL and each.kind == "cubic"
    ]
    assert abs(inside[0].start[0] - left) <= PIXEL
    assert abs(inside[-1].end[0] - right) <= PIXEL
    assert all(a.end == b.start for a, b in pairwise(inside))


def check_bands(page: Page, axis: TimeAxis, seen: list[Phase]) -> None:
    """Hold that the shading changes at the events, on both charts alike."""
    for kind in ("stick", "slip"):
        wanted = [edge(axis, each) for each in seen if each.kind == kind]
        for chart in ("x-chart", "F-chart"):
            found = drawing.bands(page, chart, kind)
            assert len(found) == len(wanted)
            for (a, b), (left, right) in zip(found, wanted, strict=True):
                assert abs(a - left) <= PIXEL
                assert abs(b - right) <= PIXEL


def edge(axis: TimeAxis, phase: Phase) -> tuple[float, float]:
    """Give left and right edge [px] of a phase."""
    return axis.place(phase.start), axis.place(phase.end)


def near(piece: drawing.Piece, left: float, right: float) -> bool:
    """Tell whether a piece lies between two places [px]."""
    return abs(piece.start[0] - left) <= PIXEL and abs(piece.end[0] - right) <= PIXEL


def zoom_at(page: Page, t: float, factor: float = 0.25) -> None:
    """Zoom with Ctrl and the wheel, the pointer at a time [s] of the position chart."""
    before = drawing.time_axis(page)
    box = page.locator("#x-chart").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + before.place(t), box["y"] + 0.5 * box["height"])
    page.keyboard.down("Control")
    page.mouse.wheel(0, math.log(factor) / 0.002)
    page.keyboard.up("Control")
    page.wait_for_function(
        "span => window.stickslip.view.to - window.stickslip.view.from !== span", arg=before.span
    )


def test_sticks_are_flat_and_corners_sharp_in_every_preset(page: Page) -> None:
    """The mass stands still to the last bit while it sticks, and the curve bends at the events."""
    pause(page)
    for name in presets():
        page.click(f"[data-preset={name}]")
        drawn(page)
        seen = check_curves(page)
        assert {each.kind for each in seen} == {"stick", "slip"}


@pytest.mark.parametrize("kind", ["break-away", "re-stick"])
def test_a_corner_stays_a_corner_at_every_zoom(page: Page, kind: str) -> None:
    """From ten seconds to microseconds, an event is where its time is, to a fiftieth of a pixel."""
    pause(page)
    look(page, 0.0, 10.0)
    events = page.evaluate("window.stickslip.events(4, 6)")
    t = next(float(each["t"]) for each in events if each["kind"] == kind)
    factor = 1.0
    while factor > 2.0**-21:
        zoom_at(page, t)
        axis = drawing.time_axis(page)
        factor = axis.span / 10.0
        seen = check_curves(page)
        assert t in drawing.corners(seen)
        assert 0.2 < (t - axis.start) / axis.span < 0.8


def test_the_dashed_line_is_the_break_away_force(page: Page) -> None:
    """The threshold lies at F_s on the labelled axis, and the force meets it at each break-away."""
    pause(page)
    look(page, 0.0, 10.0)
    level = drawing.height_of(page, "#F-chart .threshold")
    value, slack = drawing.value_at(page, "F-chart", "y", level)
    assert abs(value - 4.905) <= slack
    dashes = page.eval_on_selector(
        "#F-chart .threshold", "e => getComputedStyle(e).strokeDasharray"
    )
    assert dashes not in ("none", "")
    sticks = drawing.lines(drawing.curve(page, "#F-chart .curve.force"))
    assert len(sticks) > 20
    assert all(abs(each.end[1] - level) <= PIXEL for each in sticks[:-1])


def test_the_grey_line_is_the_pulled_end(page: Page) -> None:
    """The pulled end runs straight from 0 to v t; the mass never passes it at the start values."""
    pause(page)
    look(page, 0.0, 10.0)
    (line,) = drawing.curve(page, "#x-chart .curve.pull")
    low, slack = drawing.value_at(page, "x-chart", "y", line.start[1])
    high, _ = drawing.value_at(page, "x-chart", "y", line.end[1])
    assert abs(low) <= slack
    assert abs(high - 0.2) <= slack
    slope = (line.end[1] - line.start[1]) / (line.end[0] - line.start[0])
    for piece in drawing.curve(page, "#x-chart .curve.mass"):
        pulled = line.start[1] + slope * (piece.end[0] - line.start[0])
        assert piece.end[1] >= pulled - PIXEL


def test_the_names_stand_at_their_curves(page: Page) -> None:
    """The name of the pulled end stands on its line, that of the mass below one of its sticks."""
    pause(page)
    notes = """
      () => [...document.querySelectorAll("#x-chart .note")].map(each => {
        const { x, y, width, height } = each.getBBox();
        return [each.textContent, { left: x, right: x + width, top: y, bottom: y + height }];
      })
    """
    (line,) = drawing.curve(page, "#x-chart .curve.pull")
    slope = (line.end[1] - line.start[1]) / (line.end[0] - line.start[0])
    boxes = dict(page.evaluate(notes))
    pulled, mass = boxes["pulled end"], boxes["mass"]
    at_end = line.start[1] + slope * (pulled["right"] - line.start[0])
    assert at_end - 12.0 < pulled["bottom"] < at_end + 6.0
    middle = 0.5 * (mass["left"] + mass["right"])
    (stick,) = (
        each
        for each in drawing.lines(drawing.curve(page, "#x-chart .curve.mass"))
        if each.start[0] < middle < each.end[0]
    )
    assert stick.start[1] < mass["top"] + 6.0 < stick.start[1] + 18.0


def test_the_overshoot_is_told_where_it_shows(page: Page) -> None:
    """F passes F_s by k Delta (sqrt(1 + 1/lambda^2) - 1); the note has the number."""
    pause(page)
    p = Parameters()
    cycle = steady_cycle(p)
    over = float(p.k * cycle.Delta * (math.hypot(1.0, 1.0 / cycle.lambda_) - 1.0))
    found = re.search(r"by ([\d.]+)\s(mN|N)", notes(page))
    assert found
    number = float(found[1]) * {"mN": 1e-3, "N": 1.0}[found[2]]
    # Four digits are shown.
    assert abs(number - over) <= 0.51e-3 * over


def test_an_overshoot_that_cannot_be_seen_is_not_pointed_at(page: Page) -> None:
    """Where F passes F_s by less than a pixel, the chart itself claims nothing."""
    set_values(page, v=0.0005)
    drawn(page)
    assert "passes" not in notes(page)


def notes(page: Page) -> str:
    """Give the notes that are seen in the force chart."""
    return " ".join(page.locator("#F-chart .note").all_text_contents())


def test_the_portrait_is_one_closed_loop(page: Page) -> None:
    """Slip and stick close on themselves."""
    pause(page)
    path = drawing.curve(page, "#phase-chart .curve.mass")
    *slip, stick = path
    assert stick.kind == "line"
    assert {each.kind for each in slip} == {"cubic"}
    assert stick.end == slip[0].start
    assert stick.start[1] == stick.end[1]
    top = min(each.end[1] for each in slip)
    peak, slack = drawing.value_at(page, "phase-chart", "y", top)
    exact = float(steady_cycle(Parameters()).x_dot_peak)
    # Points stand every 0.4 rad, so the highest lies at most 0.2 rad from the top.
    assert exact * math.cos(0.2) - slack <= peak <= exact + slack
