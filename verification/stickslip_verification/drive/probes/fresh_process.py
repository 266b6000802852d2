"""A function called in a fresh process, which nothing was done in before."""

import contextlib
import faulthandler
import json
import locale
import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from stickslip_verification.drive.fmu.errors import one_line

Environment = Mapping[str, str | bool]
"""Environment variables and their values; False for one that is not set."""

LIMIT = 30.0
"""Seconds that a fresh process may take; alone on its processor most take half of one."""

_COMMAND = "from stickslip_verification.drive.probes.fresh_process import answer; answer()"
"""The program of a fresh process."""


class FreshProcessError(Exception):
    """The function failed or gave no result; the text says how."""


def call(
    function: Callable[..., Any],
    *arguments: Any,
    environment: Environment | None = None,
    folder: Path | None = None,
    limit: float | None = None,
) -> Any:
    """Return what a function of a module returns in a fresh process.

    Parameters
    ----------
    function, arguments
        The function, and what it is called with. Its result must be JSON.
    environment
        What differs from the environment here.
    folder
        Its working folder; None for the one here.
    limit
        Seconds that it may take; None for `LIMIT`.

    Raises
    ------
    FreshProcessError
        The function raised an exception, took too long, or its process ended early.
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
            raise FreshProcessError(f"no answer within {limit:g} s") from None
    try:
        result, failure = json.loads(ended.stdout)
    except ValueError:
        reason = f"the process ended with exit code {ended.returncode}"
        raise FreshProcessError(reason) from None
    if failure is not None:
        raise FreshProcessError(failure)
    return result


def answer() -> None:
    """Call the function that comes on standard input, and write its result to standard output."""
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    limit, function, arguments = pickle.load(sys.stdin.buffer)
    # Ends this process even if its parent was ended and the FMU never returns.
    faulthandler.dump_traceback_later(limit, exit=True)
    # As a host with a graphical interface does; Python itself leaves numbers in the locale C.
    with contextlib.suppress(locale.Error):
        locale.setlocale(locale.LC_ALL, "")
    result = failure = None
    try:
        result = function(*arguments)
    except (Exception, SystemExit) as error:
        failure = one_line(error)
    json.dump([result, failure], out)
    out.close()
