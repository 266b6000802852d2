"""The calls of the native FMU in a host written in C, beside those of an empty slave in C."""

import math
import statistics
import subprocess
import tempfile
import time
import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from random import Random
from typing import NamedTuple

import fmpy
import numpy as np

from stickslip_design.points.blocks import block_points
from stickslip_native.batch import Numbers, first_slips
from stickslip_native.packer import build

SLIPS = 10_000
ROUNDS = 5

_HERE = Path(__file__).parent
_OPTIONS = ("cc", "-std=c99", "-O2", "-Wall", "-Wextra")


class Calls(NamedTuple):
    """What the host printed of one kind of call.

    Attributes
    ----------
    seconds
        Time of one call [s].
    growth
        Growth of the resident memory over a million further calls [kB].
    """

    seconds: float
    growth: int


def measure_calls() -> dict[str, tuple[Calls, Calls]]:
    """Return by kind of call what the native FMU and the empty slave need.

    Raises
    ------
    FileNotFoundError
        If there is no C compiler.
    """
    with tempfile.TemporaryDirectory(prefix="stickslip-bench-") as name:
        folder = Path(name)
        host, empty = _host(folder), folder / "empty.so"
        shared = ("-fPIC", "-shared", "-o", empty, _HERE / "empty_slave.c")
        subprocess.run([*_OPTIONS, *shared], check=True)
        ours = _calls(host, *_native(folder))
        yardstick = _calls(host, empty, "none")
    return {kind: (ours[kind], yardstick[kind]) for kind in ours}


def measure_changed_input() -> tuple[float, float]:
    """Return the time of a step after a change of the input under Stribeck's law and Coulomb's [s].

    Stribeck's has its start values: the exponent is 2.
    """
    with tempfile.TemporaryDirectory(prefix="stickslip-bench-") as name:
        folder = Path(name)
        host = _host(folder)
        kind = "changed_input"
        ours, yardstick = (
            _calls(host, *_native(folder, law), kind)[kind] for law in ("stribeck", "coulomb")
        )
    return ours.seconds, yardstick.seconds


def measure_slips() -> tuple[float, float]:
    """Return the time of SLIPS slips in one call, under Stribeck's law and Coulomb's [s].

    The library is compiled before.
    """
    of_stribeck = _runs()
    runs = {name: each for name, each in of_stribeck.items() if name in "mkv"}
    return (
        _median(lambda: first_slips(of_stribeck, "stribeck")),
        _median(lambda: first_slips(runs, "coulomb")),
    )


def measure_points() -> tuple[float, float]:
    """Return the time of SLIPS points of a map under Stribeck's law, undamped and damped [s].

    Many a slip of those with damping, of ratios of 1e-3 to 0.5, has no end.
    """
    still = {name: np.array(each) for name, each in _runs().items()}
    random = np.random.default_rng(1)
    zeta = np.exp(random.uniform(math.log(1e-3), math.log(0.5), SLIPS))
    damped = {**still, "c": 2.0 * zeta * np.sqrt(still["k"] * still["m"])}
    one, other = (
        _median(partial(block_points, points, "stribeck", limit=False))
        for points in (still, damped)
    )
    return one, other


def _runs() -> dict[str, Numbers | float]:
    """Return settings under Stribeck's law.

    Mass, stiffness and pull are drawn over orders of magnitude, and so is the Stribeck velocity;
    the exponent is 2.
    """
    draw = Random(1)

    def drawn(low: float, high: float) -> list[float]:
        return [math.exp(draw.uniform(math.log(low), math.log(high))) for _ in range(SLIPS)]

    ranges = {"m": (0.1, 10.0), "k": (1e2, 1e5), "v": (1e-4, 0.1), "v_s": (1e-3, 1.0)}
    return {**{name: drawn(*ends) for name, ends in ranges.items()}, "delta": 2.0}


def _median(call: Callable[[], object]) -> float:
    call()
    times = []
    for _ in range(ROUNDS):
        begun = time.process_time()
        call()
        times.append(time.process_time() - begun)
    return statistics.median(times)


def _host(folder: Path) -> Path:
    """Compile the program that makes the calls."""
    host = folder / "calls"
    subprocess.run([*_OPTIONS, "-o", host, _HERE / "calls.c", "-ldl"], check=True)
    return host


def _native(folder: Path, law: str = "coulomb") -> tuple[Path, str]:
    """Build the native FMU under a friction law; return its library and its GUID."""
    fmu = build(folder / f"{law}.fmu", this_machine=True, law=law)
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder / law)
    (library,) = (folder / law).glob("binaries/*/*")
    return library, fmpy.read_model_description(str(fmu)).guid


def _calls(host: Path, library: Path, guid: str, *only: str) -> dict[str, Calls]:
    done = subprocess.run([host, library, guid, *only], capture_output=True, text=True, check=True)
    lines = (line.split() for line in done.stdout.splitlines())
    return {kind: Calls(float(seconds), int(growth)) for kind, seconds, growth in lines}
