"""The processes that hold FMUs: what is left of them when others are killed."""

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import pytest

from tests.needs import ROOT

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only Linux forks, and has /proc")

HANGING: dict[str, Any] = {
    "stop_time": 1, "step": 1, "parameters": {"trouble": 1}, "outputs": {"y": "last"}
}  # fmt: skip
SWEEPING = f"""
import sys
from stickslip_design.sweeps.study import prepare
prepare(sys.argv[1], {HANGING}).compute(0, 1)
"""
Found = TypeVar("Found")


def waited_for(look: Callable[[], Found]) -> Found:
    """Look till there is something; a process takes long to begin or end on a busy machine."""
    until = time.monotonic() + 100.0
    while not (found := look()):
        assert time.monotonic() < until
        time.sleep(0.02)
    return found


def descendants(process: int) -> set[int]:
    """Return the processes that a process has started, and those that these have."""
    found = set()
    with contextlib.suppress(OSError):
        for file in Path(f"/proc/{process}/task").glob("*/children"):
            for child in map(int, file.read_text().split()):
                found |= {child} | descendants(child)
    return found


def has_ended(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True


@pytest.mark.parametrize("loaded", [True, False])
def test_nothing_is_left_of_a_process_that_is_killed(
    troubled: Path, tmp_path: Path, loaded: bool
) -> None:
    sweeping = subprocess.Popen(
        [sys.executable, "-c", SWEEPING, troubled],
        env={**os.environ, "TMPDIR": str(tmp_path), "PYTHONPATH": str(ROOT)},
    )
    if loaded:
        waited_for(lambda: list(tmp_path.glob("hangs-*")))
    # What forks, what counts semaphores, the guard, the process with the FMU.
    others = waited_for(lambda: len(found := descendants(sweeping.pid)) > 3 and found)
    assert others
    assert list(tmp_path.glob("stickslip-fmu-*"))
    sweeping.kill()
    sweeping.wait()
    waited_for(lambda: all(map(has_ended, others)))
    waited_for(lambda: not list(tmp_path.glob("stickslip-fmu-*")))
