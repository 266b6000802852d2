"""An FMU as the tests call it: Python or native, FMI 2.0 or 3.0, in this process or in another one.

Run as a program this is the other process (`Host`), which cannot import the project.
"""

import atexit
import ctypes as c
import fcntl
import importlib
import json
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable, Sequence
from importlib.abc import MetaPathFinder
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

OK, WARNING, DISCARD, ERROR, FATAL = range(5)

_C_TYPES: dict[str, Any] = {
    "Real": c.c_double,
    "Integer": c.c_int,
    "Float64": c.c_double,
    "Int32": c.c_int32,
    "Int64": c.c_int64,
    "UInt64": c.c_uint64,
    "String": c.c_char_p,
}
_LOGGERS = {
    2: c.CFUNCTYPE(None, c.c_void_p, c.c_char_p, c.c_int, c.c_char_p, c.c_char_p),
    3: c.CFUNCTYPE(None, c.c_void_p, c.c_int, c.c_char_p, c.c_char_p),
}


def numbers_as_repr(text: str) -> str:
    """Return a message with its numbers in the form of repr; the native FMU's are of 15 digits."""
    return re.sub(r"(?<= )-?\d[\d.]*(e[+-]\d+)?\b", lambda m: repr(float(m[0])), text)


class Refused(Exception):  # noqa: N818 - an answer, which a test may expect
    """A call that did not return OK or Warning: its name, its status, what was logged since."""

    def __init__(self, call: str, status: int, messages: list[str]) -> None:
        super().__init__(f"{call} returned {status}: {' | '.join(messages)}")
        self.call, self.status, self.messages = call, status, messages


class _Callbacks(c.Structure):
    _fields_ = tuple(
        (name, c.c_void_p) for name in ("logger", "get", "free", "done", "environment")
    )


class Fmu:
    """One FMU, unpacked and loaded, with references and types by name, and all messages."""

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.folder = Path(tempfile.mkdtemp(prefix="fmu-"))
        atexit.register(shutil.rmtree, self.folder, ignore_errors=True)
        with zipfile.ZipFile(path) as archive:
            archive.extractall(self.folder)
        root = ElementTree.parse(self.folder / "modelDescription.xml").getroot()
        self.version = int(root.attrib["fmiVersion"][0])
        self.token = root.attrib["guid" if self.version == 2 else "instantiationToken"].encode()
        element = next(each for each in root if each.get("modelIdentifier"))
        self.identifier = element.attrib["modelIdentifier"]
        platform = "linux64" if self.version == 2 else "x86_64-linux"
        self.binary = self.folder / "binaries" / platform / f"{self.identifier}.so"
        self.is_native = not (self.folder / "resources" / "slavemodule.txt").exists()
        self.references: dict[str, int] = {}
        self.types: dict[str, str] = {}
        # Variables of FMI 3.0 beside the table: time, derivatives, indicators.
        self.beside: set[str] = set()
        for variable in root.iterfind("ModelVariables/*"):
            kind = variable.tag if self.version == 3 else variable[0].tag
            if kind == "Enumeration":
                kind = "Int64" if self.version == 3 else "Integer"
            self.references[variable.attrib["name"]] = int(variable.attrib["valueReference"])
            self.types[variable.attrib["name"]] = kind
            if variable.attrib["causality"] in ("independent", "local"):
                self.beside.add(variable.attrib["name"])
        self.library = c.CDLL(str(self.binary))
        self.messages: list[tuple[int, str, str]] = []
        self.logger = _LOGGERS[self.version](self._hear)
        self._callbacks = _Callbacks(logger=c.cast(self.logger, c.c_void_p).value)

    def _hear(self, _: Any, *said: Any) -> None:
        status, category, text = said[-3:]
        category = (category or b"").decode()
        self.messages.append((status, category, text.decode(errors="backslashreplace")))

    def call(self, name: str, *arguments: Any) -> int:
        passed = (_passed(each, self.version) for each in arguments)
        return int(self.library[f"fmi{self.version}{name}"](*passed))

    def instantiate(
        self,
        name: str = "a",
        token: bytes | None = None,
        kind: int = 1,
        events: bool = False,
        early: bool = False,
    ) -> int | None:
        folder = self.folder / "resources"
        token = self.token if token is None else token
        if self.version == 2:
            function = self.library.fmi2Instantiate
            given = (name.encode(), kind, token, folder.as_uri().encode())
            more: tuple[Any, ...] = (c.byref(self._callbacks), 0, 1)
        else:
            function = self.library.fmi3InstantiateCoSimulation
            given = (name.encode(), token, f"{folder}/".encode(), c.c_bool(False))  # type: ignore[assignment]
            flags = (c.c_bool(True), c.c_bool(events), c.c_bool(early))
            more = (*flags, None, c.c_size_t(0), None, self.logger, None)
        function.restype = c.c_void_p
        address: int | None = function(*given, *more)
        return address

    def instance(self, name: str = "a", events: bool = False, early: bool = False) -> "Instance":
        return Instance(self, name, events, early)

    def started(self, start_time: float = 0.0, **values: float) -> "Instance":
        instance = self.instance()
        instance.start(start_time, **values)
        return instance


