"""A study computed: its chunks given to workers, and the results read back.

Workers are processes of this machine, or those of a dask scheduler: what differs is the executor.
"""

from __future__ import annotations

import asyncio
import logging
import os
import pickle
import signal
import tempfile
import threading
import time
import warnings
import weakref
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext, suppress
from multiprocessing.connection import Connection
from typing import Final, TypeAlias, TypedDict

from stickslip_verification.drive.processes import discard_prints, fast_context, jobs_here

from ..datasets import digest_of, need
from .store import (
    STUDY,
    Chunk,
    Done,
    Progress,
    Results,
    Store,
    Study,
    StudyError,
    begun,
    chunks_in,
    compute,
    failures,
    manifest_of,
    reason,
    unpacked,
    work,
)

_PATIENCE: Final = 4.5
"""Seconds in which a scheduler must answer."""
_AHEAD: Final = 2
"""Chunks that a dask worker has at most: one that it computes, one that waits."""
_SHORT: Final = 2.0
"""Seconds that are not worth starting worker processes, which takes one or two."""
_DEATHS: Final = 3
"""Workers that a chunk may end before it ends the study."""
_REPORT: Final = 0.5
"""Seconds between two reports of progress while nothing comes."""
_SECONDS: Final = 1.0
"""What a chunk should take. The overhead of a chunk is some milliseconds, what a killed worker
loses is a chunk."""
_WORKERS: Final = 50
"""A scheduler hands out some hundred chunks a second: from so many workers on chunks get longer
with their number (docs/scale.md)."""
_GROWTH: Final = 8
"""A chunk has at most so many times the points of the one whose time is known: first chunks are
short, and their time says little."""
_MOST_BYTES: Final = 64 * 2**20
"""Bytes of a chunk file; who writes or reads one has it in memory."""
_SMALLEST: Final = 8
"""Towards the end chunks get smaller, down to this part, so that all workers end together."""


class Computing(TypedDict, total=False):
    """How a study is computed: arguments of `run` that others pass on."""

    workers: int | None
    cluster: str | None
    fresh: bool
    progress: Callable[[Progress], None] | None


MakeExecutor: TypeAlias = Callable[[], AbstractContextManager[Executor]]
State: TypeAlias = tuple[int, int, str]
"""How many chunks workers compute at once, how many they are given, and a note to a person."""
Workers: TypeAlias = tuple[MakeExecutor, Callable[[], State]]
"""What makes an executor, anew after it broke, and its state; `CancelledError` where it ended."""


def processes(count: int) -> Workers:
    """Return processes of this machine; each is started when there is a chunk for it."""

    @contextmanager
    def pool() -> Iterator[Executor]:
        # The processes hold one end of a pipe, and end with the other one: with the block, or when
        # this process does.
        context = fast_context()
        end, life = context.Pipe(duplex=False)
        executor = ProcessPoolExecutor(count, context, _begin, (end,))
        try:
            yield executor
        finally:
            life.close()
            executor.shutdown(cancel_futures=True)

    return pool, lambda: (count, count, "")


