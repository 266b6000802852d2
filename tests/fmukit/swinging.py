"""Runs the pendulum's FMU in fmpy and prints what it gave, as JSON; called by its path."""

import json
import sys
from typing import Any

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

STEPS = [(0.01, 0.0), (1e-13, 0.0), (0.7, 2.0), (0.003, -1.0), (2.5, 0.5), (0.125, 0.0)]
"""Length [s] and push [rad/s2] of each step."""


class Pendulum:
    """One instance, whatever its FMI version."""

    def __init__(self, file: str, **start: float) -> None:
        description = fmpy.read_model_description(file)
        self._references = {each.name: each.valueReference for each in description.modelVariables}
        self._two = description.fmiVersion == "2.0"
        self.slave: Any = (FMU2Slave if self._two else FMU3Slave)(
            guid=description.guid,
            unzipDirectory=fmpy.extract(file),
            modelIdentifier=description.coSimulation.modelIdentifier,
        )
        self.slave.instantiate()
        self.set(**start)
        if self._two:
            self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.time = 0.0

    def set(self, **values: float) -> None:
        """Set Reals."""
        references = [self._references[name] for name in values]
        put = self.slave.setReal if self._two else self.slave.setFloat64
        put(references, list(values.values()))

    def step(self, step: float, push: float) -> list[float]:
        """Make a step and return angle and angular velocity."""
        self.set(push=push)
        self.slave.doStep(self.time, step)
        self.time += step
        references = [self._references[name] for name in ("phi", "omega")]
        get = self.slave.getReal if self._two else self.slave.getFloat64
        return list(get(references))

    def state(self) -> Any:
        """Return the state, a state made of its bytes, and set neither."""
        slave = self.slave
        if self._two:
            state = slave.getFMUstate()
            return state, slave.deSerializeFMUstate(slave.serializeFMUstate(state))
        state = slave.getFMUState()
        return state, slave.deserializeFMUState(slave.serializeFMUState(state))

    def go_back(self, state: Any) -> None:
        """Set a state."""
        (self.slave.setFMUstate if self._two else self.slave.setFMUState)(state)


def refusal(file: str) -> str:
    """Return whether values that do not go together are refused."""
    try:
        Pendulum(file, l=1.0, d=4.0)
    except fmpy.fmi1.FMICallException:
        return "refused"
    return "taken"


def main() -> None:
    """Step, go back twice, step again; print all of it."""
    file = sys.argv[1]
    pendulum = Pendulum(file, l=0.5, d=0.3, phi_start=0.2)
    before = [pendulum.step(*each) for each in STEPS[:3]]
    states = pendulum.state()
    after = [pendulum.step(*each) for each in STEPS[3:]]
    again = []
    for state in states:
        pendulum.go_back(state)
        again.append([pendulum.step(*each) for each in STEPS[3:]])
    print(json.dumps({"given": before + after, "again": again, "creeping": refusal(file)}))


if __name__ == "__main__":
    main()
