"""The libpython that a host of the FMU needs which is not Python itself, and how it gets it.

The FMU's binary calls CPython and brings none: its functions must be in the process before the
binary is. On Linux that is what LD_PRELOAD does.
"""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from stickslip.errors import CommandError
from stickslip.host.elf import needed_libraries

OLDEST = (3, 8)
"""The first Python that what is packed in the FMU runs on."""

_ELF_64_X86 = (b"\x7fELF\x02", b"\x3e\x00")
_USUAL_FOLDERS = ("/usr/lib64", "/usr/lib", "/usr/local/lib", "/usr/local/lib64", "/lib64")
_LIBPYTHON = re.compile(r"libpython\d[\w.]*\.so(\.|$)")
_SECONDS = 30.0
_ABSENT = "is not there"

_SELF_PORTRAIT = """\
import json, os, struct, sys, sysconfig
names = ("LIBDIR", "INSTSONAME", "LDLIBRARY", "MULTIARCH", "LIBPL")
json.dump({
    "implementation": sys.implementation.name,
    "version": list(sys.version_info[:3]),
    "bits": 8 * struct.calcsize("P"),
    "home": [sys.base_prefix, sys.base_exec_prefix],
    "library": os.path.dirname(os.__file__),
    "build": {name: str(sysconfig.get_config_var(name) or "") for name in names},
}, sys.stdout)
"""
_VERSION_OF = """\
import ctypes, sys
version = ctypes.CDLL(sys.argv[1]).Py_GetVersion
version.restype = ctypes.c_char_p
print(version().decode().split()[0])
"""
_WHERE_IS_THE_LIBRARY = "import os; print(os.path.dirname(os.__file__))"


@dataclass(frozen=True)
class Interpreter:
    """An installed CPython.

    Attributes
    ----------
    program
        Its executable.
    version
        Such as (3, 11, 7).
    home
        The folders that it is installed in: for what is portable and for what is not.
    library
        The folder of its standard library.
    build
        Variables of its build that tell where its shared library went.
    """

    program: Path
    version: tuple[int, int, int]
    home: tuple[str, str]
    library: Path
    build: Mapping[str, str]

    @property
    def short_version(self) -> str:
        """The version in two numbers, as file names have it."""
        return f"{self.version[0]}.{self.version[1]}"


@dataclass(frozen=True)
class Launch:
    """What to start and with what.

    Attributes
    ----------
    command
        The program and its arguments.
    changes
        The environment variables to set.
    own
        The libpython that the command is linked to, by which nothing has to be set; "" if it has
        none.
    """

    command: Sequence[str]
    changes: Mapping[str, str]
    own: str = ""

    @property
    def line(self) -> str:
        """What one would type in a shell."""
        changes = [f"{name}={shlex.quote(value)}" for name, value in self.changes.items()]
        return " ".join([*changes, shlex.join(self.command)])


def prepare(command: Sequence[str], python: str | None, environment: Mapping[str, str]) -> Launch:
    """Find out what `command` needs to be a host of the FMU.

    A command that is linked to a libpython of its own is left alone: another one before it would
    be mixed with it. The chosen interpreter itself is not, for what it starts needs the library.

    Parameters
    ----------
    command
        A program and its arguments.
    python
        The interpreter whose shared library to take, a path or a name; None for this one.
    environment
        The variables that the command would be started with.

    Raises
    ------
    CommandError
        There is no such interpreter, it has no shared library that can be loaded, or the FMU has
        no binary for this platform.
    """
    if sys.platform == "darwin":
        raise CommandError("the FMU has no binary for macOS: pythonfmu brings none")
    interpreter = ask(python or sys.executable)
    if sys.platform == "win32":
        path = os.pathsep.join(filter(None, (interpreter.home[0], environment.get("PATH"))))
        return Launch(command, {"PATH": path})
    own = own_libpython(command, interpreter, environment)
    if own:
        return Launch(command, {}, own)
    library = find_library(interpreter)
    preloaded = [str(library), *_others(environment.get("LD_PRELOAD", ""), str(library))]
    changes = {"LD_PRELOAD": ":".join(preloaded)}
    if "PYTHONHOME" not in environment and _needs_home(interpreter, library, environment):
        changes["PYTHONHOME"] = ":".join(dict.fromkeys(interpreter.home))
    return Launch(command, changes)


def ask(python: str) -> Interpreter:
    """Ask an interpreter, given as a path or by name, what it is; `CommandError` if it fails."""
    program = shutil.which(python)
    if program is None:
        raise CommandError(f"--python {python}: there is no such program")
    answer = _output([program, "-I", "-c", _SELF_PORTRAIT])
    try:
        portrait = json.loads(answer or "")
        major, minor, micro = portrait["version"]
        home, own_home = portrait["home"]
    except (ValueError, KeyError, TypeError):
        raise CommandError(f"--python {python}: it does not answer as a Python 3 does") from None
    version = f"Python {major}.{minor}.{micro}"
    if portrait["implementation"] != "cpython":
        raise CommandError(f"--python {python}: {portrait['implementation']}, not CPython")
    if (major, minor) < OLDEST:
        raise CommandError(f"--python {python}: {version}; the FMU needs 3.8 or later")
    if portrait["bits"] != 64:
        raise CommandError(f"--python {python}: {version} of 32 bit; the FMU's binary has 64")
    return Interpreter(
        Path(program),
        (major, minor, micro),
        (home, own_home),
        Path(portrait["library"]),
        portrait["build"],
    )


