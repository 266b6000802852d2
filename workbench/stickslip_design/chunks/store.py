"""A study of many points, and where its results are: files that are whole or not there.

A store is a folder or an address of fsspec. A chunk file has a first line with the SHA-256 of the
rest, which tells whether it is whole; the rest is a line of JSON (the study's key, the chunk, the
names of the columns) and, for each column, an array in NumPy's format (.npy).
"""

from __future__ import annotations

import json
import re
import sys
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import IO, Any, Final, NamedTuple, Protocol, TypeAlias
from uuid import uuid4

import numpy as np
from fsspec.core import url_to_fs
from fsspec.implementations.local import LocalFileSystem
from numpy.lib import format as npy
from numpy.typing import NDArray

Columns: TypeAlias = dict[str, NDArray[np.generic]]
"""Results by name: arrays of one number, or text, a point."""


class StudyError(ValueError):
    """A study cannot be computed, or not to its end; the message is one line that says why."""


class Study(Protocol):
    """A study of many points; it is pickled to the workers.

    Each point is computed from the study and its number alone, so that the result does not depend
    on chunks, workers or order.
    """

    @property
    def count(self) -> int:
        """How many points there are; their numbers are 0 to count - 1."""

    @property
    def quantum(self) -> int:
        """A chunk is a multiple of so many points, but for the last one."""

    @property
    def identity(self) -> Mapping[str, Any]:
        """All that the results depend on, but for versions: JSON. Digests stand for files."""

    def compute(self, start: int, stop: int) -> Columns:
        """Return the results of the points from `start` up to but not including `stop`.

        A column `failure`, where there is one, is a text: the reason why a point has no result,
        empty where it has one.
        """


@dataclass(frozen=True)
class Progress:
    """How far a study is: of `count` points are `done`, of these `failed` without a result.

    It takes `seconds` by now, without the points that an earlier run `kept`; a `note` says what the
    person should know, such as a cluster without workers.
    """

    done: int
    count: int
    failed: int
    seconds: float
    kept: int = 0
    note: str = ""


class Chunk(NamedTuple):
    """The points from `start` up to but not including `stop`."""

    start: int
    stop: int

    @property
    def points(self) -> int:
        """How many they are."""
        return self.stop - self.start

    def __str__(self) -> str:
        return f"points {self.start} to {self.stop - 1}"


def reason(error: BaseException) -> str:
    """Return what an exception says, in one line; an `OSError` of a file names it."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    text = " ".join(str(error).split())
    if isinstance(error, StudyError):
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


LOCK: Final = ".lock"
"""File of a folder that is locked while a process computes a study in it."""
PART: Final = ".part"
"""End of the name of a file that is not whole yet; the name begins with a dot."""


class Store:
    """The files of a study in a folder, or at an address of fsspec such as s3://bucket/study.

    Its `address` means the same in another process. `StudyError` if it cannot be used; every method
    raises `OSError` where the store refuses.
    """

    def __init__(self, address: str) -> None:
        self._is_folder = "://" not in address
        if self._is_folder:
            self.address = str(Path(address).resolve())
            self._system, self._path = LocalFileSystem(), self.address
        else:
            self.address = address.rstrip("/")
            try:
                self._system, self._path = url_to_fs(self.address)
            # Its package is not installed, or there is no such protocol.
            except (ImportError, ValueError) as error:
                raise StudyError(f"{address}: {error}") from error

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


_FIRST: Final = b"stickslip chunk 1 %s\n"
_LINE: Final = len(_FIRST % bytes(64))
_NAME: Final = re.compile(r"points-(\d{12})-(\d{12})\.chunk")


def name_of(chunk: Chunk) -> str:
    """Return the name of the file of a chunk."""
    return f"points-{chunk.start:012}-{chunk.stop:012}.chunk"


def chunk_of(name: str) -> Chunk | None:
    """Return the chunk that a file holds, by its name; None if it is no chunk file."""
    match = _NAME.fullmatch(name)
    return None if match is None else Chunk(int(match[1]), int(match[2]))


def packed(chunk: Chunk, key: str, columns: Columns) -> bytes:
    """Return the content of the file of a chunk; a `StudyError` if a column does not fit."""
    body = BytesIO()
    body.write(json.dumps([key, chunk, list(columns)]).encode() + b"\n")
    for name, column in columns.items():
        values = np.asarray(column)
        if values.shape != (chunk.points,) or values.dtype.hasobject:
            raise StudyError(
                f"{chunk}: the column {name} has shape {values.shape} and type {values.dtype}; "
                f"{chunk.points} numbers or texts are due"
            )
        npy.write_array(body, values, allow_pickle=False)
    return _first_line(body.getbuffer()) + body.getbuffer()


def unpacked(content: bytes, chunk: Chunk, key: str) -> Columns | None:
    """Return the columns of a chunk file; None if it is not whole or of another study."""
    body = memoryview(content)[_LINE:]
    if content[:_LINE] != _first_line(body):
        return None
    stream = BytesIO(body)
    of, points, names = json.loads(stream.readline())
    if (of, tuple(points)) != (key, chunk):
        return None
    return {name: npy.read_array(stream, allow_pickle=False) for name in names}


def _first_line(body: memoryview) -> bytes:
    return _FIRST % sha256(body).hexdigest().encode()


def failures(columns: Columns) -> int:
    """Return how many points have no result."""
    return int(np.count_nonzero(columns["failure"])) if "failure" in columns else 0


class Results:
    """The results of a study of `count` points, of which a range is read at a time."""

    def __init__(self, store: Store, chunks: Iterable[Chunk], key: str) -> None:
        self._store, self._chunks, self._key = store, sorted(chunks), key
        self.count = self._chunks[-1].stop
        self._last: tuple[Chunk, Columns] | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self._columns(self._chunks[0]))

    def read(self, start: int = 0, stop: int | None = None) -> Columns:
        """Return the columns of the points from `start` up to `stop`.

        `StudyError` if a chunk file was removed or altered since it was computed.
        """
        start, stop, _ = slice(start, stop).indices(self.count)
        first = bisect_right(self._chunks, start, key=lambda chunk: chunk.start) - 1
        last = bisect_left(self._chunks, stop, key=lambda chunk: chunk.start)
        parts = []
        for chunk in self._chunks[first : max(last, first + 1)]:
            cut = slice(max(start - chunk.start, 0), max(stop - chunk.start, 0))
            parts.append({name: column[cut] for name, column in self._columns(chunk).items()})
        # Each column of the chunks is released as soon as it is joined.
        return {name: np.concatenate([part.pop(name) for part in parts]) for name in [*parts[0]]}

    def _columns(self, chunk: Chunk) -> Columns:
        if self._last is None or self._last[0] != chunk:
            self._last = None
            file = f"{self._store.address}/{name_of(chunk)}"
            try:
                columns = unpacked(self._store.read(name_of(chunk)), chunk, self._key)
            except OSError as error:
                raise StudyError(f"{file}: {error.strerror or error}") from error
            if columns is None:
                raise StudyError(f"{file}: the file was altered; the same command makes it anew")
            self._last = chunk, columns
        return self._last[1]
