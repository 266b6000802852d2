"""Runs an importer in a process that cannot import the project."""

import atexit
from collections.abc import Mapping
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

from tests.driver import Host
from tests.importers.cases import CASES
from tests.importers.inside import act
from tests.needs import LIBPYTHON

INSIDE = Path(__file__).with_name("inside")
IMPORTERS = tuple(sorted(file.stem.removeprefix("by_") for file in INSIDE.glob("by_*.py")))
"""Importers by name: each has a module `by_NAME.py` in `inside/`."""
PAIRING = ("libcosimpy", "ecospy", "proxyfmu", "fmucontainer")
"""Those that can connect two blocks."""
NOT_PYTHON = ("proxyfmu",)
"""Those in which the FMU runs in a process that is not Python."""

Rows = dict[str, Any]
"""What was recorded: `times` [s] of the importer, `outputs` by name; of a pair of blocks those of
the second, `nested`; of the case `restart` the second run in the same process, `again`."""


@cache
def host(importer: str) -> Host:
    process = Host(**preload(importer))
    atexit.register(process.end)
    return process


def preload(importer: str) -> Mapping[str, str]:
    return {"LD_PRELOAD": str(LIBPYTHON)} if importer in NOT_PYTHON else {}


def ask(importer: str, what: str, *arguments: Any, process: Host | None = None) -> tuple[Any, str]:
    process = process or host(importer)
    answer = process.call(act, f"by_{importer}", f"SIMULATION.{what}", *arguments)
    return answer, process.errors()


def run(importer: str, fmu: Path, case: str, how: str = "run") -> Rows:
    rows: Rows = ask(importer, how, fmu, asdict(CASES[case]))[0]
    return rows
