"""Friction with a memory: a cycle of the native FMU against SciPy's LSODA, in CPU time.

A compiled LSODA is not among them: numbalsoda has no wheel for Python 3.11, and its build needs a
Fortran compiler. docs/theory.md has figures of its C++ part.
"""

import math
import shutil
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from fmpy.fmi2 import FMU2Slave
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from benchmarks.calls import slave_of
from stickslip_native.packer import build

LUGRE = {"m": 1.0, "k": 2.0, "v": 0.1, "c": 0.4, "mu_s": 1.5 / 9.81, "mu_k": 1.0 / 9.81,
         "sigma_0": 1e5, "sigma_1": math.sqrt(1e5), "v_s": 1e-3}  # fmt: skip
"""Canudas de Wit et al., IEEE TAC 40 (1995) 419, section IV-D."""
PERIOD = 6.36271982107
CYCLES = 5

Floats = NDArray[np.float64]


@contextmanager
def _started(fmu: Path, values: dict[str, float]) -> Iterator[tuple[FMU2Slave, int]]:
    slave, references = slave_of(fmu)
    slave.instantiate()
    slave.setReal([references[name] for name in values], [*values.values()])
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    yield slave, references["T"]
    slave.terminate()
    slave.freeInstance()
    shutil.rmtree(slave.unzipDirectory, ignore_errors=True)


def cycle_of_the_fmu(folder: Path, law: str, values: dict[str, float], period: float) -> float:
    """Return the time of a cycle [s] of the native FMU under a law, the best of ten."""
    best = math.inf
    with _started(build(folder / f"{law}.fmu", this_machine=True, law=law), values) as (slave, _):
        slave.doStep(0.0, 3.0 * period)
        for number in range(10):
            begin = time.process_time()
            slave.doStep((3 + number * CYCLES) * period, CYCLES * period)
            best = min(best, (time.process_time() - begin) / CYCLES)
    return best


def step_of_the_fmu(folder: Path, law: str, values: dict[str, float]) -> float:
    """Return the median time [s] of a step of 1 ms at constant inputs."""
    times = []
    with _started(build(folder / f"{law}.fmu", this_machine=True, law=law), values) as (
        slave,
        period,
    ):
        for number in range(20_000):
            begin = time.process_time()
            slave.doStep(number * 1e-3, 1e-3)
            slave.getReal([period])
            times.append(time.process_time() - begin)
    return statistics.median(times)


def cycle_of_lsoda(rtol: float) -> tuple[float, float]:
    """Return the time of a cycle [s] of LSODA, and the error of its period, relative."""
    p = LUGRE
    weight = p["m"] * 9.81
    low, gap = p["mu_k"] * weight, (p["mu_s"] - p["mu_k"]) * weight

    def rates(t: float, y: Floats) -> list[float]:
        z, u, zeta = y.tolist()
        ratio = u / p["v_s"]
        zeta_dot = u - p["sigma_0"] * abs(u) * zeta / (low + gap * math.exp(-ratio * ratio))
        friction = p["sigma_0"] * zeta + p["sigma_1"] * zeta_dot + p["c"] * u
        return [p["v"] - u, (p["k"] * z - friction) / p["m"], zeta_dot]

    def top(t: float, y: Floats) -> float:
        return float(y[1]) - p["v"]

    top.direction = 1.0  # type: ignore[attr-defined]
    begin = time.process_time()
    done = solve_ivp(
        rates, (0.0, (3 + CYCLES) * PERIOD), [0.0, 0.0, 0.0], "LSODA", events=top,
        rtol=rtol, atol=[rtol, rtol * p["k"] * p["v"] / p["sigma_0"], rtol / p["sigma_0"]],
    )  # fmt: skip
    spent = (time.process_time() - begin) / (3 + CYCLES)
    maxima = done.t_events[0]
    return spent, abs(maxima[-1] - maxima[-2] - PERIOD) / PERIOD


def measured(folder: Path) -> Iterator[tuple[str, str, list[float], str, float | None]]:
    """Give what is measured, its unit, our time and the yardstick's, what that is, the limit."""
    spent, error = min(cycle_of_lsoda(1e-10) for _ in range(3))
    soft = cycle_of_the_fmu(folder, "lugre", LUGRE, PERIOD)
    against = f"SciPy's LSODA, rtol = 1e-10, period good to {error:.0e}"
    yield "LuGre, sigma_0 = 1e5: cycle, good to 1e-10", "cycle", [soft, spent], against, 0.05
    stiff = LUGRE | {"sigma_0": 1e9, "sigma_1": math.sqrt(1e9)}
    hard = cycle_of_the_fmu(folder, "lugre", stiff, 6.51187262084)
    yield "LuGre, sigma_0 = 1e9: cycle", "cycle", [hard, soft], "sigma_0 = 1e5", 2.0
    step = [step_of_the_fmu(folder, "lugre", LUGRE)]
    yield "LuGre: step of 1 ms, T read, by FMPy", "step", step, "", None
