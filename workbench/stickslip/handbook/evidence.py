"""What the FMU carries as evidence: an experiment, its result, and the report of the suite.

They are in the folder extra/org.fmi-standard.fmi-ls-ref/ of the FMU, with the manifest of the FMI
layered standard FMI-LS-REF, draft 1.0.0-alpha.1.
"""

from hashlib import sha3_256
from pathlib import Path
from typing import TYPE_CHECKING, Final

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
_EXPERIMENTS: Final = f"""\
<?xml version='1.0' encoding='utf-8'?>
<Experiments name="Default experiment">
  <Experiment name="default" description="The block as it comes, with all start values."\
 startTime="0.0" stopTime="{STOP_TIME!r}" tolerance="{TOLERANCE!r}" stepSize="{DEFAULT_STEP!r}">
    <References source="default.csv" type="text/csv" />
  </Experiment>
</Experiments>
"""
# The draft fixes the words of its description.
_MANIFEST: Final = """\
<?xml version='1.0' encoding='utf-8'?>
<fmiReferences xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"\
 fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-ref" fmi-ls:fmi-ls-version="1.0.0-alpha.1"\
 fmi-ls:fmi-ls-description="Layered Standard providing information on related files included in an\
 FMU.">
{}</fmiReferences>
"""
_RELATED: Final = """\
  <Related type="{}" source="{}" role="{}" description="{}" checksum="{}" checksumType="SHA3-256" />
"""
_ABOUT: Final = {
    "default.experiments.xml": (
        "application/x-ma-ls-experiments",
        "experiment/smoke-test",
        "The default experiment: 10 s at steps of 0.01 s, start values as they are.",
    ),
    "default.csv": (
        "text/csv",
        "result",
        "What this FMU gave in the default experiment, at every communication point, SI units.",
    ),
    "report.html": (
        "text/html",
        "report",
        "The verification of this FMU against exact solutions, with the digest of its content.",
    ),
}
"""Media type, role and description of each file."""


def evidence(fmu: Path, verdict: "Verdict", law: str) -> dict[str, bytes]:
    """Return the evidence of an FMU by its paths in it; the same for the same FMU and suite.

    The FMU may have evidence already; `verdict` is on it, and `law` the name of its friction law, a
    built-in one. ParameterError or FmuError if it cannot be simulated.
    """
    contents = {
        "default.experiments.xml": _EXPERIMENTS.encode(),
        "default.csv": result_file(fmu, law),
        "report.html": packed_report(verdict).encode(),
    }
    rows = (
        _RELATED.format(kind, name, role, words, sha3_256(contents[name]).hexdigest())
        for name, (kind, role, words) in _ABOUT.items()
    )
    contents[MANIFEST] = _MANIFEST.format("".join(rows)).encode()
    return {FOLDER + name: content for name, content in contents.items()}
