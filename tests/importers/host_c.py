"""The host written in C: compiled, started with a libpython, given scripts of calls."""

import subprocess
import sys
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from stickslip_fmu.spec import TABLE
from tests.importers.cases import STEP, Case
from tests.importers.running import Rows
from tests.needs import LIBPYTHON
from tests.python import run

SOURCE = Path(__file__).parents[2] / "examples" / "importing" / "host.c"
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
OUTPUTS = tuple(each.name for each in TABLE.rows if each.causality == "output")
BEGIN = "setup 0\nenter\nexit\n"

# Nothing of the interpreter that runs the tests, where the project is installed.
_BARE = {"PATH": "/usr/local/bin:/usr/bin:/bin", "PYTHONNOUSERSITE": "1"}


def compile_host(folder: Path, *options: str) -> Path:
    program = folder / "host"
    subprocess.run(["cc", *STRICT, *options, "-o", program, SOURCE, "-ldl"], check=True)
    return program


def unpack(fmu: Path, folder: Path) -> Path:
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    return folder


@dataclass(frozen=True)
class Host:
    program: Path
    fmu: Path
    environment: Mapping[str, str]

    def __call__(self, script: str) -> subprocess.CompletedProcess[str]:
        words = (self.program, self.fmu, "-")
        return run(*words, input=script, env=self.environment, timeout=120.0)

    def answers(self, script: str) -> list[list[float]]:
        done = self(script)
        assert (done.stderr[-2000:], done.returncode) == ("", 0)
        return [[float(value) for value in line.split(",")] for line in done.stdout.splitlines()]

    def run(self, case: Case) -> Rows:
        shown = zip(*self.answers(f"{script_of(case)}terminate\n"), strict=True)
        times = [number * STEP for number in range(case.steps + 1)]
        return {"times": times, "outputs": dict(zip(OUTPUTS, shown, strict=True))}


def with_libpython(program: Path, fmu: Path) -> Host:
    # Its standard library is looked for from the first python3 on PATH.
    path = f"{sys.base_prefix}/bin:{_BARE['PATH']}"
    return Host(program, fmu, {**_BARE, "PATH": path, "LD_PRELOAD": str(LIBPYTHON)})


def without_libpython(program: Path, fmu: Path) -> Host:
    return Host(program, fmu, _BARE)


def script_of(case: Case) -> str:
    look = f"get {' '.join(OUTPUTS)}\n"
    script = f"setup 0\n{_set(case.start)}enter\nexit\n{look}"
    for number in range(case.steps):
        # In hexadecimal, so that no digit is lost.
        step = f"step {(number * STEP).hex()} {STEP.hex()}\n"
        script += _set(case.changes.get(number, {})) + step + look
    return script


def _set(values: Mapping[str, float]) -> str:
    words = "".join(f" {name} {value.hex()}" for name, value in values.items())
    return f"set{words}\n" if values else ""
