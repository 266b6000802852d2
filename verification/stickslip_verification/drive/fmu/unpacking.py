"""A folder to unpack an FMU in, whose name every wrapper can read."""

import tempfile
from pathlib import Path
from typing import Final

from stickslip_verification.drive.fmu.errors import FmuError

_ELSEWHERE: Final = ("/tmp", "/var/tmp")
"""Where to unpack if the folder for temporary files has another name than plain."""


def new_folder() -> Path:
    """Make an empty folder for an FMU.

    An FMU is told its folder as a URI, and pythonfmu's wrapper decodes of it ``%20`` alone: any
    other escape, as for an umlaut, ends the process.

    Raises
    ------
    FmuError
        If there is no folder with a plain name to make it in.
    """
    usual = tempfile.gettempdir()
    for parent in (usual, *_ELSEWHERE):
        if _is_plain(parent):
            try:
                return Path(tempfile.mkdtemp(prefix="stickslip-fmu-", dir=parent))
            except OSError:
                continue
    raise FmuError(
        f"{usual}: FMUs made with pythonfmu cannot be unpacked in a folder of this name; "
        "set TMPDIR to one with letters of ASCII and digits"
    )


def _is_plain(folder: str) -> bool:
    """Whether the URI of a folder has no escape but that of a blank."""
    return "%" not in Path(folder).absolute().as_uri().replace("%20", "")
