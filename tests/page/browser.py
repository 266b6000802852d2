"""The browser that the page is tried in: found, started, and watched for errors."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.page.assemble import minified

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserType, ConsoleMessage, Page

ARGUMENTS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-software-rasterizer",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
WIDTH, HEIGHT = 1280, 800

PATIENCE = 120_000
"""How long a wait may be [ms]: on a busy machine a click alone takes seconds."""


@contextmanager
def started() -> Iterator[Browser]:
    """Start a browser."""
    # An extra that only these tests need: without it the others still run.
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright, launched(playwright.chromium) as browser:
        yield browser


def launched(chromium: BrowserType, *arguments: str) -> Browser:
    """Launch Debian's Chromium, or the one that Playwright brought, with further arguments."""
    return chromium.launch(executable_path=shutil.which("chromium"), args=[*ARGUMENTS, *arguments])


@contextmanager
def opened(
    browser: Browser,
    file: Path,
    *,
    width: int = WIDTH,
    height: int = HEIGHT,
    fragment: str = "",
    **options: Any,
) -> Iterator[Page]:
    """Open the file in a context of its own and wait till its script answers.

    Parameters
    ----------
    browser, file
        The browser, and the page as a file.
    width, height
        Of the window [px].
    fragment
        What stands after ``#`` in the address.
    options
        What else `Browser.new_context` takes, such as ``color_scheme="dark"``.

    Raises
    ------
    AssertionError
        At the end, if the page wrote an error to the console or let one escape.
    """
    errors: list[str] = []

    def note(message: ConsoleMessage) -> None:
        if message.type == "error":
            errors.append(f"console: {message.text}")

    with browser.new_context(viewport={"width": width, "height": height}, **options) as context:
        page = context.new_page()
        page.set_default_timeout(PATIENCE)
        page.on("console", note)
        page.on("pageerror", lambda error: errors.append(f"escaped: {error}"))
        page.goto(file.as_uri() + (f"#{fragment}" if fragment else ""))
        try:
            page.wait_for_function("window.stickslip !== undefined")
        except Exception as error:
            error.add_note(f"errors of the page: {errors}")
            raise
        yield page
    assert not errors, f"errors of the page: {errors}"


@contextmanager
def planted(browser: Browser, file: Path, folder: Path, piece: str, fault: str) -> Iterator[Page]:
    """Open the page with a fault planted: another piece of script in place of the one there.

    Raises
    ------
    AssertionError
        If the piece does not stand in the page exactly once.
    """
    text = file.read_text(encoding="utf-8")
    # What ends a statement or an entry is gone where it is the last.
    piece, fault = (minified(each).rstrip(";,") for each in (piece, fault))
    assert text.count(piece) == 1, piece
    faulty = folder / "faulty.html"
    faulty.write_text(text.replace(piece, fault), encoding="utf-8")
    with opened(browser, faulty) as page:
        yield page
