"""libcosim through libcosimpy: inputs by an override manipulator."""

from itertools import pairwise
from typing import Any

from libcosimpy.CosimAlgorithm import CosimAlgorithm, EccoParams
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave, CosimSlaveVariableDescription

from .simulation import ALONE, LINK, PAIR, STEP, NotOfferedError, Simulation

_TYPES = ("real", "integer", "string", "boolean")
_NANOSECONDS = 1_000_000_000
"""In a second: libcosim counts time in whole ones."""


class StepError(Exception):
    """libcosim says that a step failed."""


class Libcosim(Simulation):
    """An execution."""

    shows_start = False
    offering = (CosimExecution, CosimLocalSlave)
    errors = (NotOfferedError, StepError)

    def __init__(
        self,
        fmu: str,
        start: Any = None,
        step: float = STEP,
        blocks: tuple[str, ...] = ALONE,
        *,
        messages: bool = False,
        algorithm: Any = None,
    ) -> None:
        if messages:
            log_output_level(CosimLogLevel.WARNING)
        self.execution = (
            CosimExecution.from_step_size(round(step * _NANOSECONDS))
            if algorithm is None
            else CosimExecution.from_algorithm(algorithm)
        )
        self.slaves = [CosimLocalSlave(fmu, block) for block in blocks]
        self.index = {
            block: self.execution.add_local_slave(slave)
            for block, slave in zip(blocks, self.slaves, strict=True)
        }
        self.variables = {
            each.name.decode(): (each.reference, _TYPES[each.type])
            for each in self.execution.slave_variables(0)
            # Of an enumeration the type is none of these.
            if each.type < len(_TYPES)
        }
        self.observer = CosimObserver.create_last_value()
        self.execution.add_observer(self.observer)
        self.manipulator = CosimManipulator.create_override()
        self.execution.add_manipulator(self.manipulator)
        if blocks == PAIR:
            self.connect(*LINK)
        for block, index in self.index.items():
            for name, value in (start or {}).items():
                if (block, name) != LINK[1]:
                    assert self.execution.real_initial_value(index, self.variables[name][0], value)

    def connect(self, source: tuple[str, str], sink: tuple[str, str]) -> None:
        """Connect two Reals."""
        ends = [(self.index[block], self.variables[name][0]) for block, name in (source, sink)]
        self.execution.connect_real_variables(*ends[0], *ends[1])

    @property
    def time(self) -> float:  # type: ignore[override]
        """Where the execution stands [s]."""
        return float(self.execution.status().current_time / _NANOSECONDS)

    def step(self, h: float | None = None) -> None:
        """Make a step."""
        if h is not None:
            raise NotOfferedError("a step of another length")
        if not self.execution.step():
            raise StepError("step() returns False")

    def set(self, name: str, value: Any, block: str = ALONE[0]) -> None:
        """Override a variable."""
        reference, kind = self._known(name)
        assert getattr(self.manipulator, f"slave_{kind}_values")(
            self.index[block], [reference], [value]
        )

    def get(self, name: str, block: str = ALONE[0]) -> Any:
        """Return what was observed last."""
        reference, kind = self._known(name)
        [value] = getattr(self.observer, f"last_{kind}_values")(self.index[block], [reference])
        return value.decode() if isinstance(value, bytes) else value

    def _known(self, name: str) -> tuple[int, str]:
        if name not in self.variables:
            raise NotOfferedError(name)
        return self.variables[name]

    @classmethod
    def resets(cls, _: str) -> bool:
        """Look for a call that begins a run again."""
        return cls.offers("reset|restart")

    @classmethod
    def any_step(cls, fmu: str) -> bool:
        """Let the ECCO algorithm choose the steps of two blocks, one pulled by the other's mass."""
        algorithm = CosimAlgorithm.create_ecco_algorithm(EccoParams())
        with cls(fmu, blocks=("front", "rear"), algorithm=algorithm) as simulation:
            simulation.connect(("front", "x_dot"), ("rear", "v"))
            simulation.connect(("rear", "F"), ("front", "F_ext"))
            refer = {name: reference for name, (reference, _) in simulation.variables.items()}
            algorithm.add_power_bond(0, refer["x_dot"], refer["F_ext"], 1, refer["F"], refer["v"])
            times = [0.0]
            for _ in range(60):
                simulation.step()
                times.append(simulation.time)
        return len({round((later - earlier) * 1e9) for earlier, later in pairwise(times)}) > 1

    @classmethod
    def units(cls, _: str) -> bool:
        """Look for a unit in the description of a variable."""
        return any("unit" in name for name, *_ in CosimSlaveVariableDescription._fields_)


SIMULATION = Libcosim
