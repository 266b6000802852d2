"""A study of many points, its folder, and what a worker does.

A store is a folder or an address of fsspec. Its manifest says which study it holds: JSON of its
inputs, the versions it is made with, and its points. A worker computes a chunk, writes its file,
and answers in a few bytes. A chunk file is the SHA-256 of the rest, which tells whether it is
whole, a line of JSON (the study's key, the chunk, the names of the columns), and the columns in
NumPy's format (.npy).
"""

from __future__ import annotations

import json
import os
import pickle
import platform
import re
import sqlite3
import threading
import time
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from difflib import unified_diff
from functools import cache, lru_cache
from hashlib import sha256
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import Any, Final, NamedTuple, Protocol, TypeAlias
from uuid import uuid4

import numpy as np
from fsspec.core import url_to_fs
from numpy.lib import format as npy
from numpy.typing import NDArray

from ..datasets import digest_of, versions
from ..one_thread import one_thread

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

    @property
    def file(self) -> str:
        """Name of its file."""
        return f"points-{self.start:012}-{self.stop:012}.chunk"

    def __str__(self) -> str:
        return f"points {self.start} to {self.stop - 1}"


_DIGEST: Final = 32
"""Bytes of a SHA-256."""
_FILE: Final = re.compile(r"points-(\d{12})-(\d{12})\.chunk")


def chunks_in(names: Iterable[str]) -> list[Chunk]:
    """Return the chunks whose files are among these, in order."""
    matches = filter(None, map(_FILE.fullmatch, names))
    return sorted(Chunk(int(match[1]), int(match[2])) for match in matches)


def reason(error: BaseException) -> str:
    """Return what an exception says, in one line; an `OSError` of a file names it."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    text = " ".join(str(error).split())
    if isinstance(error, StudyError):
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


class Store:
    """The files of a study in a folder, or at an address of fsspec such as s3://bucket/study.

    Its `address` means the same in another process. Names that begin with a dot are its own: the
    lock, and files that are not whole yet. `StudyError` if it cannot be used; every method raises
    `OSError` where the store refuses.
    """

    def __init__(self, address: str) -> None:
        self._is_folder = "://" not in address
        self.address = str(Path(address).resolve()) if self._is_folder else address.rstrip("/")
        try:
            self._system, self._path = url_to_fs(self.address)
        # Its package is not installed, or there is no such protocol.
        except (ImportError, ValueError) as error:
            raise StudyError(f"{address}: {error}") from error

    def names(self) -> set[str]:
        """Return the names of all that is there; empty if there is no such folder."""
        # Other processes write there too, and some systems keep a list.
        self._system.invalidate_cache()
        with suppress(FileNotFoundError):
            paths = self._system.ls(self._path, detail=False)
            return {path.rstrip("/").rpartition("/")[2] for path in paths}
        return set()

    def read(self, name: str) -> bytes:
        """Return the content of a file."""
        return bytes(self._system.cat_file(f"{self._path}/{name}"))

    def write(self, name: str, content: bytes) -> None:
        """Write a file, whole or not at all."""
        part = f"{self._path}/.{uuid4().hex}.part"
        try:
            self._system.makedirs(self._path, exist_ok=True)
            self._system.pipe_file(part, content)
            self._system.mv(part, f"{self._path}/{name}")
        except OSError as error:
            why = error.strerror or str(error)
            raise OSError(error.errno, why, f"{self.address}/{name}") from error
        finally:
            with suppress(OSError):
                self._system.rm_file(part)

    def remove(self, names: Iterable[str]) -> None:
        """Remove files."""
        for name in names:
            self._system.rm_file(f"{self._path}/{name}")

    def remove_parts(self) -> None:
        """Remove what a process left that was ended while it wrote."""
        self.remove(name for name in self.names() if name.endswith(".part"))

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other processes from the study in a folder; an address of fsspec has no locks."""
        if not self._is_folder:
            yield
            return
        Path(self.address).mkdir(parents=True, exist_ok=True)
        # An empty database: its lock ends with the process, on every system.
        with closing(sqlite3.connect(Path(self.address, ".lock"), timeout=0.0)) as lock:
            try:
                lock.execute("BEGIN EXCLUSIVE")
            except sqlite3.Error as error:
                raise StudyError(
                    f"{self.address}: another process computes a study here; wait for its end, or "
                    "name another folder"
                ) from error
            yield


