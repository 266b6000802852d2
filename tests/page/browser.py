"""The browser that the page is tried in: found, started, and watched for errors."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

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

PATIENCE = 120_000
"""How long a wait may be [ms]: on a busy machine a click alone takes seconds."""


@contextmanager
def started() -> Iterator[Browser]:
    # An extra that only these tests need: without it the others still run.
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright, launched(playwright.chromium) as browser:
        yield browser


def launched(chromium: BrowserType, *arguments: str) -> Browser:
    """Launch Debian's Chromium, or the one that Playwright brought, with further arguments."""
    # The shell has no windows to manage: a page of its own costs a third there.
    path = shutil.which("chromium-headless-shell") or shutil.which("chromium")
    return chromium.launch(executable_path=path, args=[*ARGUMENTS, *arguments])


def watched(page: Page) -> list[str]:
    errors: list[str] = []

    def note(message: ConsoleMessage) -> None:
        if message.type == "error":
            errors.append(f"console: {message.text}")

    page.set_default_timeout(PATIENCE)
    page.on("console", note)
    page.on("pageerror", lambda error: errors.append(f"escaped: {error}"))
    return errors
