"""Runs a script as a user does."""

import runpy
from typing import Any


def run(fmu: str, script: Any) -> None:
    """Run the script of this name in the working folder, where the FMU lies too."""
    runpy.run_path(script, run_name="__main__")