def packed(chunk: Chunk, key: str, columns: Columns) -> bytes:
    """Return the content of the file of a chunk; a `StudyError` if a column does not fit."""
    for name, column in columns.items():
        if column.shape != (chunk.points,) or column.dtype.hasobject:
            raise StudyError(
                f"{chunk}: the column {name} has shape {column.shape} and type {column.dtype}; "
                f"{chunk.points} numbers or texts are due"
            )
    file = BytesIO()
    file.write(bytes(_DIGEST) + json.dumps([key, chunk, list(columns)]).encode() + b"\n")
    for column in columns.values():
        npy.write_array(file, column, allow_pickle=False)
    file.getbuffer()[:_DIGEST] = sha256(file.getbuffer()[_DIGEST:]).digest()
    return file.getvalue()


def unpacked(content: bytes, chunk: Chunk, key: str) -> Columns | None:
    """Return the columns of a chunk file; None if it is not whole or of another study."""
    if content[:_DIGEST] != sha256(memoryview(content)[_DIGEST:]).digest():
        return None
    stream = BytesIO(content)
    stream.seek(_DIGEST)
    of, points, names = json.loads(stream.readline())
    ours = (of, tuple(points)) == (key, chunk)
    return {name: npy.read_array(stream) for name in names} if ours else None


def failures(columns: Columns) -> int:
    """Return how many points have no result."""
    return int(np.count_nonzero(columns["failure"])) if "failure" in columns else 0


class Results:
    """The results of a study of `count` points, of which a range is read at a time."""

    def __init__(self, store: Store, chunks: Iterable[Chunk], key: str) -> None:
        self._store, self._chunks, self._key = store, sorted(chunks), key
        self.count = self._chunks[-1].stop
        self._last: tuple[Chunk, Columns] | None = None

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
            self._last = columns = None
            with suppress(OSError):
                columns = unpacked(self._store.read(chunk.file), chunk, self._key)
            if columns is None:
                file = f"{self._store.address}/{chunk.file}"
                raise StudyError(f"{file}: was removed or altered; the same command makes it anew")
            self._last = chunk, columns
        return self._last[1]


MANIFEST: Final = "manifest.json"
STUDY: Final = "study.pickle"
"""The file of the study itself, which the workers read."""

_FIELDS: Final = {"inputs", "versions", "points"}
_PACKAGES: Final = (
    *("fmi", "stickslip_design", "stickslip_fmu", "stickslip_native"),
    *("stickslip_ref", "stickslip_score", "stickslip_units", "stickslip_verification"),
)
"""Our packages that results are computed by."""
_SIGNS: Final = {"-": "before", "+": "now"}
_SHOWN: Final = 6
"""Lines of a manifest that a refusal names."""

Manifest: TypeAlias = Mapping[str, Any]


def manifest_of(study: Study) -> Manifest:
    """Return the manifest of a study, with the versions that are installed here."""
    return {
        # As a file gives it back: no tuples, every number as JSON writes it.
        "inputs": json.loads(json.dumps(study.identity)),
        "versions": _versions(),
        "points": {"count": study.count, "quantum": study.quantum},
    }


@cache
def _versions() -> dict[str, str]:
    """Return the versions here, and a digest of our sources: the same release may be edited."""
    digest = sha256()
    for package in _PACKAGES:
        spec = find_spec(package)
        assert spec is not None
        assert spec.origin is not None
        folder = Path(spec.origin).parent
        for file in sorted(folder.rglob("*.[chp]*")):
            if file.suffix in {".py", ".c", ".h"}:
                digest.update(f"{package}/{file.relative_to(folder).as_posix()}\0".encode())
                digest.update(file.read_bytes())
    return {**versions(), "sources": digest.hexdigest()[:16]}