class Instance:
    """One instance, called by the names of its variables; a call that fails raises `Refused`."""

    def __init__(
        self, fmu: Fmu, name: str = "a", events: bool = False, early: bool = False
    ) -> None:
        self.fmu = fmu
        address = fmu.instantiate(name, events=events, early=early)
        if address is None:
            raise Refused("Instantiate", ERROR, [text for *_, text in fmu.messages])
        self.address = c.c_void_p(address)
        self.time = 0.0

    def status(self, name: str, *arguments: Any) -> int:
        return self.fmu.call(name, self.address, *arguments)

    def call(self, name: str, *arguments: Any) -> None:
        before = len(self.fmu.messages)
        status = self.status(name, *arguments)
        if status not in (OK, WARNING):
            raise Refused(name, status, [text for *_, text in self.fmu.messages[before:]])

    def start(self, start_time: float = 0.0, **values: float) -> None:
        self.set(**values)
        self.enter(start_time)
        self.call("ExitInitializationMode")

    def enter(self, start_time: float = 0.0) -> None:
        self.time = start_time
        if self.fmu.version == 2:
            self.call("SetupExperiment", 0, 0.0, start_time, 0, 0.0)
            self.call("EnterInitializationMode")
        else:
            self.call("EnterInitializationMode", False, 0.0, start_time, False, 0.0)

    def step(self, h: float, times: int = 1) -> None:
        for _ in range(times):
            shown = [c.byref(c.c_double()) for _ in range(4)]
            more = (1,) if self.fmu.version == 2 else (True, *shown)
            self.call("DoStep", self.time, h, *more)
            self.time += h

    def step_to_event(self, h: float) -> tuple[bool, bool]:
        """Make one step of FMI 3.0; return whether there is an event, and whether it ends early."""
        flags: list[Any] = [c.c_bool() for _ in range(3)]
        time = c.c_double()
        self.call("DoStep", self.time, h, True, *(c.byref(each) for each in (*flags, time)))
        self.time, (event, end, early) = time.value, (flag.value for flag in flags)
        assert not end
        return event, early

    def update(self) -> float | None:
        flags: list[Any] = [c.c_bool() for _ in range(5)]
        time = c.c_double()
        self.call("UpdateDiscreteStates", *(c.byref(each) for each in (*flags, time)))
        assert not any(flag.value for flag in flags[:4])
        return time.value if flags[4] else None

    def handle(self, enter: bool = True) -> float | None:
        if enter:
            self.call("EnterEventMode")
        following = self.update()
        self.call("EnterStepMode")
        return following

    def values(
        self, verb: str, kind: str, references: Sequence[int], values: Sequence[Any]
    ) -> list[Any]:
        boolean = c.c_int if self.fmu.version == 2 else c.c_bool
        listed = (_C_TYPES.get(kind, boolean) * len(values))(*values)
        sizes = (c.c_size_t(len(references)), listed, c.c_size_t(len(values)))
        numbers = (c.c_uint32 * len(references))(*references)
        self.call(f"{verb}{kind}", numbers, *sizes[: self.fmu.version])
        return [bool(each) if kind == "Boolean" else each for each in listed]

    def set(self, **values: float) -> None:
        for name, value in values.items():
            self.values("Set", self.fmu.types[name], [self.fmu.references[name]], [value])

    def get(self, *names: str) -> list[Any]:
        found: dict[str, Any] = {}
        for kind in {self.fmu.types[name] for name in names}:
            alike = [name for name in names if self.fmu.types[name] == kind]
            references = [self.fmu.references[name] for name in alike]
            empty = [None if kind == "String" else 0] * len(alike)
            found |= zip(alike, self.values("Get", kind, references, empty), strict=True)
        return [found[name] for name in names]

    def everything(self) -> dict[str, Any]:
        """Return all variables of the table, by their names."""
        names = sorted(self.fmu.references.keys() - self.fmu.beside)
        return dict(zip(names, self.get(*names), strict=True))

    def reset(self) -> None:
        self.call("Reset")

    def terminate(self) -> None:
        self.call("Terminate")

    def free(self) -> None:
        self.fmu.library[f"fmi{self.fmu.version}FreeInstance"](self.address)

    def _of_state(self, verb: str, suffix: str = "") -> str:
        return f"{verb}FMU{'state' if self.fmu.version == 2 else 'State'}{suffix}"

    def save(self) -> c.c_void_p:
        state = c.c_void_p()
        self.call(self._of_state("Get"), c.byref(state))
        return state

    def restore(self, state: c.c_void_p) -> None:
        self.call(self._of_state("Set"), state)

    def forget(self, state: c.c_void_p) -> None:
        self.call(self._of_state("Free"), c.byref(state))

    def pack(self) -> bytes:
        state = self.save()
        try:
            return self.pack_state(state)
        finally:
            self.forget(state)

    def pack_state(self, state: c.c_void_p) -> bytes:
        size = c.c_size_t()
        self.call(self._of_state("Serialized", "Size"), state, c.byref(size))
        data = (c.c_ubyte * size.value)()
        self.call(self._of_state("Serialize"), state, data, size)
        return bytes(data)

    def unpack(self, data: bytes) -> c.c_void_p:
        state = c.c_void_p()
        verb = "DeSerialize" if self.fmu.version == 2 else "Deserialize"
        # Exactly as long as the content, so that reading beyond it is found.
        given = (c.c_ubyte * len(data)).from_buffer_copy(data)
        self.call(self._of_state(verb), given, c.c_size_t(len(data)), c.byref(state))
        return state

    def resume(self, data: bytes) -> None:
        state = self.unpack(data)
        self.restore(state)
        self.forget(state)


