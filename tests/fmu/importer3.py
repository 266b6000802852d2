"""Both faces as an importer meets them: run as a program that cannot import the project.

Called with the name of one of the functions below and the paths of FMUs, of FMI 2.0 or 3.0; reads
an argument as JSON and prints what the function returns as JSON.
"""

import atexit
import ctypes
import json
import runpy
import shutil
import sys
from pathlib import Path
from typing import Any

runpy.run_path(str(Path(__file__).resolve().parents[1] / "barred.py"), run_name="__main__")

import fmpy  # noqa: E402 - the bar comes first
from fmpy.fmi1 import FMICallException  # noqa: E402
from fmpy.fmi2 import FMU2Slave  # noqa: E402
from fmpy.fmi3 import FMU3Slave, fmi3FMUState  # noqa: E402

_MANY = 200_000


class Instance:
    """One instance, called by names that are the same for both versions."""

    def __init__(self, fmu: str, name: str = "a") -> None:
        self.description = fmpy.read_model_description(fmu, validate=True)
        self.modern = self.description.fmiVersion == "3.0"
        self.references = {
            each.name: each.valueReference for each in self.description.modelVariables
        }
        self.folder = str(_extracted(fmu))
        slave = FMU3Slave if self.modern else FMU2Slave
        self.slave = slave(
            guid=self.description.instantiationToken if self.modern else self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier="StickSlip",
            instanceName=name,
        )
        self.told: list[tuple[int, str, str]] = []
        if self.modern:
            self.slave.instantiate(logMessage=self._hear)
        else:
            self.slave.instantiate()
        self.time = 0.0

    def _hear(self, environment: Any, status: int, category: bytes, message: bytes) -> None:
        self.told.append((status, category.decode(), message.decode()))

    def start(self, values: dict[str, float], start_time: float = 0.0) -> None:
        """Set values and go through initialization."""
        for name, value in values.items():
            self.set(name, value)
        if self.modern:
            self.slave.enterInitializationMode(startTime=start_time)
        else:
            self.slave.setupExperiment(startTime=start_time)
            self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.time = start_time

    def step(self, h: float) -> None:
        """Make one step."""
        self.slave.doStep(self.time, h)
        self.time += h

    def set(self, name: str, value: float) -> None:
        """Set a parameter or an input."""
        call = self.slave.setFloat64 if self.modern else self.slave.setReal
        call([self.references[name]], [value])

    def get(self, *names: str) -> list[Any]:
        """Return variables of one type."""
        kind = next(each.type for each in self.description.modelVariables if each.name == names[0])
        suffix = "Int64" if kind == "Enumeration" else kind
        values = getattr(self.slave, f"get{suffix}")([self.references[name] for name in names])
        return [bool(value) if kind == "Boolean" else value for value in values]

    def everything(self) -> list[Any]:
        """Return every variable of the interface but the time, in the order of their names."""
        shown: dict[str, Any] = {}
        for kind in {each.type for each in self.description.modelVariables}:
            names = [
                each.name
                for each in self.description.modelVariables
                if each.type == kind and each.name != "time"
            ]
            shown |= zip(names, self.get(*names), strict=True)
        return [shown[name] for name in sorted(shown)]

    def take(self) -> Any:
        """Return the state."""
        return self.slave.getFMUState() if self.modern else self.slave.getFMUstate()

    def put(self, state: Any) -> None:
        """Set a state."""
        (self.slave.setFMUState if self.modern else self.slave.setFMUstate)(state)

    def free(self, state: Any) -> None:
        """Free a state."""
        (self.slave.freeFMUState if self.modern else self.slave.freeFMUstate)(state)

    def packed(self) -> bytes:
        """Return the state as bytes."""
        state = self.take()
        pack = self.slave.serializeFMUState if self.modern else self.slave.serializeFMUstate
        data = bytes(pack(state))
        self.free(state)
        return data

    def unpacked(self, data: bytes) -> Any:
        """Return the state that bytes hold."""
        if self.modern:
            return self.slave.deserializeFMUState(data)
        return self.slave.deSerializeFMUstate(data)


_FOLDERS: dict[str, Path] = {}


def _extracted(fmu: str) -> Path:
    if fmu not in _FOLDERS:
        _FOLDERS[fmu] = Path(fmpy.extract(fmu))
        atexit.register(shutil.rmtree, _FOLDERS[fmu], ignore_errors=True)
    return _FOLDERS[fmu]


