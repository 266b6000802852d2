"""`stickslip names`: a names file to begin with, for an FMU from elsewhere."""

from pathlib import Path
from typing import Annotated

import typer

from stickslip.commands.expanded import command
from stickslip.commands.shared import hand_out
from stickslip.errors import CommandError


@command
def names(
    *,
    fmu: Annotated[Path, typer.Argument(metavar="FILE.fmu", help="The FMU, 2.0 or 3.0.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="FILE.toml", help="File to write; default: the terminal."
        ),
    ] = None,
) -> None:
    """Write a names file to begin with, for `stickslip verify --names`; the FMU is run for it."""
    from stickslip_verification import starter

    if output is not None and output.exists():
        raise CommandError(f"-o {output}: it is there already, and may have been edited")
    hand_out(starter(fmu), output, "-o")
