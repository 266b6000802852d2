"""Nothing jumps: what is drawn once keeps its place while the rest of the page is filled in."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from benchmarks.page import OPENING

if TYPE_CHECKING:
    from playwright.sync_api import Browser

GROWS = """
addEventListener("load", () => setTimeout(() => document.body.prepend("A line above all."), 300));
"""


def shift(browser: Browser, file: Path, width: int, *scripts: str) -> float:
    """Give the layout shift in the second after the first picture, while it plays."""
    with browser.new_context(viewport={"width": width, "height": 800}) as context:
        page = context.new_page()
        for script in (OPENING, *scripts):
            page.add_init_script(script)
        page.goto(file.as_uri())
        page.wait_for_function("window.stickslip !== undefined")
        return float(page.evaluate("window.opening")["shift"])


@pytest.mark.parametrize("width", [400, 1280])
def test_nothing_moves_after_the_first_picture(
    browser: Browser, page_file: Path, width: int
) -> None:
    """The browser counts no layout shift, and counts the one that is made on purpose."""
    assert shift(browser, page_file, width) == 0.0
    assert shift(browser, page_file, width, GROWS) > 0.0
