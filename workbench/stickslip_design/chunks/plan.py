"""Which chunk is next, and how many points it has: on few workers chunks take a second each."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import Final

from .study import Chunk

_SECONDS: Final = 1.0
"""What a chunk should take. The overhead of a chunk is some milliseconds, what a killed worker
loses is a chunk."""
_GROWTH: Final = 8
"""A chunk has at most so many times the points of the one whose time is known: first chunks are
short, and their time says little."""
_MOST_BYTES: Final = 64 * 2**20
"""Bytes of a chunk file; who writes or reads one has it in memory."""
_WORKERS: Final = 50
"""A scheduler hands out some hundred chunks a second: from so many workers on chunks get longer
with their number (docs/scale.md)."""
_SMALLEST: Final = 8
"""Towards the end chunks get smaller, down to this part, so that all workers end together."""


class Plan:
    """The chunks that are left of `count` points, where `done` are there and do not overlap."""

    def __init__(self, count: int, quantum: int, done: Iterable[Chunk]) -> None:
        self._quantum = self._size = self._most = quantum
        ends = [0, *(end for chunk in sorted(done) for end in chunk), count]
        gaps = [Chunk(*gap) for gap in zip(ends[::2], ends[1::2], strict=True)]
        self._gaps = deque(gap for gap in gaps if gap.points)
        self.left = sum(gap.points for gap in gaps)

    def take(self, workers: int) -> Chunk:
        """Return the next chunk, for one of so many workers; `left` says whether there is one."""
        full = min(self._size * max(workers // _WORKERS, 1), self._most)
        even = max(self.left // (2 * workers), full // _SMALLEST)
        gap = self._gaps.popleft()
        chunk = Chunk(gap.start, min(gap.start + self._rounded(min(full, even)), gap.stop))
        if chunk.stop < gap.stop:
            self._gaps.appendleft(Chunk(chunk.stop, gap.stop))
        self.left -= chunk.points
        return chunk

    def learn(self, points: int, seconds: float, size: int) -> None:
        """Take note of the time of a chunk [s] and of the bytes of its file."""
        by_time = points * _SECONDS / max(seconds, 1e-6)
        by_bytes = points * _MOST_BYTES / max(size, 1)
        self._size = self._rounded(int(min(by_time, by_bytes, points * _GROWTH)))
        self._most = max(int(by_bytes), self._size)

    def _rounded(self, points: int) -> int:
        return max(points // self._quantum, 1) * self._quantum
