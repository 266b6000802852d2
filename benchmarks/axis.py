"""How long the verdict on a feed axis takes, from the call of the command to the report."""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from stickslip_design.axis import axis_of, example
from stickslip_design.loop.jumps import limit_of_jumps

ROUNDS = 5


def measure_limit() -> float:
    """Return the shortest time of the critical feed in the loop [s], of the example's axis."""
    axis = axis_of(example())
    times = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        limit_of_jumps(axis)
        times.append(time.perf_counter() - begin)
    return min(times)


def measure_command() -> float:
    """Return the time of `stickslip design` on the example's axis [s], in a process of its own."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "axis.toml").write_text(example(), encoding="utf-8")
        begin = time.perf_counter()
        subprocess.run(
            [Path(sys.executable).with_name("stickslip"), "design", "axis.toml"],
            cwd=folder,
            check=True,
            capture_output=True,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
        )
        return time.perf_counter() - begin
