"""The calls of the native FMU in a host written in C, beside those of an empty slave in C."""

import subprocess
import tempfile
import zipfile
from pathlib import Path
from typing import NamedTuple

import fmpy

from stickslip_native.packer import build

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
        host, empty = folder / "calls", folder / "empty.so"
        subprocess.run([*_OPTIONS, "-o", host, _HERE / "calls.c", "-ldl"], check=True)
        shared = ("-fPIC", "-shared", "-o", empty, _HERE / "empty_slave.c")
        subprocess.run([*_OPTIONS, *shared], check=True)
        fmu = build(folder / "StickSlip.fmu", this_machine=True)
        description = fmpy.read_model_description(str(fmu))
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder / "native")
        (library,) = folder.glob("native/binaries/*/StickSlip.*")
        ours = _calls(host, library, description.guid)
        yardstick = _calls(host, empty, "none")
    return {kind: (ours[kind], yardstick[kind]) for kind in ours}


def _calls(host: Path, library: Path, guid: str) -> dict[str, Calls]:
    done = subprocess.run([host, library, guid], capture_output=True, text=True, check=True)
    lines = (line.split() for line in done.stdout.splitlines())
    return {kind: Calls(float(seconds), int(growth)) for kind, seconds, growth in lines}
