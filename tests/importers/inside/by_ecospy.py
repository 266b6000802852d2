"""Ecos through ecospy: a fixed-step simulation, inputs set between steps."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import ecospy
import fmpy

from .containing import BLOCKS, LINK, for_block

_ALONE = ("block",)


def run(fmu: str, case: Any) -> Any:
    """Run a case; the case `restart` twice in one simulation, with its own reset in between."""
    with simulation(fmu, case) as opened:
        [first] = steps(opened, fmu, case)
        if case["name"] != "restart":
            return first
        opened.reset()
        [second] = steps(opened, fmu, case)
        return {**first, "again": second, "how": "reset and init of the same simulation"}


def pair(fmu: str, case: Any) -> Any:
    """Run a case of two blocks in one simulation, the second pushed by the first one's spring."""
    return pair_at(fmu, fmu, case)


def pair_at(uri: str, fmu: str, case: Any) -> Any:
    """Do so with the FMU's address to Ecos."""
    with simulation(uri, case, BLOCKS) as opened:
        first, second = steps(opened, fmu, case, BLOCKS)
    return {**first, "nested": second}


@contextmanager
def simulation(uri: str, case: Any, blocks: tuple[str, ...] = _ALONE) -> Iterator[Any]:
    """Open a simulation, end it in order."""
    with ecospy.EcosSimulationStructure() as structure:
        start = {}
        for block in blocks:
            structure.add_model(block, uri)
            for name, value in for_block(block, case["start"]).items():
                start[f"{block}::{name}"] = value
        structure.add_parameter_set("start", start)
        if len(blocks) > 1:
            structure.make_real_connection(*(f"{block}::{name}" for block, name in LINK))
        with ecospy.EcosSimulation(structure=structure, step_size=case["step"]) as opened:
            yield opened
            opened.terminate()


def steps(opened: Any, fmu: str, case: Any, blocks: tuple[str, ...] = _ALONE) -> list[Any]:
    """Initialize, run a case and return the rows of each block."""
    readers = {"Real": opened.get_real, "Integer": opened.get_integer, "Boolean": opened.get_bool}
    outputs = [
        (each.name, readers[each.type])
        for each in fmpy.read_model_description(fmu).modelVariables
        if each.causality == "output"
    ]
    rows: dict[str, Any] = {
        block: {"times": [], "outputs": {name: [] for name, _ in outputs}} for block in blocks
    }

    def look() -> None:
        for block, of_block in rows.items():
            of_block["times"].append(opened.get_time())
            for name, read in outputs:
                of_block["outputs"][name].append(read(f"{block}::{name}"))

    assert opened.init(parameter_set="start")
    look()
    for number in range(case["steps"]):
        for block in blocks:
            changes = for_block(block, case["changes"].get(str(number), {}))
            for name, value in changes.items():
                opened.set_real(f"{block}::{name}", value)
        opened.step()
        look()
    return list(rows.values())
