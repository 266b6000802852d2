"""A study computed: its chunks given to workers, and the results read back."""

from __future__ import annotations

import pickle
import tempfile
import threading
import time
import weakref
from collections import Counter, deque
from collections.abc import Callable, Iterable
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Future,
    ThreadPoolExecutor,
    wait,
)
from contextlib import ExitStack, closing
from typing import Final, TypedDict

from .executors import Processes, Workers, cores
from .executors import cluster as connected
from .store import (
    Chunk,
    Progress,
    Results,
    Store,
    Study,
    StudyError,
    chunk_of,
    failures,
    name_of,
    reason,
    store_of,
    unpacked,
)
from .work import STUDY, Done, begun, compute, key_of, manifest_of, work

_SHORT: Final = 2.0
"""Seconds that are not worth starting worker processes, which takes one or two."""
_DEATHS: Final = 3
"""Workers that a chunk may end before it ends the study."""
_REPORT: Final = 0.5
"""Seconds between two reports of progress while nothing comes."""
_READERS: Final = 8
"""Chunk files that are read and checked at once when a study resumes."""
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


class Computing(TypedDict, total=False):
    """How a study is computed: arguments of `run` that others pass on."""

    workers: int | None
    cluster: str | None
    fresh: bool
    progress: Callable[[Progress], None] | None


def run(
    study: Study,
    folder: str | None = None,
    *,
    workers: int | None = None,
    cluster: str | None = None,
    fresh: bool = False,
    progress: Callable[[Progress], None] | None = None,
) -> Results:
    """Compute a study.

    Workers write chunk files of about a second each, so that a study that was ended in any way
    resumes. A study of two seconds, or one with one worker, is computed in this process. A script
    that calls this starts its work below ``if __name__ == "__main__":``.

    Parameters
    ----------
    study
        What to compute.
    folder
        Where the chunks are kept, so that a study that was ended resumes: a folder, which other
        processes are kept from meanwhile, or an address of fsspec. None: a temporary folder.
    workers
        Processes on this machine; None: one a core.
    cluster
        Address of a dask scheduler, in place of `workers`; its workers share the folder.
    fresh
        Whether what `folder` holds of a study is thrown away.
    progress
        Called with how far the study is.

    Returns
    -------
    Results
        The same to the bit for any chunks, workers and order. Those of a temporary folder last as
        long as this object.

    Raises
    ------
    StudyError
        If the study cannot be computed to its end. What is computed is kept in `folder`.
    """
    if study.count < 1:
        raise StudyError("the study has no points")
    if workers is not None and workers < 1:
        raise StudyError(f"{workers} workers: at least 1 is needed")
    with ExitStack() as lasting, ExitStack() as stack:
        if folder is None:
            folder = lasting.enter_context(tempfile.TemporaryDirectory(prefix="stickslip-study-"))
        try:
            remote = None if cluster is None else stack.enter_context(connected(cluster))
            store, manifest = store_of(folder), manifest_of(study)
            key = key_of(manifest)
            stack.enter_context(begun(store, manifest, fresh=fresh))
            running = _Running(study, store, key, progress)
            running.by(remote or running.here(workers or cores(), stack))
        except OSError as error:
            raise StudyError(reason(error)) from error
        except CancelledError:
            raise StudyError(
                f"the scheduler {cluster} has ended; what is computed is kept, and the study "
                "resumes"
            ) from None
        results = Results(store, running.done, key)
        weakref.finalize(results, lasting.pop_all().close)
    return results


class _Plan:
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