def changes(old: Manifest, new: Manifest) -> str:
    """Return what another study or its versions differ in, in words; empty if in nothing."""
    was, now = (json.dumps(each, indent=0).splitlines() for each in (old, new))
    lines = [line for line in [*unified_diff(was, now, n=0)][2:] if line[0] in _SIGNS]
    words = [f"{_SIGNS[line[0]]} {line[1:].rstrip(',')}" for line in lines[:_SHOWN]]
    return ", ".join(words) + (", and more" if len(lines) > _SHOWN else "")


def read_manifest(store: Store) -> Manifest | None:
    """Return the manifest of a store, None if there is none; `StudyError` if its file is none."""
    content = None
    try:
        content = json.loads(store.read(MANIFEST))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except ValueError:
        pass
    if not isinstance(content, dict) or content.keys() != _FIELDS:
        raise StudyError(
            f"{store.address}: its {MANIFEST} is not one of a study; name another folder"
        )
    return content


@contextmanager
def begun(store: Store, new: Manifest, *, fresh: bool) -> Iterator[None]:
    """Lock a store that holds this study: the same one resumes, another is removed if `fresh`.

    Else a `StudyError` names the difference, or a file of a store that holds no study.
    """
    old, names = read_manifest(store), store.names()
    foreign = sorted(name for name in names if old is None and not name.startswith("."))
    if foreign:
        raise StudyError(
            f"{store.address} holds no study, but other files ({foreign[0]}); name a new folder"
        )
    with store.locked():
        old = read_manifest(store)
        if old is not None and digest_of(old) != digest_of(new) and not fresh:
            raise StudyError(
                f"{store.address} holds results of another study: {changes(old, new)}; --fresh "
                "throws them away, another folder keeps them"
            )
        store.remove_parts()
        if old is None or fresh:
            store.remove(chunk.file for chunk in chunks_in(store.names()))
            store.write(MANIFEST, json.dumps(new, indent=2).encode() + b"\n")
        try:
            yield
        finally:
            # What is in its way must not hide why the study ended.
            with suppress(OSError):
                store.remove_parts()


class Done(NamedTuple):
    """A chunk is computed and its file written: the time taken [s], its bytes, its failures."""

    chunk: Chunk
    seconds: float
    size: int
    failed: int


_ONE_AT_A_TIME = threading.Lock()
"""A study need not be safe in threads, which a dask worker may have."""


def work(address: str, key: str, chunk: Chunk) -> Done:
    """Compute a chunk in a worker; it raises `StudyError` alone, which all processes know."""
    with _ONE_AT_A_TIME:
        try:
            store, study = _opened(address, key)
        except Exception as error:
            here = f"the worker on {platform.node()} (process {os.getpid()})"
            raise StudyError(f"{here}: {reason(error)}") from None
        return compute(store, study, key, chunk)


@one_thread
def compute(store: Store, study: Study, key: str, chunk: Chunk) -> Done:
    """Compute a chunk of a study and write its file."""
    begun = time.perf_counter()
    try:
        columns = study.compute(*chunk)
    except Exception as error:
        raise StudyError(f"{chunk}: {reason(error)}") from None
    try:
        content = packed(chunk, key, columns)
        store.write(chunk.file, content)
    except Exception as error:
        kept = "what is computed is kept, and the study resumes"
        raise StudyError(f"{reason(error)}; {kept}") from None
    return Done(chunk, time.perf_counter() - begun, len(content), failures(columns))


@lru_cache(maxsize=1)
def _opened(address: str, key: str) -> tuple[Store, Study]:
    """Return the store and the study there; refuse another folder, and other versions."""
    store = Store(address)
    manifest = read_manifest(store)
    if manifest is None or digest_of(manifest) != key:
        raise StudyError(f"does not see the study in {address}; name a folder that it shares")
    if other := changes(manifest, {**manifest, "versions": _versions()}):
        raise StudyError(f"has other versions than the study: {other}")
    return store, pickle.loads(store.read(STUDY))
