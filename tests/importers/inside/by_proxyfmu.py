"""Ecos with the FMU in a process of its own: proxyfmu, a program written in C++."""

import os
import shutil
import tempfile
from functools import cache
from pathlib import Path

import ecospy

from .by_ecospy import Ecos
from .simulation import NotOfferedError


class Proxyfmu(Ecos):
    def uri(self, fmu: str) -> str:
        put_on_path()
        return f"proxyfmu://localhost?file={fmu}"

    def reset(self) -> None:
        # It passes on no reset: after one of Ecos, which does not tell, nothing moves.
        raise NotOfferedError("reset")


@cache
def put_on_path() -> None:
    folder = tempfile.mkdtemp()
    copied = shutil.copy(Path(ecospy.__file__).parent / "binaries" / "proxyfmu", folder)
    Path(copied).chmod(0o755)
    os.environ["PATH"] = f"{folder}{os.pathsep}{os.environ['PATH']}"


SIMULATION = Proxyfmu
