"""An instance through the co-simulation functions of FMI 3.0."""

import ctypes
from collections.abc import Mapping
from typing import Any, ClassVar

import fmpy.fmi1
import fmpy.fmi3

from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.instance import WARNING, FmuInstance

_INTEGERS: Mapping[str, Any] = {
    f"{sign}Int{bits}": getattr(ctypes, f"c_{sign.lower()}int{bits}")
    for sign in ("", "U")
    for bits in (8, 16, 32, 64)
}


class Fmi3Instance(FmuInstance):
    """One instance of an FMU 3.0, without event mode and without early return."""

    PREFIX = "fmi3"
    SLAVE: ClassVar[Any] = fmpy.fmi3.FMU3Slave
    C_TYPES: ClassVar[Mapping[str, tuple[str, Any]]] = {
        "Float64": ("Float64", ctypes.c_double),
        "Float32": ("Float32", ctypes.c_float),
        "Enumeration": ("Int64", ctypes.c_int64),
        "Boolean": ("Boolean", ctypes.c_bool),
        **{kind: (kind, c_type) for kind, c_type in _INTEGERS.items()},
    }

    def _instantiate(self) -> None:
        messages = self.messages

        def log(_: Any, status: int, __: bytes, text: bytes) -> None:
            if status >= WARNING and text:
                messages.append(text.decode("utf-8", errors="replace"))

        try:
            self._slave.instantiate(loggingOn=True, logMessage=log)
        except Exception as error:
            raise self._failure("fmi3InstantiateCoSimulation", error) from None
        self._event = ctypes.c_bool()
        self._terminate = ctypes.c_bool()
        self._early = ctypes.c_bool()
        self._reached = ctypes.c_double()
        self._flags = tuple(
            ctypes.byref(flag)
            for flag in (self._event, self._terminate, self._early, self._reached)
        )

    def enter(self, start_time: float) -> None:
        """Enter initialization mode, time beginning at `start_time` [s]."""
        function = self._slave.enterInitializationMode
        self._do("fmi3EnterInitializationMode", function, None, start_time)

    def step(self, time: float, h: float) -> None:
        """Step from the communication point `time` [s] by `h` [s].

        A step that ends the simulation or stops before its end is an `FmuError`: neither was
        allowed to it. That an event would need handling is no error without event mode.
        """
        # Wrappers leave untouched what they have nothing to say about.
        self._terminate.value = self._early.value = False
        self._reached.value = time + h
        try:
            self._slave.fmi3DoStep(self._slave.component, time, h, True, *self._flags)
        except fmpy.fmi1.FMICallException as error:
            raise self._failure(f"fmi3DoStep(t = {time!r}, h = {h!r})", error) from None
        if self._terminate.value or self._early.value:
            did = "ends the simulation" if self._terminate.value else "returns early"
            raise FmuError(
                f"{self.file.path.name}: fmi3DoStep(t = {time!r}, h = {h!r}) {did} "
                f"at t = {self._reached.value!r}"
            )

    def _sizes(self, count: int) -> tuple[int, ...]:
        return (count,)
