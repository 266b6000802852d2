"""A function called in a fresh process, which nothing was done in before.

What calls it is a worker, whose guard ends the process with all else; see `processes`.
"""

import contextlib
import faulthandler
import locale
import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from stickslip_verification.drive.answer import Answer, answer_of, discard_prints

Environment = Mapping[str, str | bool]
"""Environment variables and their values; False for one that is not set."""

LIMIT = 30.0
"""Seconds that a fresh process may take; alone on its processor most take half of one."""

_COMMAND = "from stickslip_verification.drive.fresh_process import serve; serve()"
"""The program of a fresh process."""


def call(
    function: Callable[..., Any],
    *arguments: Any,
    environment: Environment | None = None,
    folder: Path | None = None,
    limit: float | None = None,
) -> Answer[Any]:
    """Return the answer of a function of a module in a fresh process.

    Parameters
    ----------
    function, arguments
        The function, and what it is called with.
    environment
        What differs from the environment here.
    folder
        Its working folder; None for the one here.
    limit
        Seconds that it may take; None for `LIMIT`.
    """
    limit = LIMIT if limit is None else limit
    # A process that crashes or is ended leaves the files of the FMU there.
    with tempfile.TemporaryDirectory(prefix="stickslip-", ignore_cleanup_errors=True) as scratch:
        variables = {**os.environ, "TMPDIR": scratch, **(environment or {})}
        try:
            ended = subprocess.run(
                [sys.executable, "-P", "-c", _COMMAND],
                input=pickle.dumps((limit, function, arguments)),
                stdout=subprocess.PIPE,
                env={name: value for name, value in variables.items() if isinstance(value, str)},
                cwd=folder,
                timeout=limit,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Answer(failure=f"no answer within {limit:g} s", late=True)
    try:
        answer: Answer[Any] = pickle.loads(ended.stdout)
    except Exception:
        return Answer(failure=f"the process ended with exit code {ended.returncode}")
    return answer


def serve() -> None:
    """Call the function that comes on standard input, and write its answer to standard output."""
    with os.fdopen(os.dup(1), "wb") as out:
        discard_prints()
        limit, function, arguments = pickle.load(sys.stdin.buffer)
        # Ends this process even if its parent was ended and the FMU never returns.
        faulthandler.dump_traceback_later(limit, exit=True)
        # As a host with a graphical interface does; Python itself leaves numbers in the locale C.
        with contextlib.suppress(locale.Error):
            locale.setlocale(locale.LC_ALL, "")
        pickle.dump(answer_of(function, *arguments), out)
