"""The common cursor, its read-outs, the moving picture, and play, pause, scrub, speed."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from tests.page import drawing
from tests.page.browser import opened
from tests.page.drawing import PIXEL, SIZES
from tests.page.settings import presets
from tests.page.test_zoom import choose, place
from tests.page.using import drawn, look, pause

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

NUMBER = r"(−?[\d.]+)\s(\S+?)(?:,|$)"
READINGS = {
    "x": ("#x-now", rf"^x {NUMBER}"),
    "x_pull": ("#x-now", rf"pulled end {NUMBER}"),
    "F": ("#F-now", rf"F {NUMBER}"),
    "x_dot": ("#z-now", rf"^ẋ {NUMBER}"),
    "z": ("#z-now", rf"z {NUMBER}"),
}
"""Where each part of the state is read, and how it is written."""
TOLD = {
    "t": rf"^{NUMBER.replace(',|$', ':')}",
    "x": rf"mass at {NUMBER}",
    "x_pull": rf"pulled end at {NUMBER}",
    "F": rf"spring force {NUMBER}",
    "x_dot": rf"velocity {NUMBER}",
}
"""How each part of the state is told to who cannot see it."""


def state(page: Page, t: float) -> dict[str, Any]:
    """Give what the page's numbers say of a time [s]."""
    found: dict[str, Any] = page.evaluate("t => window.stickslip.at(t)", t)
    return found


def check_number(words: str, pattern: str, exact: float) -> None:
    """Hold a quantity in a text against its exact value [SI], to its last shown digit."""
    match = re.search(pattern, words.replace("\u00a0", " "))
    assert match, (pattern, words)
    text, size = match[1], SIZES[match[2]]
    half = 0.5 * 10.0 ** -len(text.partition(".")[2]) * size
    assert abs(float(text.replace("−", "-")) * size - exact) <= 1.001 * half, (pattern, words)


def check_readings(page: Page, t: float) -> None:
    """Hold every read-out against the state at a time, to its last shown digit."""
    exact = state(page, t)
    for name, (selector, pattern) in READINGS.items():
        check_number(page.inner_text(selector), pattern, exact[name])
    assert ("sticks" if exact["mode"] == 0 else "slips") in page.inner_text("#now")


def test_the_cursor_is_one_on_all_charts(page: Page) -> None:
    """Pointed at on one chart, a time is marked on both, and its state in the portrait."""
    pause(page)
    look(page, 0.0, 10.0)
    choose(page, "x-chart", 3.0, 4.0)
    for chart, t in (("x-chart", 3.1), ("F-chart", 3.37), ("F-chart", 3.55), ("x-chart", 3.8)):
        left, top = place(page, chart, t)
        page.mouse.move(round(left), top)
        axis = drawing.time_axis(page)
        at = drawing.cursor(page, "x-chart")
        assert drawing.cursor(page, "F-chart") == at == drawing.dot(page, "x-chart")[0]
        # The pointer stands on a whole pixel.
        assert abs(at - axis.place(t)) <= 0.5 + PIXEL
        box = page.locator(f"#{chart}").bounding_box()
        assert box is not None
        pointed = axis.time(round(left) - box["x"])
        check_readings(page, pointed)
        check_marks(page, pointed)


def check_marks(page: Page, t: float) -> None:
    """Hold the marks on all charts against the state at a time, read off by the labels."""
    exact = state(page, t)
    wanted: list[tuple[str, Literal["x", "y"], str]] = [
        ("x-chart", "y", "x"),
        ("F-chart", "y", "F"),
        ("phase-chart", "x", "z"),
        ("phase-chart", "y", "x_dot"),
    ]
    for chart, direction, name in wanted:
        spot = drawing.dot(page, chart)["xy".index(direction)]
        value, slack = drawing.value_at(page, chart, direction, spot)
        assert abs(value - exact[name]) <= slack, (chart, name)


def test_the_read_outs_are_right_in_every_preset(page: Page) -> None:
    """From microseconds to years, what is read at the cursor is the state there, well resolved."""
    pause(page)
    for name in presets():
        page.click(f"[data-preset={name}]")
        readings = set()
        for step in (0, 137, 500, 611, 1000):
            page.fill("#scrub", str(step))
            drawn(page)
            axis = drawing.time_axis(page)
            check_readings(page, axis.start + step / 1000 * axis.span)
            readings.add(page.inner_text("#x-now") + page.inner_text("#now"))
        assert len(readings) == 5, name


