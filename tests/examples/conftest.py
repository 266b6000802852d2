"""What the tests of the feed axis share: both FMUs, built once."""

import shutil
from pathlib import Path

import pytest

from examples.feed_axis.build import build_drive


@pytest.fixture(scope="session")
def fmus(fmu_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with StickSlip.fmu and ServoDrive.fmu."""
    folder = tmp_path_factory.mktemp("feed_axis")
    shutil.copy(fmu_path, folder / "StickSlip.fmu")
    build_drive(folder)
    return folder
