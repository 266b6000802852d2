"""The functions of the native FMU's library, called as a C host calls them."""

import ctypes
import re
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fmukit.table import Variable
from stickslip_fmu.spec import TABLE
from stickslip_native.named import native_law, native_laws

OK, WARNING, DISCARD, ERROR = 0, 1, 2, 3

REFERENCE = {row.name: row.number for row in TABLE.rows if row.number < 34}
"""Value references of what all friction laws have."""

_LOGGER = {
    2: ctypes.CFUNCTYPE(
        None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p
    ),
    3: ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p),
}
REAL = {2: "Real", 3: "Float64"}
INTEGER = {2: "Integer", 3: "Int32"}
ENUMERATION = {2: "Integer", 3: "Int64"}
_STATE = {2: "FMUstate", 3: "FMUState"}
_DESERIALIZE = {2: "fmi2DeSerializeFMUstate", 3: "fmi3DeserializeFMUState"}


def type_of(row: Variable, face: int) -> str:
    """Return the type of a variable in the names of an FMI version's calls."""
    if row.kind == "Integer":
        return (ENUMERATION if row.type.items else INTEGER)[face]
    return REAL[face] if row.kind == "Real" else row.kind


class Callbacks(ctypes.Structure):
    """The callbacks of FMI 2.0."""

    _fields_ = tuple(
        (name, ctypes.c_void_p)
        for name in ("logger", "allocate_memory", "free_memory", "step_finished", "environment")
    )


