"""The maps of the page: their curves are those of Python, and the point moves the setting."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from stickslip_ref import Parameters, coulomb_limit, steady_cycle
from tests.page import drawing, settings
from tests.page.browser import opened, planted
from tests.page.exchange import ask
from tests.page.test_cures import NEAR, every_setting, parameters
from tests.page.using import drawn as on_screen
from tests.page.using import set_values, setting, text_of

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

REACH = 100.0
"""The curves are asked for from this part of the setting's values to this many times of them."""

_ASK = f"""
settings => settings.map(values => {{
  const page = window.stickslip;
  page.set(values);
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


def blocks(p: Parameters, **changes: Any) -> Parameters:
    """Give the block with arrays in place of some of its values."""
    names = ("m", "g", "load", "k", "c", "mu_s", "v")
    values = {name: getattr(p, name) for name in names} | {"mu_k": p.mu_k_used} | changes
    return Parameters(**values)


def column(points: list[dict[str, float]], name: str) -> Any:
    """Give one coordinate of the points."""
    return np.array([point[name] for point in points])


def errors(page: Page, every: int = 1) -> dict[str, float]:
    """Give the largest relative error of each kind of curve against Python; see test_cures."""
    chosen = every_setting()[::every]
    worst = dict.fromkeys(("jump", "limit", "critical", "line", "end"), 0.0)
    counted = dict.fromkeys(worst, 0)

    def note(name: str, found: Any, wanted: Any) -> None:
        found, wanted = np.atleast_1d(found), np.atleast_1d(wanted)
        if found.size:
            with np.errstate(divide="ignore", invalid="ignore"):
                gap = np.where(found == wanted, 0.0, np.abs(found - wanted) / np.abs(wanted))
            worst[name] = max(worst[name], float(np.nan_to_num(gap, nan=math.inf).max()))
            counted[name] += found.size

    answers = ask(page, _ASK, [dict(each) for each in chosen])
    for values, got in zip(chosen, answers, strict=True):
        p = parameters(values)
        v_c = float(coulomb_limit(p))
        jumps = got["jumps"]
        assert bool(jumps) == (v_c > p.v / REACH)
        # The last point of a curve that ends lies on the limit, where rounding decides.
        ends = bool(jumps) and jumps[-1]["v"] == pytest.approx(v_c, rel=1e-12)
        inside = jumps[:-1] if ends else jumps
        if inside:
            exact = steady_cycle(blocks(p, v=column(inside, "v"))).delta_x
            note("jump", column(inside, "jump"), exact)
        if ends:
            below = steady_cycle(blocks(p, v=v_c * (1.0 - 1e-12))).delta_x
            note("end", jumps[-1]["jump"], below)
        if p.zeta < 1.0 and p.Delta > 0.0:
            slow = steady_cycle(blocks(p, v=1e-14 * float(p.w * p.Delta))).delta_x
            note("limit", got["slow"], slow)
        if got["critical"]:
            exact = coulomb_limit(blocks(p, k=column(got["critical"], "k")))
            note("critical", column(got["critical"], "v"), exact)
        for line in got["lines"]:
            points = line["points"]
            if not points:
                continue
            k, v = column(points, "k"), column(points, "v")
            assert (np.diff(v) > 0.0).all()
            assert (np.diff(k) >= 0.0).all()
            found = np.asarray(steady_cycle(blocks(p, k=k, v=v)).delta_x)
            edge = np.abs(v / np.asarray(coulomb_limit(blocks(p, k=k))) - 1.0) < NEAR
            note("line", found[~edge], np.full(int((~edge).sum()), line["jump"]))
            if edge.any():
                near = steady_cycle(blocks(p, k=k[edge], v=v[edge] * (1.0 - 1e-12))).delta_x
                note("end", near, np.full(int(edge.sum()), line["jump"]))
    assert min(counted.values()) > 100 / every
    return worst


def test_the_curves_are_those_of_python(page: Page) -> None:
    """At 300 settings each point of each curve lies where the reference puts it."""
    assert {name: e for name, e in errors(page).items() if not e <= NEAR} == {}


FAULTS = {
    "jump without the pull": (
        "jump: (v / w) * (Number.isNaN(period)",
        "jump: (v / w) * 1.00000001 * (Number.isNaN(period)",
        "jump",
    ),
    "limit without damping": ("Delta * (1 + Math.exp(", "Delta * (1 + Math.exp(0 * ", "limit"),
    "critical curve of another k": (
        "return { k, v: criticalVelocity({ ...p, k }) };\n  })",
        "return { k, v: criticalVelocity({ ...p, k: 1.0000001 * k }) };\n  })",
        "critical",
    ),
    "line of another jump": (
        "Math.log(((v / w) * period) / jump)",
        "Math.log(((v / w) * period * 1.0000001) / jump)",
        "line",
    ),
}
"""Faults to plant: a piece of the page's script, what to put there, what must give it away."""


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found(
    browser: Browser, page_file: Path, tmp_path: Path, name: str
) -> None:
    """The comparison refutes a wrong curve, be it in the eighth digit."""
    piece, fault, gives_away = FAULTS[name]
    with planted(browser, page_file, tmp_path, piece, fault) as page:
        assert not errors(page, every=6)[gives_away] <= NEAR


