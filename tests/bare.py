"""Runs tests as on a machine that lacks what they need beyond pip, and reads the reasons told.

``python -m tests.bare`` runs the tests that need something (tests/needs.py); further words go to
pytest, such as ``tests`` for all of them. No chromium, Firefox, C compiler and node are on the
PATH, libtbb, libatomic and Pango are empty files, the shared libpython counts as missing. No test
may fail.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.needs import HIDDEN_LIBPYTHON, NEEDS, ROOT

PROGRAMS = re.compile(
    r"(.*-)?(cc|c\d\d|gcc|clang|tcc|chromium|chrome|firefox|node|np[mx])([-_.\d].*)?"
)
"""The programs that are hidden, by their names."""
LIBRARIES = ("libtbb.so.12", "libatomic.so.1", "libpango-1.0.so.0")
MISSING = (
    *("libcosimpy", "ecospy", "proxyfmu", "cc", "libpython"),
    *("browser", "firefox", "typescript", "pdf"),
)
"""What cannot be used without them."""


def main(arguments: list[str]) -> int:
    """Run the tests, print what they say, and tell what should have been skipped and was not."""
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--color=no"]
    command += ["--numprocesses", "logical", "--dist", "worksteal"]
    reasons = []
    with (
        tempfile.TemporaryDirectory(prefix="bare-") as folder,
        subprocess.Popen(
            [*command, *(arguments or ["-m", "needs"])],
            cwd=ROOT,
            env=bare(Path(folder)),
            stdout=subprocess.PIPE,
            text=True,
        ) as running,
    ):
        assert running.stdout is not None
        for line in running.stdout:
            print(line, end="", flush=True)
            if line.startswith("SKIPPED"):
                reasons.append(line)
    silent = [name for name in MISSING if not any(tells(line, name) for line in reasons)]
    for name in silent:
        print(f"tests.bare: no test was skipped for want of {name}, with the line that installs it")
    return running.returncode or bool(silent)


def bare(folder: Path) -> dict[str, str]:
    """Return the environment of a machine with little on it; what it needs is in the folder."""
    programs, libraries = folder / "programs", folder / "libraries"
    programs.mkdir()
    libraries.mkdir()
    for directory in map(Path, os.get_exec_path()):
        for program in directory.iterdir() if directory.is_dir() else ():
            link = programs / program.name
            if not PROGRAMS.fullmatch(program.name) and not link.is_symlink():
                link.symlink_to(program)
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


def tells(line: str, name: str) -> bool:
    """Whether a skipped test names what was not tried, and how it can be."""
    return f"NOT TRIED: {NEEDS[name].untried}. " in line and "To install: apt-get install" in line


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
