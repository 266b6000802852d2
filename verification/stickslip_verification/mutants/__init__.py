"""Planted faults: each a small description, made into a real FMU from the one under test.

`load_mutants` reads the descriptions, `plant` makes the FMU. Names are resolved when they are
first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip_verification.lazy import face

if TYPE_CHECKING:
    from stickslip_verification.mutants.maker import plant
    from stickslip_verification.mutants.planted import (
        Mutant,
        MutantError,
        load_mutant,
        load_mutants,
    )

_HOME = {
    "Mutant": "planted",
    "MutantError": "planted",
    "load_mutant": "planted",
    "load_mutants": "planted",
    "plant": "maker",
}

__all__ = ["Mutant", "MutantError", "load_mutant", "load_mutants", "plant"]

__getattr__, __dir__ = face(__name__, _HOME)
