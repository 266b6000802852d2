"""Calls of FMUs without an importer: through bare ctypes, and in a host written in C."""

import ctypes
import shutil
import subprocess
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave

from stickslip_native.packer import build

TEN_OUTPUTS = ["x", "x_dot", "x_pull", "z", "F", "F_friction", "F_s", "t_stick", "t_slip", "T"]
CO_SIMULATION = 1
"""fmi2Type."""

_HERE = Path(__file__).parent
_OPTIONS = ("cc", "-std=c99", "-O2", "-Wall", "-Wextra")

Calls = dict[str, Callable[[int], None]]
"""By kind of call, what makes it so many times."""


def slave_of(fmu: Path) -> tuple[FMU2Slave, dict[str, int]]:
    """Return an FMU's slave, not yet instantiated, and its value references by name."""
    description = fmpy.read_model_description(str(fmu))
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(fmu)),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=fmu.stem,
    )
    return slave, {each.name: each.valueReference for each in description.modelVariables}


@contextmanager
def bare(fmu: Path) -> Iterator[Calls]:
    """Give the calls that importers make most of one initialized instance, through ctypes."""
    slave, references = slave_of(fmu)
    folder = slave.unzipDirectory
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    library, component = slave.dll, ctypes.c_void_p(slave.component)
    chosen = (ctypes.c_uint * len(TEN_OUTPUTS))(*(references[name] for name in TEN_OUTPUTS))
    read = component, chosen, ctypes.c_size_t(len(chosen)), (ctypes.c_double * len(chosen))()
    to_step = component, ctypes.c_double(0.0), ctypes.c_double(1e-3), ctypes.c_int(1)
    state = ctypes.c_void_p()
    kept = ctypes.byref(state)
    step, get = library["fmi2DoStep"], library["fmi2GetReal"]
    get_state, set_state = library["fmi2GetFMUstate"], library["fmi2SetFMUstate"]
    make, free = library["fmi2Instantiate"], library["fmi2FreeInstance"]
    free_state = library["fmi2FreeFMUstate"]
    make.restype = ctypes.c_void_p
    resources = (Path(folder) / "resources").as_uri().encode()
    callbacks = ctypes.byref(slave.callbacks)
    identity = b"another", CO_SIMULATION, slave.guid.encode(), resources, callbacks, 0, 0

    def steps(times: int) -> None:
        for _ in range(times):
            step(*to_step)

    def steps_and_outputs(times: int) -> None:
        for _ in range(times):
            step(*to_step)
            get(*read)

    def rounds_of_state(times: int) -> None:
        for _ in range(times):
            get_state(component, kept)
            step(*to_step)
            set_state(component, state)
            free_state(component, kept)

    def instances(times: int) -> None:
        for _ in range(times):
            free(ctypes.c_void_p(make(*identity)))

    yield {each.__name__: each for each in (steps, steps_and_outputs, rounds_of_state, instances)}
    slave.terminate()
    # The wrapper releases the interpreter twice when the process ends, unless it is made to
    # before: the stock slave does nothing about that, and its library is never unloaded.
    release = library.finalizePythonInterpreter
    slave.fmi2FreeInstance(slave.component)
    release()
    shutil.rmtree(folder, ignore_errors=True)


def in_c(folder: Path, law: str | None, *only: str) -> dict[str, tuple[float, int]]:
    """Return by kind of call of the native FMU its time [s], and growth of memory [kB], in C.

    Growth is of the resident memory over a million further calls.

    Parameters
    ----------
    folder
        Where the host and the FMU are compiled.
    law
        Friction law of the FMU; None: an empty slave in its place.
    only
        Kinds of call; all where none is named.
    """
    host, library, guid = folder / "calls", folder / "empty.so", "none"
    subprocess.run([*_OPTIONS, "-o", host, _HERE / "calls.c", "-ldl"], check=True)
    if law is None:
        shared = ("-fPIC", "-shared", "-o", library, _HERE / "empty_slave.c")
        subprocess.run([*_OPTIONS, *shared], check=True)
    else:
        fmu = build(folder / f"{law}.fmu", this_machine=True, law=law)
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder / law)
        (library,) = (folder / law).glob("binaries/*/*")
        guid = fmpy.read_model_description(str(fmu)).guid
    done = subprocess.run([host, library, guid, *only], capture_output=True, text=True, check=True)
    lines = (line.split() for line in done.stdout.splitlines())
    return {kind: (float(seconds), int(growth)) for kind, seconds, growth in lines}