def middle(page: Page) -> tuple[float, float]:
    """Give the middle of the point [px] in the window."""
    page.locator("#plane").scroll_into_view_if_needed()
    page.wait_for_function("document.querySelector('#plane-point').style.transform !== ''")
    on_screen(page)
    box = page.locator("#plane-point").bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def decade(page: Page) -> tuple[float, float]:
    """Give the pixels of a decade of k and of v, from the ends of the plot and its four decades."""
    clip = page.locator("#plane clipPath rect")
    width, height = (float(clip.get_attribute(name) or "") for name in ("width", "height"))
    return width / 4, height / 4


def test_the_dot_lies_on_the_curve_of_the_jump(page: Page) -> None:
    """The setting in use is a point of the exact curve, not of the handbooks' constant."""
    middle(page)
    for values in ({}, {"v": 0.1}, {"c": 5.0, "v": 0.03}):
        set_values(page, **values)
        on_screen(page)
        path = page.get_attribute("#jump-map .curve.mass", "d") or ""
        ends = [(each.start, each.end) for each in drawing.pieces(path)]
        x, y = drawing.dot(page, "jump-map")
        ((x_0, y_0), (x_1, y_1)) = next(each for each in ends if each[0][0] <= x <= each[1][0])
        on_curve = y_0 + (y_1 - y_0) * (x - x_0) / (x_1 - x_0)
        # The curve is of straight lines between its points.
        assert y == pytest.approx(on_curve, abs=0.5), values


def test_dragging_the_point_sets_stiffness_and_speed(page: Page) -> None:
    """A decade to the right is ten times the stiffness, half a decade down 0.316 of the speed."""
    x, y = middle(page)
    of_k, of_v = decade(page)
    before = setting(page)
    # Not in its middle: the point must not jump to the pointer.
    page.mouse.move(x + 5, y - 4)
    page.mouse.down()
    page.mouse.move(x + 5 + of_k, y - 4 + 0.5 * of_v, steps=6)
    assert middle(page) == pytest.approx((x + of_k, y + 0.5 * of_v), abs=1.0)
    page.mouse.up()
    after = setting(page)
    assert after["k"] == pytest.approx(10.0 * before["k"], rel=0.02)
    assert after["v"] == pytest.approx(before["v"] / math.sqrt(10.0), rel=0.02)
    assert {name for name in after if after[name] != before[name]} == {"k", "v"}


