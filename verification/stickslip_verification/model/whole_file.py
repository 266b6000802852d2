"""Writing a file whole or not at all."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO


@contextmanager
def replacing(path: Path) -> Iterator[IO[bytes]]:
    """Open a file that takes the place of `path` when the block ends well.

    It is written beside its place, in a folder that exists. Where the block fails, `path` is left
    as it was. The permissions are those of a file that this process makes.
    """
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=".part")
    part = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            yield stream
        part.chmod(0o666 & ~_umask())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def write_whole(path: Path, content: str | bytes) -> None:
    """Write `path`, making its folder; an interrupted write leaves the old file as it was."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as file:
        # What an FMU said may hold half a character; that must not cost the report.
        file.write(content.encode("utf-8", "replace") if isinstance(content, str) else content)


def _umask() -> int:
    # A temporary file is private; the file that was asked for is not. It can only be read by
    # setting it.
    mask = os.umask(0)
    os.umask(mask)
    return mask
