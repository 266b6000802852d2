"""Integer parameters as an importer meets them; run as a program with the path of an FMU."""

import json
import runpy
import sys
from pathlib import Path
from typing import Any

runpy.run_path(str(Path(__file__).resolve().parents[1] / "barred.py"), run_name="__main__")

import fmpy  # noqa: E402 - the bar comes first
from fmpy.fmi2 import FMU2Slave  # noqa: E402
from fmpy.fmi3 import FMU3Slave  # noqa: E402

FMU = sys.argv[1]
DESCRIPTION = fmpy.read_model_description(FMU, validate=True)
MODERN = DESCRIPTION.fmiVersion == "3.0"
VARIABLES = {each.name: each for each in DESCRIPTION.modelVariables}
FOLDER = fmpy.extract(FMU)
CURVE = {"mu_1": 0.5, "u_2": 0.01, "mu_2": 0.3, "u_3": 0.02, "mu_3": 0.4, "u_4": 0.1, "mu_4": 0.2}


def instance() -> Any:
    """Return an instance before its initialization."""
    slave = (FMU3Slave if MODERN else FMU2Slave)(
        guid=DESCRIPTION.instantiationToken if MODERN else DESCRIPTION.guid,
        unzipDirectory=FOLDER,
        modelIdentifier=DESCRIPTION.coSimulation.modelIdentifier,
        instanceName="a",
    )
    slave.instantiate()
    return slave


def set_integer(slave: Any, name: str, value: int) -> None:
    """Set an Integer, or in FMI 3.0 an Enumeration or Int32."""
    variable = VARIABLES[name]
    reference = [variable.valueReference]
    if not MODERN:
        slave.setInteger(reference, [value])
    elif variable.type == "Enumeration":
        slave.setInt64(reference, [value])
    else:
        slave.setInt32(reference, [value])


def integers(slave: Any) -> list[int]:
    """Return shape and n_points."""
    shape, count = ([VARIABLES[name].valueReference] for name in ("shape", "n_points"))
    if not MODERN:
        return [*slave.getInteger(shape), *slave.getInteger(count)]
    return [*slave.getInt64(shape), *slave.getInt32(count)]


def start(slave: Any, **values: int) -> None:
    """Initialize over the curve."""
    if not MODERN:
        slave.setupExperiment(startTime=0.0)
    for name, count in values.items():
        set_integer(slave, name, count)
    for name, value in CURVE.items():
        reference = [VARIABLES[name].valueReference]
        (slave.setFloat64 if MODERN else slave.setReal)(reference, [value])
    slave.enterInitializationMode()
    slave.exitInitializationMode()


def step(slave: Any, time: float) -> list[Any]:
    """Make a step of 0.1 s from there; return x, x_dot, shape, n_points."""
    slave.doStep(time, 0.1)
    references = [VARIABLES[name].valueReference for name in ("x", "x_dot")]
    read = slave.getFloat64 if MODERN else slave.getReal
    return [*read(references), *integers(slave)]


def refused(name: str, value: int, *, late: bool = False) -> str:
    """Return what a refused value writes to standard error."""
    slave = instance()
    heard: list[str] = []
    original, sys.stderr = sys.stderr, Heard(heard)
    try:
        if late:
            start(slave, shape=3, n_points=4)
        set_integer(slave, name, value)
    except Exception:
        return "".join(heard)
    finally:
        sys.stderr = original
    return "not refused"


class Heard:
    """A stream that keeps what is written."""

    def __init__(self, heard: list[str]) -> None:
        self.write = heard.append

    def flush(self) -> None:
        """Do nothing."""


def main() -> dict[str, Any]:
    """Return what the tests compare."""
    found: dict[str, Any] = {}
    slave = instance()
    found["start"] = integers(slave)
    start(slave, shape=3, n_points=4)
    found["set"] = integers(slave)
    for n in range(3):
        step(slave, 0.1 * n)
    if MODERN:
        state = slave.getFMUState()
        data = slave.serializeFMUState(state)
    else:
        state = slave.getFMUstate()
        data = slave.serializeFMUstate(state)
    found["goes on"] = step(slave, 0.3)
    other = instance()
    start(other, shape=2)
    for n in range(3):
        step(other, 0.1 * n)
    found["other shape"] = step(other, 0.3)[:2]
    if MODERN:
        other.setFMUState(other.deserializeFMUState(data))
    else:
        other.setFMUstate(other.deSerializeFMUstate(data))
    found["restored"] = step(other, 0.3)
    found["refused shape"] = refused("shape", 4)
    found["refused count"] = refused("n_points", 13)
    found["refused change"] = refused("shape", 1, late=True)
    return found


print(json.dumps(main()))
