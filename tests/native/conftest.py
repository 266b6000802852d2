"""What the tests of the native FMU share: it, compiled for this machine, once for each face."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from stickslip_native.packer import build

Native = Callable[[int], Path]


@pytest.fixture(scope="session")
def native(tmp_path_factory: pytest.TempPathFactory) -> Native:
    """Give the native FMU of a version of FMI, 2 or 3."""

    @cache
    def built(face: int) -> Path:
        assert face in (2, 3)
        return build(
            tmp_path_factory.mktemp("native"), face=3 if face == 3 else 2, this_machine=True
        )

    return built
