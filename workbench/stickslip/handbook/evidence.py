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

FOLDER: Final = "extra/org.fmi-standard.fmi-ls-ref/"
MANIFEST: Final = "fmi-ls-manifest.xml"
EXPERIMENTS: Final = "default.experiments.xml"


def evidence(fmu: Path, verdict: "Verdict", law: str) -> dict[str, bytes]:
    """Return the evidence of an FMU by its paths in it; the same for the same FMU and suite.

    The FMU may have evidence already; `verdict` is on it, and `law` the name of its friction law, a
    built-in one. ParameterError or FmuError if it cannot be simulated.
    """
    p = Parameters(law=law)
    run = simulate_fmu(experiment(p, 0.0, STOP_TIME, DEFAULT_STEP), fmu, lambda done, total: None)
    outputs = [row for row in p.table.rows if row.causality == "output" and row.unit != _LEFT_OUT]
    contents = {
        EXPERIMENTS: _xml(EXPERIMENTS, stop=STOP_TIME, tolerance=TOLERANCE, step=DEFAULT_STEP),
        # At every communication point of the experiment.
        "default.csv": csv_bytes(run.samples[["time", *(row.name for row in outputs)]]),
        "report.html": packed_report(verdict).encode(),
    }
    digests = {name: sha3_256(content).hexdigest() for name, content in contents.items()}
    contents[MANIFEST] = _xml(MANIFEST, digests=digests)
    return {FOLDER + name: content for name, content in contents.items()}


def _xml(name: str, **values: object) -> bytes:
    return f"{rendered(name, **values)}\n".encode()
