"""The sliders: their ends, their keys, the mouse, and the gap that the friction sliders keep."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

import pytest

from stickslip_ref import FrictionClampWarning, Parameters
from tests.page.browser import opened
from tests.page.settings import presets
from tests.page.using import (
    SI,
    drag,
    press,
    said,
    set_values,
    setting,
    shown,
    si_of,
    text_of,
    type_in,
)

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Browser, Page

ENDS = {
    "k": (10.0, 10000.0),
    "v": (0.0001, 0.2),
    "mu_s": (0.0, 1.5),
    "m": (0.01, 100.0),
    "c": (0.0, 100.0),
}
"""What a slider spans, SI."""


def test_home_and_end_reach_the_ends_of_a_slider(page: Page) -> None:
    """A slider's ends are round numbers, and a key reaches each to the last bit."""
    reached = {}
    for name in ENDS:
        press(page, name, "Home")
        low = setting(page)[name]
        press(page, name, "End")
        reached[name] = (low, setting(page)[name])
        set_values(page, **{name: low_middle(name)})
    assert reached == ENDS


def low_middle(name: str) -> float:
    """Give a harmless value, so that the extremes of two sliders do not meet."""
    return 0.3 * ENDS[name][1]


def test_arrows_move_a_slider_by_small_steps(page: Page) -> None:
    """One press of an arrow raises or lowers a value by little, and never leaves it as it is."""
    for name in (*ENDS, "mu_k"):
        press(page, name, *["ArrowRight"] * 5)
        for _ in range(2):
            before = setting(page)[name]
            press(page, name, "ArrowRight")
            above = setting(page)[name]
            press(page, name, "ArrowLeft", "ArrowLeft")
            below = setting(page)[name]
            low, high = ENDS.get(name, (0.0, 0.49))
            assert below < before < above, name
            assert above - below < 0.1 * max(before, high - low), name


def test_every_move_of_a_slider_is_drawn_and_counted(page: Page) -> None:
    """While a slider is dragged, the curves and the numbers of the cycle follow."""
    for name in ("k", "v", "mu_s", "mu_k"):
        pictures, period = shown(page), text_of(page, "#readout-T data")
        drag(page, name, 0.35)
        assert text_of(page, "#readout-T data") != period
        for each, path in shown(page).items():
            # Only v moves the pulled end, and the scale of the axis may stay.
            assert path != pictures[each] or each.endswith("pull")


def test_a_slider_and_its_typed_value_say_the_same(page: Page) -> None:
    """What a slider chose stands in the field beside it, in the shown unit."""
    for name in SI:
        drag(page, name, 0.62)
        used = normal_force(page) if name == "N" else setting(page)[name]
        assert used == pytest.approx(si_of(page, name), rel=1e-11)


def normal_force(page: Page) -> float:
    """Give the normal force in use [N]."""
    p = setting(page)
    return p["m"] * p["g"] + p["load"]


def test_the_normal_force_sets_the_load(page: Page) -> None:
    """N = m g + load: the load is what the weight leaves, from -m g, where N is 0."""
    type_in(page, "N", "20")
    assert setting(page)["load"] == 20.0 - 9.81
    assert page.inner_text("#N-parts") == "weight 9.81\u00a0N + load 10.19\u00a0N"
    for text in ("5", "0"):
        type_in(page, "N", text)
        assert setting(page)["load"] == float(text) - 9.81
    assert normal_force(page) == 0.0
    assert page.inner_text("#N-parts") == "weight 9.81\u00a0N + load −9.81\u00a0N"
    press(page, "N", "ArrowRight", "Home")
    assert normal_force(page) == pytest.approx(0.1, rel=1e-12)
    press(page, "N", "End")
    assert normal_force(page) == pytest.approx(1000.0, rel=1e-12)


def test_the_weight_in_the_normal_force_is_that_of_the_gravity_in_use(page: Page) -> None:
    """On the moon, too, N typed is N in use: the load is N less m g."""
    set_values(page, g=1.62, m=2.0)
    type_in(page, "N", "5")
    assert setting(page)["load"] == 5.0 - 2.0 * 1.62
    assert page.evaluate("stickslip.cycle.F_s") == pytest.approx(0.5 * 5.0, rel=1e-12)


def test_the_normal_force_follows_the_mass(page: Page) -> None:
    """Another mass keeps the load, and N has its weight; a load that would lift it is held at -m g.

    The mass back, the load is what it was.
    """
    set_values(page, load=50.0)
    type_in(page, "m", "2")
    assert setting(page)["load"] == 50.0
    assert float(page.input_value("#N")) == 69.62
    set_values(page, load=-15.0)
    for mass, load in (("1", -9.81), ("0.5", -0.5 * 9.81), ("2", -15.0)):
        type_in(page, "m", mass)
        assert setting(page)["load"] == load
    assert float(page.input_value("#N")) == 4.62


def test_a_load_that_lifts_the_mass_is_refused(page: Page) -> None:
    """A script that asks for it is told, and nothing changes."""
    good = setting(page)
    said = page.evaluate(
        "() => { try { stickslip.set({ load: -9.9 }); } catch (e) { return e.message; } }"
    )
    assert "-9.9 N would lift the mass" in said
    assert setting(page) == good


_BOXES = """
names => names.map(name => ["label[for=" + name + "]", "#" + name, "#" + name + "-unit",
  "#" + name + "-slider", "#" + name + "-control .ends"].map(each => {
    const { left, right, top, bottom } = document.querySelector(each).getBoundingClientRect();
    return { left, right, top, bottom, height: bottom - top };
  }))
"""


