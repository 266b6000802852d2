"""One instance of an FMU of either FMI version, read and set by the suite's names in SI."""

import atexit
import contextlib
import ctypes
import itertools
import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Protocol, Self

import fmpy.fmi1

from stickslip_verification.drive.fmu.errors import FmuError, one_line
from stickslip_verification.drive.fmu.variables import Variable

WARNING = 1
"""The highest status of a call that succeeded (FMI 2.0, section 2.1.3)."""

FATAL = 4
"""The status after which nothing may be called any more (FMI 2.0, section 2.1.3)."""

_MEANING = {2: "discarded", 3: "error", 4: "fatal", 5: "pending, and no step may be"}

FLOATING = frozenset({"Real", "Float64", "Float32"})

State = ctypes.c_void_p
"""A state that the FMU keeps; to be freed by the instance that gave it."""

_MOST_MESSAGES = 1000
_LONGEST_MESSAGE = 2000

_COUNTER = itertools.count(1)

_LOADED: set[str] = set()
"""Paths of the libraries in this process: those of pythonfmu and pythonfmu3 stay for good."""


@atexit.register
def _let_go() -> None:
    """Make the wrappers of pythonfmu and pythonfmu3 release the interpreter now.

    Left to themselves they do it twice when the process ends, the second time in freed memory.
    """
    if hasattr(os, "RTLD_NOLOAD"):
        for library in _LOADED:
            with contextlib.suppress(OSError, AttributeError):
                ctypes.CDLL(library, mode=os.RTLD_NOLOAD).finalizePythonInterpreter()


class Messages(list[str]):
    """What an FMU said: the first messages and the last one, the beginning of each."""

    def append(self, text: str) -> None:
        """Add a message; where there are `_MOST_MESSAGES`, it takes the place of the last one."""
        if len(self) == _MOST_MESSAGES:
            self.pop()
        super().append(text[:_LONGEST_MESSAGE])


class Unpacked(Protocol):
    """What an instance needs to know of its FMU."""

    path: Path
    folder: Path
    token: str
    model_identifier: str
    variables: Mapping[str, Variable]


