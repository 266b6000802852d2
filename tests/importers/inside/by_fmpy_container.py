"""The container FMU that FMPy brings along."""

import copy
import tempfile
from pathlib import Path
from typing import Any

import fmpy
from fmpy.container_fmu.cli import create_container_fmu
from fmpy.container_fmu.config import Component, Configuration, Connection
from fmpy.model_description import (
    CoSimulation,
    DefaultExperiment,
    ModelDescription,
    ModelVariable,
    Unknown,
)

from tests.importers.cases import STEP

from .containing import Container
from .simulation import LINK, PAIR


class Pairs(list[Any]):
    """The mapping of variables to those inside, as a list: ModelVariable cannot be a key."""

    def items(self) -> Any:
        return self


class FmpyContainer(Container):
    @staticmethod
    def nest(fmu: str, blocks: tuple[str, ...], threads: bool) -> str:
        inside = fmpy.read_model_description(fmu)
        components = {name: Component(name, Path(fmu), inside) for name in blocks}
        # The container counts its variables from its time, which has to be there.
        variables = [ModelVariable(name="time", type="Real", causality="independent")]
        mapping = Pairs()
        for name, component in components.items():
            for each in inside.modelVariables:
                if blocks != PAIR or (name, each.name) != LINK[1]:
                    outside = copy.copy(each)
                    outside.name = f"{name}.{each.name}"
                    variables.append(outside)
                    mapping.append((outside, [(component, each)]))
        description = ModelDescription(
            fmiVersion="2.0",
            modelName="Container",
            instantiationToken="blocks",
            defaultExperiment=DefaultExperiment(startTime="0.0", stopTime="10.0"),
            coSimulation=CoSimulation(fixedInternalStepSize=STEP),
            unitDefinitions=inside.unitDefinitions,
            typeDefinitions=inside.typeDefinitions,
            modelVariables=variables,
            outputs=[Unknown(variable=each) for each in variables if each.causality == "output"],
        )
        configuration = Configuration(
            parallelDoStep=threads,
            modelDescription=description,
            components=list(components.values()),
            connections=[_connection(components, inside)] if blocks == PAIR else [],
            variableMappings=mapping,
        )
        folder = Path(tempfile.mkdtemp())
        create_container_fmu(configuration, folder, Path(f"{folder}.fmu"))
        return f"{folder}.fmu"


def _connection(components: Any, inside: Any) -> Connection:
    ends = []
    for _, name in LINK:
        [end] = [copy.copy(each) for each in inside.modelVariables if each.name == name]
        # FMPy writes the type as FMI 3.0 names it, but for connections.
        end.type = "Float64"
        ends.append(end)
    source, sink = (components[block] for block, _ in LINK)
    return Connection(source, ends[:1], sink, ends[1:])


SIMULATION = FmpyContainer
