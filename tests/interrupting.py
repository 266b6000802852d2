"""Processes that a test sends Ctrl-C to."""

from __future__ import annotations

import os
import time
from pathlib import Path
from subprocess import Popen
from typing import Any

HEARING = ("env", "--default-signal=INT")
"""In front of a command: it hears Ctrl-C, even if the tests are run by what is deaf to it, as a
shell makes what it starts in the background."""


def wait_for_work(process: Popen[Any], seconds: float) -> None:
    """Wait until a process has used so much processor time [s], which a busy machine delays."""
    while process.poll() is None and _processor_time(process.pid) < seconds:
        time.sleep(0.02)
    assert process.returncode is None, process.communicate()


def _processor_time(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(") ")[2].split()
    # User and system time, fields 14 and 15 of proc(5).
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