class FmuInstance(ABC):
    """One instance of an FMU. Variables by our names, values in SI.

    After an `FmuError` only `reset` and `free` are of use.
    """

    C_TYPES: ClassVar[Mapping[str, tuple[str, Any]]]
    """Kind of a variable to the name in the FMI functions and the type in C."""

    PREFIX: ClassVar[str]
    """Beginning of the names of the FMI functions."""

    SLAVE: ClassVar[Any]
    """FMPy's class that loads the library."""

    def __init__(self, fmu: Unpacked) -> None:
        self.file = fmu
        self.messages = Messages()
        self._name = f"{fmu.model_identifier}-{next(_COUNTER)}"
        self._untouched = frozenset(
            name
            for name, variable in fmu.variables.items()
            if variable.kind in FLOATING and variable.conversion.leaves_alone
        )
        self._freed = False
        self._lost = False
        try:
            # FMPy stays in the folder of the library if it cannot be loaded.
            with contextlib.chdir(Path.cwd()):
                self._slave = self.SLAVE(
                    guid=fmu.token,
                    modelIdentifier=fmu.model_identifier,
                    unzipDirectory=str(fmu.folder),
                    instanceName=self._name,
                )
        except Exception as error:
            raise FmuError(f"{fmu.path.name}: {one_line(error)}") from None
        _LOADED.add(self._slave.dll._name)
        self._instantiate()

    @abstractmethod
    def _instantiate(self) -> None:
        """Make the instance in the library; `FmuError` if it refuses."""

    @abstractmethod
    def enter(self, start_time: float) -> None:
        """Enter initialization mode, time beginning at `start_time` [s]."""

    @abstractmethod
    def step(self, time: float, h: float) -> None:
        """Step from the communication point `time` [s] by `h` [s]."""

    def _sizes(self, count: int) -> tuple[int, ...]:
        """Return what a get or set function takes after the values."""
        return ()

    def _failure(self, call: str, error: Exception) -> FmuError:
        said = " ".join(self.messages[-1].split()) if self.messages else "without a message"
        status = getattr(error, "status", None)
        self._lost = self._lost or status == FATAL
        reason = f"status {_MEANING[status]}" if status in _MEANING else one_line(error)
        return FmuError(f"{self.file.path.name}: {call} failed: {said} ({reason})")

    def _do(self, call: str, function: Callable[..., Any], *arguments: object) -> Any:
        try:
            return function(*arguments)
        except fmpy.fmi1.FMICallException as error:
            raise self._failure(call, error) from None

    def start(self, values: Mapping[str, float], start_time: float = 0.0) -> None:
        """Set `values`, begin at `start_time` [s] and go through initialization mode."""
        self.set(values)
        self.enter(start_time)
        self.leave()

    def leave(self) -> None:
        """Leave initialization mode."""
        self._do(f"{self.PREFIX}ExitInitializationMode", self._slave.exitInitializationMode)

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by name; `FmuError` for one that the FMU does not have."""
        self.writer(list(values))(list(values.values()))

    def writer(self, names: Sequence[str]) -> Callable[[Sequence[float]], None]:
        """Return a function that sets these variables at once, given their values in this order."""
        groups = list(self.groups(names))

        def write(values: Sequence[float]) -> None:
            for kind, places, buffer, arguments in groups:
                for index, place in enumerate(places):
                    name, value = names[place], values[place]
                    buffer[index] = value if name in self._untouched else self._theirs(name, value)
                call = f"{self.PREFIX}Set{kind}"
                try:
                    getattr(self._slave, call)(*arguments)
                except fmpy.fmi1.FMICallException as error:
                    what = ", ".join(f"{names[place]} = {values[place]!r}" for place in places)
                    raise self._failure(f"{call}({what})", error) from None

        return write

    def groups(
        self, names: Sequence[str]
    ) -> Iterator[tuple[str, list[int], Any, tuple[object, ...]]]:
        """Yield for each kind of variable: its name in the FMI functions, the places of its names.

        Then the buffer for its values, and all arguments of a get or set function. `FmuError` for a
        name that the FMU does not have.
        """
        missing = [name for name in names if name not in self.file.variables]
        if missing:
            raise FmuError(f"{self.file.path.name}: has no variable {', '.join(missing)}")
        variables = [self.file.variables[name] for name in names]
        kinds = [self.C_TYPES[variable.kind] for variable in variables]
        for kind, c_type in dict.fromkeys(kinds):
            places = [place for place, other in enumerate(kinds) if other[0] == kind]
            count = len(places)
            references = (ctypes.c_uint * count)(*(variables[i].reference for i in places))
            buffer = (c_type * count)()
            arguments = (self._slave.component, references, count, buffer, *self._sizes(count))
            yield kind, places, buffer, arguments

    def _theirs(self, name: str, value: float) -> float:
        variable = self.file.variables[name]
        change = variable.conversion
        number = value if change.leaves_alone else change.from_si(value)
        if variable.kind in FLOATING:
            return number
        c_type = self.C_TYPES[variable.kind][1]
        # A C integer that is too small for the number would silently hold another one.
        if not float(number).is_integer() or c_type(int(number)).value != number:
            label = self.file.path.name
            raise FmuError(f"{label}: {name} = {value!r} is no value of type {variable.kind}")
        return int(number)

    def reader(self, names: Sequence[str]) -> Callable[[], list[float]]:
        """Return a function that reads these variables at once, in this order, in SI.

        `FmuError` for a name that the FMU does not have.
        """
        groups = [
            (kind, getattr(self._slave, f"{self.PREFIX}Get{kind}"), arguments, places, buffer)
            for kind, places, buffer, arguments in self.groups(names)
        ]
        conversions = [self.file.variables[name].conversion for name in names]
        converted = [
            (place, conversion.to_si)
            for place, conversion in enumerate(conversions)
            if not conversion.leaves_alone
        ]

        def read() -> list[float]:
            values = [0.0] * len(names)
            for kind, get, arguments, places, buffer in groups:
                try:
                    get(*arguments)
                except fmpy.fmi1.FMICallException as error:
                    raise self._failure(f"{self.PREFIX}Get{kind}", error) from None
                for place, value in zip(places, buffer, strict=True):
                    values[place] = float(value)
            for place, to_si in converted:
                values[place] = to_si(values[place])
            return values

        return read

    def get_state(self) -> State:
        """Have the FMU keep its state."""
        state: State = self._do("get FMU state", self._slave.getFMUState)
        return state

    def set_state(self, state: State) -> None:
        """Go back to a state, which stays valid."""
        self._do("set FMU state", self._slave.setFMUState, state)

    def free_state(self, state: State) -> None:
        """Let the FMU forget a state."""
        self._do("free FMU state", self._slave.freeFMUState, state)

    def written(self, state: State) -> bytes:
        """Write a state as bytes and free it."""
        written: bytes = self._do("serialize FMU state", self._slave.serializeFMUState, state)
        self.free_state(state)
        return written

    def restore(self, written: bytes) -> None:
        """Go back to a state that this instance, or another of this FMU, wrote as bytes."""
        state = self._do("deserialize FMU state", self._slave.deserializeFMUState, written)
        self.set_state(state)
        self.free_state(state)

    def reset(self) -> None:
        """Back to the state after instantiation."""
        self._do(f"{self.PREFIX}Reset", self._slave.reset)
        self._lost = False

    def free(self) -> None:
        """Free the instance; a second call does nothing.

        After a fatal status it is left as it is: the standard forbids the call, and the wrapper of
        pythonfmu has already freed what it would free.
        """
        if not self._freed and not self._lost:
            self._slave.freeInstance()
        self._freed = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.free()
