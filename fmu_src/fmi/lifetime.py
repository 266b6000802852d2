"""References that the wrapper releases without owning them, and their end with the process.

At every exception that reaches it, pythonfmu's wrapper releases its instance, its class and its log
queue and goes on using them; at every instantiation, the globals of the slave's module. For each
release one reference is added here, so that reference counts stay true: no object is freed too
early, and none is kept for ever. At every instantiation the wrapper also puts the FMU's folder on
the module search path; one entry is kept.

A wrapper that is still loaded at the end of the process releases the interpreter twice, the second
time from freed memory. Therefore it is made to release it earlier, at Python's exit.
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

# Flag of the loader: return a library only if it is loaded. None where there is no such flag.
_ONLY_IF_LOADED = getattr(os, "RTLD_NOLOAD", None)

# Objects kept alive for good, where reference counts cannot be raised.
_immortal: List[Any] = []

# Names under which the binary of an FMU, its wrapper, may be loaded, by its folder of resources.
_binaries: Dict[str, Set[str]] = {}


def give_reference(lost: Any) -> None:
    """Raise the reference count of an object that the wrapper is about to release."""
    if _counts_can_be_raised:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(lost))
    else:
        _immortal.append(lost)


def hold(module_globals: Dict[str, Any]) -> None:
    """Make up for one execution of the slave's module, whose globals these are."""
    give_reference(module_globals)
    resources = str(Path(module_globals["__file__"]).parent)
    # One entry of the search path is enough.
    while sys.path.count(resources) > 1:
        sys.path.remove(resources)
    if resources in _binaries or _ONLY_IF_LOADED is None:
        return
    # A simulator may delete the folder before its process ends. Then only the name that it was
    # loaded as finds a binary; a folder from a URI may begin with more slashes.
    folder = "/" + os.path.dirname(resources).lstrip("/")  # noqa: PTH120 - pathlib keeps two slashes
    _binaries[resources] = {
        name
        for binary in Path(folder).glob("binaries/*/*.so")
        for name in (str(binary), str(binary.resolve()))
    }


@atexit.register
def _let_go() -> None:
    """Make every wrapper that is still loaded release the interpreter, once and now.

    Where the wrapper itself started the interpreter, this runs within its first release, and the
    second has no effect.
    """
    if _ONLY_IF_LOADED is None or not _counts_can_be_raised:
        return
    for name in set().union(*_binaries.values()):
        # The library may be unloaded, or be another one without that function.
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(name, mode=_ONLY_IF_LOADED).finalizePythonInterpreter()
