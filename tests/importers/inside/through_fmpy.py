"""What can be done to an FMU through FMPy: tried on the block, or on a container that nests it."""

import atexit
import shutil
from collections.abc import Callable
from functools import cache
from typing import Any

import fmpy
from fmpy.fmi1 import FMICallException

STEP = 0.01


@cache
def unpacked(fmu: str) -> str:
    """Return the folder that an FMU is unpacked in until the process ends."""
    folder = str(fmpy.extract(fmu))
    atexit.register(shutil.rmtree, folder)
    return folder


class Instance:
    """An instance, its variables called by the end of their names: the first that has it."""

    def __init__(self, fmu: str, **start: float) -> None:
        folder = unpacked(fmu)
        description = fmpy.read_model_description(folder)
        self.variables = {
            each.name.split(".")[-1]: each for each in reversed(description.modelVariables)
        }
        self.slave = fmpy.instantiate_fmu(folder, description, "CoSimulation")
        # FMPy keeps an instance that nobody frees, and with it the library.
        atexit.register(self.slave.freeInstance)
        self.time = 0.0
        self.begin(**start)

    def begin(self, **start: float) -> None:
        """Initialize."""
        self.time = 0.0
        self.slave.setupExperiment(startTime=0.0)
        for name, value in start.items():
            self.set(name, value)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def step(self, h: float = STEP) -> None:
        """Do a step."""
        self.slave.doStep(self.time, h)
        self.time += h

    def set(self, name: str, value: Any) -> None:
        """Set a variable by the call of its type."""
        variable = self.variables[name]
        getattr(self.slave, f"set{_call(variable.type)}")([variable.valueReference], [value])

    def get(self, name: str) -> Any:
        """Return a variable by the call of its type."""
        variable = self.variables[name]
        [value] = getattr(self.slave, f"get{_call(variable.type)}")([variable.valueReference])
        return value.decode() if isinstance(value, bytes) else value


def _call(kind: str) -> str:
    return "Integer" if kind == "Enumeration" else str(kind)


class Probes:
    """What may be tried on an FMU; `make` makes the FMU to run of the one given.

    `prefix` is what the variables of the block are called by there.
    """

    def __init__(self, make: Callable[[str], str], prefix: str = "") -> None:
        self.make = cache(make)
        self.prefix = prefix

    def kind(self, fmu: str, value: Any) -> bool:
        """Set an input of some kind, step, and find it in the output."""
        try:
            instance = Instance(self.make(fmu))
        except Exception as error:
            # FMPy raises no class of its own here.
            if str(error) != "Failed to instantiate model":
                raise
            return False
        instance.set("given", value)
        instance.step()
        return bool(instance.get("shown") == value)

    def inputs(self, fmu: str) -> bool:
        """Change an input between two steps."""
        instance = Instance(self.make(fmu))
        instance.step()
        instance.set("v", 0.05)
        instance.step()
        return bool(abs(instance.get("x_pull") - STEP * 0.07) < 1e-15)

    def parameters(self, fmu: str) -> bool:
        """Change a tunable parameter between two steps."""
        instance = Instance(self.make(fmu))
        instance.step()
        instance.set("k", 2000.0)
        instance.step()
        return bool(instance.get("F") == 2000.0 * instance.get("z"))

    def state(self, fmu: str) -> bool:
        """Set the state back and repeat what came after."""
        instance = Instance(self.make(fmu))
        _go(instance, 30)
        try:
            kept = instance.slave.getFMUstate()
        except FMICallException:
            return False
        first = _go(instance, 30)
        instance.slave.setFMUstate(kept)
        return _go(instance, 30) == first

    def serialize(self, fmu: str) -> bool:
        """Carry the state to another instance as bytes."""
        path = self.make(fmu)
        one, other = Instance(path), Instance(path)
        _go(one, 30)
        try:
            written = one.slave.serializeFMUstate(one.slave.getFMUstate())
        except FMICallException:
            return False
        other.slave.setFMUstate(other.slave.deSerializeFMUstate(written))
        return _go(one, 30) == _go(other, 30)

    def reset(self, fmu: str) -> bool:
        """Begin again in the same instance."""
        instance = Instance(self.make(fmu))
        first = _go(instance, 30)
        instance.set("v", 0.05)
        instance.step()
        instance.slave.reset()
        instance.begin()
        return _go(instance, 30) == first

    def variable_step(self, fmu: str) -> bool:
        """Do two steps of different lengths, the second no multiple of the first."""
        instance = Instance(self.make(fmu))
        instance.step(0.01)
        try:
            instance.step(0.037)
        except FMICallException:
            return False
        return bool(abs(instance.get("x_pull") - 0.02 * 0.047) < 1e-15)

    def several(self, fmu: str) -> bool:
        """Run two instances in turns."""
        path = self.make(fmu)
        one, other = Instance(path), Instance(path, v=0.05)
        for _ in range(10):
            one.step()
            other.step()
        ways = one.get("x_pull"), other.get("x_pull")
        return bool(max(abs(ways[0] - 0.002), abs(ways[1] - 0.005)) < 1e-15)

    def units(self, fmu: str) -> bool:
        """Find the unit of the spring force."""
        description = fmpy.read_model_description(self.make(fmu))
        return any(each.unit == "N" for each in description.modelVariables)

    def log(self, fmu: str) -> None:
        """Have the FMU send a warning, with messages asked for."""
        start = {f"{self.prefix}mu_k": 0.9}
        fmpy.simulate_fmu(self.make(fmu), stop_time=STEP, start_values=start, debug_logging=True)

    def refused(self, fmu: str) -> str:
        """Set what the FMU refuses; return what comes of it."""
        try:
            Instance(self.make(fmu), k=-1.0).step()
        except FMICallException as error:
            return f"exception: {error}"
        return "goes on"

    def refused_later(self, fmu: str) -> str:
        """Set it between two steps; return what comes of it."""
        instance = Instance(self.make(fmu))
        instance.step()
        try:
            instance.set("k", -1.0)
            instance.step()
        except FMICallException as error:
            return f"exception: {error}"
        return "goes on"


def _go(instance: Instance, steps: int) -> list[float]:
    rows = []
    for _ in range(steps):
        instance.step()
        rows.append(instance.get("x"))
    return rows
