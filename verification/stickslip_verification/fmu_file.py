"""An FMU as a file: extracted once, driven through the FMI 2.0 co-simulation functions.

Nothing is known of the FMU but its archive, so any FMU 2.0 for co-simulation can stand here.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import itertools
import os
import shutil
import tempfile
import weakref
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import fmpy
import fmpy.fmi2
import fmpy.logging

WARNING = 1
"""The highest status of a call that still did what it was asked (FMI 2.0, section 2.1.3)."""


_SINKS: dict[str, list[str]] = {}
_COUNTER = itertools.count(1)


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


# Libraries that were loaded; FMUs that pythonfmu wrapped stay loaded for good.
_LOADED: set[str] = set()


@atexit.register
def _let_go() -> None:
    """Make pythonfmu's wrappers release the interpreter now.

    Left to themselves they do it twice when the process ends, the second time in freed memory.
    """
    only_if_loaded = getattr(os, "RTLD_NOLOAD", None)
    if only_if_loaded is None:
        return
    for library in _LOADED:
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(library, mode=only_if_loaded).finalizePythonInterpreter()


class FmuError(RuntimeError):
    """The FMU cannot be used or refused a call; one line with what it said itself."""


class FmuFile:
    """An extracted FMU and its description.

    Parameters
    ----------
    path
        The ``.fmu`` archive.

    Raises
    ------
    FmuError
        No such file, not an FMU, not for co-simulation, or not FMI 2.0.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        if not path.is_file():
            raise FmuError(f"{path}: no such file")
        if not zipfile.is_zipfile(path):
            raise FmuError(f"{path}: not an FMU (not a zip archive)")
        try:
            description = fmpy.read_model_description(str(path))
        except Exception as error:
            raise FmuError(f"{path}: not an FMU ({_one_line(error)})") from None
        if description.fmiVersion != "2.0":
            raise FmuError(f"{path}: FMI {description.fmiVersion}; this suite drives FMI 2.0")
        if description.coSimulation is None:
            raise FmuError(f"{path}: has no co-simulation interface")
        self.guid: str = description.guid
        self.identifier: str = description.coSimulation.modelIdentifier
        self.variables: dict[str, Any] = {v.name: v for v in description.modelVariables}
        self.folder = Path(tempfile.mkdtemp(prefix="stickslip-fmu-"))
        self.close = weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        try:
            fmpy.extract(str(path), unzipdir=str(self.folder))
        except Exception as error:
            raise FmuError(f"{path}: cannot be unpacked ({_one_line(error)})") from None

    def has(self, name: str) -> bool:
        """Whether the FMU has a variable of this name."""
        return name in self.variables

    def instantiate(self) -> FmuInstance:
        """Make a new instance; `FmuError` if the FMU refuses."""
        return FmuInstance(self)


