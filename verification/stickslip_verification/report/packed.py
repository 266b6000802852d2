"""The report that travels in the FMU: the verdict on one page, without plots, date or place."""

from collections.abc import Iterator, Sequence

from stickslip_verification.model.margins import error_text, margin_of
from stickslip_verification.model.verdict import SEQUENCE, CheckResult, Outcome, Verdict, count
from stickslip_verification.report import first_screen, view
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
        sentence=first_screen.sentence(verdict),
        fmu=fmu,
        total=len(verdict.checks),
        summary=verdict.summary,
        kinds=[(KINDS[kind], WORTH[kind], numbers) for kind, numbers in verdict.by_kind.items()],
        contract=verdict.contract,
        tables=[view.table_view(table) for table in verdict.tables],
        cases=list(_rows(verdict)),
        shown=view.rows_of([r for r in verdict.checks if r.case == SHOWN and r.side == "fmu"]),
        versions=verdict.provenance["versions"],
        style=text_of("packed.css"),
    )  # fmt: skip


def _rows(verdict: Verdict) -> Iterator[dict[str, object]]:
    """Yield one row a case, the default one first, then one for all random sequences."""
    titles = {motion.case: motion.title for motion in verdict.motions}
    results: dict[str, list[CheckResult]] = {}
    for result in verdict.checks:
        of_sequence = result.case.startswith(SEQUENCE)
        name = "random sequences" if of_sequence else view.case_name(result.case)
        results.setdefault(name, []).append(result)
    for name in sorted(results, key=lambda name: name != SHOWN):
        of_fmu = [r for r in results[name] if r.side == "fmu" and r.verdict == Outcome.PASS]
        nearest = max(of_fmu, key=lambda result: margin_of(result) or 0.0, default=None)
        yield {
            "id": name,
            "title": titles.get(name, ""),
            "sides": [_held(results[name], side) for side in ("fmu", "reference", "both")],
            "nearest": "" if nearest is None else nearest.check,
            "margin": "" if nearest is None else error_text(margin_of(nearest)),
        }


def _held(results: Sequence[CheckResult], side: str) -> str:
    counts = count([result for result in results if result.side == side])
    judged = counts["passed"] + counts["failed"]
    return f"{counts['passed']} of {judged}" if judged else ""
