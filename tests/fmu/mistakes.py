"""Wrong calls of a master on the Python FMU of FMI 2.0."""

import ctypes as c
import json
import os
import resource
import signal
import traceback
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from fmpy.fmi2 import (
    addLoggerProxy,
    defaultCallbacks,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

from tests.driver import DISCARD, ERROR, FATAL, OK, Fmu, Instance, loaded

DIES = None
"""What comes of a mistake that the process does not survive."""

_HUGE = c.c_size_t(2**62)
_ONE, _NONE = c.c_size_t(1), c.c_size_t(0)
_FIRST, _DOUBLE, _BYTES = (c.c_uint * 1)(0), (c.c_double * 1)(), (c.c_ubyte * 9)()
_WRONG = bytes(range(256)) * 100
_KINDS = ("Real", "Integer", "Boolean", "String")


def _blank(resources: str) -> str:
    folder = Path(resources.removeprefix("file://"))
    link = folder.with_name("with a blank")
    link.symlink_to(folder)
    return link.as_uri()


def _of_scheme(scheme: str) -> Callable[[str], str]:
    return lambda uri: uri.replace("file://", scheme)


def _without_logger(logger: Any = None) -> fmi2CallbackFunctions:
    callbacks = fmi2CallbackFunctions()
    callbacks.logger = logger or fmi2CallbackLoggerTYPE()
    callbacks.allocateMemory = defaultCallbacks.allocateMemory
    callbacks.freeMemory = defaultCallbacks.freeMemory
    return callbacks


def _printing() -> fmi2CallbackFunctions:
    callbacks = _without_logger(fmi2CallbackLoggerTYPE(lambda *_: None))
    addLoggerProxy(c.byref(callbacks))
    return callbacks


_PRINTING = {"callbacks": _printing, "logging": 1}
"""C's printf reads each message, as simulators written in C have it."""

SURVIVED_AT_THE_START: dict[str, dict[str, Any]] = {
    "The GUID is wrong": {"guid": b"x"},
    "The GUID is NULL": {"guid": None},
    "A model-exchange instance is requested": {"kind": 0},
    "The instance name is empty": {"name": b""},
    "The instance name has a million characters": {"name": b"x" * 10**6},
    "The instance name is not ASCII, but UTF-8": {"name": "Größe 摩擦 🧱".encode()},
    "The callbacks are NULL, logging off": {"callbacks": None},
    "The folder of resources is a path, not a URI": {"resources": _of_scheme("")},
    "The folder of resources ends in a slash": {"resources": lambda uri: uri + "/"},
    "The URI of the folder has `%20` for a blank": {"resources": _blank},
    "The instance name holds `%s%n`, logging on": {"name": b"%s%n%d%%", **_PRINTING},
}
"""By the master's mistake: arguments of fmi2Instantiate; the run after it returns OK."""
ENDING_AT_THE_START: dict[str, dict[str, Any]] = {
    "The instance name is NULL": {"name": None},
    "The instance name is not UTF-8": {"name": b"\xff\xfe"},
    "The folder of resources is NULL": {"resources": lambda _: None},
    "The folder of resources does not exist": {"resources": lambda _: "file:///nowhere/resources"},
    "The callbacks are NULL, logging on": {"callbacks": None, "logging": 1},
    "The folder of resources is `file:/...`, with one slash": {"resources": _of_scheme("file:")},
    "The folder of resources is `file://localhost/...`": {
        "resources": _of_scheme("file://localhost")
    },
    "The URI of the folder has an escape other than `%20`, as for `ü` or `#`": {
        "resources": lambda uri: uri[:-1] + "%73"
    },
    "Logging is on and the logger is NULL": {**_PRINTING, "callbacks": _without_logger},
}
"""As above; the process does not survive the run."""


def _instantiated(fmu: Fmu, changed: dict[str, Any]) -> int:
    resources = (fmu.folder / "resources").as_uri()
    callbacks = fmu._callbacks
    if "callbacks" in changed:
        callbacks = changed["callbacks"] and changed["callbacks"]()
    given = {"name": b"a", "kind": 1, "guid": fmu.token, "logging": 0, **changed}
    uri = changed.get("resources", str)(resources)
    arguments = (*(given[name] for name in ("name", "kind", "guid")), uri and uri.encode())
    function = fmu.library.fmi2Instantiate
    function.restype = c.c_void_p
    address = function(*arguments, callbacks and c.byref(callbacks), 0, given["logging"])
    instance = Instance.__new__(Instance)
    instance.fmu, instance.address = fmu, c.c_void_p(address)
    return _revived(instance)


def _revived(instance: Instance) -> int:
    """Return the highest status of calls that bring an instance back from whatever was done."""
    statuses = []
    for _ in range(3):
        # Fails now and then, without a reset before.
        instance.status("DoStep", 0.0, 0.1, 1)
        statuses.append(instance.status("Reset"))
        statuses.append(instance.status("EnterInitializationMode"))
        statuses.append(instance.status("ExitInitializationMode"))
        statuses.append(instance.status("DoStep", 0.0, 0.1, 1))
    instance.free()
    return max(statuses)


def _lists(i: Instance) -> list[int]:
    names = [f"{verb}{kind}" for verb in ("Get", "Set") for kind in _KINDS]
    return [max(i.status(name, None, _NONE, None) for name in names)]


def _statuses(i: Instance) -> list[int]:
    return [i.status(f"Get{kind}Status", 99, None) for kind in ("", *_KINDS)]


def _unsupported(i: Instance) -> list[int]:
    return [
        i.status("CancelStep"),
        i.status("GetDirectionalDerivative", None, _NONE, None, _NONE, None, None),
        i.status("SetRealInputDerivatives", None, _NONE, None, None),
        i.status("GetRealOutputDerivatives", None, _NONE, None, None),
        i.status("DoStep", 0.0, 0.1, 1),
    ]


def _text(i: Instance, text: bytes | None) -> list[int]:
    return [i.status("SetString", _FIRST, _ONE, (c.c_char_p * 1)(text))]


def _category(i: Instance, text: bytes | None, count: c.c_size_t = _ONE) -> list[int]:
    return [i.status("SetDebugLogging", 1, count, (c.c_char_p * 1)(text))]


def _got(i: Instance, references: Any, count: c.c_size_t, values: Any) -> list[int]:
    return [i.status("GetReal", references, count, values)]


def _freed(i: Instance, state: Any) -> list[int]:
    return [i.status("FreeFMUstate", state)]


def _failing(i: Instance) -> list[int]:
    return sorted({i.status("DoStep", 0.0, -1.0, 1) for _ in range(1000)})


def _freed_without_a_call(i: Instance) -> list[int]:
    for _ in range(100):
        i.fmu.instance().free()
    return []


def _of_one_that_is_gone(i: Instance) -> list[int]:
    other = i.fmu.started()
    state = other.save()
    other.free()
    return [i.status("SetFMUstate", state), i.status("FreeFMUstate", c.byref(state))]


def _freed_twice(i: Instance) -> list[int]:
    states = [i.save() for _ in range(20)]
    seen = [i.status("FreeFMUstate", c.byref(state)) for state in states * 2]
    states = [i.save() for _ in range(300)]
    seen += [i.status("SetFMUstate", state) for state in states]
    seen += [i.status("FreeFMUstate", c.byref(state)) for state in states]
    return [max(seen)]


def _set_after_free(i: Instance) -> list[int]:
    state = i.save()
    i.forget(state)
    return [i.status("SetFMUstate", state)]


def _null_of_a_failed_get(i: Instance) -> list[int]:
    state, size = c.c_void_p(), c.c_size_t()
    i.status("DoStep", 0.0, -1.0, 1)
    seen = set()
    for _ in range(50):
        seen.add(i.status("GetFMUstate", c.byref(state)))
        seen.add(i.status("SetFMUstate", state))
        seen.add(i.status("SerializedFMUstateSize", state, c.byref(size)))
        seen.add(i.status("SerializeFMUstate", state, _BYTES, c.c_size_t(9)))
        i.forget(state)
    return sorted(seen)


def _cut(i: Instance) -> list[int]:
    return [*_written(i, _BYTES, 9), *_read(i, bytes(_BYTES))]


def _read(i: Instance, data: bytes) -> list[int]:
    return [i.status("SetFMUstate", i.unpack(data))]


def _written(i: Instance, data: Any, size: int) -> list[int]:
    return [i.status("SerializeFMUstate", i.save(), data, c.c_size_t(size))]


def _failed_and_freed(i: Instance) -> list[int]:
    other = i.fmu.started()
    seen = [other.status("DoStep", 0.0, -1.0, 1)]
    other.free()
    return seen


def _used_after_free(i: Instance, call: str, *arguments: Any) -> list[int]:
    i.free()
    return [i.status(call, *arguments)]


Calls = Callable[[Instance], list[int]]
SURVIVED: dict[str, tuple[Calls, list[int]]] = {
    "NULL is freed": (lambda i: [i.fmu.library.fmi2FreeInstance(None) and 0], [0]),
    "No value is got or set, with NULL lists": (_lists, [OK]),
    "An unknown log category is switched on": (lambda i: _category(i, b"nonsense"), [OK]),
    "A status of an unknown kind is requested": (_statuses, [ERROR, *[DISCARD] * 4]),
    "A step is cancelled, or derivatives are got or set, which the FMU does not offer": (
        _unsupported,
        [*[ERROR] * 4, OK],
    ),
    "A state that is NULL is freed": (lambda i: _freed(i, c.byref(c.c_void_p())), [OK]),
    "A thousand failures in a row": (_failing, [FATAL]),
    "An instance is freed after a failure": (_failed_and_freed, [FATAL]),
    "An instance is freed before any other call, logging on": (_freed_without_a_call, []),
    "A NULL string is set": (lambda i: _text(i, None), [FATAL]),
    "A string is set that is not UTF-8": (lambda i: _text(i, b"\xff"), [FATAL]),
    "A state is set on another instance, and its own instance is freed": (
        _of_one_that_is_gone,
        [OK, OK],
    ),
    "A state is freed twice": (_freed_twice, [OK]),
    "A freed state is set": (_set_after_free, [FATAL]),
    "A state is set and serialized that a failed get left NULL": (_null_of_a_failed_get, [FATAL]),
    "A buffer is smaller than the serialized state": (_cut, [OK, FATAL]),
    "A state is deserialized from no bytes": (lambda i: _read(i, b""), [FATAL]),
    "A state is deserialized from wrong bytes": (lambda i: _read(i, _WRONG), [FATAL]),
}
"""By the master's mistake: the calls on an instance in the run, and their statuses."""
ENDING: dict[str, Calls] = {
    "An instance is freed twice": lambda i: _used_after_free(i, "FreeInstance"),
    "A call has a NULL instance": lambda i: [i.fmu.call("DoStep", None, 0.0, 0.1, 1)],
    "A call has a freed instance": lambda i: _used_after_free(i, "DoStep", 0.0, 0.1, 1),
    "A value is got with a NULL list of references": lambda i: _got(i, None, _ONE, _DOUBLE),
    "A value is got into a NULL list": lambda i: _got(i, _FIRST, _ONE, None),
    "More values are got than memory can hold": lambda i: _got(i, _FIRST, _HUGE, _DOUBLE),
    "A NULL log category is switched on": lambda i: _category(i, None),
    "More log categories are switched on than memory can hold": (
        lambda i: _category(i, b"a", _HUGE)
    ),
    "The last successful time is requested into NULL": lambda i: [
        i.status("GetRealStatus", 2, None)
    ],
    "The pointer to a state is NULL": lambda i: _freed(i, None),
    "A NULL state is set, and no get failed before": lambda i: [i.status("SetFMUstate", None)],
    "A NULL state is serialized, and no get failed before": (
        lambda i: [i.status("SerializedFMUstateSize", None, c.byref(c.c_size_t()))]
    ),
    "The state is a number, not a pointer": lambda i: [i.status("SetFMUstate", c.c_void_p(0x1234))],
    "A buffer is far larger than the serialized state": (
        lambda i: _written(i, (c.c_ubyte * 2**28)(), 2**28)
    ),
    "The buffer is NULL": lambda i: _written(i, None, 10),
    "A state is deserialized from more bytes than memory can hold": (
        lambda i: [i.status("DeSerializeFMUstate", _BYTES, _HUGE, c.byref(c.c_void_p()))]
    ),
}
"""By the master's mistake: the calls that the process does not survive."""


def tried(path: str) -> dict[str, Any]:
    """Return by mistake the statuses, None where the process dies of it, or the traceback."""
    fmu = loaded(path)
    found: dict[str, Any] = {}
    for title, changed in (SURVIVED_AT_THE_START | ENDING_AT_THE_START).items():
        found[title] = _apart(fmu, partial(_instantiated, fmu, changed))
    for title, calls in (ENDING | {title: calls for title, (calls, _) in SURVIVED.items()}).items():
        found[title] = _apart(fmu, partial(_mistaken, fmu, calls))
    return found


def _mistaken(fmu: Fmu, calls: Callable[[Instance], list[int]]) -> list[int]:
    instance = fmu.started()
    statuses = calls(instance)
    assert _revived(instance) == OK
    return statuses


def _apart(fmu: Fmu, mistake: Callable[[], Any]) -> Any:
    """Return what comes of a mistake in a copy of this process, which then must run on."""
    ours, theirs = os.pipe()
    process = os.fork()
    if process == 0:
        # It must not go on as the process it is a copy of, whatever happens.
        try:
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            signal.alarm(60)
            found = mistake()
            for _ in range(5):
                assert _revived(fmu.started()) == OK
        except BaseException:
            found = traceback.format_exc()
        finally:
            os.write(theirs, json.dumps(found).encode())
            os._exit(0)
    os.close(theirs)
    with os.fdopen(ours, "rb") as stream:
        said = stream.read()
    _, status = os.waitpid(process, 0)
    died = os.WIFSIGNALED(status) and os.WTERMSIG(status)
    if died in (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS):
        return DIES
    return signal.Signals(died).name if died else json.loads(said)
