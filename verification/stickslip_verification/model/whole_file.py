"""Writing a file whole or not at all, or several files all or none."""

import secrets
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO

_PART = ".part"


@contextmanager
def replacing(path: Path) -> Iterator[IO[bytes]]:
    """Open a file that takes the place of `path` when the block ends well.

    It is written next to its place, in a folder that exists. Where the block fails, `path` is left
    as it was.

    Raises
    ------
    OSError
        If the file cannot be written, as on a full disk; it names `path`.
    """
    part = path.parent / f".{secrets.token_hex(8)}{_PART}"
    try:
        try:
            with part.open("xb") as stream:
                yield stream
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        # A full disk names no file.
        if error.errno is None or not str(error.filename or _PART).endswith(_PART):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


def write_whole(path: Path, content: str | bytes) -> None:
    """Write `path`, making its folder; an interrupted write leaves the old file as it was."""
    write_all({path: content})


def write_all(files: Mapping[Path, str | bytes]) -> None:
    """Write files as `write_whole` does; none takes its place before all are written."""
    with ExitStack() as stack:
        for path, content in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            # What an FMU said may hold half a character; that must not cost the report.
            whole = content.encode("utf-8", "replace") if isinstance(content, str) else content
            stream = stack.enter_context(replacing(path))
            stream.write(whole)
            # What is still in a buffer might not fit.
            stream.flush()