class Library:
    """The library of an FMU that is compiled for this machine.

    Parameters
    ----------
    fmu
        The FMU.
    folder
        For the library.

    Attributes
    ----------
    face
        The major version of FMI.
    identity
        GUID or instantiation token.
    table
        The variables.
    told
        Messages so far: name of the instance ("" in FMI 3.0), status, category, text.
    """

    def __init__(self, fmu: Path, folder: Path) -> None:
        with zipfile.ZipFile(fmu) as archive:
            entry = next(each for each in archive.namelist() if each.endswith(".so"))
            file = Path(archive.extract(entry, folder))
            text = archive.read("modelDescription.xml").decode()
        found = re.search(r'(?:guid|instantiationToken)="([^"]*)"', text)
        assert found is not None
        self.identity = found[1].encode()
        model = re.search(r'modelIdentifier="([^"]*)"', text)
        assert model is not None
        specs = (native_law(each).spec for each in native_laws())
        self.table = next(each.table for each in specs if each.name == model[1])
        self.reals = [row.number for row in self.table.rows if row.kind == "Real"]
        self.face = 3 if 'fmiVersion="3.0"' in text else 2
        self.path = file
        self.calls = ctypes.CDLL(str(file))
        self.told: list[tuple[str, int, str, str]] = []
        self.logger = _LOGGER[self.face](self._hear)
        self.instantiate_ = getattr(
            self.calls, "fmi2Instantiate" if self.face == 2 else "fmi3InstantiateCoSimulation"
        )
        self.instantiate_.restype = ctypes.c_void_p

    def _hear(self, environment: Any, *told: Any) -> None:
        name, status, category, text = told if self.face == 2 else (b"", *told)
        self.told.append((name.decode(), status, category.decode(), text.decode()))

    def call(self, name: str, *arguments: Any) -> int:
        """Call an FMI function, without its prefix `fmi2` or `fmi3`, and return the status."""
        return int(getattr(self.calls, f"fmi{self.face}{name}")(*map(_passed, arguments)))

    def instantiate(
        self,
        name: bytes | None = b"a",
        identity: bytes | None = None,
        kind: int = 1,
        logger: Any = True,
    ) -> ctypes.c_void_p:
        """Return a new instance, which is NULL where it was refused; `logger` None is NULL."""
        log = ctypes.cast(self.logger, ctypes.c_void_p) if logger else None
        identity = self.identity if identity is None else identity
        if self.face == 2:
            callbacks = Callbacks(logger=log.value if log else None)
            made = self.instantiate_(name, kind, identity, None, ctypes.byref(callbacks), 0, 0)
        else:
            false = ctypes.c_bool(False)
            flags = [false] * 4
            made = self.instantiate_(
                name, identity, None, *flags, None, ctypes.c_size_t(0), None, log, None
            )
        return ctypes.c_void_p(made)

    def start(self, instance: ctypes.c_void_p, time: float = 0.0, **values: float) -> int:
        """Set values, initialize, and return the worst status."""
        statuses = [self.set(instance, values)]
        if self.face == 2:
            statuses.append(self.call("SetupExperiment", instance, 0, 0.0, time, 0, 0.0))
            statuses.append(self.call("EnterInitializationMode", instance))
        else:
            given = (False, 0.0, time, False, 0.0)
            statuses.append(self.call("EnterInitializationMode", instance, *given))
        statuses.append(self.call("ExitInitializationMode", instance))
        return max(statuses)

    def step(self, instance: ctypes.c_void_p, time: float, step: float) -> int:
        """Make a step."""
        if self.face == 2:
            return self.call("DoStep", instance, time, step, 1)
        shown = (ctypes.byref(ctypes.c_double()) for _ in range(4))
        return self.call("DoStep", instance, time, step, True, *shown)

    def set(self, instance: ctypes.c_void_p, values: dict[str, float]) -> int:
        """Set values by name, and return the worst status."""
        by_type: dict[str, dict[int, float]] = {} if values else {REAL[self.face]: {}}
        for name, value in values.items():
            row = self.table.by_name[name]
            by_type.setdefault(type_of(row, self.face), {})[row.number] = value
        statuses = [
            self.lists("Set", kind, instance, list(given), list(given.values()))[0]
            for kind, given in by_type.items()
        ]
        return max(statuses, default=OK)

    def get(
        self, instance: ctypes.c_void_p, references: Sequence[int] | None = None
    ) -> tuple[int, list[float]]:
        """Return the status and the values of Reals, by default all."""
        references = self.reals if references is None else references
        return self.lists("Get", REAL[self.face], instance, references, [0.0] * len(references))

    def lists(
        self,
        verb: str,
        kind: str,
        instance: ctypes.c_void_p,
        references: Sequence[int],
        values: Sequence[Any],
    ) -> tuple[int, list[Any]]:
        """Get or set values of a type; return the status and the values."""
        listed = (ctypes.c_uint32 * len(references))(*references)
        given = (_C_TYPES[kind] * len(values))(*values)
        sizes = [ctypes.c_size_t(len(references))]
        after = [] if self.face == 2 else [ctypes.c_size_t(len(values))]
        return self.call(f"{verb}{kind}", instance, listed, *sizes, given, *after), list(given)

    def take(self, instance: ctypes.c_void_p, into: ctypes.c_void_p | None = None) -> Any:
        """Return the status and the state."""
        state = ctypes.c_void_p() if into is None else into
        return self.call(f"Get{_STATE[self.face]}", instance, ctypes.byref(state)), state

    def put(self, instance: ctypes.c_void_p, state: ctypes.c_void_p) -> int:
        """Set a state."""
        return self.call(f"Set{_STATE[self.face]}", instance, state)

    def free(self, instance: ctypes.c_void_p, state: ctypes.c_void_p) -> int:
        """Free a state."""
        return self.call(f"Free{_STATE[self.face]}", instance, ctypes.byref(state))

    def packed(self, instance: ctypes.c_void_p) -> bytes:
        """Return the present state as bytes."""
        _, state = self.take(instance)
        size = ctypes.c_size_t()
        state_name = _STATE[self.face]
        sizing = self.call(f"Serialized{state_name}Size", instance, state, ctypes.byref(size))
        content = (ctypes.c_ubyte * size.value)()
        writing = self.call(f"Serialize{state_name}", instance, state, content, size)
        assert (sizing, writing, self.free(instance, state)) == (OK, OK, OK)
        return bytes(content)

    def unpacked(self, instance: ctypes.c_void_p, content: bytes) -> Any:
        """Return the status and the state that bytes hold."""
        state = ctypes.c_void_p()
        # Exactly as long as the content, so that reading beyond it is found.
        given = (ctypes.c_ubyte * len(content)).from_buffer_copy(content)
        function = getattr(self.calls, _DESERIALIZE[self.face])
        size = ctypes.c_size_t(len(content))
        return int(function(instance, given, size, ctypes.byref(state))), state


_C_TYPES: dict[str, Any] = {
    "Real": ctypes.c_double,
    "Integer": ctypes.c_int,
    "Boolean": ctypes.c_int,
    "String": ctypes.c_char_p,
    "Float64": ctypes.c_double,
    "Int32": ctypes.c_int32,
    "Int64": ctypes.c_int64,
}


def _passed(argument: Any) -> Any:
    """Return an argument in its C type: a float as a double."""
    if isinstance(argument, bool):
        return ctypes.c_bool(argument)
    return ctypes.c_double(argument) if isinstance(argument, float) else argument
