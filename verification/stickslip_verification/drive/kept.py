"""Results kept on disk for the processes of one session, such as a run of the gate.

Truth and reference of a case are the same whichever FMU is judged. Where `FOLDER` names a folder in
the environment, each is computed once and read from there afterwards; without it nothing is kept,
so a verdict outside a session never rests on an old file.
"""

import contextlib
import hashlib
import os
import pickle
import platform
from collections.abc import Callable
from functools import cache
from importlib import metadata, util
from pathlib import Path
from typing import Any, TypeVar

from stickslip_verification.model.whole_file import write_whole
from stickslip_verification.suite.cases import Case
from stickslip_verification.truth.named import BUILT_IN

FOLDER = "STICKSLIP_KEPT"
"""The environment variable that names the folder. Its files are pickles: it must be one's own."""

_LIBRARIES = ("numpy", "scipy", "mpmath")

T = TypeVar("T")


def kept(function: Callable[..., T], case: Case, *arguments: Any) -> T:
    """Return `function(case, *arguments)`, or its result from earlier in this session.

    An earlier result counts if the source of both packages, the libraries, the motion that the case
    describes and the other arguments are what they were. Of a friction law from elsewhere, whose
    source is not looked at, nothing is kept.
    """
    folder = os.environ.get(FOLDER)
    if not folder or case.law not in BUILT_IN:
        return function(case, *arguments)
    asked = repr((function.__qualname__, case.id, case.law, case.parameters, case.steps, arguments))
    file = Path(folder) / f"{_digest(_made_from(), asked)}.pickle"
    # A file that cannot be read or written costs the time to compute, and nothing else.
    with contextlib.suppress(OSError, EOFError, pickle.UnpicklingError):
        earlier: T = pickle.loads(file.read_bytes())
        return earlier
    result = function(case, *arguments)
    with contextlib.suppress(OSError):
        write_whole(file, pickle.dumps(result))
    return result


@cache
def _made_from() -> str:
    """Return a digest of the code that computes: both packages, Python and the libraries."""
    reference = util.find_spec("stickslip_ref")
    packages = [Path(__file__).parents[1]]
    packages += [] if reference is None else map(Path, reference.submodule_search_locations or ())
    sources = [file.read_text("utf-8") for each in packages for file in sorted(each.rglob("*.py"))]
    versions = [f"{name} {metadata.version(name)}" for name in _LIBRARIES]
    return _digest(platform.python_version(), *versions, *sources)


def _digest(*texts: str) -> str:
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()
