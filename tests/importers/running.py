"""Runs an importer in a process that cannot import the project."""

from __future__ import annotations

import atexit
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

from stickslip.host.launch import prepare
from tests.driver import Host
from tests.importers.cases import CASES
from tests.importers.inside import act

INSIDE = Path(__file__).with_name("inside")
IMPORTERS = tuple(sorted(file.stem.removeprefix("by_") for file in INSIDE.glob("by_*.py")))
"""Importers by name: each has a module `by_NAME.py` in `inside/`."""
CONTAINERS = ("fmucontainer", "fmpy_container")
"""Those that run a pair of blocks whatever the case."""
PAIRING = ("libcosimpy", "ecospy", "proxyfmu")
"""Those that run a pair of blocks where asked to."""
NOT_PYTHON = ("proxyfmu",)
"""Those in which the FMU runs in a process that is not Python."""


@dataclass(frozen=True)
class Rows:
    """What an importer recorded in one run: outputs by name, at its own communication times [s]."""

    times: tuple[float, ...]
    outputs: Mapping[str, tuple[float | int | bool, ...]]
    again: Rows | None = None
    """Of the case `restart` the second run in the same process."""
    nested: Rows | None = None
    """Of a pair of blocks the rows of the second."""


@cache
def host(importer: str) -> Host:
    """Return the process of an importer, with what `stickslip host` sets where it needs that."""
    process = Host(**preload(importer))
    atexit.register(process.end)
    return process


def preload(importer: str) -> Mapping[str, str]:
    """Return the variables that `stickslip host` sets, for an importer that is not Python."""
    return prepare([importer], None, os.environ).changes if importer in NOT_PYTHON else {}


def ask(importer: str, what: str, *arguments: Any, process: Host | None = None) -> tuple[Any, str]:
    """Call a method of the importer's simulation, the path of the FMU its first argument.

    Return what it returned, and what the process wrote: that of the importer where None is given.
    Raises `DiedError` where it crashes or hangs.
    """
    process = process or host(importer)
    answer = process.call(act, f"by_{importer}", f"SIMULATION.{what}", *arguments)
    return answer, process.errors()


def run(importer: str, fmu: Path, case: str, how: str = "run") -> Rows:
    """Run a case; `how` may be "pair", and "in_threads" for fmucontainer."""
    return rows_of(ask(importer, how, fmu, asdict(CASES[case]))[0])


def rows_of(answer: Mapping[str, Any]) -> Rows:
    """Return the rows in the answer of a run."""
    again, nested = answer.get("again"), answer.get("nested")
    return Rows(
        tuple(answer["times"]),
        {name: tuple(samples) for name, samples in answer["outputs"].items()},
        rows_of(again) if again else None,
        rows_of(nested) if nested else None,
    )