def test_a_finger_drags_the_point_and_scrolls_the_page_elsewhere(
    browser: Browser, page_file: Path
) -> None:
    """The point alone takes touches for itself; a touch on the plane scrolls."""
    with opened(browser, page_file, width=400, has_touch=True, is_mobile=True) as page:
        action = "e => getComputedStyle(e).touchAction"
        assert page.eval_on_selector("#plane-point", action) == "none"
        assert "pan-y" in page.eval_on_selector("#plane", action)
        x, y = middle(page)
        of_k, _ = decade(page)
        before = setting(page)
        session = page.context.new_cdp_session(page)
        for kind, place in (("touchStart", x), ("touchMove", x + 20), ("touchMove", x + of_k)):
            session.send(
                "Input.dispatchTouchEvent",
                {"type": kind, "touchPoints": [{"x": place, "y": y}]},
            )
        session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        assert setting(page)["k"] == pytest.approx(10.0 * before["k"], rel=0.03)
        box = page.locator("#plane-point").bounding_box()
        assert box is not None
        assert min(box["width"], box["height"]) >= 44.0


def test_arrow_keys_move_the_point(page: Page) -> None:
    """Left and right change k, up and down v; forty steps to a decade; the words tell both."""
    middle(page)
    before = setting(page)
    page.focus("#plane-point")
    for _ in range(40):
        page.keyboard.press("ArrowRight")
    assert setting(page)["k"] == pytest.approx(10.0 * before["k"], rel=0.03)
    assert setting(page)["v"] == before["v"]
    for key, k, v in (
        ("Shift+ArrowLeft", -0.25, 0.0),
        ("Shift+ArrowUp", 0.0, 0.25),
        ("ArrowDown", 0.0, -0.025),
        ("PageUp", 0.0, 0.25),
        ("PageDown", 0.0, -0.25),
    ):
        now = setting(page)
        page.keyboard.press(key)
        assert setting(page)["k"] == pytest.approx(now["k"] * 10.0**k, rel=0.01), key
        assert setting(page)["v"] == pytest.approx(now["v"] * 10.0**v, rel=0.01), key
    set_values(page, **before)
    page.keyboard.press("PageDown")
    assert setting(page)["v"] == pytest.approx(before["v"] / 10.0**0.25, rel=0.01)
    on_screen(page)
    told = page.get_attribute("#plane-point", "aria-valuetext") or ""
    assert f"{setting(page)['k']:.4g}" in told
    assert "11.2" in told
    assert "stick-slip" in told
    for key, wanted in (("Home", 10.0), ("End", 1e5)):
        set_values(page, **before)
        page.keyboard.press(key)
        assert setting(page)["k"] == wanted


def test_a_press_on_the_plane_sets_the_point_there(page: Page) -> None:
    """A click where the point is not brings it there."""
    x, y = middle(page)
    of_k, of_v = decade(page)
    page.mouse.click(x - of_k, y + of_v)
    assert setting(page)["k"] == pytest.approx(100.0, rel=0.05)
    assert setting(page)["v"] == pytest.approx(0.002, rel=0.05)


def test_the_axes_stand_while_the_point_is_dragged_and_follow_then(page: Page) -> None:
    """Dragged past the edge, the point stays at it; let go, the axes make room for more."""
    x, y = middle(page)
    of_k, _ = decade(page)
    marks = "() => document.querySelector('#plane .ticks').textContent"
    before = page.evaluate(marks)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 5 * of_k, y, steps=8)
    on_screen(page)
    assert page.evaluate(marks) == before
    edge = setting(page)["k"]
    page.mouse.up()
    on_screen(page)
    assert page.evaluate(marks) != before
    assert setting(page)["k"] == edge
    assert middle(page)[0] == pytest.approx(x, abs=0.6 * of_k)


def test_the_plane_is_drawn_once_while_the_point_moves(page: Page) -> None:
    """Neither the curve nor the lines are drawn anew while only k and v change."""
    set_values(page, c=5.0, v=0.001)
    middle(page)
    page.wait_for_timeout(300)
    page.evaluate(
        """() => {
          window.changes = 0;
          new MutationObserver(all => (window.changes += all.length)).observe(
            document.querySelector("#plane"),
            { attributes: true, childList: true, subtree: true, characterData: true },
          );
        }"""
    )
    page.focus("#plane-point")
    for key in ("ArrowUp", "ArrowUp", "ArrowRight", "ArrowLeft", "ArrowLeft"):
        page.keyboard.press(key)
        on_screen(page)
    page.wait_for_timeout(300)
    assert page.evaluate("window.changes") == 0
    set_values(page, c=6.0)
    page.wait_for_timeout(300)
    assert page.evaluate("window.changes") > 0


