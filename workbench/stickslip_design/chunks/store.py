"""A folder or an address of fsspec as a store of files, each of them there whole or not at all."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Final
from uuid import uuid4

from fsspec.core import url_to_fs
from fsspec.implementations.local import LocalFileSystem

from .study import StudyError

LOCK: Final = ".lock"
"""File of a folder that is locked while a process computes a study in it."""
PART: Final = ".part"
"""End of the name of a file that is not whole yet; the name begins with a dot."""


class Store:
    """The files of a study in a folder, or at an address of fsspec such as s3://bucket/study.

    Its `address` means the same in another process. Every method raises `OSError` where the store
    refuses.
    """

    def __init__(self, address: str) -> None:
        self._is_folder = "://" not in address
        if self._is_folder:
            self.address = str(Path(address).resolve())
            self._system, self._path = LocalFileSystem(), self.address
        else:
            self.address = address.rstrip("/")
            self._system, self._path = url_to_fs(self.address)

    def names(self) -> set[str]:
        """Return the names of all that is there; empty if there is no such folder."""
        # Other processes write there too, and some systems keep a list.
        self._system.invalidate_cache()
        try:
            paths = self._system.ls(self._path, detail=False)
        except FileNotFoundError:
            return set()
        return {path.rstrip("/").rpartition("/")[2] for path in paths}

    def read(self, name: str) -> bytes:
        """Return the content of a file."""
        return bytes(self._system.cat_file(f"{self._path}/{name}"))

    def write(self, name: str, content: bytes) -> None:
        """Write a file, whole or not at all."""
        part = f"{self._path}/.{uuid4().hex}{PART}"
        try:
            self._system.makedirs(self._path, exist_ok=True)
            self._system.pipe_file(part, content)
            self._system.mv(part, f"{self._path}/{name}")
        except BaseException as error:
            with suppress(OSError):
                self._system.rm_file(part)
            if isinstance(error, OSError) and error.errno is not None:
                file = f"{self.address}/{name}"
                raise OSError(error.errno, error.strerror or str(error), file) from error
            raise

    def remove(self, name: str) -> None:
        """Remove a file."""
        self._system.rm_file(f"{self._path}/{name}")

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other processes from the study in a folder; an address of fsspec has no locks."""
        if not self._is_folder:
            yield
            return
        Path(self.address).mkdir(parents=True, exist_ok=True)
        with Path(self.address, LOCK).open("ab") as stream:
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


def store_of(address: str) -> Store:
    """Return the store at a folder or an address of fsspec.

    `StudyError` if it cannot be used, as where the package for its protocol is not installed.
    """
    try:
        return Store(address)
    except (ImportError, ValueError) as error:
        raise StudyError(f"{address}: {error}") from error
