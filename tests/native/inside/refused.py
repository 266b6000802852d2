"""Plays lists of calls on an FMU, each on a new instance, up to the first call that is refused.

Called with the FMU's path; reads the lists as JSON and prints, for each, which calls were taken.
Standard error has a line MARK before the messages of each list, one line a message: the Python FMU
writes them itself, the log of the native FMU is written here.
"""

import ctypes
import json
import runpy
import sys
from pathlib import Path
from typing import Any

runpy.run_path(str(Path(__file__).resolve().parents[2] / "barred.py"), run_name="__main__")

import fmpy  # noqa: E402 - the bar comes first
from fmpy.fmi1 import FMICallException  # noqa: E402
from fmpy.fmi2 import (  # noqa: E402
    FMU2Slave,
    defaultCallbacks,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.fmi3 import FMU3Slave  # noqa: E402

MARK = "==="


class Player:
    """Makes instances of one FMU and calls them."""

    def __init__(self, fmu: str) -> None:
        self.description = fmpy.read_model_description(fmu)
        self.folder = fmpy.extract(fmu)
        self.modern = self.description.fmiVersion == "3.0"
        # The Python FMU writes to standard error itself.
        self.is_native = not Path(self.folder, "resources", "slavemodule.txt").exists()

    def instance(self) -> Any:
        """Return a new instance."""
        token = self.description.instantiationToken if self.modern else self.description.guid
        slave = (FMU3Slave if self.modern else FMU2Slave)(
            guid=token,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.modelName,
            instanceName="a",
        )
        if self.modern:
            slave.instantiate(logMessage=self._hear, loggingOn=True)
        else:
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(
                lambda environment, name, status, category, text: self._hear(
                    environment, status, category, text
                )
            )
            callbacks.allocateMemory = defaultCallbacks.allocateMemory
            callbacks.freeMemory = defaultCallbacks.freeMemory
            slave.instantiate(callbacks=callbacks, loggingOn=True)
            slave.kept_callbacks = callbacks
        return slave

    def _hear(self, environment: Any, status: int, category: bytes, text: bytes) -> None:
        if self.is_native:
            print(f"{self.description.modelName}: {text.decode()}", file=sys.stderr)

    def call(self, slave: Any, name: str, *arguments: Any) -> None:
        """Make one call."""
        if name == "start" and self.modern:
            slave.enterInitializationMode(startTime=arguments[0])
        elif name == "start":
            slave.setupExperiment(startTime=arguments[0])
            slave.enterInitializationMode()
        elif name == "raw":
            function, *others = arguments
            place = ctypes.byref(ctypes.c_double())
            passed = [place if each == "&" else each for each in others]
            getattr(slave, function)(slave.component, *passed)
        else:
            getattr(slave, name)(*arguments)


def main() -> None:
    """Play all lists."""
    player = Player(sys.argv[1])
    shown = []
    for calls in json.load(sys.stdin):
        print(MARK, file=sys.stderr)
        taken = []
        slave = player.instance()
        for name, *arguments in calls:
            try:
                player.call(slave, name, *arguments)
                taken.append(True)
            except FMICallException:
                taken.append(False)
                break
        slave.freeInstance()
        shown.append(taken)
    sys.stderr.flush()
    print(json.dumps(shown))


if __name__ == "__main__":
    main()
