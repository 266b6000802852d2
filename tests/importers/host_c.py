"""The host written in C: compiled, started with a libpython, given scripts of calls."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from stickslip.errors import CommandError
from stickslip.host.launch import ask, find_library, prepare
from stickslip_fmu.spec import TABLE

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "examples" / "importing" / "host.c"
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
OUTPUTS = tuple(each for each in TABLE.rows if each.causality == "output")
_LIMIT = 120.0
"""Seconds after which a process counts as hung; the longest takes two."""

# Nothing of the interpreter that runs the tests, where the project is installed.
_BARE = {"PATH": "/usr/local/bin:/usr/bin:/bin", "PYTHONNOUSERSITE": "1"}


def compile_host(folder: Path, *options: str) -> Path:
    """Compile the host into a folder and return the program."""
    program = folder / "host"
    command = ["cc", *(options or STRICT), "-o", str(program), str(SOURCE), "-ldl"]
    subprocess.run(command, check=True)
    return program


def unpack(fmu: Path, folder: Path) -> Path:
    """Unzip the FMU into a folder and return it."""
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    return folder


def interpreters() -> list[str]:
    """Return this interpreter, and the system's if it is another one with a shared library."""
    system = "/usr/bin/python3"
    try:
        find_library(ask(system))
    except CommandError:
        return [sys.executable]
    return [sys.executable] if Path(system).samefile(sys.executable) else [sys.executable, system]


@dataclass(frozen=True)
class Host:
    """The program, an unzipped FMU, and the variables it is started with."""

    program: Path
    fmu: Path
    environment: Mapping[str, str]

    def __call__(self, script: str | None = None) -> subprocess.CompletedProcess[str]:
        """Run a script, or the default experiment."""
        command = [str(self.program), str(self.fmu), *(["-"] if script is not None else [])]
        return subprocess.run(
            command,
            input=script,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=_LIMIT,
            check=False,
        )

    def answers(self, script: str) -> list[list[float]]:
        """Run a script that must succeed in silence; return what its `get` lines show."""
        done = self(script)
        assert (done.stderr[-2000:], done.returncode) == ("", 0)
        return [[float(value) for value in line.split(",")] for line in done.stdout.splitlines()]


def with_libpython(program: Path, fmu: Path, python: str | None = None) -> Host:
    """Return the host with the libpython of an interpreter, as `stickslip host` would start it."""
    return Host(program, fmu, {**_BARE, **prepare([str(program)], python, _BARE).changes})


def without_libpython(program: Path, fmu: Path) -> Host:
    """Return the host as one starts it who does not know of libpython."""
    return Host(program, fmu, _BARE)


def line(what: str, *words: object) -> str:
    """Return a line of a script; numbers in hexadecimal, so that no digit is lost."""
    texts = [word.hex() if isinstance(word, float) else str(word) for word in words]
    return " ".join([what, *texts]) + "\n"


def get_outputs() -> str:
    """Return the line that reads every output."""
    return line("get", *(each.name for each in OUTPUTS))


def set_values(values: Mapping[str, float]) -> str:
    """Return the line that sets variables by name, none if there are none."""
    words: Sequence[object] = [word for pair in values.items() for word in pair]
    return line("set", *words) if words else ""
