"""For everyone: axe-core, the keyboard alone, screen readers, phones, projectors, and paper."""

from __future__ import annotations

import re
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import pytest

from tests.page.settings import PRESETS
from tests.page.window import SI, Window, another

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Browser

NARROW = 320
"""The narrowest window [px]: 1280 px at a zoom of 400 %, WCAG 1.4.10."""

MODES: dict[str, dict[str, Any]] = {
    "light": {"color_scheme": "light"},
    "dark": {"color_scheme": "dark"},
    "high contrast": {"color_scheme": "dark", "forced_colors": "active"},
}

_NAME = "each => each.id || each.dataset.preset || each.textContent.trim()"
_WALK = f"""() => [...document.querySelectorAll(
    "a[href], button, input, select, summary, textarea, [tabindex]")]
  .filter(each => each.tabIndex >= 0 && !each.disabled && each.checkVisibility()).map({_NAME})"""
_LISTEN = """() => {
  window.heard = [];
  const live = "[aria-live]:not([aria-live=off]), [role=status], [role=alert], output";
  new MutationObserver(all => all.forEach(({ target }) => {
    const element = target.nodeType === 1 ? target : target.parentElement;
    const region = element.closest(live);
    if (region) window.heard.push([region.id, region.textContent]);
  })).observe(document.body, { subtree: true, childList: true, characterData: true });
}"""
_FOCUSED = f"""() => {{
  const here = document.activeElement;
  const {{ outlineStyle, outlineWidth }} = getComputedStyle(here);
  const box = here.getBoundingClientRect();
  return {{
    name: ({_NAME})(here),
    outlined: outlineStyle !== "none" && parseFloat(outlineWidth) >= 2,
    inSight: box.right > 0 && box.left < innerWidth && box.bottom > 0 && box.top < innerHeight,
  }};
}}"""


@pytest.mark.parametrize("width", [NARROW, 1280])
def test_axe_finds_nothing_even_unfolded_with_refused_values(window: Window, width: int) -> None:
    window.page.set_viewport_size({"width": width, "height": 800})
    script = files("axe_playwright_python") / "axe.min.js"
    window.page.evaluate(script.read_text(encoding="utf-8"))
    window.unfold()
    window.page.evaluate("location.hash = '#g=abc'")
    window.until("document.querySelector('#address-said').textContent !== ''")
    for name, text in (("mu_k", "0.8"), ("c", "100"), ("k", "nonsense"), ("v", "-1")):
        window.type(name, text)
    # Colours do not depend on the width.
    for mode, media in MODES.items() if width > NARROW else [("light", MODES["light"])]:
        window.page.emulate_media(**media)
        window.drawn()
        found = window.js("axe.run({ resultTypes: ['violations'] }).then(all => all.violations)")
        assert [(each["id"], [n["target"] for n in each["nodes"]]) for each in found] == [], mode
    # Where the system chooses the colours, the chosen preset still shows.
    window.preset("default")
    pressed = [f"[data-preset][aria-pressed={each}]" for each in ("true", "false")]
    assert len({window.style(each, "backgroundColor") for each in pressed}) == 2


def test_tab_reaches_everything_in_the_order_of_reading_outlined_and_in_sight(
    window: Window,
) -> None:
    window.unfold()
    # What is out of sight is drawn a moment later, and has buttons then.
    window.until("document.querySelector('#cures-lead').textContent !== ''")
    expected = window.js(_WALK)
    walked = []
    for _ in expected:
        window.page.keyboard.press("Tab")
        here = window.js(_FOCUSED)
        assert here["outlined"], here
        assert here["inSight"], here
        walked.append(here["name"])
    assert walked == expected
    assert [name for name in walked if name in SI] == list(SI)
    some = {*(f"{name}-slider" for name in SI), *PRESETS}
    assert some | {"play", "scrub", "speed", "zoom-in", "save-csv", "copy"} <= set(walked)


def test_the_keyboard_alone_works_the_page(window: Window) -> None:
    window.page.keyboard.press("Tab")
    assert window.page.inner_text(":focus") == "To the results"
    window.page.keyboard.press("Enter")
    window.until("document.activeElement.id === 'results'")
    window.page.keyboard.press("Tab")
    assert window.js("document.querySelector('#results').contains(document.activeElement)")
    window.page.press("[data-preset=violin-bow]", "Space")
    assert window.setting == PRESETS["violin-bow"]


