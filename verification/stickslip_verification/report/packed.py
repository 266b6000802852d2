"""The report that travels in the FMU: the verdict on one page, without plots, date or place."""

from collections.abc import Sequence
from dataclasses import replace

from stickslip_verification.model.margins import error_text, margin_of
from stickslip_verification.model.verdict import CheckResult, Outcome, Verdict, count
from stickslip_verification.report import view
from stickslip_verification.report.environment import environment, text_of
from stickslip_verification.report.words import KINDS, WORTH

SHOWN = "default"
"""The case that the page shows comparison by comparison: it is the one that runs as it comes."""

_NAMES = {"2.0": "StickSlip.fmu", "3.0": "StickSlip_fmi3.fmu"}


def packed_report(verdict: Verdict) -> str:
    """Return the report that goes into the FMU it judges.

    It names the FMU by the digest of its content without extra/, so that it can be put there, and
    carries neither date nor place: the same FMU and the same suite give the same bytes.

    Parameters
    ----------
    verdict
        What came out, for our own FMU.
    """
    fmu = verdict.provenance["fmu"]
    return environment().get_template("packed.html.j2").render(
        word="pass" if verdict.passed else "fail",
        # However the file is called now: that is no part of what it holds.
        name=_NAMES[fmu["fmi_version"]],
        fmu=fmu,
        total=len(verdict.checks),
        summary=verdict.summary,
        kinds=[(KINDS[kind], WORTH[kind], numbers) for kind, numbers in verdict.by_kind.items()],
        cases=[_case(verdict, case) for case in dict.fromkeys(r.case for r in verdict.checks)],
        shown=view.case_views(_shown(verdict), {}, frozenset()),
        versions=verdict.provenance["versions"],
        style=text_of("packed.css"),
    )  # fmt: skip


def _case(verdict: Verdict, case: str) -> dict[str, object]:
    """Return one row: how many comparisons of a case hold, on each side, and which is nearest."""
    results = [result for result in verdict.checks if result.case == case]
    title = next((motion.title for motion in verdict.motions if motion.case == case), "")
    of_fmu = [
        result for result in results if result.side == "fmu" and result.verdict == Outcome.PASS
    ]
    nearest = max(of_fmu, key=lambda result: margin_of(result) or 0.0, default=None)
    return {
        "id": view.case_name(case),
        "title": title or "what it declares, refuses and promises",
        "sides": [_held(results, side) for side in ("fmu", "reference", "both")],
        "nearest": "" if nearest is None else nearest.check,
        "margin": "" if nearest is None else error_text(margin_of(nearest)),
    }


def _held(results: Sequence[CheckResult], side: str) -> str:
    counts = count([result for result in results if result.side == side])
    judged = counts["passed"] + counts["failed"]
    return f"{counts['passed']} of {judged}" if judged else ""


def _shown(verdict: Verdict) -> Verdict:
    """Return the verdict with nothing but what the FMU did in the case that is shown."""
    checks = [each for each in verdict.checks if each.case == SHOWN and each.side == "fmu"]
    return replace(verdict, checks=checks)
