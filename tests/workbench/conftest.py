"""What the tests of the workbench share."""

from pathlib import Path

import pytest

from .running import Command


@pytest.fixture
def command(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    fmu_path: Path,
) -> Command:
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys, fmu_path)
