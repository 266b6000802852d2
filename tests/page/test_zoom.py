"""Zoom in time: buttons, keys, dragging, double-click and the wheel."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from stickslip_ref import Parameters
from tests.page import drawing
from tests.page.browser import opened
from tests.page.settings import presets
from tests.page.using import drawn, look, pause, set_values, setting, shown

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

BUTTONS = {
    "zoom-in": (2.5, 7.5),
    "zoom-out": (0.0, 20.0),
    "later": (2.5, 12.5),
    "earlier": (0.0, 10.0),
}
"""What each button makes of the view from 0 to 10 s; no view begins before the motion does."""


def view(page: Page) -> tuple[float, float]:
    """Give first and last time that are seen [s]."""
    found = page.evaluate("window.stickslip.view")
    return float(found["from"]), float(found["to"])


def whole(page: Page) -> tuple[float, float]:
    """Give the six steady cycles that begin at the end of the first slip [s]."""
    first, cycle = load_up(page), page.evaluate("window.stickslip.cycle")
    start = first + float(cycle["t_slip"])
    return start, start + 6.0 * float(cycle["T"])


def load_up(page: Page) -> float:
    """Give the time of the first break-away [s]."""
    return float(Parameters(**setting(page)).F_s) / (setting(page)["k"] * setting(page)["v"])


def place(page: Page, chart: str, t: float) -> tuple[float, float]:
    """Give where on the screen a time lies, in the middle of a chart's height."""
    found = page.locator(f"#{chart}")
    found.scroll_into_view_if_needed()
    box = found.bounding_box()
    assert box is not None
    return box["x"] + drawing.time_axis(page, chart).place(t), box["y"] + 0.5 * box["height"]


def choose(page: Page, chart: str, start: float, end: float) -> None:
    """Drag over a chart from one time to another."""
    page.mouse.move(*place(page, chart, start))
    page.mouse.down()
    page.mouse.move(*place(page, chart, end), steps=3)
    page.mouse.up()


def test_each_button_moves_the_stretch_of_time(page: Page) -> None:
    """Halve, double, earlier, later by a quarter; by mouse and by either key."""
    pause(page)
    for button, wanted in BUTTONS.items():
        look(page, 0.0, 10.0)
        page.click(f"#{button}")
        assert view(page) == pytest.approx(wanted)
        look(page, 0.0, 10.0)
        page.press(f"#{button}", "Enter")
        assert view(page) == pytest.approx(wanted)
        page.press("#zoom-auto", "Space")
        assert view(page) == pytest.approx(whole(page), rel=1e-12)


def test_at_first_six_steady_cycles_fill_the_view(page: Page) -> None:
    """In every preset the view holds six sticks and six slips; a button shows the load-up."""
    pause(page)
    for name in presets():
        page.click(f"[data-preset={name}]")
        drawn(page)
        cycle = page.evaluate("window.stickslip.cycle")
        start, end = view(page)
        assert end - start == pytest.approx(6.0 * cycle["T"], rel=1e-9)
        kinds = [each.kind for each in drawing.phases(page)]
        assert kinds == ["stick", "slip"] * 6
        page.click("#from-start")
        start, end = view(page)
        first = load_up(page)
        assert start == 0.0
        assert first + 2.0 * cycle["T"] < end <= first + 6.01 * cycle["T"]


def test_a_slider_changes_the_curve_and_not_the_scale(page: Page) -> None:
    """While a value changes, the span of the view stays as long as it holds 2.5 to 15 cycles."""
    pause(page)
    start, end = view(page)
    for k in (1100.0, 1500.0, 2500.0):
        set_values(page, k=k)
        now = view(page)
        assert now[1] - now[0] == pytest.approx(end - start, rel=1e-12)
        assert now[0] == pytest.approx(whole(page)[0])
    set_values(page, k=2e4)
    assert view(page) == pytest.approx(whole(page))


def test_two_fingers_zoom_and_what_is_under_them_stays(browser: Browser, page_file: Path) -> None:
    """Spread from a quarter of the chart to half of it, two fingers halve the view."""
    with opened(browser, page_file, width=400, has_touch=True) as page:
        pause(page)
        look(page, 0.0, 10.0)
        axis = drawing.time_axis(page)
        page.evaluate(
            """places => {
              const chart = document.querySelector("#x-chart");
              const { left } = chart.getBoundingClientRect();
              const touch = (type, pointerId, x) => chart.dispatchEvent(
                new PointerEvent(type, { pointerId, pointerType: "touch", clientX: left + x }));
              chart.setPointerCapture = () => {};
              const [a, b, c, d] = places;
              touch("pointerdown", 1, a);
              touch("pointerdown", 2, b);
              touch("pointermove", 1, c);
              touch("pointermove", 2, d);
              touch("pointerup", 1, c);
              touch("pointerup", 2, d);
            }""",
            [axis.place(t) for t in (4.0, 6.0, 3.0, 7.0)],
        )
        assert view(page) == pytest.approx((2.5, 7.5))


