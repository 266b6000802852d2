"""Handles of states: what a simulator holds, and may free twice or use when it is freed.

The wrapper gives the simulator the address of a Python object for a state, counts one reference
down when the state is freed, and leaves the address where it is. So that a second use of it finds
the object and not what else may lie there by then, a handle that was freed stays for a while,
empty and with references to lose.
"""

import atexit
import sys
from collections import deque
from typing import Any, Callable, Deque, Optional, Tuple

from .lifetime import give_reference
from .state import State

# So many handles stay after they were freed, each with so many references.
_STAYING = 512
_REFERENCES = 8


def _count(grave: Tuple[Any, ...]) -> int:
    """Return how many references there are to what lies there, seen from here."""
    return sys.getrefcount(grave[0])


# That of an object which has lost none: Python's own references from here are in it.
_WHOLE = _count((object(),) * _REFERENCES)


def _clear(grave: Tuple[Any, ...]) -> None:
    """Make up for the references that were lost, so that the others can be let go."""
    for _ in range(_WHOLE - _count(grave)):
        give_reference(grave[0])


_graves: Deque[Tuple["Handle", ...]] = deque()


@atexit.register
def _clear_all() -> None:
    """Make up for all of them: at the end of the process they go without a look."""
    while _graves:
        _clear(_graves.popleft())


class Handle:
    """Stands for one state, or for none.

    Attributes
    ----------
    state
        The state, until it is freed.
    """

    __slots__ = ("state",)

    def __init__(self, state: Optional[State]) -> None:
        self.state = state

    # What it needs are default arguments, for at the end of the process the module goes first.
    def __del__(
        self,
        graves: Deque[Tuple["Handle", ...]] = _graves,
        most: int = _STAYING,
        references: int = _REFERENCES,
        clear: Callable[[Tuple["Handle", ...]], None] = _clear,
    ) -> None:
        """Let the state go and stay; Python calls it once, at the first time that it is freed."""
        self.state = None
        graves.append((self,) * references)
        if len(graves) > most:
            clear(graves.popleft())


def held(handle: Any) -> Optional[State]:
    """Return the state behind a handle, or None where it was freed or there never was one."""
    return handle.state if type(handle) is Handle else None
