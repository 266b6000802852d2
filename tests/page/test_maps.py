"""The maps of the page: their curves are those of Python, and the point moves the setting."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from stickslip_ref import Parameters, coulomb_limit, steady_cycle
from tests.page.settings import PRESETS, START, Setting, parameters
from tests.page.test_cures import NEAR, loaded_and_lifted
from tests.page.window import Window, another

if TYPE_CHECKING:
    from playwright.sync_api import Browser

REACH = 100.0
"""The curves are asked for from this part of the setting's values to this many times of them."""

_ASK = f"""
settings => settings.map(values => {{
  const page = window.stickslip;
  page.set(values, null);
  const p = page.setting;
  const {{ exists, delta_x, w }} = page.cycle;
  const whole = exists ? delta_x : p.v / w;
  const lines = [0.01, 0.1, 1, 10].map(part => ({{
    jump: part * whole,
    points: page.curves.equalJump(p, part * whole, p.v / {REACH}, p.v * {REACH}),
  }}));
  return {{
    lines,
    jumps: page.curves.jumpOverSpeed(p, p.v / {REACH}, p.v * {REACH}),
    critical: page.curves.criticalCurve(p, p.k / {REACH}, p.k * {REACH}),
    slow: page.curves.slowJump(p),
  }};
}})
"""


def jump_of(values: Setting, **changes: Any) -> Any:
    return np.asarray(steady_cycle(parameters({**values, **changes})).delta_x)


def column(points: list[dict[str, float]], name: str) -> Any:
    return np.array([point[name] for point in points])


def test_each_point_of_each_curve_lies_where_the_reference_puts_it(
    window: Window, sized: Callable[[int], int]
) -> None:
    chosen = [*loaded_and_lifted(sized(1000)), *PRESETS.values()]
    counted = dict.fromkeys(("jump", "end", "limit", "critical", "line"), 0)

    def compare(name: str, found: Any, expected: Any) -> None:
        counted[name] += np.size(found)
        assert found == pytest.approx(expected, rel=NEAR, abs=0.0), (name, values)

    for values, got in zip(chosen, window.js(_ASK, chosen), strict=True):
        p, jumps = parameters(values), got["jumps"]
        v_c = float(coulomb_limit(p))
        assert bool(jumps) == (v_c > p.v / REACH)
        # The last point of a curve that ends lies on the limit, where rounding decides.
        if jumps and jumps[-1]["v"] == pytest.approx(v_c, rel=1e-12):
            compare("end", jumps.pop()["jump"], float(jump_of(values, v=v_c * (1.0 - 1e-12))))
        if jumps:
            compare("jump", column(jumps, "jump"), jump_of(values, v=column(jumps, "v")))
        if p.zeta < 1.0 and p.Delta > 0.0:
            compare("limit", got["slow"], float(jump_of(values, v=1e-14 * float(p.w * p.Delta))))
        if critical := got["critical"]:
            exact = coulomb_limit(parameters({**values, "k": column(critical, "k")}))
            compare("critical", column(critical, "v"), np.asarray(exact))
        for line in (each for each in got["lines"] if each["points"]):
            k, v = column(line["points"], "k"), column(line["points"], "v")
            edge = (
                np.abs(v / np.asarray(coulomb_limit(parameters({**values, "k": k}))) - 1.0) < NEAR
            )
            below = np.where(edge, v * (1.0 - 1e-12), v)
            compare("line", jump_of(values, k=k, v=below), np.full(k.size, line["jump"]))
    assert min(counted.values()) > 30


def middle(window: Window) -> tuple[float, float]:
    window.page.locator("#plane").scroll_into_view_if_needed()
    window.until("document.querySelector('#plane-point').style.transform !== ''")
    window.drawn()
    left, top, width, height = window.box("#plane-point")
    return left + width / 2, top + height / 2


