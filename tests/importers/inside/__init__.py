"""What runs in a process that has an importer and the FMU, and nothing of the project."""

import ctypes
import importlib
import operator
import os
import sys
import tempfile
from typing import Any


def act(module: str, name: str, *arguments: Any) -> Any:
    os.chdir(tempfile.mkdtemp())
    # What it prints is read with what it writes to standard error.
    os.dup2(2, 1)
    try:
        return operator.attrgetter(name)(importlib.import_module(f".{module}", __name__))(
            *arguments
        )
    finally:
        sys.stdout.flush()
        ctypes.CDLL(None).fflush(None)