def test_the_plane_says_where_there_is_no_critical_velocity(page: Page) -> None:
    """At c = 0 there is none at any stiffness; with damping the region is hatched and named."""
    middle(page)
    assert "no critical velocity at any stiffness" in text_of(page, "#plane-said")
    assert page.get_attribute("#plane [fill='url(#plane-hatch)']", "d") == ""
    set_values(page, c=10.0)
    assert "stick-slip; it ends above" in text_of(page, "#plane-said") or "no stick-slip" in (
        text_of(page, "#plane-said")
    )
    assert page.get_attribute("#plane [fill='url(#plane-hatch)']", "d")
    assert "no stick-slip" in (page.text_content("#plane") or "")


def test_the_point_lies_in_the_hatched_region_without_a_cycle(page: Page) -> None:
    """The region without stick-slip holds the point just where the cycle does not exist."""
    inside = """
      () => {
        const path = document.querySelector("#plane [fill='url(#plane-hatch)']");
        const [x, y] = document.querySelector("#plane-point").style.transform
          .match(/-?[\\d.]+/g).map(Number);
        const here = new DOMPoint(x, y);
        return path.isPointInFill(here);
      }
    """
    middle(page)
    for c in (2.0, 10.0, 25.0, 40.0, 60.0):
        for k in (100.0, 1000.0, 20000.0):
            v_c = float(coulomb_limit(Parameters(c=c, k=k)))
            for v in (1.05 * v_c, 0.95 * v_c) if v_c > 0.0 else (0.002,):
                set_values(page, c=c, k=k, v=v)
                on_screen(page)
                exists = page.evaluate("window.stickslip.cycle.exists")
                assert page.evaluate(inside) is not exists, (c, k, v)
    # So much damping that no stiffness of the whole plane has a cycle.
    set_values(page, c=1e5, k=1000.0, v=0.002)
    on_screen(page)
    assert page.get_attribute("#plane .curve", "d") == ""
    assert page.evaluate(inside)


def test_the_words_of_the_free_region_stand_in_it(page: Page) -> None:
    """Wherever the plane says that there is no stick-slip, all of the words are on the hatching."""
    inside = """
      () => {
        const words = [...document.querySelectorAll("#plane .note")]
          .find(each => each.textContent === "no stick-slip");
        if (!words) return null;
        const path = document.querySelector("#plane [fill='url(#plane-hatch)']");
        const { x, y, width, height } = words.getBBox();
        const corners = [[x, y], [x + width, y], [x, y + height], [x + width, y + height]];
        return corners.every(each => path.isPointInFill(new DOMPoint(...each)));
      }
    """
    middle(page)
    found = []
    for c in (2.0, 5.0, 10.0, 25.0, 60.0, 1e3, 1e5):
        set_values(page, c=c)
        on_screen(page)
        found.append(page.evaluate(inside))
    assert False not in found, found
    assert found.count(True) >= 4, found


def test_no_path_breaks_at_the_corners(page: Page) -> None:
    """Where a formula ends, and at the presets, each path and place is made of numbers."""
    middle(page)
    for values in [*map(settings.corner, settings.CORNERS), *settings.presets().values()]:
        set_values(page, **values)
        page.wait_for_timeout(220)
        drawn_maps = page.inner_html("#maps")
        assert "NaN" not in drawn_maps, values
        assert "Infinity" not in drawn_maps, values
        assert "undefined" not in drawn_maps, values
        for axis in ("[text-anchor=middle]", ":not([text-anchor=middle])"):
            assert page.locator(f"#jump-map .ticks text{axis}").count() >= 2, values
