"""What the tests of the native FMU share: one of each FMI version, compiled for this machine."""

from collections.abc import Callable
from pathlib import Path

import pytest

from stickslip_native import packer

Native = Callable[[int], Path]


@pytest.fixture(scope="session")
def native_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the native FMU 2.0 of this machine."""
    return packer.build(tmp_path_factory.mktemp("native"), this_machine=True)


@pytest.fixture(scope="session")
def native3_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the native FMU 3.0 of this machine."""
    return packer.build(tmp_path_factory.mktemp("native3"), face=3, this_machine=True)


@pytest.fixture(scope="session")
def native(native_path: Path, native3_path: Path) -> Native:
    """Give the native FMU of a version of FMI, 2 or 3."""
    return {2: native_path, 3: native3_path}.__getitem__


@pytest.fixture(params=[2, 3])
def either_native(request: pytest.FixtureRequest, native: Native) -> Path:
    """Return the native FMU of either version."""
    return native(request.param)
