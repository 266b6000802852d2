"""How a person uses the page: types, drags, presses keys, and looks at what is shown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stickslip.units import parse

if TYPE_CHECKING:
    from playwright.sync_api import Page

SI = {"k": "N/m", "v": "m/s", "mu_s": "1", "mu_k": "1", "N": "N", "m": "kg", "c": "N.s/m"}
"""The controls, in the order of the page, with their units as the command knows them."""
CURVES = ("#x-chart .curve.mass", "#x-chart .curve.pull", "#F-chart .curve.force")

_NEXT_FRAME = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


def drawn(page: Page) -> None:
    """Wait until what was asked for is on the screen: the page draws at the next frame."""
    page.evaluate(_NEXT_FRAME)


def pause(page: Page) -> None:
    """Stop the motion, so that only a person moves the cursor."""
    if page.text_content("#play") == "Pause":
        page.click("#play")


def look(page: Page, start: float, end: float) -> None:
    """Let the charts show a stretch of time [s]."""
    page.evaluate("([from, to]) => { window.stickslip.view = { from, to }; }", [start, end])


def type_in(page: Page, name: str, text: str) -> None:
    """Type a text for a parameter, in place of what stands there."""
    page.fill(f"#{name}", text)


def press(page: Page, slider: str, *keys: str) -> None:
    """Press keys on the slider of a parameter."""
    page.focus(f"#{slider}-slider")
    for key in keys:
        page.keyboard.press(key)


def drag(page: Page, name: str, share: float) -> None:
    """Drag the slider of a parameter with the mouse to a share of its length."""
    slider = page.locator(f"#{name}-slider")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    assert box is not None
    low, high, value = (float(slider.evaluate(f"s => s.{end}")) for end in ("min", "max", "value"))
    # The thumb is 16 px wide and stays inside the track.
    reach = box["width"] - 16
    middle = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 8 + reach * (value - low) / (high - low), middle)
    page.mouse.down()
    page.mouse.move(box["x"] + 8 + reach * share, middle, steps=4)
    page.mouse.up()


def set_values(page: Page, **values: float) -> None:
    """Set parameters (SI) as a script does, and see them drawn."""
    page.evaluate("values => window.stickslip.set(values)", values)


def setting(page: Page) -> Mapping[str, float]:
    """Give the values in use, SI, unrounded."""
    found: Mapping[str, float] = page.evaluate("window.stickslip.setting")
    return {name: float(value) for name, value in found.items()}


def shown(page: Page) -> Mapping[str, Any]:
    """Give what the pictures show, the cursor apart: the data of every curve."""
    drawn(page)
    found: Mapping[str, Any] = page.evaluate(
        "all => Object.fromEntries("
        "all.map(each => [each, document.querySelector(each).getAttribute('d')]))",
        [*CURVES, "#phase-chart .curve.mass"],
    )
    return found


def text_of(page: Page, selector: str) -> str:
    """Give the text that is seen in a part of the page, once it is drawn."""
    drawn(page)
    return page.inner_text(selector)


def si_of(page: Page, name: str) -> float:
    """Give what stands in the field of a parameter with the unit beside it, SI."""
    typed = f"{page.input_value(f'#{name}')} {page.inner_text(f'#{name}-unit')}"
    return parse(typed, SI[name], name)


def said(page: Page, name: str) -> str:
    """Give what stands under a control, if it can be seen."""
    note = page.locator(f"#{name}-said")
    return note.inner_text() if note.is_visible() else ""


def open_folds(page: Page) -> None:
    """Unfold everything that can be unfolded."""
    page.evaluate("document.querySelectorAll('details').forEach(each => (each.open = true))")
