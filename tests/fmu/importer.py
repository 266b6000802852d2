"""The FMU as an importer meets it: run as a program, in a process that cannot import the project.

Called with the FMU's path and the name of one of the functions below; prints what it returns as
JSON. The project's packages are barred, so what runs is what the FMU carries.
"""

import atexit
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


class Importer:
    """Instances of one FMU, their variables called by name."""

    def __init__(self, fmu: str) -> None:
        self.fmu = fmu
        self.description = fmpy.read_model_description(fmu, validate=True)
        self.references = {
            each.name: each.valueReference for each in self.description.modelVariables
        }
        self.folder = fmpy.extract(fmu)
        atexit.register(shutil.rmtree, self.folder, ignore_errors=True)

    def instance(self, name: str = "a", *, ready: bool = True, **values: float) -> FMU2Slave:
        """Return an instance with these values set, initialized unless told otherwise."""
        slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        slave.instantiate()
        if ready:
            self.start(slave, **values)
        return slave

    def start(self, slave: FMU2Slave, start_time: float = 0.0, **values: float) -> None:
        """Set values and go through initialization."""
        slave.setupExperiment(startTime=start_time)
        for each, value in values.items():
            self.set(slave, each, value)
        slave.enterInitializationMode()
        slave.exitInitializationMode()

    def set(self, slave: FMU2Slave, name: str, value: float) -> None:
        """Set a Real by name."""
        slave.setReal([self.references[name]], [value])

    def get(self, slave: FMU2Slave, *names: str) -> list[float]:
        """Return Reals by name."""
        return list(slave.getReal([self.references[name] for name in names]))

    def get_integer(self, slave: FMU2Slave, name: str) -> int:
        """Return an Integer by name."""
        return int(slave.getInteger([self.references[name]])[0])

    def fails(self, call: Any, *arguments: Any) -> bool:
        """Whether a call fails."""
        try:
            call(*arguments)
        except FMICallException:
            return True
        return False


def default_run(importer: Importer) -> Any:
    """Return the default run's last row, at steps of 0.01 s and in one step."""
    rows = [
        fmpy.simulate_fmu(importer.fmu, stop_time=10.0, output_interval=interval)
        for interval in (0.01, 10.0)
    ]
    return [dict(zip(row.dtype.names, row[-1].tolist(), strict=True)) for row in rows]


def failures(importer: Importer) -> Any:
    """Fail thousands of times in every way, resetting between; return what was seen."""
    bad = {
        "v": float("nan"),
        "k": -1.0,
        "m": 0.0,
        "mu_s": -0.1,
        "load": -1e3,
        "F_ext": float("inf"),
    }
    seen = 0
    for round_ in range(200):
        slave = importer.instance(f"n{round_} %s %n é")
        for name, value in bad.items():
            slave.reset()
            slave.setupExperiment(startTime=0.0)
            slave.enterInitializationMode()
            failed = importer.fails(importer.set, slave, name, value)
            failed = importer.fails(slave.exitInitializationMode) or failed
            seen += failed
            # After a failure every call fails but reset and free.
            assert importer.fails(slave.doStep, 0.0, 0.1)
            assert importer.fails(importer.get, slave, "x")
            assert importer.fails(slave.getFMUstate)
            assert importer.fails(slave.terminate)
        for step in (0.0, -1.0, float("nan"), float("inf")):
            slave.reset()
            importer.start(slave)
            seen += importer.fails(slave.doStep, 0.0, step)
        slave.reset()
        importer.start(slave)
        slave.doStep(0.0, 0.1)
        assert importer.get(slave, "x_pull") == [0.1 * 0.02]
        slave.freeInstance()
    return seen


def messages(importer: Importer) -> Any:
    """Make one call fail in each way; the messages go to standard error."""
    slave = importer.instance()
    for name, value in (("k", -1.0), ("v", float("nan")), ("load", -10.0), ("m", 2.0), ("x", 1.0)):
        slave.reset()
        importer.start(slave)
        assert importer.fails(importer.set, slave, name, value), name
        assert importer.fails(importer.set, slave, name, value), name
    for call, arguments in ((slave.doStep, (0.0, 0.1)), (slave.exitInitializationMode, ())):
        slave.reset()
        assert importer.fails(call, *arguments)
    for reference in (4_000_000, importer.references["mode"]):
        slave.reset()
        importer.start(slave)
        assert importer.fails(slave.getReal, [reference])
    slave.reset()
    assert importer.fails(slave.setupExperiment, None, float("nan"))
    slave.reset()
    importer.start(slave)
    slave.terminate()
    assert importer.fails(importer.set, slave, "k", 2000.0)
    slave.freeInstance()
    return "done"


def clamp(importer: Importer) -> Any:
    """Return mu_k_used where mu_k exceeds mu_s."""
    return importer.get(importer.instance(mu_s=0.3, mu_k=0.5), "mu_k_used")


def initialization(importer: Importer) -> Any:
    """Return outputs that follow what is set before the first step, and those that wait."""
    slave = importer.instance(ready=False)
    slave.setupExperiment(startTime=5.0)
    slave.enterInitializationMode()
    at_once = []
    for z_start in (0.001, 0.006):
        importer.set(slave, "z_start", z_start)
        at_once.append(
            [*importer.get(slave, "F", "F_s", "t_event"), importer.get_integer(slave, "mode")]
        )
    slave.exitInitializationMode()
    importer.set(slave, "k", 2000.0)
    waiting = importer.get(slave, "k", "F")
    slave.doStep(5.0, 1e-9)
    return {"at_once": at_once, "waiting": waiting, "after": importer.get(slave, "F", "t_event")}


def silent(importer: Importer) -> Any:
    """Fail, and warn, while standard error cannot be written."""

    class Broken:
        def write(self, text: str) -> int:
            raise OSError("no such terminal")

        def flush(self) -> None:
            raise OSError("no such terminal")

    for stream in (Broken(), None):
        sys.stderr = stream
        for _ in range(300):
            slave = importer.instance(mu_s=0.3, mu_k=0.5)
            slave.doStep(0.0, 0.1)
            assert importer.fails(slave.doStep, 0.1, -1.0)
            assert importer.fails(slave.doStep, 0.1, 0.1)
            slave.freeInstance()
    sys.stderr = sys.__stderr__
    return "alive"


def written_back(importer: Importer) -> Any:
    """Write back every start value that the description gives, then run."""
    slave = importer.instance(ready=False)
    for each in importer.description.modelVariables:
        if each.start is not None and each.type == "Real":
            slave.setReal([each.valueReference], [float(each.start)])
        elif each.start is not None and each.type == "Integer":
            slave.setInteger([each.valueReference], [int(each.start)])
    importer.start(slave)
    slave.doStep(0.0, 10.0)
    return importer.get(slave, "T")


def passing_clamp(importer: Importer) -> Any:
    """Lower both coefficients, one call each; only the pair that acts may warn."""
    slave = importer.instance()
    importer.set(slave, "mu_s", 0.2)
    importer.set(slave, "mu_k", 0.1)
    slave.doStep(0.0, 0.1)
    importer.set(slave, "mu_k", 0.4)
    for index in range(5):
        slave.doStep(0.1 * (index + 1), 0.1)
    return importer.get(slave, "mu_k_used")


def modules(importer: Importer) -> Any:
    """Return the modules that the FMU brought along."""
    before = set(sys.modules)
    importer.instance()
    return sorted(name for name in set(sys.modules) - before)


if __name__ == "__main__":
    print(json.dumps(globals()[sys.argv[2]](Importer(sys.argv[1]))))
