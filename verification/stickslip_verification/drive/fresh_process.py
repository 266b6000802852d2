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
from typing import TypeVar

from stickslip_verification.drive.answer import Answer, answer_of, discard_prints

Environment = Mapping[str, str | bool]
"""Environment variables and their values; False for one that is not set."""

LIMIT = 30.0
"""Seconds that a fresh process may take; alone on its processor most take half of one."""

_COMMAND = "from stickslip_verification.drive.fresh_process import serve; serve()"
"""The program of a fresh process."""

T = TypeVar("T")


def call(
    function: Callable[[], T],
    environment: Environment | None = None,
    elsewhere: bool = False,
    seconds: float = 0.0,
) -> Answer[T]:
    """Return the answer of a function that can be pickled, from a fresh process.

    Its environment differs from the one here by `environment`, its working folder is an empty one
    if it runs `elsewhere`, and it may take some `seconds` more than `LIMIT`.
    """
    limit = LIMIT + seconds
    # A process that crashes or is ended leaves the files of the FMU there.
    with tempfile.TemporaryDirectory(prefix="stickslip-", ignore_cleanup_errors=True) as scratch:
        variables = {**os.environ, "TMPDIR": scratch, **(environment or {})}
        try:
            ended = subprocess.run(
                [sys.executable, "-P", "-c", _COMMAND],
                input=pickle.dumps((limit, function)),
                stdout=subprocess.PIPE,
                env={name: value for name, value in variables.items() if isinstance(value, str)},
                cwd=scratch if elsewhere else None,
                timeout=limit,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Answer(failure=f"no answer within {limit:g} s", late=True)
    try:
        answer: Answer[T] = pickle.loads(ended.stdout)
    except Exception:
        return Answer(failure=f"the process ended with exit code {ended.returncode}")
    return answer


def serve() -> None:
    """Call the function that comes on standard input, and write its answer to standard output."""
    with os.fdopen(os.dup(1), "wb") as out:
        discard_prints()
        limit, function = pickle.load(sys.stdin.buffer)
        # Ends this process even if its parent was ended and the FMU never returns.
        faulthandler.dump_traceback_later(limit, exit=True)
        # As a host with a graphical interface does; Python itself leaves numbers in the locale C.
        with contextlib.suppress(locale.Error):
            locale.setlocale(locale.LC_ALL, "")
        pickle.dump(answer_of(function), out)
