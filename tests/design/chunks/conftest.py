"""What the tests of chunks share."""

from pathlib import Path

import pytest


@pytest.fixture
def marks(tmp_path: Path) -> Path:
    folder = tmp_path / "marks"
    folder.mkdir()
    return folder
