"""The processes that hold FMUs: what is left of them when others are killed."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from stickslip_design.sweeps.host import Host
from stickslip_design.sweeps.study import prepare
from tests.needs import ROOT

HANGING = {
    "stop_time": 1,
    "step": 1,
    "parameters": {"trouble": 1},
    "outputs": {"y": "last"},
}

SWEEPING = """
import sys
from stickslip_design.sweeps.study import prepare
prepare(sys.argv[1], {"stop_time": 1, "step": 1, "parameters": {"trouble": 1},
                      "outputs": {"y": "last"}}).compute(0, 1)
"""

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only Linux forks, and has /proc")


WITHIN = 100.0
"""Seconds in which a process has to begin or to end; on a busy machine it takes long."""


def children_of(process: int) -> list[int]:
    """Return the processes for FMUs that a process has started and that live."""
    found = []
    with contextlib.suppress(OSError):
        for file in Path(f"/proc/{process}/task").glob("*/children"):
            found += [int(child) for child in file.read_text().split()]
    return [each for each in found if b"sweeps.child" in _command_of(each)]


def _command_of(process: int) -> bytes:
    try:
        return Path(f"/proc/{process}/cmdline").read_bytes()
    except OSError:
        return b""


def child_of(process: int) -> int:
    """Wait for the process for FMUs that a process starts, and return it."""
    until = time.monotonic() + WITHIN
    while not (its := children_of(process)):
        assert time.monotonic() < until
        time.sleep(0.02)
    return its[0]


def lives(process: int) -> bool:
    """Tell whether a process has not ended; one that nobody has waited for yet has."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"


def end_of(process: int) -> None:
    """Wait for the end of a process; fails after `WITHIN`."""
    until = time.monotonic() + WITHIN
    while lives(process):
        assert time.monotonic() < until
        time.sleep(0.02)


def hanging_in(folder: Path) -> int:
    """Wait till an FMU hangs, and return its process."""
    until = time.monotonic() + WITHIN
    while not (its := list(folder.glob("hangs-*"))):
        assert time.monotonic() < until
        time.sleep(0.02)
    return int(its[0].name.removeprefix("hangs-"))


@pytest.mark.parametrize("loaded", [True, False])
def test_nothing_is_left_of_a_process_that_is_killed(
    troubled: Path, tmp_path: Path, loaded: bool
) -> None:
    """Not the FMU, be it loaded yet or not, nor the process that watches it, nor their folder."""
    sweeping = subprocess.Popen(
        [sys.executable, "-c", SWEEPING, troubled],
        env={**os.environ, "TMPDIR": str(tmp_path), "PYTHONPATH": str(ROOT)},
    )
    watching = child_of(sweeping.pid)
    # What starts other programs has a child before it has the one that loads.
    hanging = hanging_in(tmp_path) if loaded else child_of(watching)
    assert [each.name for each in tmp_path.glob("stickslip-fmu-*")]
    sweeping.kill()
    sweeping.wait()
    end_of(watching)
    end_of(hanging)
    assert not list(tmp_path.glob("stickslip-fmu-*"))


def test_an_fmu_ends_with_the_process_that_watches_it(
    troubled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And its run is recorded as one that crashed; the next one has a process of its own."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    study = prepare(troubled, {**HANGING, "parameters": {"trouble": [1, 0]}})
    host = Host(study.job, study.content, is_system=False, time_limit=2 * WITHIN)
    killed: list[int] = []

    def kill() -> None:
        watching = child_of(os.getpid())
        killed.append(hanging_in(tmp_path))
        os.kill(watching, signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    try:
        outcomes = list(host.runs(np.array([[1.0], [0.0]])))
    finally:
        thread.join()
        host.close()
    assert [each.failure for each in outcomes] == ["crashed (SIGKILL)", ""]
    end_of(killed[0])
