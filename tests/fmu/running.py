"""Runs a function of `inside` in a fresh process that cannot import the project."""

import json
from pathlib import Path
from typing import Any

from tests.python import python

PROCESS = Path(__file__).with_name("inside") / "process.py"
_LIMIT = 300.0
"""Seconds after which a process counts as hung; the longest takes twenty."""


def inside(
    fmu: Path, task: str, function: str, argument: Any, folder: Path, *, spoil_freed: bool = False
) -> Any:
    """Return what a function of a module of `inside` returns.

    Parameters
    ----------
    fmu
        The FMU.
    task, function, argument
        The module, its function, and what it is given.
    folder
        For the temporary files of the process, which outlive its death.
    spoil_freed
        Whether Python and the C library overwrite memory that is freed, so that the use of it
        shows at once and not by chance.
    """
    spoiling = ["-X", "dev"] if spoil_freed else []
    environment = {"MALLOC_PERTURB_": "165"} if spoil_freed else {}
    words = ("-I", *spoiling, PROCESS, task, function, fmu)
    environment = {"TMPDIR": str(folder), **environment}
    done = python(*words, input=json.dumps(argument), timeout=_LIMIT, env=environment)
    return json.loads(done.stdout.splitlines()[-1])
