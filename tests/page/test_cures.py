"""The cures of the page: their numbers are those of Python, and a button does what it says."""

from __future__ import annotations

import functools
import math
import re
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

import pytest

from stickslip_design.cures import Cures, cures
from stickslip_ref import FrictionClampWarning, Parameters, coulomb_limit, steady_cycle
from tests.page import settings
from tests.page.browser import planted
from tests.page.by_python import exact_critical_velocity
from tests.page.comparison import DECIDABLE
from tests.page.exchange import ask
from tests.page.using import drawn, set_values, setting, text_of

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

NEAR = 1e-9
"""Largest relative difference between the page and Python."""

_ASK = """
settings => settings.map(values => {
  const page = window.stickslip;
  page.set(values);
  return page.cures(page.setting);
})
"""
_PRESS = """
async settings => {
  const seen = [];
  for (const asked of settings) {
    window.stickslip.set(asked);
    const values = window.stickslip.setting;
    await new Promise(done => setTimeout(done, 300));
    for (const row of document.querySelectorAll("[data-cure]")) {
      for (const [index, cell] of [...row.querySelectorAll("td")].entries()) {
        const button = cell.querySelector("button");
        if (button.hidden) continue;
        const before = window.stickslip.cycle.delta_x;
        button.click();
        const { exists, delta_x } = window.stickslip.cycle;
        seen.push({
          cure: row.dataset.cure, aim: ["halve", "end"][index], before, exists, delta_x,
          changed: Object.entries(window.stickslip.setting)
            .filter(([name, value]) => value !== values[name]).map(([name]) => name),
          said: document.querySelector("#cures-said").textContent,
          parameter: row.dataset.parameter,
        });
        window.stickslip.set(values);
      }
    }
  }
  return seen;
}
"""


@functools.cache
def every_setting() -> tuple[settings.Setting, ...]:
    """Give 300 settings and those that the page offers, some with a load or a lift."""
    draw = Random("cures of the page")
    chosen = [dict(each) for each in settings.batch("cures of the page", 120, 110, 70)]
    for each in chosen[::3]:
        each["load"] = each["m"] * each["g"] * draw.choice([-0.9, -0.3, 0.5, 2.0, 5.0, 30.0])
    assert len(chosen) == 300
    return (*chosen, *settings.presets().values())


@functools.cache
def by_python() -> tuple[Cures, ...]:
    """Give what Python says of them."""
    return tuple(cures(parameters(each)) for each in every_setting())


def parameters(values: settings.Setting) -> Parameters:
    """Give a setting to the reference, with the clamp."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FrictionClampWarning)
        return Parameters(**values)


def errors(page: Page, every: int = 1) -> dict[str, float]:
    """Give the largest relative error of each number of the cures; infinite if wrong in kind.

    Parameters
    ----------
    page
        The page, or a faulty one.
    every
        Of the settings, how many to go on by.
    """
    worst: dict[str, float] = {}
    chosen, python = every_setting()[::every], by_python()[::every]
    found = ask(page, _ASK, [dict(each) for each in chosen])
    for values, got, wanted in zip(chosen, found, python, strict=True):
        p = parameters(values)
        if p.c > 0.0 and abs(float(exact_critical_velocity(values, p) / p.v) - 1) <= DECIDABLE:
            continue
        names = [each["name"] for each in got["cures"]]
        if names != [each.name for each in wanted.cures]:
            worst["names"] = math.inf
            continue
        pairs = [("jump", got["jump"], wanted.jump), ("v_c", got["v_c"], wanted.v_c)]
        for each, cure in zip(got["cures"], wanted.cures, strict=True):
            # The load is what the weight leaves of the normal force, and is as exact as they are.
            base = float(p.m) * float(p.g) if cure.name == "normal force" else 0.0
            for key in KEYS:
                scale = 0.0 if key == "least" else base
                error = difference(each[key], getattr(cure, key), scale)
                worst[f"{cure.name} {key}"] = max(worst.get(f"{cure.name} {key}", 0.0), error)
        for name, one, other in pairs:
            worst[name] = max(worst.get(name, 0.0), difference(one, other))
    return worst


KEYS = ("now", "halve", "end", "least")


def difference(one: float | None, other: float | None, scale: float = 0.0) -> float:
    """Give the difference of two numbers, of which both may be missing, over the largest."""
    if one is None or other is None:
        return 0.0 if one is other else math.inf
    if one == other or (math.isnan(one) and math.isnan(other)):
        return 0.0
    error = abs(one - other) / max(abs(one), abs(other), scale)
    return error if error >= 0.0 else math.inf


def test_the_cures_are_those_of_python(page: Page) -> None:
    """At 300 settings and the presets each value, and each lack of one, is that of Python."""
    assert {name: e for name, e in errors(page).items() if not e <= NEAR} == {}
    assert sum(len(each.cures) > 0 for each in by_python()) > 150


FAULTS = {
    "half of another jump": ("Math.log(2 * (", "Math.log(2.00000001 * (", "stiffer halve"),
    "stiffer up to the first order": (
        "const low = (4 * Math.PI) / (ray * ray);",
        "const low = (5 * Math.PI) / (ray * ray);",
        "stiffer end",
    ),
    "softer not far enough": (
        "Math.log1p((2 * lambda_) / zeta) / Math.PI",
        "Math.log1p((2 * lambda_) / zeta) / 9",
        "softer end",
    ),
    "lighter past the first limit": ("const DIPS = 60;", "const DIPS = 0;", "lighter end"),
    "lighter without its load": ("part * r + rest", "part * r + rest * r", "lighter halve"),
    "damping of another block": (
        "2 * limit * Math.sqrt(p.k * p.m)",
        "2.0000001 * limit * Math.sqrt(p.k * p.m)",
        "damping end",
    ),
    "slow pull without damping": ("lambda_ * (1 + decay)", "lambda_ * 2", "slower least"),
    "swing at an end to the gap": (": 2 * Math.PI) / whole", ": Math.PI) / whole", "gap least"),
    "gap for friction": ("p.mu_s - gap * r", "p.mu_k + gap * r", "gap halve"),
}
"""Faults to plant: a piece of the page's script, what to put there, what must give it away."""


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found(
    browser: Browser, page_file: Path, tmp_path: Path, name: str
) -> None:
    """The comparison refutes wrong cures, be it in the eighth digit."""
    piece, fault, gives_away = FAULTS[name]
    with planted(browser, page_file, tmp_path, piece, fault) as page:
        worst = errors(page, every=3)
        assert not worst[gives_away] <= NEAR


