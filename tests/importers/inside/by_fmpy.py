"""FMPy: one FMI call after the other."""

from functools import cache
from typing import Any

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

from tests.importers.cases import STEP

from .simulation import ALONE, NotOfferedError, Simulation


class Fmpy(Simulation):
    offering = (FMU2Slave,)
    errors = (FMICallException, NotOfferedError)

    def open(self) -> None:
        folder, description = unpacked(self.made())
        self.variables = {each.name: each for each in description.modelVariables}
        how: Any = {"fmi_type": "CoSimulation", "debug_logging": self.messages}
        self.slaves = self.of_blocks(lambda: fmpy.instantiate_fmu(folder, description, **how))
        self._begin()

    def made(self) -> str:
        return self.fmu

    def of_blocks(self, instantiate: Any) -> dict[str, Any]:
        return {block: instantiate() for block in self.blocks}

    def named(self, name: str, block: str) -> Any:
        return self.variables[name]

    def _begin(self) -> None:
        self.time = 0.0
        for slave in set(self.slaves.values()):
            slave.setupExperiment(startTime=0.0)
        for block, name, value in self.of_each(self.start):
            self.set(name, value, block)
        for slave in set(self.slaves.values()):
            slave.enterInitializationMode()
            slave.exitInitializationMode()

    def step(self, h: float | None = None) -> None:
        for slave in set(self.slaves.values()):
            slave.doStep(self.time, h or STEP)
        # Multiples of the step, without the roundings of a sum.
        self.time = self.time + h if h else round(self.time / STEP + 1.0) * STEP

    def set(self, name: str, value: Any, block: str = ALONE[0]) -> None:
        variable = self.named(name, block)
        getattr(self.slaves[block], f"set{variable.type}")([variable.valueReference], [value])

    def get(self, name: str, block: str = ALONE[0]) -> Any:
        variable = self.named(name, block)
        [value] = getattr(self.slaves[block], f"get{variable.type}")([variable.valueReference])
        return value

    def reset(self) -> None:
        for slave in set(self.slaves.values()):
            slave.reset()
        self._begin()

    def close(self) -> None:
        for slave in set(self.slaves.values()):
            slave.freeInstance()
        self.slaves = {}

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
        with cls(fmu) as simulation:
            return any(each.unit == "N" for each in simulation.variables.values())


SIMULATION = Fmpy


@cache
def unpacked(fmu: str) -> tuple[str, Any]:
    folder = str(fmpy.extract(fmu))
    return folder, fmpy.read_model_description(folder)
