"""An instance through the co-simulation functions of FMI 2.0."""

import ctypes
import weakref
from collections.abc import Mapping
from typing import Any, ClassVar

import fmpy.fmi1
import fmpy.fmi2
import fmpy.logging

from stickslip_verification.drive.fmu.instance import WARNING, FmuInstance

_SINKS: dict[str, list[str]] = {}


@fmpy.fmi2.fmi2CallbackLoggerTYPE  # type: ignore[untyped-decorator]
def _log(environment: Any, name: bytes, status: int, category: bytes, text: bytes) -> None:
    sink = _SINKS.get(name.decode("utf-8", errors="replace") if name else "")
    if sink is None:
        fmpy.fmi2.printLogMessage(environment, name, status, category, text)
    elif status >= WARNING and text:
        sink.append(text.decode("utf-8", errors="replace"))


_CALLBACKS = fmpy.fmi2.fmi2CallbackFunctions()
_CALLBACKS.allocateMemory = fmpy.fmi2.defaultCallbacks.allocateMemory
_CALLBACKS.freeMemory = fmpy.fmi2.defaultCallbacks.freeMemory


def _take_the_log() -> None:
    """Route the messages of all FMUs to `_log`.

    FMPy's proxy, which fills in the printf arguments of a message, holds one logger for the whole
    process, the last that was announced. So ours lives as long as the process, sorts by the
    instance's name, hands on what is not ours, and is announced anew for every instance.
    """
    _CALLBACKS.logger = _log
    fmpy.logging.addLoggerProxy(ctypes.byref(_CALLBACKS))


class Fmi2Instance(FmuInstance):
    """One instance of an FMU 2.0."""

    PREFIX = "fmi2"
    SLAVE: ClassVar[Any] = fmpy.fmi2.FMU2Slave
    C_TYPES: ClassVar[Mapping[str, tuple[str, Any]]] = {
        "Real": ("Real", ctypes.c_double),
        "Integer": ("Integer", ctypes.c_int),
        "Enumeration": ("Integer", ctypes.c_int),
        "Boolean": ("Boolean", ctypes.c_int),
    }

    def _instantiate(self) -> None:
        _SINKS[self._name] = self.messages
        weakref.finalize(self, _SINKS.pop, self._name, None)
        _take_the_log()
        try:
            self._slave.instantiate(callbacks=_CALLBACKS, loggingOn=True)
        except Exception as error:
            raise self._failure("fmi2Instantiate", error) from None

    def enter(self, start_time: float) -> None:
        """Enter initialization mode, time beginning at `start_time` [s]."""
        self._do("fmi2SetupExperiment", self._slave.setupExperiment, None, start_time)
        self._do("fmi2EnterInitializationMode", self._slave.enterInitializationMode)

    def step(self, time: float, h: float) -> None:
        """Step from the communication point `time` [s] by `h` [s]."""
        try:
            self._slave.fmi2DoStep(self._slave.component, time, h, 1)
        except fmpy.fmi1.FMICallException as error:
            raise self._failure(f"fmi2DoStep(t = {time!r}, h = {h!r})", error) from None
