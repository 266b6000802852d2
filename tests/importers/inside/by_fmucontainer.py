"""A container made by `fmucontainer` of fmu-manipulation-toolbox."""

import itertools
import json
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
from fmu_manipulation_toolbox.cli.fmucontainer import fmucontainer

from tests.importers.cases import STEP

from .by_fmpy import Fmpy
from .simulation import LINK, PAIR


class Fmucontainer(Fmpy):
    """A container with a pair, or for each block a container of its own, which FMPy runs.

    Blocks are stepped one after the other, or each in a thread of its own.
    """

    threads = False

    def made(self) -> str:
        return self.nest(self.fmu, PAIR if self.blocks == PAIR else PAIR[:1], self.threads)

    def of_blocks(self, instantiate: Any) -> dict[str, Any]:
        if self.blocks == PAIR:
            return dict.fromkeys(PAIR, instantiate())
        return super().of_blocks(instantiate)

    def named(self, name: str, block: str) -> Any:
        return self.variables[f"{block if self.blocks == PAIR else PAIR[0]}.{name}"]

    @classmethod
    def in_threads(cls, fmu: str, case: Any) -> Any:
        return type("InThreads", (cls,), {"threads": True}).pair(fmu, case)  # type: ignore[attr-defined]

    @staticmethod
    @cache
    def nest(fmu: str, blocks: tuple[str, ...], threads: bool) -> str:
        linked = LINK if blocks == PAIR else ()
        exposed: dict[str, list[list[str]]] = {"input": [], "output": []}
        variables = fmpy.read_model_description(fmu).modelVariables
        # An output that is linked is shown without being asked for.
        for block, each in itertools.product(blocks, variables):
            if each.causality in exposed and (block, each.name) not in linked:
                outside, inside = [f"{block}.{each.name}"], [f"{block}.fmu", each.name]
                ends = outside + inside if each.causality == "input" else inside + outside
                exposed[each.causality].append(ends)
        files = [f"{block}.fmu" for block in blocks]
        description = {
            "name": "container.fmu",
            "step_size": STEP,
            "mt": threads,
            "fmu": files,
            "path": dict.fromkeys(files, fmu),
            "auto_link": False,
            "auto_input": False,
            "auto_output": False,
            "auto_parameter": True,
            "link": [["a.fmu", "F", "b.fmu", "F_ext"]] if linked else [],
            **exposed,
        }
        folder = Path(tempfile.mkdtemp())
        written = folder / "container.json"
        written.write_text(json.dumps(description), encoding="utf-8")
        # As the command does, but that it is not loaded anew each time.
        sys.argv = ["fmucontainer", "-container", str(written), "-fmu-directory", str(folder)]
        fmucontainer()
        return str(folder / "container.fmu")


SIMULATION = Fmucontainer