def test_name_value_and_unit_share_a_line_from_1280_px(page: Page) -> None:
    """All seven are in sight, each on one line above its slider, and the fields in one column."""
    set_values(page, **presets()["fault-block"])
    rows = page.evaluate(_BOXES, list(SI))
    for label, field, unit, slider, ends in rows:
        assert label["height"] < 30
        assert label["left"] < field["left"] < unit["left"]
        assert max(label["top"], unit["top"]) < field["bottom"] <= slider["top"] + 1
        assert slider["bottom"] <= ends["top"] + 1
        assert field["left"] == pytest.approx(rows[0][1]["left"], abs=0.5)


def test_a_finger_finds_sliders_and_fields(browser: Browser, page_file: Path) -> None:
    """On a phone both are 44 px high, and the ends of the sliders are shown."""
    with opened(browser, page_file, width=320, has_touch=True, is_mobile=True) as phone:
        for _, field, _, slider, ends in phone.evaluate(_BOXES, list(SI)):
            assert field["height"] >= 44
            assert slider["height"] >= 44
            assert ends["height"] > 5
        assert phone.locator("#k-control .ends span").all_inner_texts() == ["10", "10000"]


def test_a_value_beyond_the_slider_is_taken_and_its_ends_follow(page: Page) -> None:
    """A stiffness of a million is a setting like any other; the slider then spans it."""
    type_in(page, "k", "1e6")
    low, high = (float(each) for each in page.locator("#k-control .ends span").all_inner_texts())
    assert setting(page)["k"] == 1e6
    assert low < 1e6 < high
    press(page, "k", "ArrowRight")
    assert 1e6 < setting(page)["k"] < 1.1e6
    type_in(page, "mu_s", "2.5")
    assert float(page.get_attribute("#mu_s-slider", "max") or "") > 2.5
    assert float(page.input_value("#mu_s-slider")) == 2.5


def test_the_kinetic_slider_ends_below_the_static_coefficient(page: Page) -> None:
    """The slider of mu_k stops at mu_s - 0.01, to the last bit, whatever its steps are."""
    for mu_s in (0.5, 0.57, 0.29, 1.1, 0.1234567, 0.02):
        type_in(page, "mu_s", repr(mu_s))
        assert float(page.get_attribute("#mu_k-slider", "max") or "") == mu_s - 0.01
        press(page, "mu_k", "Home", "End")
        assert setting(page)["mu_k"] == mu_s - 0.01
        press(page, "mu_k", "ArrowLeft")
        assert setting(page)["mu_k"] < mu_s - 0.01


def test_no_slider_of_mu_k_is_left_where_mu_s_leaves_no_room(page: Page) -> None:
    """Below mu_s = 0.01 the kinetic slider has nowhere to go, and stays at 0."""
    press(page, "mu_s", "Home")
    press(page, "mu_k", "End", "ArrowRight")
    assert setting(page)["mu_k"] == 0.0
    assert page.inner_text("#lead")


def test_mu_s_takes_mu_k_along_and_gives_it_back(page: Page) -> None:
    """Dragged below what was asked of mu_k, mu_s carries it down; dragged up, it returns."""
    drag(page, "mu_s", 0.1)
    low = setting(page)
    assert low["mu_k"] == low["mu_s"] - 0.01 < 0.29
    assert "0.3" in said(page, "mu_k")
    drag(page, "mu_s", 0.5)
    assert setting(page)["mu_k"] == 0.3
    assert said(page, "mu_k") == ""


def test_equal_coefficients_are_a_setting(page: Page) -> None:
    """mu_k = mu_s is no gap and is no mistake: it is taken as typed."""
    type_in(page, "mu_k", "0.5")
    assert setting(page)["mu_k"] == 0.5
    assert said(page, "mu_k") == ""
    assert page.get_attribute("#mu_k", "aria-invalid") is None


def test_a_kinetic_coefficient_above_the_static_one_is_held_below_it(page: Page) -> None:
    """Typed above mu_s, mu_k is clamped, and a note in sight names what was asked and what is."""
    type_in(page, "mu_k", "0.7")
    assert setting(page)["mu_k"] == 0.5 - 0.01
    note = said(page, "mu_k")
    assert "0.7" in note
    assert "0.49" in note
    page.keyboard.press("Tab")
    assert float(page.input_value("#mu_k")) == 0.49


def test_the_page_clamps_as_the_reference_does(page: Page) -> None:
    """For every pair of coefficients, mu_k in use is that of the reference, bit for bit."""
    draw = Random("clamp")
    for _ in range(25):
        mu_s = draw.choice([draw.uniform(0.0, 0.03), draw.uniform(0.0, 1.5)])
        mu_k = draw.choice([draw.uniform(0.0, 1.5), mu_s, mu_s + 1e-16, mu_s * (1 + 1e-15)])
        if mu_k > mu_s:
            with pytest.warns(FrictionClampWarning):
                used = Parameters(mu_s=mu_s, mu_k=mu_k).mu_k_used
        else:
            used = Parameters(mu_s=mu_s, mu_k=mu_k).mu_k_used
        page.fill("#mu_s", repr(mu_s))
        page.fill("#mu_k", repr(mu_k))
        assert setting(page)["mu_k"] == float(used)
        set_values(page, mu_s=0.5, mu_k=0.3)