def test_a_finger_that_the_browser_took_is_no_finger_of_two(
    browser: Browser, page_file: Path
) -> None:
    """Where a touch became a scroll, the next finger reads and zooms nothing."""
    with opened(browser, page_file, width=400, has_touch=True) as page:
        pause(page)
        look(page, 0.0, 10.0)
        page.evaluate(
            """() => {
              const chart = document.querySelector("#x-chart");
              const { left } = chart.getBoundingClientRect();
              const touch = (type, pointerId, x) => chart.dispatchEvent(
                new PointerEvent(type, { pointerId, pointerType: "touch", clientX: left + x }));
              chart.setPointerCapture = () => {};
              touch("pointerdown", 1, 100);
              touch("pointercancel", 1, 100);
              touch("pointerdown", 2, 200);
              touch("pointermove", 2, 250);
            }"""
        )
        assert view(page) == (0.0, 10.0)
        assert drawing.cursor(page, "x-chart") == pytest.approx(250.0, abs=0.5)


def test_dragging_over_a_chart_shows_what_was_dragged_over(page: Page) -> None:
    """Either way, on either chart, to the width of a pixel; a double-click shows all again."""
    pause(page)
    page.click("#zoom-auto")
    before = shown(page)
    for chart in ("x-chart", "F-chart"):
        look(page, 0.0, 10.0)
        axis = drawing.time_axis(page, chart)
        choose(page, chart, 6.0, 3.0)
        start, end = view(page)
        assert abs(start - 3.0) <= axis.span / axis.width
        assert abs(end - 6.0) <= axis.span / axis.width
        assert shown(page) != before
        page.mouse.dblclick(*place(page, chart, 4.0))
        assert view(page) == pytest.approx(whole(page), rel=1e-12)
        assert shown(page) == before


def test_what_is_being_chosen_is_seen(page: Page) -> None:
    """While the mouse is down, the stretch under it is shaded; a short slip of it is a click."""
    pause(page)
    look(page, 0.0, 10.0)
    page.mouse.move(*place(page, "x-chart", 3.0))
    page.mouse.down()
    page.mouse.move(*place(page, "x-chart", 5.0), steps=3)
    assert page.get_attribute("#x-chart .choice", "visibility") == "visible"
    page.mouse.move(*place(page, "x-chart", 3.001))
    page.mouse.up()
    assert page.get_attribute("#x-chart .choice", "visibility") == "hidden"
    assert view(page) == (0.0, 10.0)


def test_the_wheel_zooms_only_with_ctrl_and_at_the_pointer(page: Page) -> None:
    """What is under the pointer stays there; without Ctrl the wheel scrolls, as everywhere."""
    pause(page)
    look(page, 0.0, 10.0)
    at = place(page, "x-chart", 4.0)
    page.mouse.move(*at)
    page.mouse.wheel(0, 40)
    page.wait_for_function("scrollY > 0")
    assert view(page) == (0.0, 10.0)
    at = place(page, "x-chart", 4.0)
    page.mouse.move(*at)
    page.keyboard.down("Control")
    page.mouse.wheel(0, -math.log(4.0) / 0.002)
    page.wait_for_function("window.stickslip.view.to < 10")
    page.keyboard.up("Control")
    start, end = view(page)
    assert end - start == pytest.approx(2.5)
    # A browser reports a wheel at whole pixels: what was under it is known to one of those before.
    pixel = 10.0 / drawing.time_axis(page, "x-chart").width
    assert (4.0 - start) / (end - start) == pytest.approx(0.4, abs=pixel / (end - start))


def test_a_zoom_outlives_a_slider_and_ends_with_a_preset(page: Page) -> None:
    """A detail stays in sight while a value is changed; another preset shows its own picture."""
    pause(page)
    look(page, 0.0, 10.0)
    choose(page, "x-chart", 2.0, 4.0)
    zoomed = view(page)
    set_values(page, k=1200.0)
    assert view(page) == zoomed
    page.click("[data-preset=violin-bow]")
    page.wait_for_function("window.stickslip.view.to < 1")


def test_a_zoom_that_would_hold_hundreds_of_cycles_gives_way(page: Page) -> None:
    """A stretch of time outlives a setting until its cycles would be a blur; then six are shown."""
    pause(page)
    look(page, 0.0, 10.0)
    set_values(page, k=1e4)
    assert 100.0 < 10.0 / page.evaluate("window.stickslip.cycle.T") < 200.0
    assert view(page) == (0.0, 10.0)
    set_values(page, k=1e8)
    assert view(page) == pytest.approx(whole(page))


def test_the_marks_of_a_detail_are_times_in_the_unit_of_the_axis(page: Page) -> None:
    """A detail of milliseconds late in the run is read off its axis as the times that it shows."""
    pause(page)
    for start, end in ((0.0, 10.0), (10.0, 10.5), (0.0, 0.02), (60.0, 60.001)):
        look(page, start, end)
        for chart in ("x-chart", "F-chart"):
            axis = drawing.time_axis(page, chart)
            for t in (start, 0.3 * start + 0.7 * end):
                found, slack = drawing.value_at(page, chart, "x", axis.place(t))
                # The labels of a late detail have digits to tell them apart.
                assert found == pytest.approx(t, abs=slack), (chart, t)


def test_zoom_has_its_ends(page: Page) -> None:
    """However often a button is pressed, the picture stays one: no time is lost in rounding."""
    pause(page)
    look(page, 0.0, 10.0)
    for button in ("zoom-in", "zoom-out"):
        page.evaluate(
            "id => { for (let i = 0; i < 80; i++) document.getElementById(id).click(); }", button
        )
        start, end = view(page)
        assert 0.0 <= start < end < 1e3
        assert all("NaN" not in path and "Infinity" not in path for path in shown(page).values())
        ticks = page.locator("#x-chart .ticks text[text-anchor='middle']").all_text_contents()
        assert len(set(ticks)) == len(ticks) >= 2
