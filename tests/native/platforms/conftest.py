"""What the tests of the platforms share: the FMU for all of them."""

from pathlib import Path
from typing import Literal

import pytest

from stickslip_native import packer
from tests.sharing import made_once


def for_all(version: Literal[2, 3] = 2) -> Path:
    def make(folder: Path) -> None:
        packer.build(folder, face=version)

    return next(made_once(f"all-platforms-{version}", make).glob("*.fmu"))


def pytest_configure(config: pytest.Config) -> None:
    """Run the tests of this folder, which are of the gate, when it is named."""
    config.option.gate = True
