"""The friction curve as a person uses it: dragged, by keys, pasted, linked, and how fast it is."""

from __future__ import annotations

import statistics
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from stickslip_design.curve_file import read_curve
from tests.page.browser import opened
from tests.page.test_friction import FALLS_TWICE
from tests.page.using import drawn, pause, set_values, setting, text_of, type_in

if TYPE_CHECKING:
    from playwright.sync_api import Browser, CDPSession, Locator, Page

LINK = "c=2&v=0.1&curve=0.5,0.02,0.3,0.15,0.45,0.4,0.2,0.6,0.25"
CURVE = [list(point) for point in FALLS_TWICE]
REDRAW = 16.0
"""From a change of the curve to the last line drawn, median [ms]: a frame at 60 a second."""


def curve(page: Page) -> Any:
    """Give the curve in use."""
    return page.evaluate("window.stickslip.curve")


def knob(page: Page, number: int) -> Locator:
    """Give the knob of a point, from 1."""
    return page.locator("#friction-plot .knob").nth(number - 1)


def drag(page: Page, what: Locator, dx: float, dy: float) -> None:
    """Drag with the mouse by so many pixels."""
    what.scroll_into_view_if_needed()
    drawn(page)
    box = what.bounding_box()
    assert box is not None
    assert (box["width"], box["height"]) == (44, 44)
    x, y = box["x"] + 22, box["y"] + 22
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + dx, y + dy, steps=5)
    page.mouse.up()
    drawn(page)


def test_a_link_brings_the_curve_back(browser: Browser, page_file: Path) -> None:
    """With all its digits; a curve that cannot be is named and not taken."""
    with opened(browser, page_file, fragment=LINK) as page:
        assert curve(page) == CURVE
        page.wait_for_function("location.hash.includes('curve=0.5,0.02,0.3,0.15')")
        assert "calms down" in page.inner_text("#lead")
        assert "it slides evenly" in text_of(page, "#friction-said")
    for bad, told in (
        ("curve=0.5,0.02", "curve=0.5,0.02 is no number"),
        ("curve=0.6,0.02,0.3", "at most μs"),
        ("curve=0.5,0.02,0.3,0.02,0.1", "above 0.02 m/s"),
        ("curve=0.5", "2 to 12"),
    ):
        with opened(browser, page_file, fragment=bad) as page:
            assert told in text_of(page, "#address-said")
            assert curve(page) is None


def test_points_are_dragged_and_everything_follows(page: Page) -> None:
    """The first drag makes the constant a curve; motion, words, bar and command follow it."""
    pause(page)
    page.locator("#friction").scroll_into_view_if_needed()
    drawn(page)
    before = text_of(page, "#lead")
    assert "at every speed shown" in text_of(page, "#friction-said")
    drag(page, knob(page, 2), 0, 60)
    found = curve(page)
    assert len(found) == 2
    assert found[0] == [0, 0.3]
    assert found[1][1] < 0.25
    assert text_of(page, "#lead") != before
    assert "--law stribeck --curve curve.csv --k 1000" in page.inner_text("#command")
    assert "--mu-k" not in page.inner_text("#command")
    drag(page, knob(page, 1), 30, -60)
    assert curve(page)[0][0] == 0
    assert 0.3 < curve(page)[0][1] <= 0.5
    drag(page, knob(page, 1), 0, -400)
    assert curve(page)[0] == [0, 0.5]


def test_keys_move_add_and_remove_points(page: Page) -> None:
    """Arrow keys move a point, Delete removes it; there are never fewer than 2 nor more than 12."""
    page.click("[data-curve='2']")
    drawn(page)
    assert curve(page) == CURVE
    assert setting(page)["c"] == 2.0
    knob(page, 2).focus()
    for key in ("ArrowRight", "ArrowUp"):
        page.keyboard.press(key)
    assert curve(page)[1] == [0.021, 0.31]
    drawn(page)
    value = knob(page, 2).get_attribute("aria-valuetext")
    assert value is not None
    assert value.replace("\u00a0", " ") == "21.00 mm/s, μ 0.31"
    page.keyboard.press("Delete")
    assert [u for u, _ in curve(page)] == [0, 0.15, 0.4, 0.6]
    for _ in range(2):
        page.click("#point-less")
    assert len(curve(page)) == 2
    drawn(page)
    assert page.is_disabled("#point-less")
    for _ in range(10):
        page.click("#point-more")
    found = curve(page)
    assert len(found) == 12
    assert found == sorted(found)
    drawn(page)
    assert page.is_disabled("#point-more")
    page.click("[data-curve='']")
    assert curve(page) is None


