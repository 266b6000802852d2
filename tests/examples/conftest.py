"""What the tests of the feed axis share: both FMUs, built once."""

import shutil
from pathlib import Path

import pytest

from stickslip.systems import build_driver
from tests.sharing import made_once


@pytest.fixture(scope="session")
def fmus(fmu_path: Path) -> Path:
    def make(folder: Path) -> None:
        shutil.copy(fmu_path, folder / "StickSlip.fmu")
        build_driver("drive", folder)

    return made_once("feed-axis", make)
