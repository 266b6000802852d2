"""The default experiment of the FMU: how to run it, and what the FMU gives there."""

from pathlib import Path
from typing import Final
from xml.etree.ElementTree import Element, SubElement

from stickslip.handbook.evidence.xml_file import xml_file
from stickslip.parameters import Parameters
from stickslip.runs.csv_file import csv_bytes
from stickslip.runs.engines import DEFAULT_STEP, experiment, simulate_fmu

STOP_TIME: Final = 10.0
TOLERANCE: Final = 1e-9
"""What an importer may differ by, of the largest value: it may reach its points a rounding off."""

_LEFT_OUT: Final = "J"
"""The unit of the energy account: a third of the packed file, and it follows from the rest."""


def result_file(fmu: Path, law: str) -> bytes:
    """Return the outputs of the FMU at every communication point of the experiment, as CSV.

    `law` is the name of its friction law.

    Raises
    ------
    ParameterError, FmuError
        If the FMU cannot be simulated.
    """
    p = Parameters(law=law)
    what = experiment(p, 0.0, STOP_TIME, DEFAULT_STEP)
    run = simulate_fmu(what, fmu, lambda done, total: None)
    names = [
        row.name for row in p.table.rows if row.causality == "output" and row.unit != _LEFT_OUT
    ]
    return csv_bytes(run.samples[["time", *names]])


def experiment_file(result: str) -> bytes:
    """Return the description of the experiment; `result` names the file with its result."""
    root = Element("Experiments", {"name": "Default experiment"})
    run = SubElement(
        root,
        "Experiment",
        {
            "name": "default",
            "description": "The block as it comes, with all start values.",
            "startTime": "0.0",
            "stopTime": repr(STOP_TIME),
            "tolerance": repr(TOLERANCE),
            "stepSize": repr(DEFAULT_STEP),
        },
    )
    SubElement(run, "References", {"source": result, "type": "text/csv"})
    return xml_file(root)
