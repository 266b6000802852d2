"""Unpacks an FMU within limits, into a folder whose name every wrapper can read."""

import contextlib
import tempfile
import zipfile
from pathlib import Path
from typing import Final

import fmpy

from stickslip_verification.drive.fmu.errors import FmuError, one_line

DESCRIPTION = "modelDescription.xml"

MOST_UNPACKED: Final = 2_000_000_000
"""Bytes of all files of an FMU."""

MOST_DESCRIBED: Final = 64_000_000
"""Bytes of a model description; one with 100,000 variables has some 30 million."""

MOST_FILES: Final = 100_000
"""Files and folders of an FMU: empty ones take room as well."""

MOST_RATIO: Final = 200
"""Bytes unpacked for each packed one, in a file and in all; source and binaries reach 10."""

FREE, FREE_IN_ALL = 10_000_000, 100_000_000
"""Bytes of a file, and of all, that may have any ratio: a table of zeros packs to a thousandth."""

_ELSEWHERE: Final = ("/tmp", "/var/tmp")
"""Where to unpack if the folder for temporary files has another name than plain."""


def check_size(path: Path) -> None:
    """Refuse an FMU that unpacks, by what it says, to more than the limits; `FmuError`."""
    with zipfile.ZipFile(path) as archive:
        entries = archive.infolist()
    total = sum(entry.file_size for entry in entries)
    if len(entries) > MOST_FILES:
        raise FmuError(f"{path}: has {len(entries)} files; at most {MOST_FILES} are unpacked")
    if total > MOST_UNPACKED:
        most = _mb(MOST_UNPACKED)
        raise FmuError(f"{path}: unpacks to {_mb(total)}; at most {most} are unpacked")
    for entry in entries:
        if entry.filename == DESCRIPTION and entry.file_size > MOST_DESCRIBED:
            size, most = _mb(entry.file_size), _mb(MOST_DESCRIBED)
            raise FmuError(f"{path}: {DESCRIPTION} has {size}; at most {most} are read")
        if entry.file_size > max(FREE, MOST_RATIO * entry.compress_size):
            raise _grows(path, f"its file {entry.filename!r}", entry.file_size)
    # Packed files may overlap, but the archive has no more bytes than it has.
    if total > max(FREE_IN_ALL, MOST_RATIO * path.stat().st_size):
        raise _grows(path, "it", total)


def unpack(path: Path, folder: Path) -> None:
    """Unpack an FMU that `check_size` lets pass; `FmuError` for damaged files, names elsewhere."""
    try:
        fmpy.extract(path, unzipdir=folder)
    except OSError as error:
        reason = error.strerror or one_line(error)
        raise FmuError(f"{path}: cannot be unpacked into {folder} ({reason})") from None
    except Exception as error:
        raise FmuError(f"{path}: cannot be unpacked ({one_line(error)})") from None


def new_folder() -> Path:
    """Make an empty folder for an FMU; `FmuError` if none can have a name without escapes.

    An FMU gets its folder as a URI, and pythonfmu's wrapper decodes of it ``%20`` alone: any other
    escape, as for an umlaut, ends the process.
    """
    usual = tempfile.gettempdir()
    for parent in (usual, *_ELSEWHERE):
        if "%" not in Path(parent).absolute().as_uri().replace("%20", ""):
            with contextlib.suppress(OSError):
                return Path(tempfile.mkdtemp(prefix="stickslip-fmu-", dir=parent))
    raise FmuError(
        f"{usual}: FMUs made with pythonfmu cannot be unpacked in a folder of this name; "
        "set TMPDIR to one with letters of ASCII and digits"
    )


def _grows(path: Path, what: str, size: int) -> FmuError:
    return FmuError(
        f"{path}: {what} unpacks to {_mb(size)}, more than {MOST_RATIO} times its packed size"
    )


def _mb(size: int) -> str:
    return f"{size / 1e6:,.0f} MB"
