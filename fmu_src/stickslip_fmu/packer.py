"""Builds StickSlip.fmu from the specification of the block."""

from pathlib import Path
from typing import Literal, Mapping, Optional

from fmukit import packer

from .spec import SPEC

MAIN = "from stickslip_fmu.spec import SPEC"
"""What is packed: the text of a module that defines SPEC."""

_FILE_NAMES = {2: f"{SPEC.name}.fmu", 3: f"{SPEC.name}_fmi3.fmu"}


def build(
    destination: Path, parts: Optional[Mapping[str, bytes]] = None, face: Literal[2, 3] = 2
) -> Path:
    """Build the FMU.

    Parameters
    ----------
    destination
        The file to write, ending in .fmu, or the folder that gets StickSlip.fmu, and for FMI 3.0
        StickSlip_fmi3.fmu. Folders are made. What was there stays until the new file is whole.
    parts
        Files that travel beside what is built here, such as documentation/index.html, by their
        path in the FMU.
    face
        The major version of FMI.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    OSError
        If it cannot be written.
    ValueError
        If SOURCE_DATE_EPOCH is set to something else than whole seconds.
    """
    target = destination if destination.suffix == ".fmu" else destination / _FILE_NAMES[face]
    return packer.build_fmu(MAIN, target, "stickslip_fmu_", parts, face)
