"""The FMI 2.0 functions of the FMU as they are: no exception, the status comes back."""

import ctypes as c
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import fmpy
from fmpy.fmi2 import (
    addLoggerProxy,
    defaultCallbacks,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

_P, _N, _REAL, _INT, _TEXT = c.c_void_p, c.c_size_t, c.c_double, c.c_int, c.c_char_p

_ARGUMENTS: dict[str, list[Any]] = {
    "SetupExperiment": [_P, _INT, _REAL, _REAL, _INT, _REAL],
    "EnterInitializationMode": [_P],
    "ExitInitializationMode": [_P],
    "Terminate": [_P],
    "Reset": [_P],
    "FreeInstance": [_P],
    "DoStep": [_P, _REAL, _REAL, _INT],
    "CancelStep": [_P],
    **{
        f"{verb}{kind}": [_P, _P, _N, _P]
        for verb in ("Get", "Set")
        for kind in ("Real", "Integer", "Boolean", "String")
    },
    **{f"Get{kind}Status": [_P, _INT, _P] for kind in ("", "Real", "Integer", "Boolean", "String")},
    "GetFMUstate": [_P, _P],
    "SetFMUstate": [_P, _P],
    "FreeFMUstate": [_P, _P],
    "SerializedFMUstateSize": [_P, _P, _P],
    "SerializeFMUstate": [_P, _P, _P, _N],
    "DeSerializeFMUstate": [_P, _P, _N, _P],
    "GetDirectionalDerivative": [_P, _P, _N, _P, _N, _P, _P],
    "SetRealInputDerivatives": [_P, _P, _N, _P, _P],
    "GetRealOutputDerivatives": [_P, _P, _N, _P, _P],
    "SetDebugLogging": [_P, _INT, _N, _P],
    "Instantiate": [_TEXT, _INT, _TEXT, _TEXT, _P, _INT, _INT],
    "GetVersion": [],
    "GetTypesPlatform": [],
}
_RESULTS = {"Instantiate": _P, "FreeInstance": None, "GetVersion": _TEXT, "GetTypesPlatform": _TEXT}

CTYPES: dict[str, Any] = {"Real": _REAL, "Integer": _INT, "Boolean": _INT, "String": _TEXT}


class Raw:
    """The functions of one FMU.

    Attributes
    ----------
    messages
        What the FMU has logged, as printf shows it.
    """

    def __init__(self, importer: Any) -> None:
        identifier = importer.description.coSimulation.modelIdentifier
        binary = f"{identifier}{fmpy.sharedLibraryExtension}"
        self.library = c.CDLL(str(Path(importer.folder, "binaries", fmpy.platform, binary)))
        for name, arguments in _ARGUMENTS.items():
            function = self.library[f"fmi2{name}"]
            function.argtypes = arguments
            function.restype = _RESULTS.get(name, _INT)
            setattr(self, name, function)
        self.guid = importer.description.guid.encode()
        self.resources = Path(importer.folder, "resources").as_uri().encode()
        self.references = importer.references
        self.messages: list[str] = []
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
        self.callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self.callbacks.freeMemory = defaultCallbacks.freeMemory
        # It has C's printf read each message, as simulators written in C do.
        addLoggerProxy(c.byref(self.callbacks))

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)

    def _log(self, _: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.messages.append(message.decode("utf-8", errors="backslashreplace"))

    def instance(self, name: str = "a", *, logging: bool = False) -> Any:
        """Return a new instance."""
        made = self.Instantiate(
            name.encode(), 1, self.guid, self.resources, c.byref(self.callbacks), 0, logging
        )
        assert made
        return made

    def started(self, name: str = "a", **values: float) -> Any:
        """Return a new instance with these values set, ready to step."""
        made = self.instance(name)
        assert self.SetupExperiment(made, 0, 0.0, 0.0, 0, 0.0) == 0
        for each, value in values.items():
            assert self.set(made, each, value) == 0
        assert self.EnterInitializationMode(made) == 0
        assert self.ExitInitializationMode(made) == 0
        return made

    def set(self, instance: Any, name: str, value: float) -> int:
        """Set a Real by name; return the status."""
        return self.write(instance, "Real", [self.references[name]], [value])

    def write(self, instance: Any, kind: str, references: Sequence[int], values: Any) -> int:
        """Set variables of a kind; return the status."""
        count = len(references)
        given = (CTYPES[kind] * count)(*values)
        status: int = getattr(self, f"Set{kind}")(
            instance, (c.c_uint * count)(*references), count, given
        )
        return status

    def read(self, instance: Any, kind: str, references: Sequence[int]) -> tuple[int, list[Any]]:
        """Get variables of a kind; return the status and the values."""
        count = len(references)
        taken = (CTYPES[kind] * count)()
        status = getattr(self, f"Get{kind}")(
            instance, (c.c_uint * count)(*references), count, taken
        )
        return status, list(taken)

    def save(self, instance: Any) -> Any:
        """Return a state."""
        state = c.c_void_p()
        assert self.GetFMUstate(instance, c.byref(state)) == 0
        return state

    def forget(self, instance: Any, state: Any) -> None:
        """Free a state."""
        assert self.FreeFMUstate(instance, c.byref(state)) == 0

    def pack(self, instance: Any, state: Any) -> bytes:
        """Return a state as bytes."""
        size = c.c_size_t()
        assert self.SerializedFMUstateSize(instance, state, c.byref(size)) == 0
        data = c.create_string_buffer(size.value)
        assert self.SerializeFMUstate(instance, state, data, size.value) == 0
        return data.raw

    def unpack(self, instance: Any, data: bytes) -> Any:
        """Return the state that bytes hold."""
        state = c.c_void_p()
        buffer = c.create_string_buffer(data, len(data)) if data else None
        assert self.DeSerializeFMUstate(instance, buffer, len(data), c.byref(state)) == 0
        return state
