"""`stickslip lint`: the suite's own data files, checked."""

from pathlib import Path
from typing import Annotated

import typer

from stickslip.errors import CommandError


def lint(
    cases: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="The folder of cases; default: those of the suite."),
    ] = None,
) -> None:
    """Check the suite's data files: ids, units, reasons, sources; exit 1 if wrong."""
    from stickslip.progress import Meter
    from stickslip_verification import lint as findings_of

    if cases is not None and not cases.is_dir():
        raise CommandError(f"--cases {cases}: no such folder")
    with Meter("Checking the data files, about a minute"):
        findings = findings_of() if cases is None else findings_of(cases)
    for finding in findings:
        print(finding)
    print(f"{len(findings)} findings")
    if findings:
        raise typer.Exit(1)
