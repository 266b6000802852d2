"""The folder extra/org.fmi-standard.fmi-ls-ref/ of the FMU, made from the FMU without it."""

from pathlib import Path
from typing import TYPE_CHECKING, Final

from stickslip.handbook.evidence.experiment import experiment_file, result_file
from stickslip.handbook.evidence.manifest import FOLDER, MANIFEST, Related, manifest
from stickslip_verification import packed_report

if TYPE_CHECKING:
    from stickslip_verification import Verdict

_EXPERIMENT: Final = "default.experiments.xml"
_RESULT: Final = "default.csv"
_REPORT: Final = "report.html"

_RELATED: Final = {
    _EXPERIMENT: Related(
        "application/x-ma-ls-experiments",
        "experiment/smoke-test",
        "The default experiment: 10 s at steps of 0.01 s, start values as they are.",
    ),
    _RESULT: Related(
        "text/csv",
        "result",
        "What this FMU gave in the default experiment, at every communication point, SI units.",
    ),
    _REPORT: Related(
        "text/html",
        "report",
        "The verification of this FMU against exact solutions, with the digest of its content.",
    ),
}


def evidence(fmu: Path, verdict: "Verdict", law: str) -> dict[str, bytes]:
    """Return the evidence of an FMU by its paths in it; the same for the same FMU and suite.

    Parameters
    ----------
    fmu
        The FMU, with evidence in it or without.
    verdict
        What the suite found of that FMU.
    law
        The name of its friction law, a built-in one.

    Raises
    ------
    CommandError
        If the FMU cannot be simulated.
    """
    contents = {
        _EXPERIMENT: experiment_file(_RESULT),
        _RESULT: result_file(fmu, law),
        _REPORT: packed_report(verdict).encode(),
    }
    contents[MANIFEST] = manifest(_RELATED, contents)
    return {FOLDER + name: content for name, content in contents.items()}
