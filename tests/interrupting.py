"""Processes that a test sends Ctrl-C to."""

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from subprocess import PIPE, Popen
from typing import Any

PROGRAM = "from stickslip.cli import main; main()"

HEARING = ("env", "--default-signal=INT")
"""In front of a command: it hears Ctrl-C, even if the tests are run by what is deaf to it, as a
shell makes what it starts in the background."""


@contextmanager
def session(*command: str, folder: Path, scratch: Path) -> Iterator[Popen[str]]:
    with Popen(
        [*HEARING, sys.executable, "-c", PROGRAM, *command],
        cwd=folder,
        env={**os.environ, "TMPDIR": str(scratch)},
        stdout=PIPE,
        stderr=PIPE,
        text=True,
        start_new_session=True,
    ) as running:
        try:
            yield running
        finally:
            running.kill()


def wait_for_work(leader: Popen[Any], seconds: float) -> None:
    """Wait until a session has used so much processor time [s], however busy the machine is."""
    while leader.poll() is None and sum(_processor_times(leader.pid)) < seconds:
        time.sleep(0.05)
    assert leader.returncode is None, leader.communicate()


def _processor_times(session: int) -> Iterator[float]:
    """Give user and system time [s] of each process of a session: proc(5), fields 6, 14 and 15."""
    for file in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = file.read_text(encoding="utf-8", errors="replace").rpartition(") ")[2].split()
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(fields[3]) == session:
            yield (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