def _passed(argument: Any, version: int) -> Any:
    if isinstance(argument, bool) and version == 3:
        return c.c_bool(argument)
    return c.c_double(argument) if isinstance(argument, float) else argument


_LOADED: dict[str, Fmu] = {}


def loaded(path: str | Path) -> Fmu:
    return _LOADED.setdefault(str(path), _LOADED.get(str(path)) or Fmu(path))


def play(path: str, script: Sequence[Sequence[Any]]) -> list[Any]:
    """Return what each line, a method of `Instance` and its arguments, gives on a new instance.

    Values by name stand last. Or a line is "save", "restore" of what was saved, "rewrite": the
    state as bytes and back. A line that is refused gives {"refused": status, "messages": [...]}.
    """
    instance = loaded(path).instance()
    state: c.c_void_p | None = None
    at = 0.0
    found: list[Any] = []
    for name, *arguments in script:
        values = arguments.pop() if arguments and isinstance(arguments[-1], dict) else {}
        try:
            if name == "save":
                state, at = instance.save(), instance.time
            elif name == "restore":
                assert state is not None
                instance.restore(state)
                instance.time = at
            elif name == "rewrite":
                instance.resume(instance.pack())
            else:
                found.append(getattr(instance, name)(*arguments, **values))
                continue
            found.append(None)
        except Refused as refused:
            found.append({"refused": refused.status, "messages": refused.messages})
    if state is not None:
        instance.status(instance._of_state("Free"), c.byref(state))
    instance.free()
    return found