def _begin(life: Connection) -> None:
    """Set up a worker process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    discard_prints()

    def follow() -> None:
        life.poll(None)
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


@contextmanager
def cluster_of(address: str) -> Iterator[Workers]:
    """Give the workers of a dask scheduler; it gives the chunk of a dead one to another.

    At the end of the block, no chunk is asked of them. `StudyError` if no scheduler answers within
    10 s, `ExtraMissingError` without the extra `cluster`.
    """
    distributed = need("distributed", "cluster")
    with ExitStack() as stack:
        # A lost connection is told as an error, in one line.
        for handler in logging.getLogger("distributed").handlers:
            stack.callback(handler.setLevel, handler.level)
            handler.setLevel(logging.CRITICAL)
        try:
            # A notebook runs a loop in its own thread.
            with ThreadPoolExecutor(1) as thread:
                thread.submit(asyncio.run, _greeted(address)).result()
            # Its warning of other versions is less strict than our check on the workers.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                client = distributed.Client(address, timeout=_PATIENCE, set_as_default=False)
        # A TLS that is not set up is a TypeError.
        except Exception as error:
            raise StudyError(
                f"no dask scheduler answers at {address} in {_PATIENCE} s: {reason(error)}"
            ) from error

        def state() -> State:
            try:
                threads = client.nthreads().values()
            except (OSError, RuntimeError) as error:
                raise CancelledError from error
            count, note = max(len(threads), 1), ""
            if set(threads) != {1}:
                has = "workers of several threads, which compute one chunk at a time"
                has = has if threads else "no workers: waiting"
                note = f"{address} has {has}; dask worker {address} --nthreads 1 starts one"
            return count, _AHEAD * count, note

        try:
            executor: Executor = client.get_executor(pure=False)
            yield lambda: nullcontext(executor), state
        finally:
            # One that hangs is left behind.
            with suppress(OSError):
                client.close(timeout=_PATIENCE)


async def _greeted(address: str) -> None:
    """Connect once: a client would wait without end where another kind of server listens."""
    options = need("distributed").Security().get_connection_args("client")
    connecting = need("distributed.comm").connect(address, **options)
    (await asyncio.wait_for(connecting, _PATIENCE)).abort()


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
            remote = None if cluster is None else stack.enter_context(cluster_of(cluster))
            store, manifest = Store(folder), manifest_of(study)
            stack.enter_context(begun(store, manifest, fresh=fresh))
            running = _Running(study, store, digest_of(manifest), progress)
            if remote is None:
                running.here(workers or jobs_here())
            else:
                running.by(*remote)
        except OSError as error:
            raise StudyError(reason(error)) from error
        except CancelledError:
            raise StudyError(
                f"the scheduler {cluster} has ended; what is computed is kept, and the study "
                "resumes"
            ) from None
        results = Results(store, running.done, running.key)
        weakref.finalize(results, lasting.pop_all().close)
    return results


class _Running:
    """A study on its way, of which the chunks `done` are computed."""

    def __init__(
        self, study: Study, store: Store, key: str, progress: Callable[[Progress], None] | None
    ) -> None:
        self._begun = time.monotonic()
        self._study, self._store, self.key, self._progress = study, store, key, progress
        try:
            store.write(STUDY, pickle.dumps(study))
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise StudyError(f"the study cannot be sent to workers: {reason(error)}") from error
        self.done: list[Chunk] = []
        self._failed = 0
        for chunk in chunks_in(store.names()):
            columns = unpacked(store.read(chunk.file), chunk, key)
            # A worker that outlived its study may have written a chunk that overlaps others.
            if columns is None or (self.done and chunk.start < self.done[-1].stop):
                store.remove([chunk.file])
            else:
                self.done.append(chunk)
                self._failed += failures(columns)
        ends = [0, *(end for chunk in self.done for end in chunk), study.count]
        gaps = [Chunk(*gap) for gap in zip(ends[::2], ends[1::2], strict=True)]
        self._gaps = [gap for gap in reversed(gaps) if gap.points]
        self._left = sum(gap.points for gap in gaps)
        self._kept = study.count - self._left
        self._computed = self._kept
        self._size = self._most = study.quantum
        self._report()

    def here(self, count: int) -> None:
        """Compute in this process; a study that turns out to be long gets `count` workers."""
        while self._left:
            chunk, first = self._take(1), self._computed == self._kept
            seconds = self._compute(chunk)
            # The first chunk also loads libraries, and tells little unless it is long itself.
            if count > 1 and seconds * (1.0 if first else self._left / chunk.points) > _SHORT:
                self.by(*processes(count), meanwhile=True)

    def _compute(self, chunk: Chunk) -> float:
        """Compute a chunk in this process, and return its time [s]."""
        done = compute(self._store, self._study, self.key, chunk)
        self._note(done)
        self._report()
        return done.seconds

    def by(
        self, make: MakeExecutor, state: Callable[[], State], *, meanwhile: bool = False
    ) -> None:
        """Have workers compute the rest, and this process `meanwhile`, till they are ready."""
        given: dict[Future[Done], Chunk] = {}
        # Chunks of a broken executor are given singly, so that the deadly one is found.
        suspects: list[Chunk] = []
        deaths = Counter[Chunk]()
        with ExitStack() as stack:
            executor = stack.enter_context(make())
            if meanwhile:
                # Till the first worker is there its libraries are loaded, which takes a second.
                starting = threading.Thread(target=executor.submit, args=(int,))
                starting.start()
                while self._left and starting.is_alive():
                    self._compute(self._take(1))
            while self._left or suspects or given:
                count, ahead, note = state()
                singly = deaths.keys() & {*suspects, *given.values()}
                try:
                    while len(given) < (1 if singly else ahead) and (suspects or self._left):
                        if not suspects:
                            suspects.append(self._take(count))
                        future = executor.submit(work, self._store.address, self.key, suspects[-1])
                        given[future] = suspects.pop()
                    for future in wait(given, _REPORT, FIRST_COMPLETED).done:
                        self._note(future.result())
                        del given[future]
                except BrokenExecutor:
                    suspects += given.values()
                    deaths.update(given.values())
                    given.clear()
                    for chunk in suspects:
                        if deaths[chunk] == _DEATHS:
                            why = f"{chunk} ended their worker process {_DEATHS} times"
                            raise StudyError(why) from None
                    stack.close()
                    executor = stack.enter_context(make())
                except (StudyError, CancelledError):
                    raise
                except Exception as error:
                    raise StudyError(f"a worker cannot compute: {reason(error)}") from error
                self._report(note)

    def _take(self, workers: int) -> Chunk:
        """Return the next chunk, for one of so many workers."""
        gap = self._gaps.pop()
        full = min(self._size * max(workers // _WORKERS, 1), self._most)
        even = max(self._left // (2 * workers), full // _SMALLEST)
        chunk = Chunk(gap.start, min(gap.start + self._rounded(min(full, even)), gap.stop))
        if chunk.stop < gap.stop:
            self._gaps.append(Chunk(chunk.stop, gap.stop))
        self._left -= chunk.points
        return chunk

    def _note(self, done: Done) -> None:
        """Take note of a chunk, and of how many points make the next ones."""
        points = done.chunk.points
        self.done.append(done.chunk)
        self._computed += points
        self._failed += done.failed
        by_bytes = points * _MOST_BYTES / done.size
        by_time = points * _SECONDS / max(done.seconds, 1e-6)
        self._size = self._rounded(int(min(by_time, by_bytes, points * _GROWTH)))
        self._most = max(int(by_bytes), self._size)

    def _rounded(self, points: int) -> int:
        return max(points // self._study.quantum, 1) * self._study.quantum

    def _report(self, note: str = "") -> None:
        if self._progress is not None:
            so_far = self._computed, self._study.count, self._failed
            self._progress(Progress(*so_far, time.monotonic() - self._begun, self._kept, note))
