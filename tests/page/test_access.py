"""For everyone: axe-core, the keyboard alone, screen readers, 320 px, and paper."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from stickslip.units import parse
from tests.page.browser import opened
from tests.page.settings import presets
from tests.page.using import SI, drawn, open_folds, press, setting, type_in

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

NARROW = 320
"""The narrowest window [px]: 1280 px at a zoom of 400 %, WCAG 1.4.10."""

MODES: dict[str, dict[str, Any]] = {
    "light": {"color_scheme": "light"},
    "dark": {"color_scheme": "dark"},
    "high contrast": {"color_scheme": "dark", "forced_colors": "active"},
}

_OPERABLE = "a[href], button, input, select, summary, textarea, [tabindex]"

_WALK = f"""
() => [...document.querySelectorAll("{_OPERABLE}")]
  .filter(each => each.tabIndex >= 0 && !each.disabled && each.checkVisibility())
  .map(each => each.id || each.dataset.preset || each.textContent.trim())
"""
_FOCUSED = """
() => {
  const here = document.activeElement;
  const { outlineStyle, outlineWidth } = getComputedStyle(here);
  const box = here.getBoundingClientRect();
  return {
    name: here.id || here.dataset.preset || here.textContent.trim(),
    outlined: outlineStyle !== "none" && parseFloat(outlineWidth) >= 2,
    inSight: box.right > 0 && box.left < innerWidth && box.bottom > 0 && box.top < innerHeight,
    atEnd: here === document.body,
  };
}
"""


def bring_axe(page: Page) -> None:
    """Load axe-core into the page."""
    script = files("axe_playwright_python") / "axe.min.js"
    page.evaluate(script.read_text(encoding="utf-8"))


def violations(page: Page) -> list[str]:
    """Let axe-core look at the page, and give what it finds."""
    drawn(page)
    found = page.evaluate("axe.run({ resultTypes: ['violations'] })")["violations"]
    return [f"{each['id']}: {[node['target'] for node in each['nodes']]}" for each in found]


@pytest.mark.parametrize("width", [NARROW, 1280])
def test_axe_finds_nothing(browser: Browser, page_file: Path, width: int) -> None:
    """No violation of WCAG that a program can find; folded, unfolded, with refused values."""
    with opened(browser, page_file, width=width) as page:
        bring_axe(page)
        assert not violations(page)
        open_folds(page)
        type_in(page, "k", "nonsense")
        type_in(page, "mu_k", "0.8")
        type_in(page, "c", "100")
        type_in(page, "v", "-1")
        page.evaluate("location.hash = '#g=abc'")
        page.wait_for_function("document.querySelector('#address-said').textContent !== ''")
        type_in(page, "k", "nonsense")
        for mode, media in MODES.items():
            page.emulate_media(**media)
            assert not violations(page), mode


def test_forced_colours_hide_no_state(browser: Browser, page_file: Path) -> None:
    """Where the system chooses the colours, the chosen preset still shows."""
    with opened(browser, page_file, forced_colors="active") as page:
        paint = "e => getComputedStyle(e).backgroundColor"
        chosen = page.eval_on_selector("[data-preset][aria-pressed=true]", paint)
        other = page.eval_on_selector("[data-preset][aria-pressed=false]", paint)
        assert chosen != other


def test_every_control_is_reached_by_tab_in_the_order_of_reading(page: Page) -> None:
    """Tab passes everything that can be used once, in order, each outlined and in sight."""
    open_folds(page)
    # What is out of sight is drawn a moment later, and has buttons then.
    page.wait_for_function("document.querySelector('#cures-lead').textContent !== ''")
    wanted = page.evaluate(_WALK)
    walked = []
    for _ in range(len(wanted)):
        page.keyboard.press("Tab")
        here = page.evaluate(_FOCUSED)
        assert here["outlined"], here
        assert here["inSight"], here
        walked.append(here["name"])
    assert walked == wanted
    controls = list(SI)
    assert [name for name in walked if name in controls] == controls
    assert {f"{name}-slider" for name in controls} <= set(walked)
    assert {"play", "scrub", "speed", "zoom-in", "save-csv", "copy", *presets()} <= set(walked)
    page.keyboard.press("Tab")
    assert page.evaluate(_FOCUSED)["name"] not in wanted[1:]


def test_the_keyboard_alone_works_the_page(page: Page) -> None:
    """Presets, a slider, a field with a unit, play, speed: by Tab, Enter, Space and arrows."""
    page.press("[data-preset=squeaky-drawer]", "Enter")
    assert setting(page) == presets()["squeaky-drawer"]
    page.press("[data-preset=violin-bow]", "Space")
    assert setting(page) == presets()["violin-bow"]
    press(page, "k", "Home", "ArrowRight")
    assert setting(page)["k"] > 0.0
    page.focus("#v")
    page.keyboard.press("Control+a")
    page.keyboard.type("12.5")
    assert setting(page)["v"] == 0.0125
    page.keyboard.press("Control+a")
    page.keyboard.type("31 mm/year")
    page.keyboard.press("Tab")
    assert setting(page)["v"] == parse("31 mm/year", "m/s", "v")
    page.focus("#speed")
    page.keyboard.press("ArrowDown")
    assert page.input_value("#speed") == "1"


def test_a_first_tab_leads_past_the_controls(page: Page) -> None:
    """The first stop of Tab is a link to the results, seen when focused, and it goes there."""
    page.keyboard.press("Tab")
    assert page.inner_text(":focus") == "To the results"
    page.keyboard.press("Enter")
    page.wait_for_function("document.activeElement.id === 'results'")
    page.keyboard.press("Tab")
    assert page.evaluate("document.querySelector('#results').contains(document.activeElement)")


def test_a_slider_says_value_and_unit(page: Page) -> None:
    """What a screen reader says of a slider is the number that is shown, with its unit."""
    for name in SI:
        press(page, name, "ArrowLeft", "ArrowRight", "ArrowRight")
        spoken = page.get_attribute(f"#{name}-slider", "aria-valuetext") or ""
        number, _, unit = spoken.partition(" ")
        assert unit == page.inner_text(f"#{name}-unit")
        assert float(number) == float(page.input_value(f"#{name}"))
        label = page.get_attribute(f"#{name}-slider", "aria-label") or ""
        assert label.split(",")[0] in page.inner_text(f"label[for={name}]").replace("\u00a0", " ")


def test_a_screen_reader_hears_the_numbers_once_the_slider_is_still(page: Page) -> None:
    """Fifteen moves are one sentence: said politely, when they end, and with the new numbers."""
    page.wait_for_function("document.querySelector('#told').textContent !== ''")
    assert page.get_attribute("#told", "role") == "status"
    before = page.text_content("#told")
    page.evaluate(
        """() => {
          window.heard = [];
          const told = document.querySelector("#told");
          new MutationObserver(() => window.heard.push(told.textContent))
            .observe(told, { childList: true, characterData: true, subtree: true });
        }"""
    )
    press(page, "k", *["ArrowRight"] * 15)
    page.wait_for_function("window.heard.length > 0")
    drawn(page)
    (heard,) = page.evaluate("window.heard")
    assert heard == page.text_content("#lead") != before
    assert "mm" in heard
    assert "ms" in heard


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_each_curve_stands_out_from_the_paper(
    browser: Browser, page_file: Path, scheme: str
) -> None:
    """Its contrast is 3 at least, WCAG 1.4.11; axe-core looks at texts only."""
    with opened(browser, page_file, color_scheme=scheme) as page:
        page.evaluate("window.stickslip.compare({ k: 2000 })")
        paper = luminance(page, "body", "backgroundColor")
        for chart in ("x-chart", "F-chart", "phase-chart"):
            for each in page.locator(f"#{chart} .curve, #{chart} .threshold").all():
                name = each.get_attribute("class")
                ink = luminance(page, f"#{chart} [class='{name}']", "stroke")
                contrast = (max(ink, paper) + 0.05) / (min(ink, paper) + 0.05)
                assert contrast >= 3.0, (chart, name)


def luminance(page: Page, selector: str, name: str) -> float:
    """Give the relative luminance of a colour of an element, WCAG 2.2."""
    parts = [
        part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4
        for part in rgb(page, selector, name)
    ]
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]


def test_nothing_scrolls_sideways_at_320_px(browser: Browser, page_file: Path) -> None:
    """At the start, unfolded, with objections, and with the longest numbers."""
    with opened(browser, page_file, width=NARROW, height=640) as page:
        assert overflow(page) == NARROW
        open_folds(page)
        assert overflow(page) == NARROW
        for name in ("k", "v", "mu_s", "m"):
            type_in(page, name, "9" * 60 + "x")
        type_in(page, "mu_k", "0.77777777777777777")
        assert overflow(page) == NARROW
        for name in presets():
            page.click(f"[data-preset={name}]")
            assert overflow(page) == NARROW
        type_in(page, "k", "1.2345678901234567e-5")
        type_in(page, "c", "123456789.123456789")
        assert overflow(page) == NARROW
        page.evaluate("location.hash = '#k=" + "9" * 100 + "x'")
        page.wait_for_function("document.querySelector('#address-said').textContent !== ''")
        assert overflow(page) == NARROW


def overflow(page: Page) -> int:
    """Give the width [px] that the content takes."""
    drawn(page)
    width: int = page.evaluate("document.scrollingElement.scrollWidth")
    return width


def test_a_projector_is_filled(browser: Browser, page_file: Path) -> None:
    """At 1920 x 1080 controls, charts and results stand side by side, all in sight at once."""
    with opened(browser, page_file, width=1920, height=1080) as page:
        boxes = {
            part: page.locator(part).bounding_box()
            for part in ("#controls", "#schematic", "#x-chart", "#F-chart", ".results")
        }
        for box in boxes.values():
            assert box is not None
            assert box["y"] + box["height"] <= 1080
        assert page.evaluate("document.scrollingElement.scrollWidth") == 1920


def test_on_paper_it_is_light_and_keeps_its_values(browser: Browser, page_file: Path) -> None:
    """Printed from a dark screen: dark ink on light paper, values and charts there, no buttons."""
    with opened(browser, page_file, color_scheme="dark") as page:
        type_in(page, "k", "1234")
        page.emulate_media(media="print", color_scheme="dark")
        drawn(page)
        assert lightness(page, "body", "backgroundColor") > 0.95
        assert lightness(page, "body", "color") < 0.3
        assert lightness(page, "#k", "color") < 0.3
        assert lightness(page, "#F-chart .threshold", "stroke") < 0.3
        for part in ("#k", "#mu_k", "#x-chart", "#F-chart", "#phase-chart", ".results", "#command"):
            assert page.is_visible(part)
        assert page.input_value("#k") == "1234"
        assert "1234" in page.inner_text("#command")
        # Browsers leave out backgrounds on paper; the bands are what is said.
        exact = "e => getComputedStyle(e).printColorAdjust"
        assert page.eval_on_selector(".stick-band", exact) == "exact"
        for part in ("#play", "#k-slider", ".presets", "#save-csv", "#copy"):
            assert not page.is_visible(part)


def lightness(page: Page, selector: str, name: str) -> float:
    """Give how light a colour of an element is, from 0 to 1."""
    red, green, blue = rgb(page, selector, name)
    return 0.21 * red + 0.72 * green + 0.07 * blue


def rgb(page: Page, selector: str, name: str) -> list[float]:
    """Give red, green and blue of a colour of an element, each from 0 to 1."""
    colour = page.eval_on_selector(selector, "(e, name) => getComputedStyle(e)[name]", name)
    return [int(each) / 255.0 for each in re.findall(r"\d+", colour)[:3]]
