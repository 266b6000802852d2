"""The friction curve as a person uses it: dragged, by keys, pasted, linked."""

from pathlib import Path
from typing import Any

import pytest

from stickslip_design.curve_file import read_curve
from tests.page.test_friction import FALLS_TWICE
from tests.page.window import Window


def curve(window: Window) -> Any:
    """Return the curve in use."""
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


@pytest.mark.parametrize(
    ("bad", "told"),
    [
        ("curve=0.5,0.02", "curve=0.5,0.02 is no number"),
        ("curve=0.6,0.02,0.3", "at most μs"),
        ("curve=0.5,0.02,0.3,0.02,0.1", "above 0.02 m/s"),
        ("curve=0.5", "2 to 12"),
    ],
)
def test_a_link_with_a_curve_that_cannot_be_is_refused(window: Window, bad: str, told: str) -> None:
    window.open(bad)
    assert told in window.text("#address-said")
    assert curve(window) is None


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
    drag(window, knob(1), 30, -60)
    assert curve(window)[0][0] == 0
    assert 0.3 < curve(window)[0][1] <= 0.5
    drag(window, knob(1), 0, -400)
    assert curve(window)[0] == [0, 0.5]


def test_keys_move_add_and_remove_points_and_drag_the_speed(window: Window) -> None:
    assert window.page.locator("text=A friction curve is set").count() == 0
    window.page.click("[data-curve='2']")
    assert curve(window) == FALLS_TWICE
    assert window.setting["c"] == 2.0
    # What is about constant friction says so: said, cures, maps, questions, theory.
    window.page.wait_for_timeout(300)
    assert window.page.locator("text=A friction curve is set; this").count() == 5
    assert window.page.locator("#mu_k-control >> text=Not used").count() == 1
    assert not window.has_nonsense()
    assert "it sticks" in window.text("#friction-said")
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
    for button, presses, points in (("less", 2, 2), ("more", 10, 12)):
        for _ in range(presses):
            window.page.click(f"#point-{button}")
        assert len(curve(window)) == points
        assert curve(window) == sorted(curve(window))
        assert window.page.is_disabled(f"#point-{button}")
    window.preset("default")
    assert curve(window) is None
    window.page.wait_for_timeout(300)
    assert window.page.locator("text=A friction curve is set").count() == 0


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
        ("speed,mu\n0,0.4\n1,x\n", "Line 3: “x” is not a finite number."),
        ("speed [kg],mu\n0,0.4\n1,0.2\n", "Line 2"),
        ("v,mu\n0,0.4\n-1,0.2\n", "above 0 m/s"),
        ("v,mu\n0,0.4\n1,-0.2\n", "0 or more"),
        ("v,mu\n0,0.9\n1,0.2\n", "at most μs = 0.5"),
        ("v,force\n0,1\n1,2\n", "must name speed and mu"),
        ("v,mu\n0,0.4\n", "2 to 12"),
        ("", "must name speed and mu"),
    ):
        paste(window, text)
        window.until(
            "told => document.querySelector('#friction-bad').textContent.includes(told)", told
        )
    assert len(curve(window)) == 4
    # What is drawn again with all detail, once a curve stands still, takes no refusal away.
    paste(window, "v,mu\n0,0.4\n0.1,0.2\n")
    paste(window, "v,mu\n0,x\n")
    window.page.wait_for_timeout(1000)
    assert "“x” is not a finite number" in window.text("#friction-bad")
    assert len(curve(window)) == 2
