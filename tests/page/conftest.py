"""What the tests of the page share: the page as a file, and one window on it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from stickslip.page import page as page_text
from tests.page.window import Window

if TYPE_CHECKING:
    from playwright.sync_api import Browser


@pytest.fixture(scope="session")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("page") / "stick-slip.html"
    file.write_text(page_text(), encoding="utf-8")
    return file


@pytest.fixture(scope="session")
def only_window(browser: Browser, page_file: Path) -> Iterator[Window]:
    allowed = ["clipboard-read", "clipboard-write"]
    with browser.new_context(permissions=allowed) as context:
        yield Window(context, page_file)


@pytest.fixture
def window(only_window: Window) -> Iterator[Window]:
    """Give the page freshly loaded, 1280 x 800, nothing moving; it must end without an error."""
    only_window.errors.clear()
    only_window.open()
    only_window.page.mouse.move(0, 0)
    yield only_window
    assert not only_window.errors, f"errors of the page: {only_window.errors}"
