"""What libcosim can do, through libcosimpy."""

from itertools import pairwise
from typing import Any

from libcosimpy.CosimAlgorithm import CosimAlgorithm, EccoParams
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave, CosimSlaveVariableDescription

from .offering import offers

_STEP = 10_000_000
"""Nanoseconds."""
_REAL, _INTEGER, _STRING, _BOOLEAN = range(4)


class Running:
    """An execution of one or more instances of an FMU."""

    def __init__(
        self, fmu: str, names: tuple[str, ...] = ("block",), algorithm: Any = None
    ) -> None:
        if algorithm is None:
            self.execution = CosimExecution.from_step_size(_STEP)
        else:
            self.execution = CosimExecution.from_algorithm(algorithm)
        self.slaves = [CosimLocalSlave(fmu, name) for name in names]
        for slave in self.slaves:
            self.execution.add_local_slave(slave)
        self.variables = {
            each.name.decode(): (each.reference, each.type)
            for each in self.execution.slave_variables(0)
        }
        self.observer = CosimObserver.create_last_value()
        self.execution.add_observer(self.observer)
        self.manipulator = CosimManipulator.create_override()
        self.execution.add_manipulator(self.manipulator)

    def step(self, count: int = 1) -> bool:
        """Do steps; return whether libcosim says that they were done."""
        return bool(self.execution.step(count))

    def set(self, name: str, value: Any) -> None:
        """Override a variable of the first instance."""
        reference, kind = self.variables[name]
        setters = {
            _REAL: self.manipulator.slave_real_values,
            _INTEGER: self.manipulator.slave_integer_values,
            _STRING: self.manipulator.slave_string_values,
            _BOOLEAN: self.manipulator.slave_boolean_values,
        }
        assert setters[kind](0, [reference], [value])

    def get(self, name: str, slave: int = 0) -> Any:
        """Return what was last observed of a variable."""
        reference, kind = self.variables[name]
        getters = {
            _REAL: self.observer.last_real_values,
            _INTEGER: self.observer.last_integer_values,
            _STRING: self.observer.last_string_values,
            _BOOLEAN: self.observer.last_boolean_values,
        }
        [value] = getters[kind](slave, [reference])
        return value.decode() if isinstance(value, bytes) else value


class Probes:
    """What may be tried on an FMU."""

    def kind(self, fmu: str, value: Any) -> bool:
        """Set an input of some kind, step, and find it in the output."""
        running = Running(fmu)
        if "given" not in running.variables:
            return False
        running.set("given", value)
        running.step()
        return bool(running.get("shown") == value)

    def inputs(self, fmu: str) -> bool:
        """Change an input between two steps."""
        running = Running(fmu)
        running.step()
        running.set("v", 0.05)
        running.step()
        return bool(abs(running.get("x_pull") - 0.01 * 0.07) < 1e-15)

    def parameters(self, fmu: str) -> bool:
        """Change a tunable parameter between two steps."""
        running = Running(fmu)
        running.step()
        running.set("k", 2000.0)
        running.step()
        return bool(running.get("F") == 2000.0 * running.get("z"))

    def state(self, fmu: str) -> bool:
        """Look for calls that keep and restore a state."""
        return offers("save|restore|state", CosimExecution, CosimLocalSlave)

    def serialize(self, fmu: str) -> bool:
        """Look for calls that give a state as bytes."""
        return offers("serial|export", CosimExecution, CosimLocalSlave)

    def reset(self, fmu: str) -> bool:
        """Look for a call that begins a run again."""
        return offers("reset|restart", CosimExecution, CosimLocalSlave)

    def variable_step(self, fmu: str) -> bool:
        """Let the ECCO algorithm choose the steps of two blocks, one pulled by the other's mass."""
        algorithm = CosimAlgorithm.create_ecco_algorithm(EccoParams())
        running = Running(fmu, ("front", "rear"), algorithm)
        refer = {name: reference for name, (reference, _) in running.variables.items()}
        bond = (0, refer["x_dot"], refer["F_ext"]), (1, refer["F"], refer["v"])
        for source, sink in (bond, bond[::-1]):
            running.execution.connect_real_variables(source[0], source[1], sink[0], sink[2])
        algorithm.add_power_bond(*bond[0], *bond[1])
        times = [0]
        for _ in range(60):
            assert running.step()
            times.append(running.execution.status().current_time)
        return len({later - earlier for earlier, later in pairwise(times)}) > 1

    def several(self, fmu: str) -> bool:
        """Run two instances in one execution."""
        running = Running(fmu, ("one", "other"))
        running.execution.real_initial_value(1, running.variables["v"][0], 0.05)
        running.step(10)
        ways = running.get("x_pull"), running.get("x_pull", 1)
        return bool(max(abs(ways[0] - 0.002), abs(ways[1] - 0.005)) < 1e-15)

    def units(self, fmu: str) -> bool:
        """Look for a unit among what libcosim tells of a variable."""
        return any("unit" in name for name, *_ in CosimSlaveVariableDescription._fields_)

    def log(self, fmu: str) -> None:
        """Have the FMU send a warning, with messages asked for."""
        log_output_level(CosimLogLevel.WARNING)
        running = Running(fmu)
        running.set("mu_k", 0.9)
        running.step(2)

    def refused(self, fmu: str) -> str:
        """Set what the FMU refuses; return what comes of it."""
        running = Running(fmu)
        running.execution.real_initial_value(0, running.variables["k"][0], -1.0)
        return "goes on" if running.step() else "step() returns False"

    def refused_later(self, fmu: str) -> str:
        """Set it between two steps; return what comes of it."""
        running = Running(fmu)
        running.step()
        running.set("k", -1.0)
        return "goes on" if running.step() else "step() returns False"


PROBES = Probes()
