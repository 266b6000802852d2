"""The faultless foreign FMUs that the suite is tried on, and their faulty twins."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from stickslip_verification.drive.fmu.names import NameMap, load_names
from tests.needs import needs
from tests.verification.foreign import building, exact_in_c

COMBINATIONS: Mapping[str, str] = {
    "runge_kutta": "no-external-when-damped",
    "taylor": "load-ignored-backward",
    "renamed": "no-damping-after-reversal",
    "exact_in_c": "push-lost-beside-load",
}
"""Foreign FMU to a fault of it that shows where inputs, damping and phases meet."""

CALLING_PATTERNS: Mapping[str, str] = {
    "runge_kutta": "state-loses-pending",
    "taylor": "moves-when-read",
    "renamed": "clamp-when-set",
    "exact_in_c": "reset-keeps-mass",
}
"""Foreign FMU to a fault of it that shows in how a master calls."""

MAKERS = [
    "runge_kutta",
    "taylor",
    "renamed",
    pytest.param("exact_in_c", marks=needs("cc")),
]
"""The foreign FMUs, as values of a parameter of tests."""

WITHOUT_STATE = frozenset({"taylor"})
"""Foreign FMUs that cannot get and set their state."""


def make(maker: str, folder: Path, fault: str = "", conventions: bool = True) -> Path:
    """Build a foreign FMU, with a fault of `COMBINATIONS` or `CALLING_PATTERNS` in it if given.

    Without `conventions` the FMU `renamed` keeps those of the exact block.
    """
    name = "".join(word.capitalize() for word in f"{maker}-{fault}".replace("_", "-").split("-"))
    if maker == "exact_in_c":
        return exact_in_c.build(folder, name, fault)
    settings = {"FAULT": repr(fault)}
    if not conventions:
        name, settings["CONVENTIONS"] = f"{name}Plain", "()"
    able = maker not in WITHOUT_STATE
    return building.build(
        maker, folder, name, settings, canGetAndSetFMUstate=able, canSerializeFMUstate=able
    )


def names_of(maker: str) -> NameMap:
    """Return the map from our names to those of a foreign FMU."""
    return load_names(building.HERE / f"{maker}.toml")
