"""`stickslip build`: the FMU as a file."""

from pathlib import Path
from typing import Annotated

import typer

from stickslip.commands.shared import DEFAULT_FMU, build_fmu


def build(
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="DIR|FILE.fmu", help="Folder or file to write."),
    ] = DEFAULT_FMU,
) -> None:
    """Build the FMU; print its path, size and SHA-256."""
    import hashlib

    fmu = build_fmu(output, "-o")
    content = fmu.read_bytes()
    print(f"{fmu}  {len(content)} bytes  SHA-256 {hashlib.sha256(content).hexdigest()}")
