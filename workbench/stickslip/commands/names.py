"""`stickslip names`: a names file to begin with, for an FMU from elsewhere."""

from pathlib import Path
from typing import Annotated

import typer

from stickslip.errors import CommandError


def names(
    fmu: Annotated[Path, typer.Argument(metavar="FILE.fmu", help="The FMU, 2.0 or 3.0.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="FILE.toml", help="File to write; default: the terminal."
        ),
    ] = None,
) -> None:
    """Write a names file to begin with, for `stickslip verify --names`; the FMU is run for it."""
    from stickslip.files import writing
    from stickslip_verification import FmuError, starter

    if output is not None and output.is_file():
        raise CommandError(f"-o {output}: it is there already, and may have been edited")
    try:
        text = starter(fmu)
    except FmuError as error:
        raise CommandError(str(error)) from error
    if output is None:
        print(text, end="")
        return
    with writing(output, "-o") as stream:
        stream.write(text.encode())
    print(output)
