"""An FMU 2.0 or 3.0 as a file, its variables by our names, and its instances; values in SI."""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import itertools
import os
import shutil
import weakref
from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import fmpy
import fmpy.fmi1
import fmpy.fmi2
import fmpy.fmi3
import fmpy.logging

from ..truth.parameters import Parameter
from .description import (
    UNITS,
    Description,
    FmuError,
    NameMap,
    Variable,
    collect,
    new_folder,
    one_line,
    unpack,
)

if TYPE_CHECKING:
    from ..suite.faults import Hook

WARNING, FATAL = 1, 4
"""The highest status of a call that succeeded, and the one after which nothing may be called any
more (FMI 2.0, section 2.1.3)."""

_MEANING = {2: "discarded", 3: "error", 4: "fatal", 5: "pending, and no step may be"}

FLOATING = frozenset({"Real", "Float64", "Float32"})

State = ctypes.c_void_p  # a state that the FMU keeps; to be freed by the instance that gave it

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


class FmuInstance(contextlib.AbstractContextManager["FmuInstance"]):
    """One instance of an FMU. Variables by our names, values in SI.

    After an `FmuError` only `reset` and `free` are of use. ``FMI`` is FMPy's module with the types
    in C, ``SLAVE`` its class that loads the library; names in both begin with ``PREFIX``.
    ``ENUMERATION`` is the kind whose functions an enumeration has.
    """

    FMI: ClassVar[Any]
    SLAVE: ClassVar[Any]
    PREFIX: ClassVar[str]
    ENUMERATION: ClassVar[str]

    def __init__(self, fmu: Unpacked) -> None:
        self.file = fmu
        self.messages = Messages()
        self._name = f"{fmu.model_identifier}-{next(_COUNTER)}"
        self._gone = False
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
        try:
            self._instantiate()
        except Exception as error:
            raise self._failure(f"{self.PREFIX}Instantiate", error) from None

    @abstractmethod
    def _instantiate(self) -> None: ...

    @abstractmethod
    def _enter(self, start_time: float) -> None: ...

    def enter(self, start_time: float) -> None:
        """Enter initialization mode, time beginning at `start_time` [s]."""
        self._do(self._enter, start_time)

    def step(self, time: float, h: float) -> None:
        """Step from the communication point `time` [s] by `h` [s]."""
        try:
            flags = self._slave.doStep(time, h)
        except fmpy.fmi1.FMICallException as error:
            call = f"{self.PREFIX}DoStep(t = {time!r}, h = {h!r})"
            raise self._failure(call, error) from None
        # FMI 2.0 has no flags.
        if flags and any(flags[1:3]):
            did = "ends the simulation" if flags[1] else "returns early"
            call = f"{self.file.path.name}: {self.PREFIX}DoStep(t = {time!r}, h = {h!r})"
            raise FmuError(f"{call} {did} at t = {flags[3]!r}")

    def _failure(self, call: str, error: Exception) -> FmuError:
        said = " ".join(self.messages[-1].split()) if self.messages else "without a message"
        status = getattr(error, "status", None)
        self._gone = self._gone or status == FATAL
        reason = f"status {_MEANING[status]}" if status in _MEANING else one_line(error)
        return FmuError(f"{self.file.path.name}: {call} failed: {said} ({reason})")

    def _do(self, function: Callable[..., Any], *arguments: object) -> Any:
        try:
            return function(*arguments)
        except fmpy.fmi1.FMICallException as error:
            raise self._failure(error.function, error) from None

    def start(self, values: Mapping[str, float], start_time: float = 0.0) -> None:
        """Set `values`, begin at `start_time` [s] and go through initialization mode."""
        self.set(values)
        self.enter(start_time)
        self.leave()

    def leave(self) -> None:
        """Leave initialization mode."""
        self._do(self._slave.exitInitializationMode)

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by name; `FmuError` for one that the FMU does not have."""
        self.writer(list(values))(list(values.values()))

    def writer(self, names: Sequence[str]) -> Callable[[Sequence[float]], None]:
        """Return a function that sets these variables at once, given their values in this order."""
        groups = list(self._groups(names))

        def write(values: Sequence[float]) -> None:
            for kind, places, buffer, arguments in groups:
                for index, place in enumerate(places):
                    buffer[index] = self._theirs(names[place], values[place])
                call = f"{self.PREFIX}Set{kind}"
                try:
                    getattr(self._slave, call)(*arguments)
                except fmpy.fmi1.FMICallException as error:
                    what = ", ".join(f"{names[place]} = {values[place]!r}" for place in places)
                    raise self._failure(f"{call}({what})", error) from None

        return write

    def _groups(
        self, names: Sequence[str]
    ) -> Iterator[tuple[str, list[int], Any, tuple[object, ...]]]:
        """Yield for each kind of variable its name in the FMI functions, the places of its names.

        Then the buffer for its values, and all arguments of a get or set function.
        """
        missing = [name for name in names if name not in self.file.variables]
        if missing:
            raise FmuError(f"{self.file.path.name}: has no variable {', '.join(missing)}")
        variables = [self.file.variables[name] for name in names]
        kinds = [self._kind(variable) for variable in variables]
        for kind, c_type in dict.fromkeys(kinds):
            places = [place for place, other in enumerate(kinds) if other[0] == kind]
            count = len(places)
            references = (ctypes.c_uint * count)(*(variables[i].reference for i in places))
            buffer = (c_type * count)()
            sizes = (count,) if self.PREFIX == "fmi3" else ()
            arguments = (self._slave.component, references, count, buffer, *sizes)
            yield kind, places, buffer, arguments

    def _kind(self, variable: Variable) -> tuple[str, Any]:
        kind = self.ENUMERATION if variable.kind == "Enumeration" else variable.kind
        return kind, getattr(self.FMI, f"{self.PREFIX}{kind}")

    def _theirs(self, name: str, value: float) -> float:
        variable = self.file.variables[name]
        number = variable.conversion.from_si(value)
        if variable.kind in FLOATING:
            return number
        _, c_type = self._kind(variable)
        # A C integer that is too small for the number would silently hold another one.
        if not float(number).is_integer() or c_type(int(number)).value != number:
            label = self.file.path.name
            raise FmuError(f"{label}: {name} = {value!r} is no value of type {variable.kind}")
        return int(number)

    def reader(self, names: Sequence[str]) -> Callable[[], list[float]]:
        """Return a function that reads these variables at once, in this order, in SI."""
        groups = [
            (getattr(self._slave, f"{self.PREFIX}Get{kind}"), *group)
            for kind, *group in self._groups(names)
        ]
        converted = [
            (place, conversion.to_si)
            for place, name in enumerate(names)
            if not (conversion := self.file.variables[name].conversion).leaves_alone
        ]

        def read() -> list[float]:
            values = [0.0] * len(names)
            for get, places, buffer, arguments in groups:
                self._do(get, *arguments)
                for place, value in zip(places, buffer, strict=True):
                    values[place] = float(value)
            for place, to_si in converted:
                values[place] = to_si(values[place])
            return values

        return read

    def get_state(self) -> State:
        """Have the FMU keep its state."""
        state: State = self._do(self._slave.getFMUState)
        return state

    def set_state(self, state: State) -> None:
        """Go back to a state, which stays valid."""
        self._do(self._slave.setFMUState, state)

    def free_state(self, state: State) -> None:
        """Let the FMU forget a state."""
        self._do(self._slave.freeFMUState, state)

    def written(self, state: State) -> bytes:
        """Write a state as bytes and free it."""
        written: bytes = self._do(self._slave.serializeFMUState, state)
        self.free_state(state)
        return written

    def restore(self, written: bytes) -> None:
        """Go back to a state that this instance, or another of this FMU, wrote as bytes."""
        state = self._do(self._slave.deserializeFMUState, written)
        self.set_state(state)
        self.free_state(state)

    def reset(self) -> None:
        """Back to the state after instantiation."""
        self._do(self._slave.reset)
        self._gone = False

    def free(self) -> None:
        """Free the instance once; after a fatal status not at all, as the standard forbids it."""
        if not self._gone:
            self._slave.freeInstance()
        self._gone = True

    def __exit__(self, *_: object) -> None:
        self.free()


_SINKS: weakref.WeakValueDictionary[str, Messages] = weakref.WeakValueDictionary()


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
_CALLBACKS.logger = _log


class Fmi2Instance(FmuInstance):
    """One instance of an FMU 2.0."""

    FMI, SLAVE, PREFIX = fmpy.fmi2, fmpy.fmi2.FMU2Slave, "fmi2"
    ENUMERATION = "Integer"

    def _instantiate(self) -> None:
        _SINKS[self._name] = self.messages
        # FMPy's proxy, which fills in the printf arguments of a message, has one logger for the
        # whole process, the last that was announced. So ours lives as long as the process, sorts by
        # the instance's name, hands on what is not ours, and is announced anew each time.
        fmpy.logging.addLoggerProxy(ctypes.byref(_CALLBACKS))
        self._slave.instantiate(callbacks=_CALLBACKS, loggingOn=True)

    def _enter(self, start_time: float) -> None:
        self._slave.setupExperiment(None, start_time)
        self._slave.enterInitializationMode()


class Fmi3Instance(FmuInstance):
    """One instance of an FMU 3.0, without event mode and without early return.

    A step that ends the simulation or stops before its end is an `FmuError`: neither was allowed to
    it. That an event would need handling is no error without event mode.
    """

    FMI, SLAVE, PREFIX = fmpy.fmi3, fmpy.fmi3.FMU3Slave, "fmi3"
    ENUMERATION = "Int64"

    def _instantiate(self) -> None:
        messages = self.messages

        def log(_: Any, status: int, __: bytes, text: bytes) -> None:
            if status >= WARNING and text:
                messages.append(text.decode("utf-8", errors="replace"))

        self._slave.instantiate(loggingOn=True, logMessage=log)

    def _enter(self, start_time: float) -> None:
        self._slave.enterInitializationMode(None, start_time)


FACES: Mapping[str, type[FmuInstance]] = {"2.0": Fmi2Instance, "3.0": Fmi3Instance}
"""The class of instances by the version of FMI."""


class Hooked(FmuInstance):
    """An instance whose reads pass `get`; a hook may keep attributes of its own on it."""

    @cached_property
    def _reader_of(self) -> Callable[[tuple[str, ...]], Callable[[], list[float]]]:
        return cache(super().reader)

    def read(self, names: Sequence[str]) -> dict[str, float]:
        """Read variables from the FMU itself, past the planted `get`."""
        return dict(zip(names, self._reader_of(tuple(names))(), strict=True))

    def get(self, names: Sequence[str]) -> dict[str, float]:
        """Read variables as the suite sees them."""
        return self.read(names)

    def reader(self, names: Sequence[str]) -> Callable[[], list[float]]:
        """Return a function that reads these variables at once, in this order, in SI."""
        # It refuses a name that the FMU does not have.
        self._reader_of(tuple(names))

        def read() -> list[float]:
            values = self.get(names)
            return [values[name] for name in names]

        return read


def hooked(face: type[FmuInstance], hooks: Sequence[Hook]) -> type[FmuInstance]:
    """Return the class of the instances that these hooks act on, one laid over the other."""
    if not hooks:
        return face
    made = type("Hooked", (Hooked, face), {})
    for name, code in hooks:
        space: dict[str, Any] = {"original": getattr(made, name)}
        exec(code, space)
        setattr(made, name, space[name])
    return made


REQUIRED: tuple[str, ...] = ("m", "k", "mu_s", "mu_k", "v", "x")
"""What an FMU must have to be judged as a stick-slip block at all."""


class FmuFile(Description):
    """An FMU, extracted to ``folder`` until `close` or the end of this object, and its description.

    ``variables`` are ours, by our names; ``extra_outputs`` are none of ours, by the FMU's names.
    `hooks` are faults planted between the master and its instances. With `own_starts` a case leaves
    parameters that it does not name at the FMU's start values; None for where the FMU promises
    them: its description names the exact contract, and no names differ.

    `FmuError` if it is none of this `KIND` by FMI 2.0 or 3.0 on this platform, if it has too much
    to unpack, or a variable of ours that cannot be used, see `collect`.
    """

    KIND: ClassVar[str] = "CoSimulation"
    FACES: ClassVar[Mapping[str, type[FmuInstance]]] = FACES

    def __init__(
        self,
        path: Path,
        names: NameMap | None = None,
        hooks: Sequence[Hook] = (),
        *,
        own_starts: bool | None = None,
    ) -> None:
        super().__init__(path, self.KIND)
        self.path = path
        self.names = NameMap() if names is None else names
        promised = self.stated.exact and not self.names.targets
        self.own_starts = promised if own_starts is None else own_starts
        platforms = fmpy.supported_platforms(str(path))
        if fmpy.platform not in platforms:
            has = ", ".join(each for each in platforms if each != "c-code") or "no binary"
            raise FmuError(f"{path}: is not for this platform, {fmpy.platform}; it has {has}")
        self._face = hooked(self.FACES[self.fmi_version], hooks)
        self.variables: Mapping[str, Variable] = collect(path.name, self, self.names, UNITS)

        known = {variable.their_name for variable in self.variables.values()}
        self.extra_outputs = tuple(
            name
            for name, each in self.declared.items()
            if each.causality == "output" and name not in known
        )
        self.folder = new_folder()
        self.close = weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        unpack(path, self.folder)

    def has(self, name: str) -> bool:
        """Whether the FMU has this variable of ours."""
        return name in self.variables

    def look_for(self, parameters: Iterable[Parameter], *, optional: bool = False) -> None:
        """Add what the FMU has of the parameters of a friction law to its variables.

        Where they are `optional`, one that is of another kind or unit is another quantity with the
        same name, and is left alone; what the names file maps must be right.
        """
        for each in parameters:
            if self.has(each.name):
                continue
            try:
                own = collect(self.path.name, self, self.names, {each.name: each.unit})
            except FmuError:
                if not optional or each.name in self.names.targets:
                    raise
            else:
                self.variables = {**self.variables, **own}

    def __reduce__(self) -> tuple[type[FmuFile], tuple[Path, NameMap]]:
        """Pickle the path and the names: whoever reads it extracts the FMU anew."""
        return type(self), (self.path.absolute(), self.names)

    def instantiate(self) -> FmuInstance:
        """Make a new instance; `FmuError` if the FMU refuses."""
        return self._face(self)


def available(fmu: FmuFile, names: Iterable[str]) -> list[str]:
    """Return those of the names that the FMU has, in the same order."""
    return [name for name in names if fmu.has(name)]


def require(fmu: FmuFile, without: Iterable[str] = ()) -> None:
    """Raise `FmuError` with what the FMU lacks of `REQUIRED`, less ``without``, and what to do."""
    lacking = [name for name in REQUIRED if not (fmu.has(name) or name in without)]
    if lacking:
        them = "them" if len(lacking) > 1 else "it"
        raise FmuError(
            f"{fmu.path}: has no variable {', '.join(lacking)}; map {them} with --names "
            f"(`stickslip names` begins the file); {fmu.listing(lacking)}"
        )
