"""`stickslip prove`: the random tests of the specification."""

from pathlib import Path
from typing import Annotated

import typer

from stickslip.commands.shared import console, current_fmu, long_work
from stickslip.errors import CommandError


def prove(
    fmu: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="The FMU to test; default: build/StickSlip.fmu, built anew."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the random settings.")] = 1,
    fraction: Annotated[
        float, typer.Option(help="Share of the full random sets, above 0, at most 1.")
    ] = 1.0,
) -> None:
    """Check FMU and reference on random settings; exit 0 if all statements hold, else 1."""
    from stickslip.show.random_test_table import random_test_table
    from stickslip_verification import FmuError
    from stickslip_verification import prove as prove_all

    if not 0.0 < fraction <= 1.0:
        raise CommandError(f"--fraction {fraction!r}: must be above 0 and at most 1")
    if fmu is None:
        fmu = current_fmu()
    with long_work("Running random tests", here=True) as progress:
        try:
            results = prove_all(fmu, seed, fraction, progress)
        except FmuError as error:
            raise CommandError(str(error)) from error
    console().print(random_test_table(results))
    if not all(each.passed for each in results):
        raise typer.Exit(1)
