"""Files written whole or not at all."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from stickslip.errors import CommandError


@contextmanager
def replacing(target: Path, option: str) -> Iterator[Path]:
    """Give a temporary file beside `target` that takes its place when the block ends well.

    If the block raises, the temporary file is removed and `target` is as it was before.

    Parameters
    ----------
    target
        The file to write.
    option
        The option that named it, for the message.

    Yields
    ------
    Path
        The temporary file, in the folder of `target` and with its suffix.

    Raises
    ------
    CommandError
        If the folder is missing or the file cannot be written.
    """
    check_writable(target, option)
    try:
        handle, name = tempfile.mkstemp(
            prefix=f".{target.stem}-", suffix=target.suffix, dir=target.parent
        )
        os.close(handle)
        temporary = Path(name)
        try:
            yield temporary
            temporary.chmod(0o666 & ~_umask())
            temporary.replace(target)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise _cannot_write(target, option, error.strerror or str(error)) from error


def check_writable(target: Path, option: str) -> None:
    """Raise a `CommandError` unless `target` can be written: known before a long run, not after.

    Parameters
    ----------
    target
        The file that is going to be written.
    option
        The option that named it, for the message.
    """
    if target.is_dir():
        raise _cannot_write(target, option, "it is a folder")
    if not target.parent.is_dir():
        raise _cannot_write(target, option, f"there is no folder {target.parent}")
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise _cannot_write(target, option, f"the folder {target.parent} is not writable")


def make_folder(folder: Path, option: str) -> None:
    """Make `folder` and those above it where they are missing.

    Raises
    ------
    CommandError
        If that is not possible; the message names `option`.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise CommandError(f"{option} {folder}: cannot make the folder: {reason}") from error


def _cannot_write(target: Path, option: str, reason: str) -> CommandError:
    return CommandError(f"{option} {target}: cannot write the file: {reason}")


def _umask() -> int:
    # A temporary file is private; the file that the person asked for is not.
    mask = os.umask(0)
    os.umask(mask)
    return mask
