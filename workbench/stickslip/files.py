"""Files written whole or not at all, and what is no file written as it is."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from stickslip.errors import CommandError

_MOST_LINKS: Final = 40
"""Links in a row that Linux follows before it takes them for a circle."""


def write(target: Path, content: bytes, option: str) -> None:
    """Write a file, so that it is there whole or as it was before.

    A regular file, at the end of all links, is written beside its place and put there. Anything
    else (a device, a pipe, /dev/stdout) is written into directly. `CommandError`, which names
    `option` and `target`, if it cannot be written.
    """
    from stickslip_verification import replacing

    check_writable(target, option)
    with refused(target, option):
        descriptor = _own_descriptor(target)
        if descriptor is not None:
            # Opened by name, a redirected output would begin again at its first byte.
            with os.fdopen(os.dup(descriptor), "wb") as stream:
                stream.write(content)
        elif _is_special(target):
            target.write_bytes(content)
        else:
            with replacing(target.resolve()) as stream:
                stream.write(content)


def check_writable(target: Path, option: str) -> None:
    """Raise a `CommandError` unless `target` can be written: known before a long run, not after."""
    with refused(target, option):
        if obstacle := _obstacle(target):
            raise OSError(0, obstacle)


def check_drawable(target: Path, option: str) -> None:
    """Raise a `CommandError` that names `option` unless the suffix is one that can be drawn."""
    if target.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise CommandError(
            f"{option} {target}: unknown format {target.suffix!r}; expected .png, .svg or .pdf"
        )


def _obstacle(target: Path) -> str | None:
    descriptor = _own_descriptor(target)
    if descriptor is not None:
        os.fstat(descriptor)
        return None
    if target.is_dir():
        return "it is a folder"
    if _is_special(target):
        return None if os.access(target, os.W_OK) else "it is not writable"
    folder = target.resolve().parent if target.is_symlink() else target.parent
    if not folder.is_dir():
        return f"there is no folder {folder}"
    if not os.access(folder, os.W_OK | os.X_OK):
        return f"the folder {folder} is not writable"
    return None


def _own_descriptor(target: Path) -> int | None:
    """Return the descriptor of this process that a name like /dev/stdout means, else None."""
    descriptors = (Path(f"/proc/{os.getpid()}/fd"), Path("/dev/fd"))
    path = target
    for _ in range(_MOST_LINKS):
        if path.name.isdecimal() and path.parent.resolve() in descriptors:
            return int(path.name)
        if not path.is_symlink():
            return None
        path = path.parent / path.readlink()
    return None


def _is_special(target: Path) -> bool:
    try:
        return not stat.S_ISREG(target.stat().st_mode)
    except FileNotFoundError:
        return False


def make_folder(folder: Path, option: str) -> None:
    """Make `folder` and those above it where they are missing; `CommandError` if it cannot be."""
    with refused(folder, option, "make the folder"):
        folder.mkdir(parents=True, exist_ok=True)


@contextmanager
def refused(target: Path | str, option: str, what: str = "write the file") -> Iterator[None]:
    """Make a `CommandError` of the `OSError` of the block; it names `option` and `target`."""
    try:
        yield
    except OSError as error:
        # The text of the error itself may name the temporary file.
        reason = error.strerror or type(error).__name__
        raise CommandError(f"{option} {target}: cannot {what}: {reason}") from error
