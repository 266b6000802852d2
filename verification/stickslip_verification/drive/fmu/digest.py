"""Digest of an FMU's content; evidence packed into the FMU does not change it."""

import hashlib
import zipfile
from pathlib import Path
from typing import Final

EVIDENCE: Final = "extra/"
"""The folder of an FMU with its evidence, left out of the digest."""


def content_digest(fmu: Path) -> str:
    """Return the SHA-256 of an FMU's content without its extra/ folder, in hexadecimal.

    It is that of the list which ``sha256sum`` prints of the unpacked files, in the order of the
    bytes of their names: how the archive is packed makes no difference.
    """
    with zipfile.ZipFile(fmu) as archive:
        names = (name for name in archive.namelist() if not name.endswith("/"))
        lines = [
            f"{_digest(archive, name)}  {name}\n"
            for name in sorted(names, key=str.encode)
            if not name.startswith(EVIDENCE)
        ]
    return hashlib.sha256("".join(lines).encode()).hexdigest()


def _digest(archive: zipfile.ZipFile, name: str) -> str:
    with archive.open(name) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()  # type: ignore[arg-type]
