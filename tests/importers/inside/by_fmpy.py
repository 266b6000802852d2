"""FMPy: runs by `simulate_fmu`, as its users call it; probes by its calls one by one."""

from functools import cache
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

from .simulation import ALONE, NotOfferedError, Simulation, outputs

_HELD = {"v": 0.02, "load": 0.0, "F_ext": 0.0}
"""Start values of the inputs."""


class Fmpy(Simulation):
    """Instances of an FMU, each a block; in a container variables have a prefix."""

    offering = (FMU2Slave,)
    errors = (FMICallException, NotOfferedError)

    def open(self) -> None:
        folder, description = unpacked(self.made(self.fmu))
        variables = reversed(description.modelVariables)
        self.variables = {each.name.split(".")[-1]: each for each in variables}
        how: Any = {"fmi_type": "CoSimulation", "debug_logging": self.messages}
        try:
            self.slaves = {
                block: fmpy.instantiate_fmu(folder, description, **how) for block in self.blocks
            }
        except Exception as error:
            # FMPy raises no class of its own here.
            if str(error) != "Failed to instantiate model":
                raise
            raise NotOfferedError(str(error)) from None
        self._begin()

    @classmethod
    def made(cls, fmu: str) -> str:
        """Return the FMU to instantiate."""
        return fmu

    def _begin(self) -> None:
        self.time = 0.0
        for block, slave in self.slaves.items():
            slave.setupExperiment(startTime=0.0)
            for name, value in self.start.items():
                self.set(name, value, block)
            slave.enterInitializationMode()
            slave.exitInitializationMode()

    def step(self, h: float | None = None) -> None:
        for slave in self.slaves.values():
            slave.doStep(self.time, h or self.h)
        # Multiples of the step, without the roundings of a sum.
        self.time = self.time + h if h else round(self.time / self.h + 1.0) * self.h

    def set(self, name: str, value: Any, block: str = ALONE[0]) -> None:
        variable = self.variables[name]
        getattr(self.slaves[block], f"set{_call(variable)}")([variable.valueReference], [value])

    def get(self, name: str, block: str = ALONE[0]) -> Any:
        variable = self.variables[name]
        slave = self.slaves[block]
        [value] = getattr(slave, f"get{_call(variable)}")([variable.valueReference])
        return value.decode() if isinstance(value, bytes) else value

    def reset(self) -> None:
        for slave in self.slaves.values():
            slave.reset()
        self._begin()

    def close(self) -> None:
        for slave in self.slaves.values():
            slave.freeInstance()
        self.slaves = {}

    @classmethod
    def run(cls, fmu: str, case: Any, blocks: tuple[str, ...] = ALONE) -> Any:
        assert blocks == ALONE
        return simulated(fmu, case, outputs(fmu))

    @classmethod
    def state(cls, fmu: str) -> bool:
        with cls(fmu) as simulation:
            simulation.go()
            slave = simulation.slaves[ALONE[0]]
            saved = slave.getFMUstate()
            first = simulation.go()
            slave.setFMUstate(saved)
            return bool(simulation.go() == first)

    @classmethod
    def serialize(cls, fmu: str) -> bool:
        with cls(fmu) as one, cls(fmu) as other:
            one.go()
            ours, theirs = one.slaves[ALONE[0]], other.slaves[ALONE[0]]
            data = ours.serializeFMUstate(ours.getFMUstate())
            theirs.setFMUstate(theirs.deSerializeFMUstate(data))
            return bool(one.go() == other.go())

    @classmethod
    def units(cls, fmu: str) -> bool:
        _, description = unpacked(cls.made(fmu))
        return any(each.unit == "N" for each in description.modelVariables)


SIMULATION = Fmpy


@cache
def unpacked(fmu: str) -> tuple[str, Any]:
    """Return the folder that an FMU is unpacked in, and its description."""
    folder = str(fmpy.extract(fmu))
    return folder, fmpy.read_model_description(folder)


def _call(variable: Any) -> str:
    return "Integer" if variable.type == "Enumeration" else str(variable.type)


def simulated(fmu: str, case: Any, names: list[str]) -> Any:
    """Run a case by `simulate_fmu` and record these variables."""
    if case["name"] != "restart":
        return _simulated(fmu, case, names)
    folder, description = unpacked(fmu)
    instance = fmpy.instantiate_fmu(folder, description, "CoSimulation")
    more = {"model_description": description, "fmu_instance": instance}
    first = _simulated(folder, case, names, **more)
    instance.reset()
    second = _simulated(folder, case, names, **more)
    instance.freeInstance()
    return {**first, "again": second}


def _simulated(fmu: str, case: Any, names: list[str], **more: Any) -> Any:
    result = fmpy.simulate_fmu(
        fmu,
        stop_time=case["steps"] * case["step"],
        output_interval=case["step"],
        start_values=case["start"],
        input=signals(case),
        output=names,
        **more,
    )
    return {
        "times": result["time"].tolist(),
        "outputs": {name: result[name].tolist() for name in names},
    }


def signals(case: Any) -> Any:
    """Return the inputs as FMPy's table of signals: a time that stands twice is a step.

    FMPy draws a straight line from row to row, and warns of inputs that are not in the table.
    """
    names = sorted({name for changes in case["changes"].values() for name in changes})
    if not names:
        return None
    now = {name: case["start"].get(name, _HELD[name.split(".")[-1]]) for name in names}
    table = [(0.0, *now.values())]
    for number, changes in case["changes"].items():
        time = int(number) * case["step"]
        table.append((time, *now.values()))
        now.update(changes)
        table.append((time, *now.values()))
    return np.array(table, dtype=[(name, np.float64) for name in ("time", *names)])
