"""What the tests of the native FMU share: one of each FMI version, compiled for this machine."""

from pathlib import Path

import pytest

from stickslip_native import packer


@pytest.fixture(scope="session")
def native_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the native FMU 2.0 of this machine."""
    return packer.build(tmp_path_factory.mktemp("native"), this_machine=True)


@pytest.fixture(scope="session")
def native3_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the native FMU 3.0 of this machine."""
    return packer.build(tmp_path_factory.mktemp("native3"), face=3, this_machine=True)


@pytest.fixture(params=[2, 3])
def native(request: pytest.FixtureRequest) -> Path:
    """Return the native FMU of either version."""
    path: Path = request.getfixturevalue("native_path" if request.param == 2 else "native3_path")
    return path
