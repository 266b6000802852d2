"""Packs ServoDrive.fmu: the modules of `servo_drive` and fmi, named by their content."""

from pathlib import Path
from typing import Final

from fmi.packer import build_fmu

_MAIN: Final = "from examples.feed_axis.servo_drive.model import SPEC"


def build_drive(folder: Path) -> Path:
    """Build ServoDrive.fmu in a folder and return its path."""
    return build_fmu(_MAIN, folder / "ServoDrive.fmu", "servo_drive_")
