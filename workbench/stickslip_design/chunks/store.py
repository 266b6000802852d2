"""Folders and addresses of fsspec as stores of files, each of them there whole or not at all."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from pathlib import Path
from typing import IO, Final, Protocol
from uuid import uuid4

from stickslip_verification import replacing

from ..datasets import ExtraMissingError, need
from .study import StudyError

LOCK: Final = ".lock"
"""File of a folder that is locked while a process computes a study in it."""
PART: Final = ".part"
"""End of the name of a file that is not whole yet; the name begins with a dot."""


class Store(Protocol):
    """Where the files of a study are.

    Attributes
    ----------
    address
        The folder or address, which means the same in another process.

    Every method raises `OSError` where the store refuses.
    """

    address: str

    def names(self) -> set[str]:
        """Return the names of all that is there; empty if there is no such folder."""

    def read(self, name: str) -> bytes:
        """Return the content of a file."""

    def write(self, name: str, content: bytes) -> None:
        """Write a file, whole or not at all."""

    def remove(self, name: str) -> None:
        """Remove a file."""

    def locked(self) -> AbstractContextManager[None]:
        """Keep other processes from the study that is here, where the store has locks."""


class _Folder:
    """A folder of this machine, or one that it mounts."""

    def __init__(self, address: str) -> None:
        self._path = Path(address).resolve()
        self.address = str(self._path)

    def names(self) -> set[str]:
        try:
            return {entry.name for entry in self._path.iterdir()}
        except FileNotFoundError:
            return set()

    def read(self, name: str) -> bytes:
        return (self._path / name).read_bytes()

    def write(self, name: str, content: bytes) -> None:
        with replacing(self._path / name) as stream:
            stream.write(content)

    def remove(self, name: str) -> None:
        (self._path / name).unlink(missing_ok=True)

    @contextmanager
    def locked(self) -> Iterator[None]:
        self._path.mkdir(parents=True, exist_ok=True)
        with (self._path / LOCK).open("ab") as stream:
            try:
                _lock(stream)
            except OSError as error:
                raise StudyError(
                    f"{self.address}: another process computes a study here; wait for its end, or "
                    "name another folder"
                ) from error
            yield


def _lock(stream: IO[bytes]) -> None:
    """Lock a file till it is closed, at the latest by the end of this process."""
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)


class _Address:
    """An address of fsspec, such as s3://bucket/study. It has no locks."""

    def __init__(self, address: str) -> None:
        self.address = address.rstrip("/")
        self._system, self._path = need("fsspec.core").url_to_fs(self.address)

    def names(self) -> set[str]:
        # Other processes write there too, and some systems keep a list.
        self._system.invalidate_cache()
        try:
            found = self._system.ls(self._path, detail=False)
        except FileNotFoundError:
            return set()
        return {each.rstrip("/").rpartition("/")[2] for each in found}

    def read(self, name: str) -> bytes:
        return bytes(self._system.cat_file(self._at(name)))

    def write(self, name: str, content: bytes) -> None:
        part = self._at(f".{uuid4().hex}{PART}")
        try:
            self._system.makedirs(self._path, exist_ok=True)
            self._system.pipe_file(part, content)
            self._system.mv(part, self._at(name))
        except BaseException as error:
            with suppress(OSError):
                self._system.rm_file(part)
            if isinstance(error, OSError) and error.errno is not None:
                shown = f"{self.address}/{name}"
                raise OSError(error.errno, error.strerror or str(error), shown) from error
            raise

    def remove(self, name: str) -> None:
        self._system.rm_file(self._at(name))

    def locked(self) -> AbstractContextManager[None]:
        return nullcontext()

    def _at(self, name: str) -> str:
        return f"{self._path}/{name}"


def store_of(address: str) -> Store:
    """Return the store at a folder or an address of fsspec.

    Raises
    ------
    StudyError
        If the address cannot be used, as where the package for its protocol is not installed.
    """
    if "://" not in address:
        return _Folder(address)
    try:
        return _Address(address)
    except ExtraMissingError as error:
        raise StudyError(str(error)) from error
    except (ImportError, ValueError) as error:
        raise StudyError(f"{address}: {error}") from error


@contextmanager
def temporary() -> Iterator[Store]:
    """Give a folder that is removed at the end."""
    with tempfile.TemporaryDirectory(prefix="stickslip-study-") as folder:
        yield _Folder(folder)
