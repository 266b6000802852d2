"""What the FMU carries as evidence: an experiment, its result, and the report of the suite.

They are in the folder extra/org.fmi-standard.fmi-ls-ref/ of the FMU, with the manifest of the FMI
layered standard FMI-LS-REF, draft 1.0.0-alpha.1.
"""

from hashlib import sha3_256
from pathlib import Path
from typing import TYPE_CHECKING, Final

from stickslip.handbook.parts import rendered
from stickslip.parameters import Parameters
from stickslip.runs import DEFAULT_STEP, csv_bytes, experiment, simulate_fmu
from stickslip_verification import packed_report

if TYPE_CHECKING:
    from stickslip_verification import Verdict


STOP_TIME: Final = 10.0
TOLERANCE: Final = 1e-9
"""What an importer may differ by, of the largest value: it may reach its points a rounding off."""

_LEFT_OUT: Final = "J"
"""The unit of the energy account: a third of the packed file, and it follows from the rest."""


def result_file(fmu: Path, law: str) -> bytes:
    """Return the outputs of the FMU at every communication point of the experiment, as CSV."""
    p = Parameters(law=law)
    what = experiment(p, 0.0, STOP_TIME, DEFAULT_STEP)
    run = simulate_fmu(what, fmu, lambda done, total: None)
    names = [
        row.name for row in p.table.rows if row.causality == "output" and row.unit != _LEFT_OUT
    ]
    return csv_bytes(run.samples[["time", *names]])


FOLDER: Final = "extra/org.fmi-standard.fmi-ls-ref/"
MANIFEST: Final = "fmi-ls-manifest.xml"
EXPERIMENTS: Final = "default.experiments.xml"


def evidence(fmu: Path, verdict: "Verdict", law: str) -> dict[str, bytes]:
    """Return the evidence of an FMU by its paths in it; the same for the same FMU and suite.

    The FMU may have evidence already; `verdict` is on it, and `law` the name of its friction law, a
    built-in one. ParameterError or FmuError if it cannot be simulated.
    """
    contents = {
        EXPERIMENTS: _xml(EXPERIMENTS, stop=STOP_TIME, tolerance=TOLERANCE, step=DEFAULT_STEP),
        "default.csv": result_file(fmu, law),
        "report.html": packed_report(verdict).encode(),
    }
    digests = {name: sha3_256(content).hexdigest() for name, content in contents.items()}
    contents[MANIFEST] = _xml(MANIFEST, digests=digests)
    return {FOLDER + name: content for name, content in contents.items()}


def _xml(name: str, **values: object) -> bytes:
    return f"{rendered(name, **values)}\n".encode()
