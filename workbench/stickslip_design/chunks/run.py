"""A study computed: its chunks given to workers, and the results read back.

Workers are processes of this machine, or those of a dask scheduler.
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
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
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
from contextlib import ExitStack, closing, contextmanager, suppress
from multiprocessing.connection import Connection
from typing import Any, Final, TypedDict, TypeVar

from stickslip_verification.drive.processes import discard_prints, fast_context, jobs_here

from ..datasets import ExtraMissingError, need
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
    unpacked,
)
from .work import STUDY, Done, begun, compute, key_of, manifest_of, work

_PATIENCE: Final = 4.5
"""Seconds in which a scheduler must answer."""
_AHEAD: Final = 2
"""Chunks that a dask worker has at most: one that it computes, one that waits."""
_LOOK: Final = 2.0
"""Seconds between two looks at who works for a scheduler."""

T = TypeVar("T")


class Workers:
    """An executor, and who is behind it.

    `count` chunks can be computed at once, and `at_once` are given at once; `note` is what the
    person should know, empty as a rule.
    """

    executor: Executor
    count = 1
    at_once = 1
    note = ""

    def look(self) -> None:
        """Bring the attributes up to date; `CancelledError` if there are no workers any more."""

    def submit(self, function: Callable[..., T], *arguments: object) -> Future[T]:
        """Have a function called; what is in the way of that is the future's exception."""
        try:
            return self.executor.submit(function, *arguments)
        # One that is broken or has ended raises the latter.
        except (OSError, RuntimeError) as error:
            broken: Future[T] = Future()
            broken.set_exception(error)
            return broken

    def renew(self) -> None:
        """Go on after the executor broke; that of a cluster goes on by itself."""


class Processes(Workers):
    """Processes of this machine; each is started when there is a chunk for it.

    They hold one end of a pipe, and end with the other one: with `close`, or when this process
    does.
    """

    def __init__(self, count: int) -> None:
        self.count = self.at_once = count
        self._start()

    def _start(self) -> None:
        context = fast_context()
        end, self._life = context.Pipe(duplex=False)
        self.executor = ProcessPoolExecutor(self.count, context, _begin, (end,))

    def renew(self) -> None:
        """Start anew, after the processes and what they compute have ended."""
        self.close()
        self._start()

    def close(self) -> None:
        """End the processes and what they compute."""
        self._life.close()
        self.executor.shutdown(cancel_futures=True)


def _begin(life: Connection) -> None:
    """Set up a worker process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    discard_prints()

    def follow() -> None:
        life.poll(None)
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


class _Cluster(Workers):
    """The workers of a dask scheduler; it gives the chunk of a dead one to another."""

    def __init__(self, client: Any, address: str) -> None:
        self.executor = client.get_executor(pure=False)
        self._client, self._address = client, address
        self._looked = -_LOOK

    def look(self) -> None:
        if time.monotonic() < self._looked + _LOOK:
            return
        try:
            threads = list(self._client.nthreads().values())
        except (OSError, RuntimeError) as error:
            raise CancelledError from error
        self._looked = time.monotonic()
        self.count = max(len(threads), 1)
        self.at_once = _AHEAD * self.count
        self.note = ""
        if not threads:
            self.note = (
                f"{self._address} has no workers: waiting; dask worker {self._address} "
                "--nthreads 1 starts one"
            )
        elif max(threads) > 1:
            self.note = (
                f"{self._address} has workers of several threads, which compute one chunk at a "
                "time: dask worker --nthreads 1 --nworkers N uses N cores"
            )


@contextmanager
def cluster_of(address: str) -> Iterator[Workers]:
    """Give the workers of a dask scheduler; at the end of the block, no chunk is asked of them.

    `StudyError` if the extra `cluster` is not installed, or no scheduler answers within 10 s.
    """
    try:
        distributed = need("distributed", "cluster")
    except ExtraMissingError as error:
        raise StudyError(f"--cluster: {error}") from error
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
        try:
            yield _Cluster(client, address)
        finally:
            # One that hangs is left behind.
            with suppress(OSError):
                client.close(timeout=_PATIENCE)


async def _greeted(address: str) -> None:
    """Connect once: a client would wait without end where another kind of server listens."""
    options = need("distributed").Security().get_connection_args("client")
    connecting = need("distributed.comm").connect(address, **options)
    (await asyncio.wait_for(connecting, _PATIENCE)).abort()


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
            remote = None if cluster is None else stack.enter_context(cluster_of(cluster))
            store, manifest = Store(folder), manifest_of(study)
            key = key_of(manifest)
            stack.enter_context(begun(store, manifest, fresh=fresh))
            running = _Running(study, store, key, progress)
            running.by(remote or running.here(workers or jobs_here(), stack))
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