def test_a_screen_reader_hears_each_value_with_its_unit_and_the_result_once(window: Window) -> None:
    for name in SI:
        window.press(name, "ArrowLeft", "ArrowRight", "ArrowRight")
        number, _, unit = window.part(f"#{name}-slider", "aria-valuetext").partition(" ")
        assert unit == window.page.inner_text(f"#{name}-unit")
        assert float(number) == float(window.page.input_value(f"#{name}"))
        label = window.part(f"#{name}-slider", "aria-label").split(",")[0]
        assert label in window.text(f"label[for={name}]")
    window.page.wait_for_timeout(1000)
    before = window.page.text_content("#told")
    assert window.part("#told", "role") == "status"
    # While it plays no live region changes: nobody is talked to sixty times a second.
    window.page.click("#play")
    window.js(_LISTEN)
    for _ in range(10):
        window.drawn()
    assert window.js("heard") == []
    # Fifteen moves are one sentence, when they end.
    window.press("k", *["ArrowRight"] * 15)
    window.until("heard.length > 0")
    window.drawn()
    lead = window.page.text_content("#lead")
    assert window.js("heard") == [["told", lead]]
    assert lead != before


def luminance(window: Window, selector: str, name: str) -> float:
    parts = [int(each) / 255.0 for each in re.findall(r"\d+", window.style(selector, name))[:3]]
    linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
    return sum(weight * x for weight, x in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def test_each_curve_stands_out_from_the_paper(window: Window) -> None:
    window.js("stickslip.compare({ k: 2000 })")
    for mode in ("light", "dark"):
        window.page.emulate_media(**MODES[mode])
        paper = luminance(window, "body", "backgroundColor")
        for chart in ("x-chart", "F-chart", "phase-chart"):
            for each in window.page.locator(f"#{chart} .curve, #{chart} .threshold").all():
                name = each.get_attribute("class")
                ink = luminance(window, f"#{chart} [class='{name}']", "stroke")
                # WCAG 1.4.11; axe-core looks at texts only.
                contrast = (max(ink, paper) + 0.05) / (min(ink, paper) + 0.05)
                assert contrast >= 3.0, (chart, name)


def test_on_paper_it_is_light_and_keeps_its_values(window: Window) -> None:
    window.type("k", "1234")
    window.page.emulate_media(media="print", color_scheme="dark")
    window.drawn()
    assert luminance(window, "body", "backgroundColor") > 0.9
    inks = (("body", "color"), ("#k", "color"), ("#F-chart .threshold", "stroke"))
    assert all(luminance(window, *ink) < 0.2 for ink in inks)
    seen = ("#k", "#x-chart", "#phase-chart", ".results", "#command")
    assert [part for part in seen if not window.page.is_visible(part)] == []
    assert window.page.input_value("#k") == "1234"
    # Browsers leave out backgrounds on paper; the bands are what is said.
    assert window.style(".stick-band", "printColorAdjust") == "exact"
    hidden = ("#play", "#k-slider", ".presets", "#save-csv", "#copy")
    assert [part for part in hidden if window.page.is_visible(part)] == []


def test_on_a_phone_nothing_scrolls_sideways_and_a_finger_finds_all(
    browser: Browser, page_file: Path
) -> None:
    phone = {"width": NARROW, "height": 640}
    with another(browser, page_file, viewport=phone, has_touch=True, is_mobile=True) as window:
        for name in SI:
            assert min(window.box(f"#{name}")[3], window.box(f"#{name}-slider")[3]) >= 44
        window.unfold()
        window.page.evaluate("location.hash = '#k=" + "9" * 100 + "x'")
        window.until("document.querySelector('#address-said').textContent !== ''")
        widths = [window.js("document.scrollingElement.scrollWidth")]
        for name in PRESETS:
            window.preset(name)
            widths.append(window.js("document.scrollingElement.scrollWidth"))
        for name, text in {
            "v": "9" * 60 + "x",
            "mu_k": "0.777777777",
            "c": "123456789.12345",
        }.items():
            window.type(name, text)
            window.drawn()
            widths.append(window.js("document.scrollingElement.scrollWidth"))
        assert set(widths) == {NARROW}
