"""What the tests of the page share: one browser, the page as a file, and a window on it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from stickslip.page import page as page_text
from tests.needs import needs
from tests.page.browser import opened, started

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


def pytest_itemcollected(item: pytest.Item) -> None:
    """Mark what uses the browser, by whatever fixture, as in need of one."""
    if "browser" in getattr(item, "fixturenames", ()):
        item.add_marker(needs("browser"))


@pytest.fixture(scope="session")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the page, written to a file as `stickslip page` does."""
    file = tmp_path_factory.mktemp("page") / "stick-slip.html"
    file.write_text(page_text(), encoding="utf-8")
    return file


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Give a real browser."""
    with started() as browser:
        yield browser


@pytest.fixture
def page(browser: Browser, page_file: Path) -> Iterator[Page]:
    """Give the page in a fresh window of 1280 x 800; it must end without an error."""
    with opened(browser, page_file) as page:
        yield page
