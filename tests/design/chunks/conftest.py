"""What the tests of chunks share."""

from importlib import import_module
from pathlib import Path

import pytest

RUN = import_module("stickslip_design.chunks.run")
"""The module, whose name is also that of its function."""


@pytest.fixture
def _short_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have chunks of a twentieth of a second, and workers for every study."""
    monkeypatch.setattr("stickslip_design.chunks.plan._SECONDS", 0.05)
    monkeypatch.setattr(RUN, "_SHORT", 0.0)


@pytest.fixture
def _by_workers_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have no chunk computed in this process, for a study that harms the one that computes it."""
    monkeypatch.setattr(RUN._Running, "here", lambda *_, **__: None)


@pytest.fixture
def marks(tmp_path: Path) -> Path:
    """Return a folder in which a study marks what it computes."""
    folder = tmp_path / "marks"
    folder.mkdir()
    return folder
