"""Planted faults: each a small description, made into a real FMU from the one under test.

`load_mutants` reads the descriptions, `plant` makes the FMU. Names are resolved when they are
first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip_verification.mutants.maker import plant
    from stickslip_verification.mutants.planted import Mutant, MutantError, load_mutants

_HOME = {
    "Mutant": "planted",
    "MutantError": "planted",
    "load_mutants": "planted",
    "plant": "maker",
}

__all__ = ["Mutant", "MutantError", "load_mutants", "plant"]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
