"""The friction curve as a person uses it: dragged, by keys, pasted, linked."""

from pathlib import Path
from typing import Any

import pytest

from stickslip_design.axis.curve_file import read_curve
from tests.page.test_friction import FALLS_TWICE
from tests.page.window import Window


def curve(window: Window) -> Any:
    window.drawn()
    return window.js("stickslip.curve")


def drag(window: Window, selector: str, dx: float, dy: float) -> None:
    """Drag with the mouse by so many pixels what is large enough for a finger."""
    window.page.locator(selector).scroll_into_view_if_needed()
    window.drawn()
    x, y, *size = window.box(selector)
    assert size == pytest.approx([44, 44], abs=0.01)
    window.pull(x + 22, y + 22, dx, dy)


def knob(number: int) -> str:
    return f"#friction-plot .knob >> nth={number - 1}"


def paste(window: Window, text: str) -> None:
    window.page.fill("#friction-text", text)
    window.page.dispatch_event("#friction-text", "change")


def test_a_link_brings_the_curve_back(window: Window) -> None:
    window.open("c=2&v=0.1&curve=0.5,0.02,0.3,0.15,0.45,0.4,0.2,0.6,0.25")
    assert curve(window) == FALLS_TWICE
    window.until("location.hash.includes('curve=0.5,0.02,0.3,0.15')")
    assert "calms down" in window.text("#lead")
    assert "it slides evenly" in window.text("#friction-said")
    # mu_1 must be at most mu_s.
    window.type("mu_s", "0.4")
    assert "mu1 = 0.5 of the curve must be at most μs = 0.4" in window.said("mu_s")
    assert window.setting["mu_s"] == 0.5


def test_points_are_dragged_and_everything_follows(window: Window) -> None:
    before = window.text("#lead")
    assert "at every speed shown" in window.text("#friction-said")
    drag(window, knob(2), 0, 60)
    first, second = curve(window)
    assert first == [0, 0.3]
    assert second[1] < 0.25
    assert window.text("#lead") != before
    assert "--law stribeck --curve curve.csv --k 1000" in window.text("#command")
    assert "--mu-k" not in window.text("#command")
    # Held between its neighbours and mu_s.
    drag(window, knob(1), 30, -400)
    assert curve(window)[0] == [0, 0.5]


def test_keys_move_add_and_remove_points_and_drag_the_speed(window: Window) -> None:
    window.page.click("[data-curve='2']")
    assert curve(window) == FALLS_TWICE
    # What is about constant friction says so: said, cures, maps, questions, theory.
    window.page.locator("text=A friction curve is set; this").nth(4).wait_for(state="attached")
    assert not window.has_nonsense()
    drag(window, "#friction-v", -100, 0)
    assert 0.01 < window.setting["v"] < 0.19
    window.set(v=0.1)
    window.page.locator("#friction-v").press("ArrowRight")
    assert window.setting["v"] == 0.105
    for key in ("ArrowRight", "ArrowUp"):
        window.page.locator(knob(2)).press(key)
    assert curve(window)[1] == [0.021, 0.31]
    spoken = window.part(knob(2), "aria-valuetext").replace("\u00a0", " ")
    assert spoken == "21.00 mm/s, μ 0.31"
    window.page.keyboard.press("Delete")
    assert [u for u, _ in curve(window)] == [0, 0.15, 0.4, 0.6]
    for _ in range(8):
        window.page.click("#point-more")
    assert len(curve(window)) == 12
    assert curve(window) == sorted(curve(window))
    assert window.page.is_disabled("#point-more")
    window.preset("default")
    assert curve(window) is None


def test_a_table_is_pasted_and_saved_as_the_command_reads_it(
    window: Window, tmp_path: Path
) -> None:
    window.page.click("#friction summary")
    paste(window, "# measured\nmu; speed [mm/s]\n0,42; 5\n0,31 ; 50\n\n0,27;100\n")
    assert curve(window) == [[0, 0.42], [0.005, 0.42], [0.05, 0.31], [0.1, 0.27]]
    read = read_curve(window.save("friction-save", tmp_path), None)
    points = zip(read.speeds, read.coefficients, strict=True)
    assert [list(each) for each in points] == curve(window)
    for text, told in (
        ("speed [m/s],mu\n0,0.4\n1,x\n", "Line 3: “x” is not a finite number."),
        ("speed [kg],mu\n0,0.4\n1,0.2\n", "Line 2"),
        ("v [m/s],mu\n0,0.4\n-1,0.2\n", "above 0 m/s"),
        ("v,force\n0,1\n1,2\n", "must name speed and mu"),
        ("v [m/s],mu\n0,0.4\n", "2 to 12"),
        ("v,mu\n0,0.4\n5,0.2\n", "with units: speed [mm/s], mu"),
    ):
        paste(window, text)
        window.until(
            "told => document.querySelector('#friction-bad').textContent.includes(told)", told
        )
    assert len(curve(window)) == 4
