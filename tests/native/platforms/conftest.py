"""What the tests of the platforms share: one FMU of each FMI version, for all platforms."""

from pathlib import Path

import pytest

from stickslip_native import packer


@pytest.fixture(scope="session")
def all_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the native FMU 2.0 for all platforms."""
    return packer.build(tmp_path_factory.mktemp("all"))


@pytest.fixture(scope="session")
def all3_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the native FMU 3.0 for all platforms."""
    return packer.build(tmp_path_factory.mktemp("all3"), face=3)
