"""Runs of our FMU in a sweep: 3 s of motion in one step, last values kept, one worker."""

import tempfile
import time
from pathlib import Path

from stickslip_design.sweeps.study import prepare, release
from stickslip_fmu.packer import build
from stickslip_native.packer import build as build_native

ROUNDS = 5
RUNS = {"python": 500, "native": 5000}

_PLAN = {
    "stop_time": "3 s",
    "step": "3 s",
    "outputs": {"delta_x": "last", "T": "last"},
}


def measure_runs() -> dict[str, float]:
    """Return the time of a run by kind of FMU [s]: reset, values set, stepped, read, handed over.

    The process that holds the FMU is started before. The mass differs a little from run to run.
    """
    with tempfile.TemporaryDirectory(prefix="stickslip-bench-") as name:
        folder = Path(name)
        fmus = {
            "python": build(folder),
            "native": build_native(folder / "native.fmu", this_machine=True),
        }
        return {kind: _seconds(fmu, RUNS[kind]) for kind, fmu in fmus.items()}


def _seconds(fmu: Path, runs: int) -> float:
    study = prepare(fmu, {**_PLAN, "parameters": {"m": f"1..1.001 kg {runs}"}})
    best = float("inf")
    try:
        study.compute(0, 1)
        for _ in range(ROUNDS):
            begun = time.perf_counter()
            columns = study.compute(0, runs)
            best = min(best, time.perf_counter() - begun)
            if any(columns["failure"]):
                raise RuntimeError(f"a run fails: {columns['failure']}")
    finally:
        release()
    return best / runs