class DiedError(Exception):
    """The other process ended, or did not answer in time: its exit code and its last words."""

    def __init__(self, code: int | None, errors: str) -> None:
        super().__init__(f"exit code {code}: {errors[-2000:]}")
        self.code, self.errors = code, errors


class Host:
    """A process without the project that calls functions of the tests; started anew if dead."""

    def __init__(self, **environment: str) -> None:
        self.environment = environment
        self.process: subprocess.Popen[bytes] | None = None
        self._errors: Path | None = None

    def call(self, function: Callable[..., Any], *arguments: Any, timeout: float = 120.0) -> Any:
        """Return `function(*arguments)`, computed there; all of it goes through JSON."""
        if self.process is None or self.process.poll() is not None:
            self._start()
        assert self.process is not None
        assert self.process.stdin is not None
        line = json.dumps([function.__module__, function.__name__, arguments], default=str)
        answer = b""
        try:
            self.process.stdin.write(line.encode() + b"\n")
            self.process.stdin.flush()
            ends = time.monotonic() + timeout
            while not answer.endswith(b"\n"):
                ready = select.select([self._answers], [], [], max(0.0, ends - time.monotonic()))[0]
                piece = os.read(self._answers, 1 << 20) if ready else b""
                if not piece:
                    raise BrokenPipeError
                answer += piece
        except BrokenPipeError:
            code = self.end()
            raise DiedError(code, self.errors()) from None
        raised, result = json.loads(answer)
        if raised:
            raise AssertionError(f"in the other process: {raised}")
        return result

    def errors(self) -> str:
        """Return what the process wrote to standard error since it was started or last asked."""
        if self._errors is None:
            return ""
        text = self._errors.read_text(errors="backslashreplace")
        os.truncate(self._errors, 0)
        return text

    def _start(self) -> None:
        handle, name = tempfile.mkstemp(prefix="host-", suffix=".txt")
        # Each write goes to the end, wherever that is after the file was emptied.
        fcntl.fcntl(handle, fcntl.F_SETFL, os.O_APPEND)
        self._errors = Path(name)
        self._answers, theirs = os.pipe()
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        self.process = subprocess.Popen(
            [sys.executable, str(Path(__file__).resolve()), str(theirs)],
            stdin=subprocess.PIPE,
            stderr=handle,
            pass_fds=[theirs],
            env=environment | self.environment,
            start_new_session=True,
        )
        os.close(theirs)
        os.close(handle)

    def end(self) -> int | None:
        """End the process, what it started included, and return its exit code."""
        if self.process is None:
            return None
        if self.process.stdin is not None:
            self.process.stdin.close()
        try:
            code = self.process.wait(10.0)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            code = self.process.wait()
        os.close(self._answers)
        self.process = None
        return code


class Bar(MetaPathFinder):
    """Refuses the project's packages."""

    def find_spec(self, name: str, path: Any, target: Any = None) -> None:
        root = name.partition(".")[0]
        ours = root in ("examples", "fmi", "stickslip") or root.startswith("stickslip_")
        # What an FMU brings is named by its content.
        if ours and not re.match(r"stickslip_fmu_[0-9a-f]{16}", root):
            raise ImportError(f"{name} is barred here")


def serve(answers: int) -> None:
    """Answer calls, one a line of standard input, until it ends."""
    sys.meta_path.insert(0, Bar())
    sys.path[0] = str(Path(__file__).resolve().parents[1])
    for line in sys.stdin:
        module, name, arguments = json.loads(line)
        answer: list[Any] = [None, None]
        try:
            answer[1] = getattr(importlib.import_module(module), name)(*arguments)
        except Exception as error:
            answer[0] = f"{type(error).__name__}: {error}"
        os.write(answers, json.dumps(answer, default=str).encode() + b"\n")


if __name__ == "__main__":
    serve(int(sys.argv[1]))
