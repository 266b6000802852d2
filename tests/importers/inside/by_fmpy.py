"""FMPy's `simulate_fmu`, as its users call it."""

import shutil
from typing import Any

import fmpy
import numpy as np

_HELD = {"v": 0.02, "load": 0.0, "F_ext": 0.0}
"""Start values of the inputs."""


def run(fmu: str, case: Any) -> Any:
    """Run a case; the case `restart` twice in one instance, with fmi2Reset in between."""
    return runs(fmu, case, outputs(fmu))


def runs(fmu: str, case: Any, names: list[str]) -> Any:
    """Run a case and record the variables `names`."""
    if case["name"] != "restart":
        return simulate(fmu, case, names)
    folder = fmpy.extract(fmu)
    description = fmpy.read_model_description(folder)
    instance = fmpy.instantiate_fmu(folder, description, "CoSimulation")
    kept = {"model_description": description, "fmu_instance": instance}
    first = simulate(folder, case, names, **kept)
    instance.reset()
    second = simulate(folder, case, names, **kept)
    instance.freeInstance()
    shutil.rmtree(folder)
    return {**first, "again": second, "how": "fmi2Reset of the same instance"}


def simulate(fmu: str, case: Any, names: list[str], **more: Any) -> Any:
    """Call `simulate_fmu` and return its rows."""
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
    changes = case["changes"]
    names = sorted({name for each in changes.values() for name in each})
    if not names:
        return None
    now = {name: case["start"].get(name, _HELD[name.split(".")[-1]]) for name in names}
    table = [(0.0, *now.values())]
    for number, change in changes.items():
        time = int(number) * case["step"]
        table.append((time, *now.values()))
        now.update(change)
        table.append((time, *now.values()))
    return np.array(table, dtype=[(name, np.float64) for name in ("time", *names)])


def outputs(fmu: str) -> list[str]:
    """Return the names of all outputs."""
    variables = fmpy.read_model_description(fmu).modelVariables
    return [each.name for each in variables if each.causality == "output"]
