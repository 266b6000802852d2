"""Bars the project from a process that plays a user, who has an importer and the FMU alone.

To be run by its path: such a process cannot import it either.
"""

import sys
from importlib.abc import MetaPathFinder
from typing import Any

_BARRED = (
    "examples",
    "fmukit",
    "stickslip",
    "stickslip_fmu",
    "stickslip_ref",
    "stickslip_verification",
)


class Bar(MetaPathFinder):
    """Refuses the project's own packages."""

    def find_spec(self, name: str, path: Any, target: Any = None) -> None:
        """Raise ImportError for a package of the project, pass on every other name."""
        if name.partition(".")[0] in _BARRED:
            raise ImportError(f"{name} is barred here")


if __name__ == "__main__":
    sys.meta_path.insert(0, Bar())
