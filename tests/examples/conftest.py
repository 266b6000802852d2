"""What the tests of the feed axis share: both FMUs, built once."""

import shutil
from pathlib import Path

import pytest

from stickslip.systems import driver_of
from tests.sharing import made_once


@pytest.fixture(scope="session")
def fmus(fmu_path: Path) -> Path:
    def make(folder: Path) -> None:
        shutil.copy(fmu_path, folder / "StickSlip.fmu")
        driver_of("drive", folder)

    return made_once("feed-axis", make)
