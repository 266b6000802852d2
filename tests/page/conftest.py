"""What the tests of the page share: the page as a file, and a window on it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from stickslip.page import page as page_text
from tests.page.browser import opened

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


@pytest.fixture(scope="session")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the page, written to a file as `stickslip page` does."""
    file = tmp_path_factory.mktemp("page") / "stick-slip.html"
    file.write_text(page_text(), encoding="utf-8")
    return file


@pytest.fixture
def page(browser: Browser, page_file: Path) -> Iterator[Page]:
    """Give the page in a fresh window of 1280 x 800; it must end without an error."""
    with opened(browser, page_file) as page:
        yield page