def decade(window: Window) -> tuple[float, float]:
    """Return the pixels of a decade of k and of v: the plot has four of each."""
    width, height = (float(window.part("#plane clipPath rect", n)) for n in ("width", "height"))
    return width / 4, height / 4


def test_dragging_the_point_sets_stiffness_and_speed_alone(window: Window) -> None:
    x, y = middle(window)
    of_k, of_v = decade(window)
    # Not in its middle: the point must not jump to the pointer.
    window.pull(x + 5, y - 4, of_k, 0.5 * of_v)
    after = window.setting
    # Half a pixel at either end, of 70 px a decade.
    assert after["k"] == pytest.approx(1e4, rel=0.02)
    assert after["v"] == pytest.approx(0.02 / math.sqrt(10.0), rel=0.02)
    assert {name for name in after if after[name] != START[name]} == {"k", "v"}
    # A press where the point is not brings it there.
    window.set(**START)
    x, y = middle(window)
    window.page.mouse.click(x - of_k, y + of_v)
    # Half a pixel at either end, of 70 px a decade.
    assert window.setting["k"] == pytest.approx(100.0, rel=0.05)
    assert window.setting["v"] == pytest.approx(0.002, rel=0.05)


def test_a_finger_drags_the_point_and_scrolls_the_page_elsewhere(
    browser: Browser, page_file: Path
) -> None:
    narrow = {"width": 400, "height": 800}
    with another(browser, page_file, viewport=narrow, has_touch=True, is_mobile=True) as window:
        assert window.style("#plane-point", "touchAction") == "none"
        assert "pan-y" in window.style("#plane", "touchAction")
        x, y = middle(window)
        of_k, _ = decade(window)
        session = window.page.context.new_cdp_session(window.page)
        for kind, place in (("Start", [x]), ("Move", [x + 20]), ("Move", [x + of_k]), ("End", [])):
            touch = {"type": f"touch{kind}", "touchPoints": [{"x": each, "y": y} for each in place]}
            session.send("Input.dispatchTouchEvent", touch)
        assert window.setting["k"] == pytest.approx(1e4, rel=0.03)
        assert min(window.box("#plane-point")[2:]) >= 44.0


def test_arrow_keys_move_the_point_by_a_fortieth_of_a_decade(window: Window) -> None:
    middle(window)
    window.page.focus("#plane-point")
    for key, k, v in (
        ("ArrowRight", 0.025, 0.0),
        ("Shift+ArrowUp", 0.0, 0.25),
        ("Home", -2.0, 0.0),
        ("PageDown", 0.0, -0.25),
    ):
        window.set(**START)
        window.page.keyboard.press(key)
        # The value is rounded to what a person reads.
        assert window.setting["k"] == pytest.approx(1000.0 * 10.0**k, rel=0.01), key
        assert window.setting["v"] == pytest.approx(0.02 * 10.0**v, rel=0.01), key
    window.drawn()
    spoken = window.part("#plane-point", "aria-valuetext")
    assert all(word in spoken for word in ("1000", "11.2", "stick-slip"))


HATCH = "#plane [fill='url(#plane-hatch)']"
POINT_IN_HATCH = f"""() => {{
  const [x, y] = document.querySelector("#plane-point").style.transform.match(/-?[\\d.]+/g);
  return document.querySelector("{HATCH}").isPointInFill(new DOMPoint(x, y));
}}"""


def test_the_hatched_region_holds_the_point_just_where_there_is_no_cycle(window: Window) -> None:
    middle(window)
    assert "no critical velocity at any stiffness" in window.text("#plane-said")
    assert window.part(HATCH, "d") == ""
    for c in (2.0, 60.0, 1e5):
        for k in (100.0, 20000.0):
            v_c = float(coulomb_limit(Parameters(c=c, k=k)))
            for v in (1.05 * v_c, 0.95 * v_c) if v_c > 0.0 else (0.002,):
                window.set(c=c, k=k, v=v)
                window.drawn()
                assert window.js(POINT_IN_HATCH) is not window.cycle["exists"], (c, k, v)