def test_the_speed_is_dragged_along_the_bar(page: Page) -> None:
    """The knob under the bar, and its arrow keys, set the pulling velocity."""
    page.click("[data-curve='2']")
    drawn(page)
    assert "it sticks" in text_of(page, "#friction-said")
    drag(page, page.locator("#friction-v"), -100, 0)
    assert 0.01 < setting(page)["v"] < 0.19
    set_values(page, v=0.1)
    assert "it slides evenly" in text_of(page, "#friction-said")
    page.locator("#friction-v").focus()
    page.keyboard.press("ArrowRight")
    assert setting(page)["v"] == 0.105
    assert curve(page) == CURVE


def test_a_table_is_pasted_and_saved_as_the_command_reads_it(page: Page, tmp_path: Path) -> None:
    """Units, separators and comments as in --curve; what is wrong is told with its line."""
    page.click("#friction summary")
    page.fill("#friction-text", "# measured\nmu; speed [mm/s]\n0,42; 5\n0,31 ; 50\n\n0,27;100\n")
    page.dispatch_event("#friction-text", "change")
    assert curve(page) == [[0, 0.42], [0.005, 0.42], [0.05, 0.31], [0.1, 0.27]]
    with page.expect_download() as download:
        page.click("#friction-save")
    file = tmp_path / "curve.csv"
    download.value.save_as(file)
    read = read_curve(file, None)
    assert [list(each) for each in zip(read.speeds, read.coefficients, strict=True)] == curve(page)
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
        page.fill("#friction-text", text)
        page.dispatch_event("#friction-text", "change")
        page.wait_for_function(
            "told => document.querySelector('#friction-bad').textContent.includes(told)", arg=told
        )
    assert len(curve(page)) == 4
    # What is drawn again with all detail, once a curve stands still, takes no refusal away.
    page.fill("#friction-text", "v,mu\n0,0.4\n0.1,0.2\n")
    page.dispatch_event("#friction-text", "change")
    page.fill("#friction-text", "v,mu\n0,x\n")
    page.dispatch_event("#friction-text", "change")
    page.wait_for_timeout(1000)
    assert "“x” is not a finite number" in text_of(page, "#friction-bad")
    assert len(curve(page)) == 2


def test_what_is_about_constant_friction_says_so(page: Page) -> None:
    """While a curve is set: said, cures, maps, questions, theory, and the slider of mu_k."""
    assert page.locator("text=A friction curve is set").count() == 0
    page.click("[data-curve='2']")
    drawn(page)
    page.wait_for_timeout(300)
    assert page.locator("text=A friction curve is set; this").count() == 5
    assert page.locator("#mu_k-control >> text=Not used").count() == 1
    assert "NaN" not in page.inner_text("body")
    page.click("[data-preset=default]")
    drawn(page)
    page.wait_for_timeout(300)
    assert curve(page) is None
    assert page.locator("text=A friction curve is set").count() == 0


def test_static_friction_is_not_taken_below_the_curve(page: Page) -> None:
    """mu_1 must be at most mu_s: what is typed is refused with the reason."""
    page.click("[data-curve='2']")
    type_in(page, "mu_s", "0.4")
    assert "mu1 = 0.5 of the curve must be at most μs = 0.4" in page.inner_text(
        "#mu_s-control .said"
    )
    assert setting(page)["mu_s"] == 0.5


@pytest.mark.parametrize("preset", [1, 2])
def test_a_drag_is_redrawn_within_a_frame(page: Page, preset: int) -> None:
    """From the move of the pointer to the last line, with the section in sight."""
    pause(page)
    page.click(f"[data-curve='{preset}']")
    page.locator("#friction").scroll_into_view_if_needed()
    page.wait_for_timeout(500)
    session = page.context.new_cdp_session(page)
    # The page's own computing time: what else the machine does is not in it.
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    times = []
    for n in range(15):
        before = busy(session)
        page.evaluate(
            """n => {
              const { curve, setting } = window.stickslip;
              for (let each = 0; each < 10; each++) {
                const factor = (each + n) % 2 ? 0.99 : 1 / 0.99;
                const next = curve.map(([u, mu], i) => [u, i === 2 ? mu * factor : mu]);
                window.stickslip.set(setting, next);
                document.body.offsetHeight;
              }
            }""",
            n,
        )
        times.append((busy(session) - before) / 10.0)
    assert statistics.median(times) < REDRAW


def busy(session: CDPSession) -> float:
    """Give the time that the page's thread has computed for [ms]."""
    metrics = session.send("Performance.getMetrics")["metrics"]
    return 1e3 * next(float(each["value"]) for each in metrics if each["name"] == "TaskDuration")
