"""Packs ServoDrive.fmu: what stands in `servo_drive`, named by its content."""

from pathlib import Path
from typing import Final

import stickslip_fmu.lifetime
from stickslip_fmu.packer import pack, write_archive

HERE: Final = Path(__file__).parent

_SLAVE: Final = """\
from {package}.slave import ServoDrive
from {package}.lifetime import hold

hold(globals())
"""


def build_drive(folder: Path) -> Path:
    """Build ServoDrive.fmu in a folder and return its path."""
    target = folder / "ServoDrive.fmu"
    sources = {file.name: file.read_bytes() for file in (HERE / "servo_drive").glob("*.py")}
    # What the wrapper releases without owning it, the block's FMU has solved.
    sources["lifetime.py"] = Path(stickslip_fmu.lifetime.__file__).read_bytes()
    write_archive(pack("servo_drive_", sources, _SLAVE), target)
    return target
