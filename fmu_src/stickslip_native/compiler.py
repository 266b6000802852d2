"""Compiles C sources to a shared library: by Zig for every platform, by `cc` for this machine.

Zig is a C compiler (clang) that carries the C libraries of all platforms; the package `ziglang` of
PyPI brings it. What it makes of them is kept in Zig's cache, in the cache folder of the user: the
runtime of Windows takes minutes once.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Dict, List, Mapping, NamedTuple, Tuple

from .platforms import PLATFORMS, Platform, current

FLAGS = (
    "-std=c99",
    "-O2",
    # A fused multiply-add rounds once where the Python block rounds twice.
    "-ffp-contract=off",
    "-fPIC",
    "-fvisibility=hidden",
    "-s",
    "-g0",
)
"""Options of every compiler, on every platform."""


_RUNTIME = (
    ("zig", "LICENSE", "Functions of Zig's runtime in the library for Windows: MIT"),
    ("musl", "lib/libc/musl/COPYRIGHT", "Functions of musl, from which those of Zig are made: MIT"),
    ("mingw-w64", "lib/libc/mingw/COPYING", "mingw-w64, in the library for Windows: ZPL 2.1"),
)
"""What Zig links into libraries: name, file of the licence, and what it is."""


class CompilerError(RuntimeError):
    """The compiler is missing, or it failed; the text is one line."""


class Compiler(NamedTuple):
    """A compiler that is installed: see `compiler_for`.

    Attributes
    ----------
    command
        Its words, without options.
    platforms
        Platforms that it compiles for.
    is_zig
        Whether it takes a target.
    """

    command: Tuple[str, ...]
    platforms: Tuple[Platform, ...]
    is_zig: bool

    def library(self, sources: Mapping[str, bytes], name: str, target: Platform) -> bytes:
        """Return the shared library of sources, by name; raises CompilerError.

        Parameters
        ----------
        sources
            Files in one folder by name; those that end in .c are compiled.
        name
            Name of the library without its ending.
        target
            One of `platforms`.
        """
        # The same words in every folder: a path would get into the library, and into Zig's cache.
        file = f"{name}{target.suffix}"
        words: List[str] = [*self.command, *self._options(file, target), "-shared", "-o", file]
        words += sorted(file for file in sources if file.endswith(".c"))
        if target.system == "linux":
            words.append("-lm")
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            for each, content in sources.items():
                Path(folder, each).write_bytes(content)
            done = subprocess.run(
                words,
                cwd=folder,
                env=_with_cache() if self.is_zig else None,
                capture_output=True,
                encoding="utf-8",
                errors="replace",
            )
            if done.returncode != 0:
                raise CompilerError(f"{' '.join(self.command)}: {_cause(done)}")
            # Beside it lies what only a linker needs, such as an import library for Windows.
            return Path(folder, file).read_bytes()

    def runtime(self) -> Dict[str, Tuple[str, bytes]]:
        """Return the parts of the compiler's runtime that are in its libraries, by name.

        Each with what it is and the text of its licence. Of gcc and clang nothing is linked here
        that asks for one.
        """
        if not self.is_zig:
            return {}
        zig = find_spec("ziglang")
        assert zig is not None
        assert zig.origin is not None
        folder = Path(zig.origin).parent
        return {name: (what, (folder / file).read_bytes()) for name, file, what in _RUNTIME}

    def _options(self, file: str, target: Platform) -> List[str]:
        options = list(FLAGS)
        if self.is_zig:
            # Zig checks for undefined behaviour, and ends the process where it finds some.
            options += ["-target", target.triple, "-fno-sanitize=undefined"]
        if target.system == "darwin":
            # Else the library carries the path at which it was built.
            options += ["-install_name", f"@rpath/{file}"]
        return options


def compiler_for(this_machine: bool) -> Compiler:
    """Return `cc` for this machine, or Zig for all platforms.

    Raises CompilerError if it is not installed, or FMI has no name for this machine here.
    """
    if not this_machine:
        if find_spec("ziglang") is None:
            raise CompilerError(
                "the native FMU for all platforms is compiled by ziglang, which is not installed: "
                "pip install 'stickslip[native]', or --this-machine: for this one alone, by its cc"
            )
        return Compiler((sys.executable, "-m", "ziglang", "cc"), PLATFORMS, is_zig=True)
    if shutil.which("cc") is None:
        raise CompilerError("there is no C compiler: a program cc, which is gcc or clang")
    target = current()
    if target is None:
        names = ", ".join(platform.fmi3 for platform in PLATFORMS)
        raise CompilerError(f"this machine is none of {names}")
    return Compiler(("cc",), (target,), is_zig=False)


def _with_cache() -> Dict[str, str]:
    """Return the environment with the folder of Zig's cache; raises CompilerError.

    It is the folder that Zig takes by itself. Where that cannot be written Zig never ends.
    """
    own = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA") or "~/.cache"
    folder = Path(os.environ.get("ZIG_GLOBAL_CACHE_DIR") or Path(own, "zig")).expanduser()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise CompilerError(
            f"Zig's cache {folder} cannot be written ({error.strerror}); "
            "name another folder in the environment variable ZIG_GLOBAL_CACHE_DIR"
        ) from None
    return {**os.environ, "ZIG_GLOBAL_CACHE_DIR": str(folder)}


def _cause(done: "subprocess.CompletedProcess[str]") -> str:
    """Return the first line that names an error, else the last one."""
    lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
    return next((line for line in lines if "error" in line), lines[-1])
