"""The results of a study, read from its chunk files."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable

import numpy as np

from .chunk import name_of, unpacked
from .store import Store
from .study import Chunk, Columns, StudyError


class Results:
    """The results of a study, of which a range of points is read at a time.

    Attributes
    ----------
    count
        Number of points.
    """

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

        Raises
        ------
        StudyError
            If a chunk file was removed or altered since it was computed.
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
