"""Libraries of C for this process: compiled once for this machine, and kept in the user's cache."""

import contextlib
import ctypes
import hashlib
import os
import shutil
import tempfile
from pathlib import Path
from typing import Mapping

from .compiler import FLAGS, Compiler, CompilerError, compiler_for
from .platforms import current


def load(name: str, sources: Mapping[str, bytes]) -> ctypes.CDLL:
    """Return the library of sources by file name; raises CompilerError.

    What was compiled is kept as ``stickslip/NAME-HASH`` in the cache folder of the user; where that
    cannot be written it is compiled in each process.
    """
    target = current()
    suffix = target.suffix if target else ""
    content = repr((sorted(sources.items()), FLAGS, target)).encode()
    file = cache_folder() / f"{name}-{hashlib.sha256(content).hexdigest()[:16]}{suffix}"
    # Of another machine, or damaged: compiled anew.
    with contextlib.suppress(OSError):
        return ctypes.CDLL(str(file))
    compiler = _compiler()
    assert target is not None
    library = compiler.library(sources, name, target)
    folder = tempfile.mkdtemp(prefix="stickslip-")
    try:
        fresh = Path(folder, file.name)
        fresh.write_bytes(library)
        with contextlib.suppress(OSError):
            file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            # At once: another process may be reading.
            beside = file.with_name(f"{file.name}.{os.getpid()}")
            beside.write_bytes(library)
            beside.replace(file)
            fresh = file
        return ctypes.CDLL(str(fresh))
    finally:
        # Windows keeps the file of a library that is in use.
        with contextlib.suppress(OSError):
            shutil.rmtree(folder)


def cache_folder() -> Path:
    """Return the folder in which compiled libraries are kept."""
    own = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA") or "~/.cache"
    # A user without a home: a folder that cannot be written.
    with contextlib.suppress(RuntimeError):
        return Path(own).expanduser() / "stickslip"
    return Path(os.devnull) / "stickslip"


def this_machine() -> bool:
    """Return whether `cc` compiles for this machine, and not Zig; raises CompilerError if none."""
    return not _compiler().is_zig


def _compiler() -> Compiler:
    """Return a compiler for this machine; raises CompilerError with the remedy if there is none."""
    if current() is None:
        return compiler_for(this_machine=True)
    for own in (True, False):
        with contextlib.suppress(CompilerError):
            return compiler_for(own)
    raise CompilerError(
        "the native core needs a C compiler: install gcc or clang as the program cc, or "
        "pip install 'stickslip[native]'"
    )
