"""What the tests of the FMU share: the other face, built once."""

from pathlib import Path

import pytest

from stickslip_fmu import packer


@pytest.fixture(scope="session")
def fmi3_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the FMU with the FMI 3.0 face."""
    return packer.build(tmp_path_factory.mktemp("fmi3"), face=3)
