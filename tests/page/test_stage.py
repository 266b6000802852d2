"""The block and the cursor: what is drawn and read at a time is the state at that time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pytest

from tests.page import drawing
from tests.page.drawing import PIXEL, place, quantity
from tests.page.settings import PRESETS
from tests.page.window import Window, another

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Browser

READ = {"x": ("#x-now", "^x "), "x_pull": ("#x-now", "pulled end "), "F": ("#F-now", "F ")} | {
    "x_dot": ("#z-now", "^ẋ "),
    "z": ("#z-now", "z "),
}
"""Where each part of the state is read, and what stands before it."""
_STAGE = """
shares => {
  const scrub = document.querySelector("#scrub");
  const schematic = document.querySelector("#schematic");
  const part = (selector, name) => schematic.querySelector(selector).getAttribute(name);
  const number = (selector, name) => Number(part(selector, name).match(/-?[\\d.]+/)[0]);
  const { from, to } = window.stickslip.view;
  return shares.map(share => {
    scrub.value = 1000 * share;
    scrub.dispatchEvent(new Event("input", { bubbles: true }));
    const points = part(".spring", "points").split(" ").map(each => Number(each.split(",")[0]));
    return {
      state: window.stickslip.at(from + scrub.value / 1000 * (to - from)),
      block: number(".mass", "transform"), wide: number(".mass rect", "width"),
      spring: [points[0], points.at(-1)], gauge: number(".gauge", "transform"),
      bar: [number(".bar", "x"), number(".bar", "width")], limit: number(".limit", "d"),
      places: (part(".places", "d").match(/M[-\\d.]+/g) ?? []).map(each => Number(each.slice(1))),
      word: schematic.querySelector(".mass text").textContent,
      lifted: part(".mass g", "transform") !== "translate(0 0)", streaks: part(".streaks", "d"),
    };
  });
}
"""


def stage(window: Window, shares: list[float] | None = None) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = window.js(_STAGE, shares or [n / 40 for n in range(40)])
    return found


def test_block_spring_and_force_bar_are_drawn_to_one_scale(window: Window) -> None:
    for name in PRESETS:
        window.preset(name)
        moments = stage(window)
        x, pull, z = (np.array([m["state"][n] for m in moments]) for n in ("x", "x_pull", "z"))
        block, wide, gauge, limit = (
            np.array([m[n] for m in moments]) for n in ("block", "wide", "gauge", "limit")
        )
        left, right = np.array([m["spring"] for m in moments]).T
        bar, length = np.array([m["bar"] for m in moments]).T
        per_metre = (block[-1] - block[0]) / (x[-1] - x[0])
        # A pushed spring has its bar on the other side of no force.
        end = bar + np.where(z > 0.0, length, 0.0)
        # The mark F_s is ahead by the extension that is missing to break-away.
        missing = window.cycle["F_s"] / window.setting["k"] - z
        for one, other in (
            (block - block[0], per_metre * (x - x[0])),
            (right - right[0], per_metre * (pull - pull[0])),
            (left, block + wide),
            (gauge + end, right),
            (limit - end, per_metre * missing),
        ):
            # Each of up to four places is rounded.
            assert one == pytest.approx(other, abs=4 * PIXEL), name


def test_stick_and_slip_are_told_apart_and_the_marks_are_whole_jumps_behind(window: Window) -> None:
    moments = stage(window)
    (a, x_a), (b, x_b) = ((moments[n]["block"], moments[n]["state"]["x"]) for n in (0, -1))
    jump = (b - a) / (x_b - x_a) * window.cycle["delta_x"]
    for each in moments:
        sticks = each["state"]["mode"] == 0
        # By a word, by the teeth, by streaks: without colour.
        assert each["word"] == ("STICK" if sticks else "SLIP")
        assert (each["lifted"], bool(each["streaks"])) == (not sticks, not sticks)
        behind = [*each["places"], each["block"]] if sticks else each["places"]
        assert np.diff(behind) == pytest.approx(jump, abs=3 * PIXEL)
        assert all(mark < each["block"] for mark in each["places"])
    assert max(len(each["places"]) for each in moments) == 6


def check_readings(window: Window, t: float) -> Any:
    """Hold what is read and told at the cursor against the state there, to its last digit."""
    window.drawn()
    (exact,) = window.states([t])
    word = "sticks" if exact["mode"] == 0 else "slips"
    for name, (selector, before) in READ.items():
        found, half = quantity(window.page.inner_text(selector), before)
        assert found == pytest.approx(exact[name], abs=half), name
    assert word in window.page.inner_text("#now")
    # Who cannot see it is told the same.
    spoken = window.part("#scrub", "aria-valuetext")
    found, half = quantity(spoken, "mass at ")
    assert found == pytest.approx(exact["x"], abs=half, rel=1e-12)
    assert word in spoken
    return exact


def test_the_cursor_reads_the_state_in_every_preset(window: Window) -> None:
    for name in PRESETS:
        window.preset(name)
        readings = set()
        for step in (0, 137, 611):
            window.page.fill("#scrub", str(step))
            axis = drawing.time_axis(window)
            check_readings(window, axis.start + step / 1000 * axis.span)
            readings.add(window.text("#x-now") + window.text("#now"))
        assert len(readings) == 3, name
    # A key moves it by a step; a new value changes at once what is told of the same time.
    window.set(**PRESETS["default"])
    window.look(0.0, 10.0)
    window.page.fill("#scrub", "600")
    window.page.press("#scrub", "ArrowRight")
    window.type("v", "25")
    check_readings(window, 6.01)


def test_pointed_at_on_one_chart_a_time_is_marked_on_all(window: Window) -> None:
    window.look(3.0, 4.0)
    marks: list[tuple[str, Literal["x", "y"], str]] = [
        ("x-chart", "y", "x"),
        ("F-chart", "y", "F"),
        ("phase-chart", "x", "z"),
        ("phase-chart", "y", "x_dot"),
    ]
    for chart, t in (("x-chart", 3.1), ("F-chart", 3.55)):
        left, top = place(window, chart, t)
        # The pointer stands on a whole pixel.
        window.page.mouse.move(round(left), top)
        pointed = drawing.time_axis(window).time(round(left) - window.box(f"#{chart}")[0])
        assert drawing.cursor(window) == drawing.dot(window, "x-chart")[0]
        assert abs(drawing.cursor(window) - drawing.time_axis(window).place(pointed)) <= PIXEL
        exact = check_readings(window, pointed)
        for where, axis, name in marks:
            spot = drawing.dot(window, where)["xy".index(axis)]
            found, slack = drawing.value_at(window, where, axis, spot)
            assert found == pytest.approx(exact[name], abs=slack), (where, name)


MOVES = "d => document.querySelector('#x-chart .cursor').getAttribute('d') !== d"


def test_the_cursor_plays_by_itself_stops_and_is_held_by_a_pointer(window: Window) -> None:
    def now() -> str:
        window.drawn()
        return window.part("#x-chart .cursor", "d")

    # Who wants less motion gets none until it is asked for.
    assert now() == now()
    window.page.click("#play")
    window.until(MOVES, now())
    window.open(motion="no-preference")
    assert window.page.inner_text("#play") == "Pause"
    window.until(MOVES, now())
    window.page.mouse.move(*place(window, "x-chart", drawing.time_axis(window).time(300.0)))
    assert now() == now()
    window.page.mouse.move(2, 2)
    window.until(MOVES, now())
    window.page.press("#play", "Space")
    assert window.page.inner_text("#play") == "Play"
    assert now() == now()
    window.page.press("#play", "Enter")
    window.until(MOVES, now())
    window.page.fill("#scrub", "732")
    assert window.page.inner_text("#play") == "Play"
    assert now() == now()


def test_the_speed_is_as_it_says(browser: Browser, page_file: Path) -> None:
    with another(browser, page_file) as window:
        window.look(0.0, 2.5)
        axis = drawing.time_axis(window)
        clock = window.page.clock
        clock.install(time=0)
        clock.pause_at(1000)
        for speed, expected in {"1": 1.0, "0.25": 0.25, "0.01": 0.01, "view": 0.25}.items():
            window.page.select_option("#speed", speed)
            window.page.fill("#scrub", "0")
            window.page.click("#play")
            clock.run_for(1000)
            window.page.click("#play")
            moved = axis.time(drawing.start_of(window, "#x-chart .cursor")[0])
            # A frame of 16 ms may be under way at either end; a pixel is 1/width of the span.
            slack = 0.034 * expected + PIXEL * axis.span / axis.width
            assert moved == pytest.approx(expected, abs=slack)


def test_the_setting_before_stays_as_a_ghost_until_it_is_removed(window: Window) -> None:
    before = window.cycle
    window.js("stickslip.compare({ k: 2000 })")
    window.drawn()
    first, second, *_ = drawing.lines(window, "#x-chart .curve.ghost")
    own, next_own, *_ = drawing.lines(window, "#x-chart .curve.mass")
    # It is as long and as high as it was.
    for rise, name in ((1, "delta_x"), (0, "T")):
        moved, own_moved = (
            b.start[rise] - a.start[rise] for a, b in ((first, second), (own, next_own))
        )
        # Of two distances of 30 px or more, each to a fiftieth.
        assert moved / own_moved == pytest.approx(before[name] / window.cycle[name], abs=0.01)
    window.page.click("#forget")
    window.drawn()
    assert drawing.curve(window, "#x-chart .curve.ghost") == []