def fails(call: Any, *arguments: Any) -> bool:
    """Whether a call fails."""
    try:
        call(*arguments)
    except FMICallException:
        return True
    return False


def play(instance: Instance, script: list[list[Any]]) -> list[Any]:
    """Return what an instance shows after each line of a script."""
    shown: list[Any] = []
    state, at = None, 0.0
    for action, *arguments in script:
        failed = False
        if action == "start":
            instance.start(*arguments)
        elif action in ("step", "set"):
            failed = fails(getattr(instance, action), *arguments)
        elif action == "reset":
            instance.slave.reset()
        elif action == "take":
            state, at = instance.take(), instance.time
        elif action == "back":
            instance.put(state)
            instance.time = at
        elif action == "write":
            instance.put(instance.unpacked(instance.packed()))
        if failed:
            shown.append("failed")
            assert fails(instance.everything)
            assert fails(instance.step, 0.1)
        else:
            shown.append(instance.everything())
    return shown


def played(fmus: list[str], scripts: list[list[list[Any]]]) -> Any:
    """Play every script on a new instance of each FMU; return what each FMU showed."""
    shown: list[list[Any]] = [[] for _ in fmus]
    for script in scripts:
        for fmu, of_fmu in zip(fmus, shown, strict=True):
            instance = Instance(fmu)
            of_fmu.append(play(instance, script))
            instance.slave.freeInstance()
    return shown


def packed(fmus: list[str], values: dict[str, float]) -> Any:
    """Return a state in mid-slip as bytes, and what the instance shows in the steps after it."""
    instance = Instance(fmus[0])
    instance.start(values)
    while instance.get("mode") != [1]:
        instance.step(0.0111)
    data = instance.packed().decode()
    return data, _steps(instance, instance.time)


def resumed(fmus: list[str], argument: tuple[str, float]) -> Any:
    """Return what a new instance shows in the steps after it was given a state as bytes."""
    instance = Instance(fmus[0])
    data, at = argument
    instance.put(instance.unpacked(data.encode()))
    return _steps(instance, at)


def _steps(instance: Instance, at: float) -> list[Any]:
    instance.time = at
    shown: list[Any] = [at]
    for _ in range(30):
        instance.step(0.02)
        shown.append(instance.everything())
    return shown


def failures(fmus: list[str], rounds: int) -> Any:
    """Fail in every way, twice in a row, resetting between; return how often and what was told."""
    seen = 0
    told: list[Any] = []
    for round_ in range(rounds):
        instance = Instance(fmus[0], f"n{round_} %s %n é")
        for call, arguments in (
            (instance.set, ("k", -1.0)),
            (instance.set, ("v", float("nan"))),
            (instance.set, ("load", -1e3)),
            (instance.set, ("m", 2.0)),
            (instance.set, ("x", 1.0)),
            (instance.set, ("time", 1.0)),
            (instance.slave.getFloat64, ([4_000_000],)),
            (instance.slave.getFloat64, ([instance.references["mode"]],)),
            (instance.slave.getInt32, ([instance.references["mode"]],)),
            (instance.slave.getUInt64, ([0],)),
            (instance.slave.getString, ([0],)),
            (instance.slave.setInt64, ([instance.references["mode"]], [1])),
            (instance.slave.setUInt64, ([0], [1])),
            (instance.slave.setInt32, ([instance.references["n_slips"]], [1])),
            (instance.slave.setBoolean, ([instance.references["sticking"]], [True])),
            (instance.slave.setFloat64, ([0, 1], [1.0])),
            (instance.slave.setString, ([0], ["%s"])),
            (instance.slave.exitInitializationMode, ()),
            (instance.slave.enterInitializationMode, ()),
            (instance.put, (instance.unpacked(b"no state"),)),
            (instance.step, (-1.0,)),
            (instance.step, (float("nan"),)),
        ):
            instance.slave.reset()
            instance.start({})
            seen += fails(call, *arguments) and fails(call, *arguments)
            # After a failure every call fails but reset and free.
            assert fails(instance.step, 0.1)
            assert fails(instance.everything)
            assert fails(instance.take)
            assert fails(instance.slave.terminate)
        told = told or instance.told
        instance.slave.reset()
        instance.start({})
        instance.step(0.1)
        assert instance.get("x_pull") == [0.1 * 0.02]
        instance.slave.freeInstance()
    return seen, told


