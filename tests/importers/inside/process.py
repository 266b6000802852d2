"""A process of a user who has an importer and the FMU, and nothing of this project.

Called with a module here, a function of it, the FMU, a file with the function's
argument and one for what it returns, both JSON. JSON keeps every digit of a double.
"""

import importlib
import json
import sys
from importlib.abc import MetaPathFinder
from pathlib import Path
from typing import Any


class Bar(MetaPathFinder):
    """Refuses the project's own packages."""

    def find_spec(self, name: str, path: Any, target: Any = None) -> None:
        """Raise ImportError for a package of the project, pass on every other name."""
        if name.split(".")[0] in (
            "stickslip",
            "stickslip_fmu",
            "stickslip_ref",
            "stickslip_verification",
        ):
            raise ImportError(f"{name} is barred here")


if __name__ == "__main__":
    sys.meta_path.insert(0, Bar())
    # python -I leaves the folder of the script out, and with it this package.
    sys.path.insert(0, str(Path(__file__).parents[1]))
    name, function, fmu, order, answer = sys.argv[1:]
    module = importlib.import_module(f"inside.{name}")
    argument = json.loads(Path(order).read_text(encoding="utf-8"))
    given = getattr(module, function)(fmu, argument)
    Path(answer).write_text(json.dumps(given), encoding="utf-8")
