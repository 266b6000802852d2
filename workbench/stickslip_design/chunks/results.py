"""The results of a study, read from its chunk files."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable

import numpy as np

from .chunk import name_of, unpacked
from .store import Store
from .study import Chunk, Columns, StudyError


class Results:
    """The results of a study; a range of points is read with one chunk file in memory at a time.

    Attributes
    ----------
    count
        Number of points.
    """

    def __init__(self, store: Store, chunks: Iterable[Chunk], key: str) -> None:
        self._store, self._chunks, self._key = store, sorted(chunks), key
        self._starts = [chunk.start for chunk in self._chunks]
        self._last: tuple[Chunk, Columns] | None = None
        self.count = self._chunks[-1].stop

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self._columns(self._chunks[0]))

    def read(self, start: int = 0, stop: int | None = None) -> Columns:
        """Return the columns of the points from `start` up to `stop`.

        Raises
        ------
        StudyError
            If a chunk file was removed or altered since it was computed.
        """
        start, stop, _ = slice(start, stop).indices(self.count)
        read: Columns = {}
        first = bisect_right(self._starts, start) - 1
        for chunk in self._chunks[first:]:
            if chunk.start >= stop and read:
                break
            low, high = max(start, chunk.start), max(min(stop, chunk.stop), start)
            for name, column in self._columns(chunk).items():
                part = column[low - chunk.start : high - chunk.start]
                if name not in read:
                    read[name] = np.empty(max(stop - start, 0), part.dtype)
                wide = np.promote_types(read[name].dtype, part.dtype)
                # The texts of another chunk may be longer.
                if wide != read[name].dtype:
                    read[name] = read[name].astype(wide)
                read[name][low - start : high - start] = part
        return read

    def _columns(self, chunk: Chunk) -> Columns:
        if self._last is None or self._last[0] != chunk:
            self._last = None
            name = name_of(chunk)
            try:
                columns = unpacked(self._store.read(name), chunk, self._key)
            except OSError as error:
                raise StudyError(
                    f"{self._store.address}/{name}: {error.strerror or error}"
                ) from error
            if columns is None:
                raise StudyError(
                    f"{self._store.address}/{name}: the file was altered; the same command makes "
                    "it anew"
                )
            self._last = chunk, columns
        return self._last[1]
