"""Runs a master as a simulator is: in a process that cannot import the project.

Called with the path of `masters.py` and its arguments.
"""

import runpy
import sys
from importlib.abc import MetaPathFinder
from typing import Any


class Bar(MetaPathFinder):
    """Refuses the project's own packages."""

    def find_spec(self, name: str, path: Any, target: Any = None) -> None:
        """Raise ImportError for a package of the project, pass on every other name."""
        if name.split(".")[0] in (
            "examples",
            "stickslip",
            "stickslip_fmu",
            "stickslip_ref",
            "stickslip_verification",
        ):
            raise ImportError(f"{name} is barred here")


if __name__ == "__main__":
    sys.meta_path.insert(0, Bar())
    sys.argv = sys.argv[1:]
    runpy.run_path(sys.argv[0], run_name="__main__")
