"""What the tests of the native FMU share: one of each law and FMI version, for this machine."""

from functools import cache
from pathlib import Path
from typing import Literal, Protocol

import pytest

from stickslip_native import packer

FACES: tuple[Literal[2, 3], ...] = (2, 3)
LAWS = ("coulomb", "stribeck")
EACH = [(face, law) for law in LAWS for face in FACES]
"""Every FMI version with every friction law."""


class Native(Protocol):
    """Gives the native FMU of a version of FMI, 2 or 3, under a friction law."""

    def __call__(self, face: Literal[2, 3], law: str = "coulomb") -> Path: ...  # noqa: D102


@pytest.fixture(scope="session")
def native(tmp_path_factory: pytest.TempPathFactory) -> Native:
    """Give the native FMU of a version of FMI under a friction law."""

    @cache
    def built(face: Literal[2, 3], law: str = "coulomb") -> Path:
        folder = tmp_path_factory.mktemp(f"native-{law}-{face}")
        return packer.build(folder, face=face, this_machine=True, law=law)

    return built


@pytest.fixture(scope="session")
def native_path(native: Native) -> Path:
    """Return the native FMU 2.0 of this machine."""
    return native(2)


@pytest.fixture(scope="session")
def native3_path(native: Native) -> Path:
    """Return the native FMU 3.0 of this machine."""
    return native(3)


@pytest.fixture(params=EACH, ids=lambda each: f"{each[1]}-{each[0]}")
def either_native(request: pytest.FixtureRequest, native: Native) -> Path:
    """Return the native FMU of either version, under each law."""
    face, law = request.param
    return native(face, law)