class _Running:
    """A study on its way, of which the chunks `done` are computed."""

    def __init__(
        self, study: Study, store: Store, key: str, progress: Callable[[Progress], None] | None
    ) -> None:
        self._begun = time.monotonic()
        self._study, self._store, self._key, self._progress = study, store, key, progress
        try:
            store.write(STUDY, pickle.dumps(study))
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise StudyError(f"the study cannot be sent to workers: {reason(error)}") from error
        self.done, self._failed = _computed_before(store, key)
        self._plan = _Plan(study.count, study.quantum, self.done)
        self._kept = study.count - self._plan.left
        self._computed = self._kept
        self._report()

    def here(self, count: int, stack: ExitStack) -> Workers | None:
        """Compute in this process till `count` workers, which long studies get, are ready."""
        workers: Workers | None = None
        # Till the first one is there its libraries are loaded, which takes a second.
        starting: threading.Thread | None = None
        while self._plan.left and (starting is None or starting.is_alive()):
            chunk = self._plan.take(1)
            seconds = self._take(compute(self._store, self._study, self._key, chunk))
            self._report()
            # The first chunk also loads libraries, and tells little unless it is long itself.
            if self._computed > self._kept + chunk.points:
                seconds *= self._plan.left / chunk.points
            if count > 1 and starting is None and self._plan.left and seconds > _SHORT:
                workers = stack.enter_context(closing(Processes(count)))
                starting = threading.Thread(target=workers.submit, args=(int,))
                starting.start()
        return workers

    def by(self, workers: Workers | None) -> None:
        """Have workers compute the rest."""
        given: dict[Future[Done], Chunk] = {}
        # Chunks of a broken pool are given singly, so that the deadly one is found.
        suspects: list[Chunk] = []
        deaths = Counter[Chunk]()
        while workers is not None and (self._plan.left or suspects or given):
            workers.look()
            singly = deaths.keys() & {*suspects, *given.values()}
            while len(given) < (1 if singly else workers.at_once) and (suspects or self._plan.left):
                chunk = suspects.pop() if suspects else self._plan.take(workers.count)
                given[workers.submit(work, self._store.address, self._key, chunk)] = chunk
            ended, _ = wait(given, _REPORT, FIRST_COMPLETED)
            if any(map(_is_broken, ended)):
                ended, _ = wait(given)
                workers.renew()
            for future in ended:
                chunk = given.pop(future)
                if not _is_broken(future):
                    self._take(_answer(future, chunk))
                    continue
                deaths[chunk] += 1
                if deaths[chunk] == _DEATHS:
                    raise StudyError(f"{chunk} ended their worker process {_DEATHS} times")
                suspects.append(chunk)
            self._report(workers.note)

    def _take(self, done: Done) -> float:
        """Take note of a chunk, and return its time [s]."""
        self._plan.learn(done.chunk.points, done.seconds, done.size)
        self.done.append(done.chunk)
        self._computed += done.chunk.points
        self._failed += done.failed
        return done.seconds

    def _report(self, note: str = "") -> None:
        if self._progress is not None:
            so_far = self._computed, self._study.count, self._failed
            self._progress(Progress(*so_far, time.monotonic() - self._begun, self._kept, note))


def _is_broken(future: Future[Done]) -> bool:
    return not future.cancelled() and isinstance(future.exception(), BrokenExecutor)


def _answer(future: Future[Done], chunk: Chunk) -> Done:
    try:
        return future.result()
    except (StudyError, CancelledError):
        raise
    except Exception as error:
        raise StudyError(f"{chunk} cannot be computed by a worker: {reason(error)}") from error


def _computed_before(store: Store, key: str) -> tuple[list[Chunk], int]:
    """Return the chunks that are whole, and their failures; a file that is not is removed."""
    chunks = sorted(filter(None, map(chunk_of, store.names())))

    def failed(chunk: Chunk) -> int | None:
        columns = unpacked(store.read(name_of(chunk)), chunk, key)
        return None if columns is None else failures(columns)

    done: list[Chunk] = []
    total = 0
    with ThreadPoolExecutor(_READERS) as readers:
        for chunk, count in zip(chunks, readers.map(failed, chunks), strict=True):
            # A worker that outlived its study may have written a chunk that overlaps others.
            if count is None or (done and chunk.start < done[-1].stop):
                store.remove(name_of(chunk))
            else:
                done.append(chunk)
                total += count
    return done, total