def test_the_scrubber_moves_the_cursor_by_mouse_and_by_key(page: Page) -> None:
    """Half of the scrubber is half of what is seen; a key moves it; it stops the playing."""
    look(page, 0.0, 10.0)
    page.fill("#scrub", "500")
    assert page.text_content("#play") == "Play"
    check_readings(page, 5.0)
    assert abs(drawing.cursor(page, "x-chart") - drawing.time_axis(page).place(5.0)) <= PIXEL
    page.press("#scrub", "ArrowRight")
    check_readings(page, 5.01)
    spoken = page.get_attribute("#scrub", "aria-valuetext") or ""
    assert "5.01" in spoken
    for word in ("mass at", "pulled end at", "spring force", "velocity", "mm", "N"):
        assert word in spoken
    page.press("#scrub", "Home")
    check_readings(page, 0.0)


def test_who_cannot_see_is_told_the_state_at_the_cursor(page: Page) -> None:
    """In stick and in slip the words of the scrubber are that state's, to their last digit."""
    pause(page)
    for name in ("default", "violin-bow", "machine-slideway"):
        page.click(f"[data-preset={name}]")
        modes = set()
        for step in range(0, 500, 23):
            page.fill("#scrub", str(step))
            check_told(page)
            modes.add(state(page, cursor_time(page))["mode"])
        assert len(modes) == 2


def test_what_is_told_is_back_after_a_pause(page: Page) -> None:
    """Paused, the scrubber tells the state at which the cursor stopped."""
    page.wait_for_function("Number(document.querySelector('#scrub').value) > 5")
    page.click("#play")
    assert page.inner_text("#play") == "Play"
    check_told(page, near=True)


def cursor_time(page: Page) -> float:
    """Give the time of the cursor where the scrubber was put [s]."""
    axis = drawing.time_axis(page)
    return axis.start + float(page.input_value("#scrub")) / 1000.0 * axis.span


def check_told(page: Page, near: bool = False) -> None:
    """Hold the words of the scrubber against the state there; near: only to a step of it."""
    words = page.get_attribute("#scrub", "aria-valuetext") or ""
    exact = state(page, cursor_time(page))
    if near:
        match = re.search(TOLD["t"], words.replace("\u00a0", " "))
        assert match, words
        told = float(match[1]) * SIZES[match[2]]
        assert abs(told - exact["t"]) <= drawing.time_axis(page).span / 1000.0
        return
    for name, pattern in TOLD.items():
        check_number(words, pattern, exact[name])
    assert ("sticks" if exact["mode"] == 0 else "slips") in words


def test_play_and_pause(page: Page) -> None:
    """Playing moves the cursor from frame to frame; paused it stands, and the button says which."""
    assert page.inner_text("#play") == "Pause"
    before = drawing.cursor(page, "x-chart")
    page.wait_for_function(
        "d => document.querySelector('#x-chart .cursor').getAttribute('d') !== d",
        arg=page.get_attribute("#x-chart .cursor", "d"),
    )
    page.press("#play", "Space")
    assert page.inner_text("#play") == "Play"
    assert page.text_content("#play") == "Play"
    stopped = drawing.cursor(page, "x-chart")
    for _ in range(3):
        drawn(page)
    assert drawing.cursor(page, "x-chart") == stopped != before
    page.press("#play", "Enter")
    assert page.text_content("#play") == "Pause"


def test_a_pointer_holds_the_motion_and_lets_it_go_on(page: Page) -> None:
    """Over a chart the cursor stays at the pointer; off it, what played plays on."""
    left, top = place(page, "x-chart", drawing.time_axis(page).time(300.0))
    page.mouse.move(round(left), top)
    drawn(page)
    held = page.get_attribute("#x-chart .cursor", "d")
    for _ in range(3):
        drawn(page)
    assert page.get_attribute("#x-chart .cursor", "d") == held
    page.mouse.move(2, 2)
    goes = "d => document.querySelector('#x-chart .cursor').getAttribute('d') !== d"
    page.wait_for_function(goes, arg=held)
    moved = page.get_attribute("#x-chart .cursor", "d")
    page.wait_for_function(goes, arg=moved)
    assert page.inner_text("#play") == "Pause"


