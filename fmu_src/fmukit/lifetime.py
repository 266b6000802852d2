"""What the wrappers release without owning it, made up for.

At every exception that escapes to it, a wrapper releases its instance, its class and its log
queue and yet keeps using them; pythonfmu's releases the globals of the slave's module too, at every
instantiation. Each release is met here by one more reference, so that the counts stay true: nothing
is freed too early, and nothing is kept for ever. Both wrappers also put the FMU's folder on the
module search path at every instantiation, where once is enough.

At the end of the process a wrapper releases its hold on the interpreter twice, the second time in
freed memory, if it is still loaded then. So it is made to let go before, while that is still sound.
"""

import atexit
import contextlib
import os
import sys
from pathlib import Path
from typing import Any, Dict, List, Set

try:
    import ctypes
except ImportError:  # an embedded Python may come without it
    _counts_can_be_raised = False
else:
    _counts_can_be_raised = True

# How a loader is asked for what it has and no more; None where that cannot be.
_ONLY_IF_LOADED = getattr(os, "RTLD_NOLOAD", None)

# Where counts cannot be raised, what was given is kept alive instead, for good.
_kept: List[Any] = []

# By its folder of resources, what the binary of an FMU may have been loaded as; each has a wrapper
# of its own.
_binaries: Dict[str, Set[str]] = {}


def give_reference(lost: Any) -> None:
    """Raise the reference count of an object that the wrapper is about to release."""
    if _counts_can_be_raised:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(lost))
    else:
        _kept.append(lost)


def hold(module_globals: Dict[str, Any]) -> None:
    """Make up for one more execution of the slave's module, whose globals these are."""
    give_reference(module_globals)
    settle(str(Path(module_globals["__file__"]).parent))


def settle(resources: str) -> None:
    """Make up for one more instance of the FMU whose resources are in this folder."""
    while sys.path.count(resources) > 1:
        sys.path.remove(resources)
    if resources not in _binaries:
        _binaries[resources] = _names(resources)


def _names(resources: str) -> Set[str]:
    """Return the names under which the binaries beside this folder may have been loaded.

    A simulator may delete the folder before its process ends. Then a loaded binary is found by
    the name it was loaded as and by no other; a folder from a URI may begin with more slashes.
    """
    if _ONLY_IF_LOADED is None:
        return set()
    folder = "/" + os.path.dirname(resources).lstrip("/")  # noqa: PTH120 - pathlib keeps two slashes
    return {
        name
        for binary in Path(folder).glob("binaries/*/*.so")
        for name in (str(binary), str(binary.resolve()))
    }


@atexit.register
def _let_go() -> None:
    """Make every wrapper that is still loaded release the interpreter, once and now.

    Where the wrapper itself started the interpreter this runs inside that very release, and
    leaves nothing for the second.
    """
    if _ONLY_IF_LOADED is None or not _counts_can_be_raised:
        return
    for name in set().union(*_binaries.values()):
        # It may be unloaded, or another wrapper without that function.
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(name, mode=_ONLY_IF_LOADED).finalizePythonInterpreter()