def refused_step(fmus: list[str], argument: None) -> Any:
    """Return status, what the step wrote for the caller, and what was told, of a refused step."""
    instance = Instance(fmus[0])
    instance.start({})
    flags = [ctypes.c_bool(True) for _ in range(3)]
    reached = ctypes.c_double(-7.0)
    found = []
    for h in (0.1, -1.0):
        status = instance.slave.dll.fmi3DoStep(
            ctypes.c_void_p(instance.slave.component),
            ctypes.c_double(0.1),
            ctypes.c_double(h),
            True,
            *map(ctypes.byref, flags),
            ctypes.byref(reached),
        )
        found.append([status, flags[1].value, reached.value])
    instance.slave.freeInstance()
    return found, instance.told


def other_calls(fmus: list[str], argument: None) -> Any:
    """Return the status of the calls that nothing declares, each on a fresh instance."""
    instance = Instance(fmus[0])
    library = instance.slave.dll
    values = (ctypes.c_double * 1)()
    none = ctypes.c_size_t(0)
    flags = [ctypes.byref(ctypes.c_bool()) for _ in range(5)]
    found = {}
    for name, arguments in {
        "SetTime": (ctypes.c_double(1.0),),
        "GetContinuousStates": (values, none),
        "SetContinuousStates": (values, none),
        "GetContinuousStateDerivatives": (values, none),
        "GetNominalsOfContinuousStates": (values, none),
        "GetEventIndicators": (values, none),
        "UpdateDiscreteStates": (*flags, ctypes.byref(ctypes.c_double())),
    }.items():
        instance.slave.reset()
        instance.start({})
        component = ctypes.c_void_p(instance.slave.component)
        found[name] = library[f"fmi3{name}"](component, *arguments)
    instance.slave.reset()
    instance.start({})
    instance.step(0.1)
    instance.slave.freeInstance()
    return found


def times(fmus: list[str], argument: None) -> Any:
    """Return time and t_event before and after a step, after the next, and rolled back."""
    instance = Instance(fmus[0])
    instance.start({}, 5.0)
    found = [instance.get("time", "t_event", "x", "time")]
    instance.step(0.0625)
    found.append(instance.get("t_event", "time"))
    state = instance.take()
    instance.step(0.0625)
    found.append(instance.get("t_event", "time"))
    instance.put(state)
    found.append(instance.get("t_event", "time"))
    return found


def many(fmus: list[str], argument: None) -> Any:
    """Return what 100 instances at once show, and how often the FMU is on the search path."""
    together = [Instance(fmus[0], f"n{n}") for n in range(100)]
    for n, instance in enumerate(together):
        instance.start({"v": 0.01 + 1e-4 * n})
    for instance in together:
        instance.step(0.5)
    found = [instance.get("x_pull")[0] / (0.01 + 1e-4 * n) for n, instance in enumerate(together)]
    for instance in together:
        instance.slave.terminate()
        instance.slave.freeInstance()
    own = sum(together[0].folder in path for path in sys.path)
    return min(found), max(found), own


def growth(fmus: list[str], argument: None) -> Any:
    """Return by how many bytes the process grew over many rollbacks."""
    instance = Instance(fmus[0])
    instance.start({})
    instance.step(0.3)
    library, state = instance.slave.dll, fmi3FMUState()
    component = ctypes.c_void_p(instance.slave.component)

    def rollbacks(times: int) -> None:
        for _ in range(times):
            library.fmi3GetFMUState(component, ctypes.byref(state))
            library.fmi3SetFMUState(component, state)
            library.fmi3FreeFMUState(component, ctypes.byref(state))

    found = []
    rollbacks(10_000)
    before = _resident()
    rollbacks(_MANY)
    found.append(_resident() - before)
    return found


def _resident() -> int:
    """Return the bytes of memory that the process holds."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


def modules(fmus: list[str], argument: None) -> Any:
    """Return the modules that the FMU brought along."""
    # What the importer itself loads late.
    fmpy.read_model_description(fmus[0], validate=True)
    before = set(sys.modules)
    Instance(fmus[0])
    return sorted(name for name in set(sys.modules) - before)


if __name__ == "__main__":
    print(json.dumps(globals()[sys.argv[1]](sys.argv[2:], json.load(sys.stdin))))
