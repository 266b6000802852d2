"""Two blocks nested in the container FMU that FMPy brings along, the container run by FMPy.

The spring force of the first block acts as external force on the second.
"""

import copy
import shutil
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

from . import by_fmpy
from .containing import BLOCKS, LINK, both, of_both, split


class Pairs(list[Any]):
    """The mapping of variables to those inside, as a list: ModelVariable cannot be a key."""

    def items(self) -> Any:
        """Return the pairs."""
        return self


def run(fmu: str, case: Any) -> Any:
    """Nest the FMU twice, run a case in the container; `restart` by fmi2Reset of the container."""
    container = nest(fmu, case["step"])
    outputs = by_fmpy.outputs(fmu)
    return split(by_fmpy.runs(container, both(case), of_both(outputs)), outputs)


def nest(
    fmu: str,
    step: float,
    blocks: tuple[str, ...] = BLOCKS,
    link: tuple[tuple[str, str], tuple[str, str]] | None = LINK,
) -> str:
    """Make the container and return its path."""
    inside = fmpy.read_model_description(fmu)
    components = {name: Component(name, Path(fmu), inside) for name in blocks}
    # The container counts its variables from its time, which has to be there.
    variables = [ModelVariable(name="time", type="Real", causality="independent")]
    mapping = Pairs()
    for name, component in components.items():
        for each in inside.modelVariables:
            if link is None or (name, each.name) != link[1]:
                outside = copy.copy(each)
                outside.name = f"{name}.{each.name}"
                variables.append(outside)
                mapping.append((outside, [(component, each)]))
    description = ModelDescription(
        fmiVersion="2.0",
        modelName="Container",
        instantiationToken="blocks",
        defaultExperiment=DefaultExperiment(startTime="0.0", stopTime="10.0"),
        coSimulation=CoSimulation(fixedInternalStepSize=step),
        unitDefinitions=inside.unitDefinitions,
        typeDefinitions=inside.typeDefinitions,
        modelVariables=variables,
        outputs=[Unknown(variable=each) for each in variables if each.causality == "output"],
    )
    configuration = Configuration(
        parallelDoStep=False,
        modelDescription=description,
        components=list(components.values()),
        connections=[] if link is None else [_connection(components, inside, *link)],
        variableMappings=mapping,
    )
    folder = Path(tempfile.mkdtemp())
    create_container_fmu(configuration, folder, Path(f"{folder}.fmu"))
    shutil.rmtree(folder)
    return f"{folder}.fmu"


def _connection(
    components: Any, inside: Any, source: tuple[str, str], sink: tuple[str, str]
) -> Connection:
    """Connect two Reals."""
    by_name = {each.name: each for each in inside.modelVariables}
    ends = []
    for _, name in (source, sink):
        end = copy.copy(by_name[name])
        # FMPy writes the type as FMI 3.0 names it, but for connections.
        end.type = "Float64"
        ends.append(end)
    return Connection(components[source[0]], ends[:1], components[sink[0]], ends[1:])
