"""References that pythonfmu's wrapper gives away without owning them, made up for.

At every exception that escapes to it, the wrapper releases its instance, its class and its log
queue and yet keeps using them; at every instantiation it releases the globals of the slave's
module. Each release is met here by one more reference, so that the counts stay true: nothing is
freed too early, and nothing is kept for ever. It also puts the FMU's folder on the module search
path at every instantiation, where once is enough.
"""

import sys
from pathlib import Path
from typing import Any, Dict, List

try:
    import ctypes
except ImportError:  # an embedded Python may come without it
    _counts_can_be_raised = False
else:
    _counts_can_be_raised = True

# Where counts cannot be raised, what was given is kept alive instead, for good.
_kept: List[Any] = []


def give_reference(lost: Any) -> None:
    """Raise the reference count of an object that the wrapper is about to release."""
    if _counts_can_be_raised:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(lost))
    else:
        _kept.append(lost)


def hold(module_globals: Dict[str, Any]) -> None:
    """Make up for one more execution of the slave's module, whose globals these are."""
    give_reference(module_globals)
    folder = str(Path(module_globals["__file__"]).parent)
    while sys.path.count(folder) > 1:
        sys.path.remove(folder)
