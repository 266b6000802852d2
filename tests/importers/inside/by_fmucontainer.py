"""Two blocks nested by `fmucontainer` of fmu-manipulation-toolbox, the container run by FMPy.

The spring force of the first block acts as external force on the second.
"""

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import fmpy
from fmu_manipulation_toolbox.cli.fmucontainer import fmucontainer

from . import by_fmpy
from .containing import BLOCKS, LINK, both, of_both, split


def run(fmu: str, case: Any) -> Any:
    """Nest the FMU twice, run a case in the container; `restart` by fmi2Reset of the container."""
    return _run(fmu, case, nest(fmu, case["step"]))


def in_threads(fmu: str, case: Any) -> Any:
    """Do the same, each block stepped in a thread of its own."""
    return _run(fmu, case, nest(fmu, case["step"], threads=True))


def _run(fmu: str, case: Any, container: str) -> Any:
    outputs = by_fmpy.outputs(fmu)
    return split(by_fmpy.runs(container, both(case), of_both(outputs)), outputs)


def nest(
    fmu: str,
    step: float,
    blocks: tuple[str, ...] = BLOCKS,
    link: tuple[tuple[str, str], tuple[str, str]] | None = LINK,
    *,
    threads: bool = False,
) -> str:
    """Call `fmucontainer` on a description of the container and return the FMU it made."""
    ends = link or ()
    exposed: dict[str, list[list[str]]] = {"input": [], "output": []}
    for block in blocks:
        for each in fmpy.read_model_description(fmu).modelVariables:
            # An output that is linked is shown without being asked for.
            if (block, each.name) not in ends and each.causality in exposed:
                inside, outside = [f"{block}.fmu", each.name], f"{block}.{each.name}"
                both_ways = {"input": [outside, *inside], "output": [*inside, outside]}
                exposed[each.causality].append(both_ways[each.causality])
    files = [f"{block}.fmu" for block in blocks]
    links = [[f"{block}.fmu", name] for block, name in ends]
    description = {
        "name": "container.fmu",
        "step_size": step,
        "mt": threads,
        "fmu": files,
        "path": dict.fromkeys(files, fmu),
        "auto_link": False,
        "auto_input": False,
        "auto_output": False,
        "auto_parameter": True,
        "link": [[*links[0], *links[1]]] if links else [],
        **exposed,
    }
    folder = Path(tempfile.mkdtemp())
    written = folder / "container.json"
    written.write_text(json.dumps(description), encoding="utf-8")
    # As the command does, but that it is not loaded anew each time.
    sys.argv = ["fmucontainer", "-container", str(written), "-fmu-directory", str(folder)]
    fmucontainer()
    return str(folder / "container.fmu")
