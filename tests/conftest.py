"""What all tests share: one FMU, built once."""

from pathlib import Path

import pytest

from stickslip_fmu.packer import build


@pytest.fixture(scope="session")
def fmu_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the FMU of this source tree."""
    return build(tmp_path_factory.mktemp("fmu"))
