"""Zoom in time: buttons, keys, dragging, double-click, the wheel, two fingers."""

import math

import pytest

from tests.page import drawing
from tests.page.drawing import place
from tests.page.settings import PRESETS, parameters
from tests.page.window import Window


def whole(window: Window) -> tuple[float, float]:
    """Return the six steady cycles that begin at the end of the first slip [s]."""
    start = load_up(window) + float(window.cycle["t_slip"])
    return start, start + 6.0 * float(window.cycle["T"])


def load_up(window: Window) -> float:
    p = window.setting
    return float(parameters(p).F_s / (p["k"] * p["v"]))


@pytest.mark.parametrize(
    ("button", "seen"),
    [
        ("zoom-in", (2.5, 7.5)),
        ("zoom-out", (0.0, 20.0)),
        ("later", (2.5, 12.5)),
        # No view begins before the motion does.
        ("earlier", (0.0, 10.0)),
    ],
)
def test_each_button_moves_the_view_and_has_its_ends(
    window: Window, button: str, seen: tuple[float, float]
) -> None:
    window.look(0.0, 10.0)
    window.page.press(f"#{button}", "Enter")
    assert window.view == pytest.approx(seen)
    window.js("id => { for (let i = 0; i < 80; i++) document.getElementById(id).click(); }", button)
    assert 0.0 <= window.view[0] < window.view[1] < 1e3
    assert not window.has_nonsense()
    for chart in ("x-chart", "F-chart"):
        axis = drawing.time_axis(window, chart)
        found, slack = drawing.value_at(window, chart, "x", axis.place(axis.end))
        assert found == pytest.approx(axis.end, abs=slack)
    window.page.press("#zoom-auto", "Space")
    assert window.view == pytest.approx(whole(window), rel=1e-12)


def test_at_first_six_steady_cycles_fill_the_view_and_a_button_shows_the_load_up(
    window: Window,
) -> None:
    for name in PRESETS:
        window.preset(name)
        assert window.view == pytest.approx(whole(window), rel=1e-9)
        assert [kind for kind, *_ in drawing.phases(window)] == ["stick", "slip"] * 6
        window.page.fill("#scrub", "500")
        window.page.click("#from-start")
        assert window.page.input_value("#scrub") == "0"
        (start, end), T = window.view, window.cycle["T"]
        assert start == 0.0
        assert 2.0 * T < end - load_up(window) <= 6.01 * T


def test_dragging_over_a_chart_shows_what_was_dragged_over(window: Window) -> None:
    for chart in ("x-chart", "F-chart"):
        window.look(0.0, 10.0)
        # To the width of a pixel.
        pixel = 10.0 / drawing.time_axis(window, chart).width
        (right, top), (left, _) = (place(window, chart, t) for t in (6.0, 3.0))
        window.pull(right, top, left - right, 0.0)
        assert window.view == pytest.approx((3.0, 6.0), abs=pixel)
        window.page.mouse.dblclick(*place(window, chart, 4.0))
        assert window.view == pytest.approx(whole(window), rel=1e-12)
    # While the mouse is down the stretch is shaded; Escape is no choice.
    window.look(0.0, 10.0)
    window.page.mouse.move(*place(window, "x-chart", 3.0))
    window.page.mouse.down()
    window.page.mouse.move(*place(window, "x-chart", 5.0), steps=3)
    assert window.part("#x-chart .choice", "visibility") == "visible"
    window.page.keyboard.press("Escape")
    window.page.mouse.up()
    assert window.part("#x-chart .choice", "visibility") == "hidden"
    assert window.view == (0.0, 10.0)


def test_the_wheel_zooms_only_with_ctrl_and_at_the_pointer(window: Window) -> None:
    window.look(0.0, 10.0)
    window.page.mouse.move(*place(window, "x-chart", 4.0))
    window.page.mouse.wheel(0, 40)
    window.until("scrollY > 0")
    assert window.view == (0.0, 10.0)
    window.page.mouse.move(*place(window, "x-chart", 4.0))
    window.page.keyboard.down("Control")
    window.page.mouse.wheel(0, -math.log(4.0) / 0.002)
    window.until("window.stickslip.view.to < 10")
    window.page.keyboard.up("Control")
    start, end = window.view
    assert end - start == pytest.approx(2.5)
    # A browser reports a wheel at whole pixels: what was under it is known to one of those before.
    pixel = 10.0 / drawing.time_axis(window, "x-chart").width
    assert (4.0 - start) / (end - start) == pytest.approx(0.4, abs=pixel / (end - start))


TOUCH = """all => {
  const chart = document.querySelector("#x-chart");
  const { left } = chart.getBoundingClientRect();
  chart.setPointerCapture = () => {};
  for (const [type, pointerId, x] of all) chart.dispatchEvent(
    new PointerEvent(`pointer${type}`, { pointerId, pointerType: "touch", clientX: left + x }));
}"""


def test_two_fingers_zoom_what_is_under_them_and_one_reads(window: Window) -> None:
    window.look(0.0, 10.0)
    # A touch that became a scroll is no finger of two.
    window.js(TOUCH, [["down", 1, 99], ["cancel", 1, 99], ["down", 2, 200], ["move", 2, 250]])
    assert window.view == (0.0, 10.0)
    assert drawing.cursor(window) == pytest.approx(250.0, abs=0.5)
    a, b, c, d = (drawing.time_axis(window).place(t) for t in (4.0, 6.0, 3.0, 7.0))
    downs, moves = [["down", 1, a], ["down", 2, b]], [["move", 1, c], ["move", 2, d]]
    window.js(TOUCH, [["up", 2, 250], *downs, *moves, ["up", 1, c], ["up", 2, d]])
    assert window.view == pytest.approx((2.5, 7.5))


def test_a_view_outlives_a_value_until_its_cycles_would_be_a_blur(window: Window) -> None:
    start, end = window.view
    window.set(k=2500.0)
    assert window.view == pytest.approx((whole(window)[0], whole(window)[0] + end - start))
    window.set(k=2e4)
    assert window.view == pytest.approx(whole(window))
    window.set(k=1000.0)
    window.look(0.0, 10.0)
    window.set(k=1e4)
    assert window.view == (0.0, 10.0)
    window.set(k=1e8)
    assert window.view == pytest.approx(whole(window))