def test_a_button_does_what_it_says(page: Page) -> None:
    """Pressed, each value that the table offers halves the jump, or leaves no cycle, alone."""
    chosen = [dict(each) for each in settings.presets().values()]
    chosen += [dict(each) for each in every_setting()[150:156]]
    chosen += [dict(settings.corner(name)) for name in ("no gap", "frictionless", "fastest")]
    pressed = press_all(page, chosen)
    for each in pressed:
        assert each["changed"] == [each["parameter"]], each
        if each["aim"] == "end":
            assert each["exists"] is False, each
            assert each["said"].endswith("No cycle."), each
        else:
            assert each["delta_x"] == pytest.approx(0.5 * each["before"], rel=NEAR), each
    aims = [each["aim"] for each in pressed]
    assert aims.count("halve") > 15
    assert aims.count("end") > 25


def to_cures(page: Page) -> None:
    """Scroll to the section, which is drawn when it comes into sight."""
    page.locator("#cures").scroll_into_view_if_needed()
    page.wait_for_function("document.querySelector('#cures-lead').textContent !== ''")


def press_all(page: Page, chosen: Sequence[Mapping[str, float]]) -> Any:
    """Press each button of the table at each setting, and give what it does."""
    to_cures(page)
    return page.evaluate(_PRESS, list(chosen))


def test_a_value_that_ends_the_cycle_is_round_and_near_its_limit(page: Page) -> None:
    """A person sees two or three digits, not more than 2 % beyond the limit."""
    to_cures(page)
    preset = dict(settings.presets()["machine-slideway"])
    set_values(page, **preset)
    limits = {each.name: each.end for each in cures(parameters(preset)).cures}
    for cure, name, parameter in (
        ("stiffer", "stiffer", "k"),
        ("damping", "damping", "c"),
        ("speed", "faster", "v"),
        ("lighter", "lighter", "m"),
    ):
        set_values(page, **preset)
        page.locator(f"[data-cure={cure}] td:last-child button").click()
        value, limit = setting(page)[parameter], limits[name]
        assert limit is not None
        assert value != limit
        assert value == pytest.approx(limit, rel=0.02)
        assert len(re.sub(r"e.*|^0\.0*|\.|0+$", "", f"{value:.12g}".rstrip("0"))) <= 3, value
    # What is rounded of these two is the gap and the normal force.
    for cure, name in (("gap", "gap"), ("force", "normal force")):
        set_values(page, **preset)
        page.locator(f"[data-cure={cure}] td:last-child button").click()
        after, limit = parameters(setting(page)), limits[name]
        assert limit is not None
        left = after.mu_s - after.mu_k if cure == "gap" else float(after.N)
        whole = after.mu_s - limit if cure == "gap" else after.m * after.g + limit
        assert 0.98 * whole <= left < whole, cure


def test_the_keyboard_stays_on_the_cure(page: Page) -> None:
    """A button that ends the cycle stays with its value and the focus; Tab leads on from it."""
    to_cures(page)
    before = setting(page)
    button = page.locator("[data-cure=damping] td:last-child button")
    button.press("Enter")
    text_of(page, "#cures-said")
    assert button.evaluate("each => each === document.activeElement")
    assert page.evaluate("window.stickslip.cycle.exists") is False
    page.press("#cures-back", "Enter")
    assert setting(page) == before


def test_back_brings_the_setting_back(page: Page) -> None:
    """After any cure, one press brings the setting before."""
    to_cures(page)
    # With damping each of the rows offers something.
    set_values(page, c=5.0, v=0.01)
    text_of(page, "#cures-lead")
    before = setting(page)
    rows = {"stiffer": "k", "damping": "c", "gap": "mu_k", "force": "load", "lighter": "m"}
    for cure, parameter in rows.items():
        page.locator(f"[data-cure={cure}] td button:visible").first.click()
        assert setting(page)[parameter] != before[parameter]
        page.click("#cures-back")
        assert setting(page) == before