def test_the_speed_is_as_it_says(page: Page) -> None:
    """A second of a clock moves the cursor a second, a part of it, or a tenth of the view."""
    pause(page)
    look(page, 0.0, 2.5)
    span = drawing.time_axis(page).span
    page.clock.install(time=0)
    page.clock.pause_at(1000)
    for speed, per_second in {"1": 1.0, "0.25": 0.25, "0.01": 0.01, "view": span / 10.0}.items():
        page.select_option("#speed", speed)
        page.fill("#scrub", "0")
        page.click("#play")
        page.clock.run_for(1000)
        page.click("#play")
        axis = drawing.time_axis(page)
        moved = axis.time(drawing.cursor(page, "x-chart")) - axis.start
        # A frame of 16 ms may be under way at either end, and a pixel is 1/width of the span.
        assert abs(moved - per_second) <= 0.034 * per_second + PIXEL * span / axis.width


def test_stick_and_slip_are_told_apart_without_colour(page: Page) -> None:
    """A word in the block, its teeth in the ground or above it, streaks behind it."""
    pause(page)
    seen = {phase.kind: phase for phase in drawing.phases(page)[2:4]}
    for kind, phase in seen.items():
        page.mouse.move(*place(page, "x-chart", 0.5 * (phase.start + phase.end)))
        drawn(page)
        assert page.text_content("#schematic .mass text") == kind.upper()
        lifted = page.get_attribute("#schematic .mass g", "transform")
        assert (lifted == "translate(0 0)") is (kind == "stick")
        assert bool(page.get_attribute("#schematic .streaks", "d")) is (kind == "slip")


def test_the_spring_stretches_and_the_mass_moves_as_computed(page: Page) -> None:
    """In the schematic the mass goes only in slip, and the spring is longest near break-away."""
    pause(page)
    (stick, slip) = drawing.phases(page)[2:4]
    if stick.kind != "stick":
        (slip, stick) = (stick, drawing.phases(page)[3])

    def at(t: float) -> tuple[str | None, float]:
        page.evaluate(
            """t => {
              const chart = document.querySelector("#x-chart");
              const { left } = chart.getBoundingClientRect();
              const clip = chart.querySelector("clipPath rect");
              const { from, to } = window.stickslip.view;
              const share = (t - from) / (to - from);
              const clientX = left + +clip.getAttribute("x") + share * clip.getAttribute("width");
              chart.dispatchEvent(new PointerEvent("pointermove", { clientX }));
            }""",
            t,
        )
        points = (page.get_attribute("#schematic .spring", "points") or "").split()
        ends = [float(points[i].split(",")[0]) for i in (0, -1)]
        return page.get_attribute("#schematic .mass", "transform"), ends[1] - ends[0]

    early, late = (at(stick.start + part * (stick.end - stick.start)) for part in (0.1, 0.9))
    slipping = at(slip.start + 0.5 * (slip.end - slip.start))
    assert early[0] == late[0] != slipping[0]
    assert late[1] > early[1]


def test_who_wants_less_motion_gets_none(browser: Browser, page_file: Path) -> None:
    """With prefers-reduced-motion nothing moves by itself; who presses Play has asked for it."""
    with opened(browser, page_file, reduced_motion="reduce") as page:
        changed = page.evaluate(
            """async () => {
              let changes = 0;
              const watch = new MutationObserver(all => (changes += all.length));
              const all = { attributes: true, childList: true, characterData: true, subtree: true };
              watch.observe(document.querySelector("#stage"), all);
              for (let i = 0; i < 20; i++) await new Promise(requestAnimationFrame);
              return changes + document.getAnimations().length;
            }"""
        )
        assert changed == 0
        assert page.inner_text("#play") == "Play"
        before = page.get_attribute("#x-chart .cursor", "d")
        page.click("#play")
        page.wait_for_function(
            "d => document.querySelector('#x-chart .cursor').getAttribute('d') !== d", arg=before
        )
