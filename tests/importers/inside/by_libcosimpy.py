"""libcosim through libcosimpy: inputs by an override manipulator."""

from itertools import pairwise
from typing import Any

from libcosimpy.CosimAlgorithm import CosimAlgorithm, EccoParams
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave, CosimSlaveVariableDescription

from tests.importers.cases import STEP

from .simulation import ALONE, LINK, PAIR, NotOfferedError, Simulation

_TYPES = ("real", "integer", "string", "boolean")
_NANOSECONDS = 1_000_000_000
"""In a second: libcosim counts time in whole ones."""


class StepError(Exception):
    """libcosim says that a step failed."""


class Libcosim(Simulation):
    shows_start = False
    offering = (CosimExecution, CosimLocalSlave)
    errors = (NotOfferedError, StepError)

    algorithm: Any = None

    def open(self) -> None:
        if self.messages:
            log_output_level(CosimLogLevel.WARNING)
        self.execution = (
            CosimExecution.from_step_size(round(STEP * _NANOSECONDS))
            if self.algorithm is None
            else CosimExecution.from_algorithm(self.algorithm)
        )
        self.slaves = [CosimLocalSlave(self.fmu, block) for block in self.blocks]
        indices = [self.execution.add_local_slave(slave) for slave in self.slaves]
        self.index = dict(zip(self.blocks, indices, strict=True))
        self.variables = {
            each.name.decode(): (each.reference, _TYPES[each.type])
            for each in self.execution.slave_variables(0)
        }
        self.observer = CosimObserver.create_last_value()
        self.execution.add_observer(self.observer)
        self.manipulator = CosimManipulator.create_override()
        self.execution.add_manipulator(self.manipulator)
        if self.blocks == PAIR:
            self.connect(*LINK)
        for block, name, value in self.of_each(self.start):
            reference, _ = self.variables[name]
            assert self.execution.real_initial_value(self.index[block], reference, value)

    def connect(self, source: tuple[str, str], sink: tuple[str, str]) -> None:
        ends = [(self.index[block], self.variables[name][0]) for block, name in (source, sink)]
        self.execution.connect_real_variables(*ends[0], *ends[1])

    @property
    def time(self) -> float:  # type: ignore[override]
        return float(self.execution.status().current_time / _NANOSECONDS)

    def step(self, h: float | None = None) -> None:
        if h is not None:
            raise NotOfferedError("a step of another length")
        if not self.execution.step():
            raise StepError("step() returns False")

    def set(self, name: str, value: Any, block: str = ALONE[0]) -> None:
        reference, kind = self._known(name)
        assert getattr(self.manipulator, f"slave_{kind}_values")(
            self.index[block], [reference], [value]
        )

    def get(self, name: str, block: str = ALONE[0]) -> Any:
        reference, kind = self._known(name)
        [value] = getattr(self.observer, f"last_{kind}_values")(self.index[block], [reference])
        return value

    def _known(self, name: str) -> tuple[int, str]:
        if name not in self.variables:
            raise NotOfferedError(name)
        return self.variables[name]

    @classmethod
    def resets(cls, _: str) -> bool:
        return cls.offers("reset|restart")

    @classmethod
    def any_step(cls, fmu: str) -> bool:
        class WithEcco(cls):  # type: ignore[valid-type, misc]
            algorithm = CosimAlgorithm.create_ecco_algorithm(EccoParams())

        with WithEcco(fmu, blocks=("front", "rear")) as simulation:
            simulation.connect(("front", "x_dot"), ("rear", "v"))
            simulation.connect(("rear", "F"), ("front", "F_ext"))
            refer = {name: reference for name, (reference, _) in simulation.variables.items()}
            WithEcco.algorithm.add_power_bond(
                0, refer["x_dot"], refer["F_ext"], 1, refer["F"], refer["v"]
            )
            times = [0.0]
            for _ in range(60):
                simulation.step()
                times.append(simulation.time)
        return len({round((later - earlier) * 1e9) for earlier, later in pairwise(times)}) > 1

    @classmethod
    def units(cls, _: str) -> bool:
        return any("unit" in name for name, *_ in CosimSlaveVariableDescription._fields_)


SIMULATION = Libcosim