def own_libpython(
    command: Sequence[str], interpreter: Interpreter, environment: Mapping[str, str]
) -> str:
    """Return the libpython that the command's program is linked to, "" if it has none of its own.

    What the program's libraries are linked to is not looked at.
    """
    found = shutil.which(command[0], path=environment.get("PATH")) if command else None
    if found is None or Path(found).samefile(interpreter.program):
        return ""
    libraries = needed_libraries(Path(found))
    return next((each for each in libraries if _LIBPYTHON.match(each)), "")


def find_library(interpreter: Interpreter) -> Path:
    """Return the shared library of an interpreter, or one of its version; else `CommandError`."""
    refused = []
    for candidate in dict.fromkeys(_candidates(interpreter)):
        try:
            objection = _objection(candidate, interpreter) if candidate.is_file() else _ABSENT
        except OSError as error:
            objection = f"cannot be read: {error.strerror or error}"
        if objection is None:
            return candidate
        if objection != _ABSENT:
            refused.append(f"{candidate} {objection}")
    name = f"libpython{interpreter.short_version}.so"
    if refused:
        raise CommandError(f"no {name} can be preloaded: {'; '.join(refused)}")
    raise CommandError(
        f"{interpreter.program} has no shared library {name}: "
        f"install it (Debian, Ubuntu: apt-get install libpython{interpreter.short_version}) "
        "or name another interpreter with --python"
    )


def _candidates(interpreter: Interpreter) -> Iterator[Path]:
    """Yield the files that may be the shared library, the interpreter's own first."""
    stem = f"libpython{interpreter.short_version}.so"
    build = interpreter.build
    told = [build[name] for name in ("INSTSONAME", "LDLIBRARY") if ".so" in build[name]]
    names = dict.fromkeys([*told, f"{stem}.1.0", f"{stem}.1", stem])
    for folder in (*_own_folders(interpreter), None, *_foreign_folders(interpreter)):
        if folder is None:
            yield from _cached(names)
        else:
            yield from (folder / name for name in names)


def _own_folders(interpreter: Interpreter) -> list[Path]:
    build = interpreter.build
    folders = [Path(build[name]) for name in ("LIBDIR", "LIBPL") if build[name]]
    for prefix in map(Path, dict.fromkeys(interpreter.home)):
        folders += [prefix / "lib", prefix / "lib64", prefix / "lib" / build["MULTIARCH"]]
    return folders


def _foreign_folders(interpreter: Interpreter) -> list[Path]:
    multiarch = interpreter.build["MULTIARCH"] or "x86_64-linux-gnu"
    return [Path("/usr/lib") / multiarch, *map(Path, _USUAL_FOLDERS)]


def _cached(names: Mapping[str, None]) -> Iterator[Path]:
    """Yield what the loader's cache has under these names."""
    ldconfig = shutil.which("ldconfig", path=f"{os.environ.get('PATH', '')}:/sbin:/usr/sbin")
    for line in (_output([ldconfig, "-p"]) or "").splitlines() if ldconfig else ():
        name, _, rest = line.strip().partition(" ")
        _, arrow, path = rest.partition("=> ")
        if name in names and arrow:
            yield Path(path)


def _objection(library: Path, interpreter: Interpreter) -> str | None:
    """Return why a file cannot be preloaded, None if it can."""
    with library.open("rb") as stream:
        head = stream.read(20)
    if (head[:5], head[18:20]) != _ELF_64_X86:
        return "is no library for x86-64, as the FMU's binary is"
    if set(str(library)) & {" ", ":"}:
        return "has a space or a colon in its path, which LD_PRELOAD cannot take"
    loaded = _run([str(interpreter.program), "-I", "-c", _VERSION_OF, str(library)])
    if loaded is None or loaded.returncode != 0:
        lines = loaded.stderr.strip().splitlines() if loaded else []
        return f"cannot be loaded: {lines[-1] if lines else 'no reason is given'}"
    if not loaded.stdout.startswith(f"{interpreter.short_version}."):
        return f"is of Python {loaded.stdout.strip()}"
    return None


def _needs_home(interpreter: Interpreter, library: Path, environment: Mapping[str, str]) -> bool:
    """Whether a CPython that starts in the host has to be told where its standard library is.

    It looks from the first `python3` on PATH upward for a library of its version, and where there
    is none takes the folder that it was built for. What it finds beside a `python3` of another
    build of its version is not its own: modules that are built in there it does not have.
    """
    if library.parent not in _own_folders(interpreter):
        return False
    # Called by that name alone, the interpreter starts as one in a host does.
    found = _run(
        ["python3", "-c", _WHERE_IS_THE_LIBRARY],
        executable=str(interpreter.program),
        environment={**environment, "LD_PRELOAD": str(library)},
    )
    if found is None or found.returncode != 0:
        return True
    return Path(found.stdout.strip()).resolve() != interpreter.library.resolve()


def _others(preloaded: str, library: str) -> list[str]:
    """Return what else is preloaded already."""
    return [each for each in preloaded.replace(":", " ").split() if each != library]


def _output(command: Sequence[str]) -> str | None:
    """Return what a program prints, None if it fails."""
    done = _run(command)
    return done.stdout if done is not None and done.returncode == 0 else None


def _run(
    command: Sequence[str],
    *,
    executable: str | None = None,
    environment: Mapping[str, str] | None = None,
) -> subprocess.CompletedProcess[str] | None:
    """Run a program that tells something, None if it cannot be run or does not end."""
    try:
        return subprocess.run(
            command,
            executable=executable,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