def test_a_cure_leaves_the_curve_before_as_a_ghost(page: Page) -> None:
    """The curve of the setting before stays in the charts."""
    to_cures(page)
    page.locator("[data-cure=damping] td:last-child button").click()
    text_of(page, "#cures-said")
    assert page.locator("#x-chart .ghost").first.get_attribute("d")


def test_without_damping_the_table_says_what_does_not_end_it(page: Page) -> None:
    """At c = 0 neither speed nor stiffness ends the cycle, and without a gap it touches rest."""
    to_cures(page)
    rows = {
        cure: page.inner_text(f"[data-cure={cure}] td:last-child")
        for cure in ("stiffer", "softer", "speed", "gap", "force", "lighter")
    }
    for cure in ("stiffer", "softer", "speed", "lighter"):
        assert "without damping" in rows[cure]
    for cure in ("gap", "force"):
        assert "touches rest" in rows[cure]
    assert page.inner_text("[data-cure=damping] td").strip() == "ends the cycle first"
    assert "62 % at best" in page.inner_text("[data-cure=speed] td")


def test_out_of_sight_the_section_follows_all_the_same(page: Page) -> None:
    """Soon after the setting, for who reads without looking; on paper at once."""
    page.evaluate("scrollTo(0, 0)")
    jump = "document.querySelector('#cures-lead').textContent.includes('{}')"
    set_values(page, k=2000.0)
    page.wait_for_function(jump.format(f"{1e3 * page.evaluate('stickslip.cycle.delta_x'):.4g}"))
    told = page.evaluate(
        """() => {
          stickslip.set({ k: 3000 });
          dispatchEvent(new Event("beforeprint"));
          return document.querySelector("#cures-lead").textContent;
        }"""
    )
    assert f"{1e3 * page.evaluate('stickslip.cycle.delta_x'):.4g}" in told


def test_without_a_cycle_there_is_nothing_to_suppress(page: Page) -> None:
    """The section says how far the pull is above the critical velocity, and offers nothing."""
    to_cures(page)
    set_values(page, c=10.0, v=0.5)
    lead = text_of(page, "#cures-lead")
    factor = 0.5 / float(coulomb_limit(Parameters(c=10.0)))
    assert f"{factor:.3g} times the critical" in lead
    assert page.locator(".cures button:visible").count() == 0
    set_values(page, c=100.0)
    assert "no slip comes to rest" in text_of(page, "#cures-lead")
    set_values(page, c=10.0, mu_k=0.5)
    assert "no gap" in text_of(page, "#cures-lead")
    assert not steady_cycle(Parameters(c=10.0, mu_k=0.5)).exists


def test_values_far_beyond_sense_are_said_to_be(page: Page) -> None:
    """A stiffness changed by more than a hundredfold and a damping ratio above 0.5 are marked."""
    to_cures(page)
    set_values(page, **settings.presets()["machine-slideway"])
    ends = {
        cure: text_of(page, f"[data-cure={cure}] td:last-child")
        for cure in ("stiffer", "softer", "damping")
    }
    assert [cure for cure, text in ends.items() if "out of reach" in text] == ["softer"]
    set_values(page, **settings.presets()["fault-block"])
    assert "out of reach" in text_of(page, "[data-cure=damping] td:last-child")


def test_every_corner_has_an_answer(page: Page) -> None:
    """Where a formula takes another branch or ends, no number is missing that should be there."""
    to_cures(page)
    corners = [settings.corner(name) for name in settings.CORNERS]
    for values, got in zip(corners, ask(page, _ASK, [dict(each) for each in corners]), strict=True):
        wanted = cures(parameters(values))
        assert [each["name"] for each in got["cures"]] == [each.name for each in wanted.cures]
        for each, cure in zip(got["cures"], wanted.cures, strict=True):
            for key in KEYS:
                assert difference(each[key], getattr(cure, key)) <= NEAR, (values, cure, key)
        set_values(page, **values)
        assert not re.search(r"NaN|undefined|Infinity|null|Invalid", text_of(page, "#cures"))


def test_cures_are_compared_from_one_setting(page: Page) -> None:
    """A second cure starts where the first did, the table stays, and Back leads there."""
    own = dict(setting(page))
    stiffer = page.locator("[data-cure=stiffer] button").first
    lighter = page.locator("[data-cure=lighter] button").first
    stiffer.scroll_into_view_if_needed()
    drawn(page)
    before = page.inner_text("#cures table")
    stiffer.click()
    drawn(page)
    assert setting(page)["k"] > own["k"]
    assert page.inner_text("#cures table") == before
    assert stiffer.get_attribute("aria-pressed") == "true"
    lighter.click()
    drawn(page)
    assert setting(page)["k"] == own["k"]
    assert setting(page)["m"] < own["m"]
    page.click("#cures-back")
    drawn(page)
    assert setting(page) == own
    assert not page.is_visible("#cures-back")
