"""What all tests share: one FMU, built once, and what they need beyond the core."""

from pathlib import Path

import pytest

from stickslip_fmu.packer import build
from tests.needs import require


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip or fail a test before anything is made for it that it cannot use."""
    require(name for mark in item.iter_markers("needs") for name in mark.args)


@pytest.fixture(scope="session")
def fmu_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the FMU of this source tree."""
    return build(tmp_path_factory.mktemp("fmu"))
