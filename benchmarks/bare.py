"""An FMU called through bare ctypes, so that what is timed is the FMU and not its importer."""

import ctypes
import shutil
from pathlib import Path
from types import TracebackType

import fmpy
from fmpy.fmi2 import FMU2Slave

CO_SIMULATION = 1
"""fmi2Type."""


class BareSlave:
    """One initialized instance with the calls that importers make most.

    Parameters
    ----------
    fmu
        The FMU file.
    outputs
        Names of the Real outputs that `get` reads.
    """

    def __init__(self, fmu: Path, outputs: list[str]) -> None:
        description = fmpy.read_model_description(str(fmu))
        references = {each.name: each.valueReference for each in description.modelVariables}
        self._folder = fmpy.extract(str(fmu))
        self._slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self._folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=fmu.stem,
        )
        self._slave.instantiate()
        self._slave.setupExperiment(startTime=0.0)
        self._slave.enterInitializationMode()
        self._slave.exitInitializationMode()
        component = ctypes.c_void_p(self._slave.component)
        library = self._slave.dll
        count = ctypes.c_size_t(len(outputs))
        chosen = (ctypes.c_uint * len(outputs))(*(references[name] for name in outputs))
        values = (ctypes.c_double * len(outputs))()
        step_size = ctypes.c_double(1e-3)
        now = ctypes.c_double(0.0)
        yes = ctypes.c_int(1)
        do_step, get_real = library["fmi2DoStep"], library["fmi2GetReal"]

        def step(times: int) -> None:
            for _ in range(times):
                do_step(component, now, step_size, yes)

        def step_and_get(times: int) -> None:
            for _ in range(times):
                do_step(component, now, step_size, yes)
                get_real(component, chosen, count, values)

        state = ctypes.c_void_p()
        kept = ctypes.byref(state)
        get_state, set_state = library["fmi2GetFMUstate"], library["fmi2SetFMUstate"]
        free_state = library["fmi2FreeFMUstate"]

        def step_and_go_back(times: int) -> None:
            for _ in range(times):
                get_state(component, kept)
                do_step(component, now, step_size, yes)
                set_state(component, state)
                free_state(component, kept)

        make, free = library["fmi2Instantiate"], library["fmi2FreeInstance"]
        make.restype = ctypes.c_void_p
        identity = (
            b"another",
            CO_SIMULATION,
            description.guid.encode(),
            (Path(self._folder) / "resources").as_uri().encode(),
            ctypes.byref(self._slave.callbacks),
            0,
            0,
        )

        def instantiate(times: int) -> None:
            for _ in range(times):
                free(ctypes.c_void_p(make(*identity)))

        self.step = step
        self.step_and_get = step_and_get
        self.step_and_go_back = step_and_go_back
        self.instantiate = instantiate

    def __enter__(self) -> "BareSlave":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._slave.terminate()
        # The wrapper releases the interpreter twice when the process ends, unless it is made to
        # before: the stock slave does nothing about that, and its library is never unloaded.
        release = self._slave.dll.finalizePythonInterpreter
        self._slave.fmi2FreeInstance(self._slave.component)
        release()
        shutil.rmtree(self._folder, ignore_errors=True)
