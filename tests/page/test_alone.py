"""The page is alone: one file that asks for nothing, wherever it is opened."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

import pytest

from tests.page.browser import launched, opened
from tests.page.settings import presets
from tests.page.using import SI, drag, open_folds, press, type_in

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

MOST_BYTES = 200_000
BUTTONS = (
    "play",
    "play",
    "sound",
    "sound",
    "zoom-in",
    "zoom-out",
    "earlier",
    "later",
    "zoom-auto",
    "copy",
)
PLANTED = "http://127.0.0.1:9/planted"
FILES = ("save-csv", "save-svg", "save-png")


def use_everything(page: Page) -> None:
    """Press, drag, type, choose and save all that the page offers."""
    open_folds(page)
    for name in SI:
        press(page, name, "ArrowRight")
        type_in(page, name, "x")
        type_in(page, name, "0.4")
    drag(page, "k", 0.5)
    for preset in presets():
        page.click(f"[data-preset={preset}]")
    for button in BUTTONS:
        page.click(f"#{button}")
    for sentence in page.locator("[data-said]").all():
        sentence.click()
    for button in FILES:
        with page.expect_download() as download:
            page.click(f"#{button}")
        download.value.path()
    page.hover("#x-chart")
    page.fill("#scrub", "300")
    page.select_option("#speed", "0.05")
    for link in page.locator("a[href]").all():
        assert (link.get_attribute("href") or "").startswith("#")


@dataclass(frozen=True)
class Session:
    """What was asked for while the whole page was used: as the page's own events and in the log."""

    asked: list[str]
    logged: set[str]


@pytest.fixture(scope="module")
def session(browser: Browser, page_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Session:
    """Use everything in a browser that logs; afterwards one request is made on purpose."""
    log = tmp_path_factory.mktemp("net") / "net.json"
    asked: list[str] = []
    with launched(browser.browser_type, f"--log-net-log={log}") as logging:
        with opened(logging, page_file) as page:
            page.context.on("request", lambda request: asked.append(request.url))
            page.reload()
            page.wait_for_function("window.stickslip !== undefined")
            use_everything(page)
        with logging.new_context() as context:
            context.new_page().evaluate("url => fetch(url).catch(() => null)", PLANTED)
    return Session(asked, requests_in(log))


def test_no_request_leaves_the_page(session: Session, page_file: Path) -> None:
    """From loading to the last export, the page fetches itself and what it made itself."""
    own = page_file.as_uri()
    assert own in [url.partition("#")[0] for url in session.asked]
    assert not [url for url in session.asked if not url.startswith((own, "blob:", "data:"))]


def test_the_browsers_own_log_shows_no_request(session: Session) -> None:
    """Chromium's net log has nothing of the whole session, but has the one made on purpose."""
    assert session.logged == {PLANTED}


def requests_in(log: Path) -> set[str]:
    """Give the addresses on the network that a net log says a page has asked for.

    What the browser asks for itself, such as its own updates, has "not an origin" as initiator.
    """
    record = json.loads(log.read_text(encoding="utf-8"))
    start = record["constants"]["logEventTypes"]["URL_REQUEST_START_JOB"]
    started = [each["params"] for each in record["events"] if each["type"] == start]
    urls = {each.get("url", "") for each in started if each.get("initiator") != "not an origin"}
    return {url for url in urls if urlsplit(url).scheme in ("http", "https", "ws", "wss")}


def test_it_is_small(page_file: Path) -> None:
    """The whole page is at most 200 kB, so that it travels inside an FMU."""
    assert page_file.stat().st_size <= MOST_BYTES


def test_it_names_no_address(page_file: Path) -> None:
    """No address stands in the file but the names of XML's own vocabularies."""
    text = page_file.read_text(encoding="utf-8")
    found = set(re.findall(r"(?:https?|wss?):?//[^\s\"'<>)]*", text))
    assert found <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1998/Math/MathML"}
    markup, _, script = text.partition("<script>")
    assert not re.findall(r"\b(?:src|srcset|href|action|poster)=(?![\"']?#)", markup)
    assert not re.findall(r"@import|url\((?!#)", text)
    # The script makes addresses of its own data alone, for the PNG and for the downloads.
    made = re.findall(r"\.(?:src|href)=([`\w.:/]+)", script)
    assert sorted(made) == ["URL.createObjectURL", "`data:image/svg"]
    for name in ("fetch(", "XMLHttpRequest", "WebSocket", "sendBeacon", "EventSource", "import("):
        assert name not in text


def test_it_is_one_whole_document(page_file: Path, tmp_path: Path, browser: Browser) -> None:
    """Copied alone to another folder, under a name with blanks, it is the same page."""
    copy = tmp_path / "a folder" / "the page äß.html"
    copy.parent.mkdir()
    shutil.copy(page_file, copy)
    with opened(browser, copy) as page:
        assert page.inner_text("#readout-delta_x data") == "6.305\u00a0mm"
