"""Runs a case in an importer, in a fresh process that cannot import the project."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from stickslip.host.launch import prepare
from tests.importers.cases import CASES

INSIDE = Path(__file__).with_name("inside")
IMPORTERS = tuple(sorted(file.stem.removeprefix("able_") for file in INSIDE.glob("able_*.py")))
"""Importers by name: each has the modules `by_NAME.py` and `able_NAME.py` in `inside/`."""
CONTAINERS = ("fmucontainer", "fmpy_container")
"""Those that run two blocks at once."""
NOT_PYTHON = ("proxyfmu",)
"""Those in which the FMU runs in a process that is not Python."""

_LIMIT = 120.0
"""Seconds after which a process counts as hung; the longest takes two."""


@dataclass(frozen=True)
class Rows:
    """What an importer recorded in one run.

    Attributes
    ----------
    times
        Communication times [s], as the importer gives them.
    outputs
        Every output at those times, by name: floats in SI, mode and n_slips int, sticking bool.
    again
        Of the case `restart` the second run in the same process, else None.
    how
        Of the case `restart` how the importer was made to run again, else "".
    nested
        Of a container the rows of the second block, that is inside with the first; else None.
    """

    times: tuple[float, ...]
    outputs: Mapping[str, tuple[float | int | bool, ...]]
    again: Rows | None = None
    how: str = ""
    nested: Rows | None = None


@dataclass(frozen=True)
class Said:
    """What a process left behind: its answer, and what it wrote."""

    answer: Any
    out: str
    err: str


class ImporterError(RuntimeError):
    """The importer's process ended badly; the message has its exit code and what it wrote.

    `code` is the exit code, minus the signal's number where a signal ended it; `err` what the
    process wrote on standard error.
    """

    def __init__(self, message: str, done: subprocess.CompletedProcess[str]) -> None:
        super().__init__(message)
        self.code = done.returncode
        self.err = done.stderr


def run(
    importer: str, fmu: Path, case: str, folder: Path, environment: Mapping[str, str] | None = None
) -> Rows:
    """Run a case of `cases.CASES` in an importer and return what it recorded.

    Parameters
    ----------
    importer
        One of `IMPORTERS`.
    fmu
        The FMU.
    folder
        An empty folder for everything the run writes; temporary files of the importer too.
    environment
        Further environment variables of the process.

    Raises
    ------
    ImporterError
        The process failed, crashed or hung.
    """
    needed = {**preload(importer), **(environment or {})}
    return _rows(ask(f"by_{importer}", "run", fmu, folder, needed, asdict(CASES[case])).answer)


def run_pair(importer: str, fmu: Path, case: str, folder: Path, *, how: str = "pair") -> Rows:
    """Run a case of two connected blocks in one simulation; the second is in `nested`.

    For libcosimpy, ecospy and proxyfmu, and for fmucontainer with how="in_threads"; without
    threads the containers do so in `run`.
    """
    argument = asdict(CASES[case])
    return _rows(ask(f"by_{importer}", how, fmu, folder, preload(importer), argument).answer)


def ask(
    module: str,
    what: str,
    fmu: Path,
    folder: Path,
    environment: Mapping[str, str] | None = None,
    argument: Any = None,
) -> Said:
    """Call the function `what` of a module of `inside/` with the FMU and `argument`.

    Parameters and errors as of `run`; the answer is what the function returned, through JSON.
    """
    order = folder / "order.json"
    answer = folder / "answer.json"
    order.write_text(json.dumps(argument), encoding="utf-8")
    process = [sys.executable, "-I", str(INSIDE / "process.py"), module, what]
    done = subprocess.run(
        [*process, str(fmu), str(order), str(answer)],
        cwd=folder,
        env={**os.environ, "TMPDIR": str(folder), **(environment or {})},
        capture_output=True,
        text=True,
        timeout=_LIMIT,
        check=False,
    )
    if done.returncode != 0:
        raise ImporterError(
            f"{module} {what} ended with {done.returncode}\n{done.stdout}\n{done.stderr}", done
        )
    return Said(json.loads(answer.read_text(encoding="utf-8")), done.stdout, done.stderr)


def preload(importer: str) -> Mapping[str, str]:
    """Return what `stickslip host` sets, for an importer that is not Python."""
    if importer not in NOT_PYTHON:
        return {}
    return prepare([importer], None, os.environ).changes


def _rows(answer: Mapping[str, Any]) -> Rows:
    again, nested = answer.get("again"), answer.get("nested")
    return Rows(
        tuple(answer["times"]),
        {name: tuple(samples) for name, samples in answer["outputs"].items()},
        _rows(again) if again else None,
        answer.get("how", ""),
        _rows(nested) if nested else None,
    )
