"""The report that travels in the FMU: the verdict on one page, without plots, date or place."""

from stickslip_verification.model.verdict import SEQUENCE, CheckResult, Verdict
from stickslip_verification.report import words
from stickslip_verification.report.environment import environment, text_of

SHOWN = "default"
"""The case that the page shows comparison by comparison: it is the one that runs as it comes."""

_NAMES = {"2.0": "StickSlip.fmu", "3.0": "StickSlip_fmi3.fmu"}
"""However the file is called now: that is no part of what it holds."""


def packed_report(verdict: Verdict) -> str:
    """Return the report that goes into the FMU it judges.

    It names the FMU by the digest of its content without extra/, so that it can be put there, and
    carries neither date nor place: the same FMU and the same suite give the same bytes.

    Parameters
    ----------
    verdict
        What came out, for our own FMU.
    """
    cases: dict[str, list[CheckResult]] = {SHOWN: []}
    for result in verdict.checks:
        drawn = result.case.startswith(SEQUENCE)
        name = "random sequences" if drawn else result.case or "the FMU itself"
        cases.setdefault(name, []).append(result)
    return environment().get_template("packed.html.j2").render(
        verdict=verdict,
        name=_NAMES[verdict.provenance["fmu"]["fmi_version"]],
        sentence=words.sentence(verdict),
        cases={name: results for name, results in cases.items() if results},
        titles={motion.case: motion.title for motion in verdict.motions},
        shown=[(n, r) for n, r in enumerate(cases[SHOWN]) if r.side == "fmu"],
        style=text_of("style.css"),
    )  # fmt: skip