class FmuInstance:
    """One instance of an FMU. Values in SI, as FMI hands them over.

    After an `FmuError` only `reset` and `free` are of use.
    """

    def __init__(self, fmu: FmuFile) -> None:
        self.file = fmu
        name = f"{fmu.identifier}-{next(_COUNTER)}"
        self.messages: list[str] = _SINKS.setdefault(name, [])
        weakref.finalize(self, _SINKS.pop, name, None)
        self._freed = False
        try:
            self._slave = fmpy.fmi2.FMU2Slave(
                guid=fmu.guid,
                modelIdentifier=fmu.identifier,
                unzipDirectory=str(fmu.folder),
                instanceName=name,
            )
        except Exception as error:
            raise FmuError(f"{fmu.path.name}: {_one_line(error)}") from None
        _LOADED.add(self._slave.dll._name)
        _take_the_log()
        try:
            self._slave.instantiate(callbacks=_CALLBACKS, loggingOn=True)
        except Exception as error:
            raise self._failure("fmi2Instantiate", error) from None

    def _failure(self, call: str, error: Exception) -> FmuError:
        said = " ".join(self.messages[-1].split()) if self.messages else "without a message"
        return FmuError(f"{self.file.path.name}: {call} failed: {said} ({_one_line(error)})")

    def _do(self, call: str, function: Callable[..., object], *arguments: object) -> None:
        try:
            function(*arguments)
        except fmpy.fmi1.FMICallException as error:
            raise self._failure(call, error) from None

    def start(self, values: Mapping[str, float], start_time: float = 0.0) -> None:
        """Set `values`, set up the experiment [s] and go through initialization mode."""
        self.set(values)
        self._do("fmi2SetupExperiment", self._slave.setupExperiment, None, start_time)
        self._do("fmi2EnterInitializationMode", self._slave.enterInitializationMode)
        self._do("fmi2ExitInitializationMode", self._slave.exitInitializationMode)

    def set(self, values: Mapping[str, float]) -> None:
        """Set real variables by name; `FmuError` for one that the FMU does not have."""
        if not values:
            return
        missing = [name for name in values if not self.file.has(name)]
        if missing:
            raise FmuError(f"{self.file.path.name}: has no variable {', '.join(missing)}")
        references = [self.file.variables[name].valueReference for name in values]
        self._do(
            f"fmi2SetReal({', '.join(f'{n} = {v!r}' for n, v in values.items())})",
            self._slave.setReal,
            references,
            list(values.values()),
        )

    def step(self, time: float, h: float) -> None:
        """Step from the communication point `time` [s] by `h` [s]."""
        try:
            self._slave.fmi2DoStep(self._slave.component, time, h, 1)
        except fmpy.fmi1.FMICallException as error:
            raise self._failure(f"fmi2DoStep(t = {time!r}, h = {h!r})", error) from None

    def reader(self, names: Sequence[str]) -> Callable[[], list[float]]:
        """Give a function that reads these variables at once, in this order.

        `FmuError` for a name that the FMU does not have.
        """
        missing = [name for name in names if not self.file.has(name)]
        if missing:
            raise FmuError(f"{self.file.path.name}: has no variable {', '.join(missing)}")
        groups = []
        for kind, c_type in (
            ("Real", ctypes.c_double),
            ("Integer", ctypes.c_int),
            ("Boolean", ctypes.c_int),
        ):
            places = [i for i, n in enumerate(names) if self.file.variables[n].type == kind]
            if places:
                references = (ctypes.c_uint * len(places))(
                    *(self.file.variables[names[i]].valueReference for i in places)
                )
                buffer = (c_type * len(places))()
                get = getattr(self._slave, f"fmi2Get{kind}")
                groups.append((kind, get, places, references, buffer))
        if sum(len(group[2]) for group in groups) != len(names):
            raise FmuError(f"{self.file.path.name}: a String cannot be read as a number")

        def read() -> list[float]:
            values = [0.0] * len(names)
            for kind, get, places, references, buffer in groups:
                try:
                    get(self._slave.component, references, len(places), buffer)
                except fmpy.fmi1.FMICallException as error:
                    raise self._failure(f"fmi2Get{kind}", error) from None
                for place, value in zip(places, buffer, strict=True):
                    values[place] = float(value)
            return values

        return read

    def reset(self) -> None:
        """Back to the state after instantiation."""
        self._do("fmi2Reset", self._slave.reset)

    def free(self) -> None:
        """Free the instance; a second call does nothing."""
        if not self._freed:
            self._freed = True
            self._slave.freeInstance()

    def __enter__(self) -> FmuInstance:
        return self

    def __exit__(self, *_: object) -> None:
        self.free()


def available(fmu: FmuFile, names: Iterable[str]) -> list[str]:
    """Of these names, those that the FMU has, in the same order."""
    return [name for name in names if fmu.has(name)]


def _one_line(error: BaseException) -> str:
    return " ".join(str(error).split()) or type(error).__name__
