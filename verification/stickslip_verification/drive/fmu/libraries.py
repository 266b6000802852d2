"""The shared libraries of FMUs that this process has loaded, and how to leave them at its end."""

import atexit
import contextlib
import ctypes
import os

# FMUs that pythonfmu or pythonfmu3 wrapped stay loaded for good.
_LOADED: set[str] = set()


def note(library: str) -> None:
    """Remember a library, by its path, for the end of the process."""
    _LOADED.add(library)


@atexit.register
def _let_go() -> None:
    """Make the wrappers of pythonfmu and pythonfmu3 release the interpreter now.

    Left to themselves they do it twice when the process ends, the second time in freed memory.
    """
    only_if_loaded = getattr(os, "RTLD_NOLOAD", None)
    if only_if_loaded is None:
        return
    for library in _LOADED:
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(library, mode=only_if_loaded).finalizePythonInterpreter()
