"""`stickslip names`: a names file to begin with, for an FMU from elsewhere."""

from pathlib import Path
from typing import Literal

from stickslip.commands.expanded import command
from stickslip.commands.shared import hand_out
from stickslip.errors import CommandError


@command
def names(fmu: Path, *, interface: Literal["cs", "me"] = "cs", output: Path | None = None) -> None:
    """Write a names file to begin with, for `stickslip verify --names`; the FMU is run for it."""
    from stickslip_verification import starter

    if output is not None and output.exists():
        raise CommandError(f"-o {output}: it is there already, and may have been edited")
    hand_out(starter(fmu, interface), output, "-o")
