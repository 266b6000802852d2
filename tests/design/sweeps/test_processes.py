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


def children_of(process: int) -> list[int]:
    """Return the processes for FMUs that a process has started and that live."""
    found = []
    with contextlib.suppress(OSError):
        for file in Path(f"/proc/{process}/task").glob("*/children"):
            for child in file.read_text().split():
                if b"sweeps.child" in Path(f"/proc/{child}/cmdline").read_bytes():
                    found.append(int(child))
    return found


def has_ended(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True


def hanging_in(folder: Path) -> int:
    file = waited_for(lambda: next(folder.glob("hangs-*"), None))
    assert file is not None
    return int(file.name.removeprefix("hangs-"))


@pytest.mark.parametrize("loaded", [True, False])
def test_nothing_is_left_of_a_process_that_is_killed(
    troubled: Path, tmp_path: Path, loaded: bool
) -> None:
    sweeping = subprocess.Popen(
        [sys.executable, "-c", SWEEPING, troubled],
        env={**os.environ, "TMPDIR": str(tmp_path), "PYTHONPATH": str(ROOT)},
    )
    (watching,) = waited_for(lambda: children_of(sweeping.pid))
    # What starts other programs has a child before it has the one that loads.
    fork = hanging_in(tmp_path) if loaded else waited_for(lambda: children_of(watching))[0]
    assert list(tmp_path.glob("stickslip-fmu-*"))
    sweeping.kill()
    sweeping.wait()
    waited_for(lambda: has_ended(watching) and has_ended(fork))
    assert not list(tmp_path.glob("stickslip-fmu-*"))
