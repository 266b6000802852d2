"""Calls written down elsewhere, made again one by one through FMPy's bare functions."""

from typing import Any

import fmpy
from fmpy.fmi2 import FMU2Slave


def run(fmu: str, calls: Any) -> Any:
    """Make calls, each `[instance, what, arguments]`; return what each returned."""
    description = fmpy.read_model_description(fmu)
    folder = fmpy.extract(fmu)
    slaves: dict[str, FMU2Slave] = {}
    answers: list[Any] = []
    for name, what, arguments in calls:
        if what == "make":
            slaves[name] = FMU2Slave(
                guid=description.guid,
                unzipDirectory=folder,
                modelIdentifier=description.coSimulation.modelIdentifier,
                instanceName=name,
            )
            slaves[name].instantiate()
            answers.append(None)
        else:
            answers.append(_call(slaves[name], what, arguments))
    for slave in slaves.values():
        slave.freeInstance()
    return answers


def _call(slave: FMU2Slave, what: str, arguments: Any) -> Any:
    if what == "setup_experiment":
        start, stop, tolerance = arguments
        return slave.setupExperiment(startTime=start, stopTime=stop, tolerance=tolerance)
    if what == "do_step":
        return slave.fmi2DoStep(slave.component, *arguments, 1)
    function = {
        "enter_initialization_mode": slave.enterInitializationMode,
        "exit_initialization_mode": slave.exitInitializationMode,
        "terminate": slave.terminate,
        "get_real": slave.getReal,
        "get_integer": slave.getInteger,
        "get_boolean": slave.getBoolean,
        "set_real": slave.setReal,
        "set_integer": slave.setInteger,
        "set_boolean": slave.setBoolean,
    }[what]
    return function(*arguments)
