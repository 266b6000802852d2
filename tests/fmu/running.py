"""Runs a function of `inside` in a fresh process that cannot import the project."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

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
    done = subprocess.run(
        [sys.executable, "-I", *spoiling, str(PROCESS), task, function, str(fmu)],
        input=json.dumps(argument),
        capture_output=True,
        text=True,
        timeout=_LIMIT,
        check=False,
        env={"TMPDIR": str(folder), **environment},
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.splitlines()[-1])
