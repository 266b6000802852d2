"""The results of a study, in chunk files with a digest that tells whether a file is whole.

A file has a first line with the SHA-256 of the rest; the rest is a line of JSON (the study's key,
the chunk, the names of the columns) and, for each column, an array in NumPy's format (.npy).
"""

from __future__ import annotations

import json
import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterable
from hashlib import sha256
from io import BytesIO
from typing import Final

import numpy as np
from numpy.lib import format as npy

from .store import Store
from .study import Chunk, Columns, StudyError

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
