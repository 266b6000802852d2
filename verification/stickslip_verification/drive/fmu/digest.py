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
    lines = ""
    with zipfile.ZipFile(fmu) as archive:
        for name in sorted(archive.namelist(), key=str.encode):
            if not name.endswith("/") and not name.startswith(EVIDENCE):
                with archive.open(name) as stream:
                    digest = hashlib.file_digest(stream, "sha256")  # type: ignore[arg-type]
                lines += f"{digest.hexdigest()}  {name}\n"
    return hashlib.sha256(lines.encode()).hexdigest()
