"""The report of a verdict, with what goes into it from elsewhere: claims, meanings, margins."""

from collections.abc import Sequence
from pathlib import Path

from stickslip_design.claims import draw, findings
from stickslip_verification import (
    Case,
    ClaimSection,
    EarlierReport,
    Verdict,
    compare,
    draw_cases,
    load_invariants,
    meanings,
    render,
    write_json,
    write_pdf,
    write_report,
)


def write(
    verdict: Verdict,
    cases: Sequence[Case],
    earlier: EarlierReport | None,
    output: Path,
    pdf: Path | None,
    *,
    full: bool = False,
) -> list[Path]:
    """Write a report and give the files that a person or a program opens first.

    Parameters
    ----------
    verdict
        What came out.
    cases
        What was tried.
    earlier
        An earlier report to compare margins with, or None.
    output
        Folder of the whole report, or a file ending in .json that gets the JSON alone.
    pdf
        Where the PDF goes, or None.
    full
        Whether every comparison is printed; else a case that passed is printed as one line.
    """
    written = []
    if output.suffix == ".json":
        write_json(verdict, output)
        written.append(output)
    if output.suffix == ".json" and pdf is None:
        return written
    known = meanings(cases, load_invariants())
    moves = None if earlier is None else compare(earlier, verdict)
    claims = _claims()
    drawn = draw_cases(verdict)
    if output.suffix != ".json":
        write_report(
            verdict, output, claims=claims, meanings=known, margins=moves, drawn=drawn, full=full
        )
        written += [output / "index.html", output / "report.json"]
    if pdf is not None:
        page = render(
            verdict, claims=claims, meanings=known, margins=moves, drawn=drawn, full=full,
            compact=not full,
        )  # fmt: skip
        write_pdf(page, pdf)
        written.append(pdf)
    return written


def _claims() -> list[ClaimSection]:
    return [
        ClaimSection(title=each.title, sentence=each.sentence, verdict=each.verdict, svg=draw(each))
        for each in findings()
    ]
