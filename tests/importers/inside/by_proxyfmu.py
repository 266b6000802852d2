"""Ecos with the FMU in a process of its own: proxyfmu, a program written in C++."""

import os
import shutil
from pathlib import Path
from typing import Any

import ecospy

from .by_ecospy import pair_at, simulation, steps


def run(fmu: str, case: Any) -> Any:
    """Run a case; `restart` in a second process of the FMU, since proxyfmu passes on no reset."""
    prepare()
    first = once(fmu, case)
    if case["name"] != "restart":
        return first
    return {**first, "again": once(fmu, case), "how": "a second simulation and FMU process"}


def pair(fmu: str, case: Any) -> Any:
    """Run a case of two blocks, each in its process, as `by_ecospy` does."""
    prepare()
    return pair_at(uri(fmu), fmu, case)


def once(fmu: str, case: Any) -> Any:
    """Run a case in a simulation of its own."""
    with simulation(uri(fmu), case) as opened:
        [rows] = steps(opened, fmu, case)
    return rows


def uri(fmu: str) -> str:
    """Return what tells Ecos to start proxyfmu for this FMU."""
    return f"proxyfmu://localhost?file={fmu}"


def prepare() -> None:
    """Put a proxyfmu that may run on the PATH: what `chmod +x` does where one may change it."""
    programs = Path("programs").resolve()
    programs.mkdir()
    copied = shutil.copy(Path(ecospy.__file__).parent / "binaries" / "proxyfmu", programs)
    Path(copied).chmod(0o755)
    os.environ["PATH"] = f"{programs}{os.pathsep}{os.environ['PATH']}"
