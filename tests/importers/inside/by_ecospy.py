"""Ecos through ecospy."""

from contextlib import ExitStack
from pathlib import Path
from typing import Any

import ecospy
import fmpy

from tests.importers.cases import STEP

from .simulation import ALONE, LINK, PAIR, NotOfferedError, Simulation

_WORDS = {"Real": "real", "Integer": "integer", "Boolean": "bool"}


class Ecos(Simulation):
    offering = (ecospy.EcosSimulation,)

    def open(self) -> None:
        if self.messages:
            ecospy.EcosLib.set_log_level("trace")
        variables = fmpy.read_model_description(self.fmu).modelVariables
        self.words = {each.name: _WORDS[each.type] for each in variables}
        self.stack = ExitStack()
        structure = self.stack.enter_context(ecospy.EcosSimulationStructure())
        for block in self.blocks:
            structure.add_model(block, self.uri(self.fmu))
        start = {f"{block}::{name}": value for block, name, value in self.of_each(self.start)}
        structure.add_parameter_set("start", start)
        if self.blocks == PAIR:
            structure.make_real_connection(*("::".join(end) for end in LINK))
        self.opened = self.stack.enter_context(
            ecospy.EcosSimulation(structure=structure, step_size=STEP)
        )
        self.stack.callback(self.opened.terminate)
        if self.messages:
            self.opened.add_csv_writer("results.csv")
        self.opened.init(parameter_set="start")

    def uri(self, fmu: str) -> str:
        return fmu

    @property
    def time(self) -> float:  # type: ignore[override]
        return float(self.opened.get_time())

    def step(self, h: float | None = None) -> None:
        if h is None:
            self.opened.step()
        else:
            self.opened.step_for(h)

    def set(self, name: str, value: Any, block: str = ALONE[0]) -> None:
        try:
            getattr(self.opened, f"set_{self.words[name]}")(f"{block}::{name}", value)
        except Exception as error:
            # Ecos raises no class of its own.
            if f"property {block}::{name} found" not in str(error):
                raise
            raise NotOfferedError(name) from None

    def get(self, name: str, block: str = ALONE[0]) -> Any:
        return getattr(self.opened, f"get_{self.words[name]}")(f"{block}::{name}")

    def reset(self) -> None:
        self.opened.reset()
        self.opened.init(parameter_set="start")

    def close(self) -> None:
        self.stack.close()

    @classmethod
    def units(cls, fmu: str) -> bool:
        with cls(fmu, messages=True) as simulation:
            simulation.step()
        head = Path("results.csv").read_text(encoding="utf-8").splitlines()[0]
        assert "block::F[REAL]" in head
        return "[N]" in head or cls.offers("unit")


SIMULATION = Ecos
