"""The page is alone: one file that asks for nothing, wherever it is opened, and nothing jumps."""

from __future__ import annotations

import json
import re
import shutil
from base64 import b64decode
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import pytest
from matplotlib.image import imread

from benchmarks.page import OPENING
from tests.page.browser import launched
from tests.page.settings import PRESETS
from tests.page.window import SI, Window, another

if TYPE_CHECKING:
    from playwright.sync_api import Browser

MOST_BYTES = 350_000
"""So that it travels inside an FMU."""

PLANTED = "http://127.0.0.1:9/planted"


def use_everything(window: Window, folder: Path) -> None:
    """Press, drag, type, choose and save all that the page offers."""
    window.unfold()
    for name in SI:
        window.press(name, "ArrowRight")
        window.type(name, "x")
        window.type(name, "0.4")
    window.drag("k", 0.5)
    for button in window.page.locator("button").all():
        if button.is_visible() and not (button.get_attribute("id") or "").startswith("save"):
            button.evaluate("each => each.click()")
    for name in ("save-csv", "save-svg", "save-png"):
        window.save(name, folder)
    window.preset(next(iter(PRESETS)))
    window.page.hover("#x-chart")
    window.page.fill("#scrub", "300")
    window.page.select_option("#speed", "0.05")


def test_no_request_leaves_the_page(browser: Browser, page_file: Path, tmp_path: Path) -> None:
    copy = tmp_path / "a folder" / "the page äß.html"
    copy.parent.mkdir()
    shutil.copy(page_file, copy)
    log, asked = tmp_path / "net.json", []
    with launched(browser.browser_type, f"--log-net-log={log}") as logging:
        with another(logging, copy) as window:
            assert window.text("#readout-delta_x data") == "6.305 mm"
            window.page.context.on("request", lambda request: asked.append(request.url))
            window.reload()
            use_everything(window, tmp_path)
        with logging.new_context() as context:
            context.new_page().evaluate("url => fetch(url).catch(() => null)", PLANTED)
    own = copy.as_uri()
    assert own in [url.partition("#")[0] for url in asked]
    assert [url for url in asked if not url.startswith((own, "blob:", "data:"))] == []
    # The browser's own log has the one made on purpose, and none of the page.
    assert requests_in(log) == {PLANTED}


def requests_in(log: Path) -> set[str]:
    """Return the addresses that pages asked for by a net log; the browser's own have no origin."""
    record = json.loads(log.read_text(encoding="utf-8"))
    start = record["constants"]["logEventTypes"]["URL_REQUEST_START_JOB"]
    started = [each["params"] for each in record["events"] if each["type"] == start]
    urls = {each.get("url", "") for each in started if each.get("initiator") != "not an origin"}
    return {url for url in urls if urlsplit(url).scheme in ("http", "https", "ws", "wss")}


@pytest.mark.gate
def test_it_is_small_and_names_no_address(page_file: Path) -> None:
    assert page_file.stat().st_size <= MOST_BYTES
    text = page_file.read_text(encoding="utf-8")
    found = set(re.findall(r"(?:https?|wss?):?//[^\s\"'<>)]*", text))
    # The names of XML's own vocabularies.
    assert found <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1998/Math/MathML"}
    markup, _, _ = text.partition("<script>")
    # What shows a link with title and picture takes them from here.
    seen = dict(re.findall(r'<meta property="og:(\w+)" content="([^"]*)">', markup))
    assert seen["title"] in text.partition("</title>")[0]
    encoded = seen["image"].removeprefix("data:image/png;base64,")
    assert imread(BytesIO(b64decode(encoded, validate=True))).shape[:2] == (315, 600)
    assert not re.findall(r"\b(?:src|srcset|href|action|poster)=(?![\"']?#)", markup)
    assert not re.findall(r"@import|url\((?!#)", text)


GROWS = """
addEventListener("load", () => setTimeout(() => document.body.prepend("A line above all."), 300));
"""


def test_nothing_moves_after_the_first_picture(browser: Browser, page_file: Path) -> None:
    shifts = []
    # The browser counts no shift of its own, and counts the one that is made on purpose.
    for script, width in ((OPENING, 400), (OPENING, 1280), (OPENING + GROWS, 1280)):
        size: dict[str, Any] = {
            "viewport": {"width": width, "height": 800},
            "reduced_motion": "no-preference",
        }
        with another(browser, page_file, script, **size) as window:
            shifts.append(window.js("opening.then(each => each.shift)"))
    assert shifts[:2] == [0.0, 0.0] < shifts[2:]
