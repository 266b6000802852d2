"""Runs tests as on a machine that lacks what they need beyond pip, or has it by half.

``python -m tests.bare none`` hides compilers, browsers and node and empties libraries; ``half``
leaves a compiler without the C library's headers, a browser without a font, node without packages.
Further words go to pytest; without any it runs the tests that need more than pip brings. No test
may fail, and with ``none`` each need must be told as missing.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from tests.needs import BY_PIP, HIDDEN_LIBPYTHON, NEEDS, ROOT

PROGRAMS = re.compile(
    r"(.*-)?(cc|c\d\d|gcc|clang|tcc|chromium|chrome|firefox|node|np[mx])([-_.\d].*)?"
)
"""The programs that are hidden, by their names."""
LIBRARIES = ("libtbb.so.12", "libatomic.so.1")
MISSING = (
    *("libcosimpy", "ecospy", "proxyfmu", "cc", "libpython"),
    *("browser", "firefox", "typescript"),
)
"""What cannot be used without them."""
HALVES = {
    "cc": 'exec gcc -nostdinc "$@"',
    "gcc": 'exec gcc -nostdinc "$@"',
    "chromium": 'FONTCONFIG_FILE=/dev/null exec chromium "$@"',
    "npx": 'echo "npm error network" >&2; exit 1',
}
"""What a program does that is there by half, as a line of a shell."""


def main(machine: str, arguments: list[str]) -> int:
    """Run the tests on a machine, "none" or "half"; print what they say and what was not told."""
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--color=no", "--gate"]
    command += arguments or ["-p", "tests.bare"]
    with tempfile.TemporaryDirectory(prefix="bare-") as folder:
        done = subprocess.run(
            command,
            cwd=ROOT,
            env=bare(Path(folder), half=machine == "half"),
            stdout=subprocess.PIPE,
            text=True,
            check=False,
        )
    print(done.stdout, end="")
    told = [line for line in done.stdout.splitlines() if line.startswith("SKIPPED")]
    silent = [
        name
        for name in (MISSING if machine == "none" else ())
        if not any(f"NOT TRIED: {NEEDS[name].untried}. " in line for line in told)
    ]
    for name in silent:
        print(f"tests.bare: no test was skipped for want of {name}")
    return done.returncode or bool(silent)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items[:] = [
        item
        for item in items
        if {name for mark in item.iter_markers("needs") for name in mark.args} - BY_PIP
    ]


def bare(folder: Path, *, half: bool = False) -> dict[str, str]:
    """Return the environment of a machine with little on it; what it needs is in the folder."""
    programs, libraries = folder / "programs", folder / "libraries"
    programs.mkdir()
    libraries.mkdir()
    for directory in map(Path, os.get_exec_path()):
        for program in directory.iterdir() if directory.is_dir() else ():
            link = programs / program.name
            if not PROGRAMS.fullmatch(program.name) and not link.is_symlink():
                link.symlink_to(program)
    for name, line in HALVES.items() if half else ():
        script = programs / name
        line = re.sub(r"exec (\w+)", lambda found: f"PATH={os.environ['PATH']} {found[0]}", line)
        script.write_text(f"#!/bin/sh\n{line}\n", encoding="utf-8")
        script.chmod(0o755)
    for library in LIBRARIES:
        (libraries / library).touch()
    return {
        **{name: value for name, value in os.environ.items() if name != "CI"},
        "PATH": str(programs),
        "LD_LIBRARY_PATH": f"{libraries}:{os.environ.get('LD_LIBRARY_PATH', '')}".rstrip(":"),
        # The browser that Playwright brings.
        "PLAYWRIGHT_BROWSERS_PATH": str(folder),
        HIDDEN_LIBPYTHON: "1",
    }


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
