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
    for name, key in (("squeaky-drawer", "Enter"), ("violin-bow", "Space")):
        window.page.press(f"[data-preset={name}]", key)
        assert window.setting == PRESETS[name]
    window.page.focus("#v")
    window.page.keyboard.press("Control+a")
    window.page.keyboard.type("12.5")
    assert window.setting["v"] == 0.0125
    window.page.focus("#speed")
    window.page.keyboard.press("ArrowDown")
    assert window.page.input_value("#speed") == "1"


def test_a_screen_reader_hears_each_value_with_its_unit_and_the_result_once(
    window: Window,
) -> None:
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
    window.js(
        """() => {
          window.heard = [];
          const live = "[aria-live]:not([aria-live=off]), [role=status], [role=alert], output";
          new MutationObserver(all => all.forEach(({ target }) => {
            const element = target.nodeType === 1 ? target : target.parentElement;
            const region = element.closest(live);
            if (region) window.heard.push([region.id, region.textContent]);
          })).observe(document.body, { subtree: true, childList: true, characterData: true });
        }"""
    )
    for _ in range(10):
        window.drawn()
    assert window.js("heard") == []
    # Fifteen moves are one sentence, when they end.
    window.press("k", *["ArrowRight"] * 15)
    window.until("heard.length > 0")
    window.drawn()
    ((region, heard),) = window.js("heard")
    assert region == "told"
    assert heard == window.page.text_content("#lead") != before
    assert "mm" in heard
    assert "ms" in heard


def rgb(window: Window, selector: str, name: str) -> list[float]:
    """Return red, green and blue of a colour of an element, each from 0 to 1."""
    return [int(each) / 255.0 for each in re.findall(r"\d+", window.style(selector, name))[:3]]


def luminance(window: Window, selector: str, name: str) -> float:
    """Return the relative luminance of a colour of an element, WCAG 2.2."""
    red, green, blue = (
        part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4
        for part in rgb(window, selector, name)
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


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
    for part in ("#k", "#mu_k", "#x-chart", "#F-chart", "#phase-chart", ".results", "#command"):
        assert window.page.is_visible(part)
    assert window.page.input_value("#k") == "1234"
    # Browsers leave out backgrounds on paper; the bands are what is said.
    assert window.style(".stick-band", "printColorAdjust") == "exact"
    for part in ("#play", "#k-slider", ".presets", "#save-csv", "#copy"):
        assert not window.page.is_visible(part)


def width_of(window: Window) -> int:
    window.drawn()
    width: int = window.js("document.scrollingElement.scrollWidth")
    return width


def test_on_a_phone_nothing_scrolls_sideways_and_a_finger_finds_all(
    browser: Browser, page_file: Path
) -> None:
    phone = {"width": NARROW, "height": 640}
    with another(browser, page_file, viewport=phone, has_touch=True, is_mobile=True) as window:
        assert width_of(window) == NARROW
        for name in SI:
            assert min(window.box(f"#{name}")[3], window.box(f"#{name}-slider")[3]) >= 44
        window.unfold()
        assert width_of(window) == NARROW
        for name in PRESETS:
            window.preset(name)
            assert width_of(window) == NARROW
        for texts in (
            dict.fromkeys(("k", "v", "mu_s", "m"), "9" * 60 + "x") | {"mu_k": "0.77777777777"},
            {"k": "1.2345678901234567e-5", "c": "123456789.123456789"},
        ):
            for name, text in texts.items():
                window.type(name, text)
            assert width_of(window) == NARROW
        window.page.evaluate("location.hash = '#k=" + "9" * 100 + "x'")
        window.until("document.querySelector('#address-said').textContent !== ''")
        assert width_of(window) == NARROW
