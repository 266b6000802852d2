"""The report of a verdict, with what goes into it from elsewhere: meanings, margins."""

from collections.abc import Sequence
from pathlib import Path

from stickslip_verification import (
    Case,
    EarlierReport,
    Verdict,
    compare,
    load_invariants,
    meanings,
    write_json,
    write_report,
)


def write(
    verdict: Verdict,
    cases: Sequence[Case],
    earlier: EarlierReport | None,
    output: Path,
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
    full
        Whether every comparison is printed; else a case that passed is printed as one line.
    """
    if output.suffix == ".json":
        write_json(verdict, output)
        return [output]
    known = meanings(cases, load_invariants())
    moves = None if earlier is None else compare(earlier, verdict)
    write_report(verdict, output, meanings=known, margins=moves, full=full)
    return [output / "index.html", output / "report.json"]
