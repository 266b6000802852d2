"""Results kept on disk for the processes of one session, such as a run of the gate.

Truth and reference of a case are the same whichever FMU is judged. Where `FOLDER` names a folder in
the environment, each is computed once; without it a verdict never rests on an old file.
"""

import contextlib
import hashlib
import os
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from stickslip_verification.model.whole_file import write_whole
from stickslip_verification.suite.cases import Case
from stickslip_verification.truth.named import BUILT_IN

FOLDER = "STICKSLIP_KEPT"
"""The environment variable that names the folder: one's own, for its files are pickles, and new in
each session, for they do not say from what code they come."""

T = TypeVar("T")


def kept(function: Callable[..., T], case: Case, *arguments: Any) -> T:
    """Return `function(case, *arguments)`, or its result from earlier in this session.

    Of a friction law from elsewhere, whose source is not looked at, nothing is kept.
    """
    folder = os.environ.get(FOLDER)
    if not folder or case.law not in BUILT_IN:
        return function(case, *arguments)
    asked = repr((function.__qualname__, case.id, case.law, case.parameters, case.steps, arguments))
    file = Path(folder) / f"{hashlib.sha256(asked.encode()).hexdigest()}.pickle"
    # A file that cannot be read or written costs the time to compute, and nothing else.
    with contextlib.suppress(OSError, EOFError, pickle.UnpicklingError):
        earlier: T = pickle.loads(file.read_bytes())
        return earlier
    result = function(case, *arguments)
    with contextlib.suppress(OSError):
        write_whole(file, pickle.dumps(result))
    return result
