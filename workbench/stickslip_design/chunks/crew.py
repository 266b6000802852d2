"""Who computes chunks: worker processes of this machine, or the workers of a dask scheduler."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import queue
import socket
import threading
import time
import warnings
from collections.abc import Iterator
from concurrent.futures import CancelledError, Future
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import Any, Final, Protocol
from urllib.parse import urlsplit

from stickslip_verification.drive.processes import LostError, Worker

from ..datasets import ExtraMissingError, need
from .study import Chunk, StudyError
from .work import Done, Failed, Job, Lost, prepare, reason, work

_PATIENCE: Final = 4.5
"""Seconds in which a scheduler must answer, asked twice: whether it is there, and then by dask."""
_AHEAD: Final = 2
"""Chunks that a dask worker has at most: one that it computes, one that waits."""
_LOOK: Final = 2.0
"""Seconds between two looks at who works for a scheduler."""
_ASK_ANEW: Final = 3.0
"""Seconds after which the answer of a worker is asked for once more."""
_MOST_FRAMES: Final = 1000
"""Frames of a message; the greeting of a scheduler has a few."""


def cores() -> int:
    """Return how many cores of this machine this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Crew(Protocol):
    """Workers that take chunks."""

    @property
    def workers(self) -> int:
        """How many chunks can be computed at once."""

    @property
    def note(self) -> str:
        """What the person should know; empty as a rule."""

    @property
    def idle(self) -> bool:
        """Whether another chunk would be taken now."""

    def give(self, job: Job, chunk: Chunk) -> None:
        """Have a chunk computed."""

    def answers(self, seconds: float) -> list[Done | Failed | Lost]:
        """Return the answers that have come, after so many seconds at the latest."""


class _Processes:
    """Processes of this machine; all but the first are started when there is a chunk for them."""

    note = ""

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._idle: list[Worker] = []
        self._busy: dict[Worker, Chunk] = {}
        self._starting = threading.Thread(target=self._start_first, daemon=True)
        self._starting.start()

    @property
    def starting(self) -> bool:
        """Whether the first process is not there yet; loading its libraries takes a second."""
        return self._starting.is_alive()

    def _start_first(self) -> None:
        # What is in its way is told by the next attempt.
        with contextlib.suppress(Exception):
            self._idle.append(Worker(prepare, (), None))

    @property
    def idle(self) -> bool:
        return len(self._busy) < self.workers

    def give(self, job: Job, chunk: Chunk) -> None:
        self._starting.join()
        worker = self._idle.pop() if self._idle else Worker(prepare, (), None)
        self._busy[worker] = chunk
        worker.give(work, (job, chunk))

    def answers(self, seconds: float) -> list[Done | Failed | Lost]:
        ready = set(wait([each for worker in self._busy for each in worker.handles], seconds))
        return [
            self._answer(worker, chunk)
            for worker, chunk in list(self._busy.items())
            if ready.intersection(worker.handles)
        ]

    def _answer(self, worker: Worker, chunk: Chunk) -> Done | Failed | Lost:
        del self._busy[worker]
        try:
            answer: Done | Failed = worker.answer()
        except LostError as lost:
            worker.end()
            return Lost(chunk, str(lost))
        self._idle.append(worker)
        return answer

    def end(self) -> None:
        """End the processes and what they compute."""
        self._starting.join()
        for worker in (*self._idle, *self._busy):
            worker.end()


@contextmanager
def processes(workers: int) -> Iterator[_Processes]:
    """Give worker processes of this machine; they end with the block."""
    crew = _Processes(workers)
    try:
        yield crew
    finally:
        crew.end()


class _Cluster:
    """The workers of a dask scheduler; the scheduler gives a chunk of a dead one to another."""

    def __init__(self, client: Any, address: str) -> None:
        self._client, self._address = client, address
        self._waiting: dict[Future[Done | Failed], Chunk] = {}
        self._ended: queue.SimpleQueue[Future[Done | Failed]] = queue.SimpleQueue()
        self._looked = -_LOOK
        self._threads: list[int] = []

    @property
    def workers(self) -> int:
        return max(len(self._threads_of_workers()), 1)

    @property
    def note(self) -> str:
        threads = self._threads_of_workers()
        if not threads:
            return (
                f"{self._address} has no workers: waiting; dask worker {self._address} "
                "--nthreads 1 starts one"
            )
        if max(threads) > 1:
            return (
                f"{self._address} has workers of several threads, which compute one chunk at a "
                "time: dask worker --nthreads 1 --nworkers N uses N cores"
            )
        return ""

    @property
    def idle(self) -> bool:
        return len(self._waiting) < _AHEAD * self.workers

    def give(self, job: Job, chunk: Chunk) -> None:
        future = self._client.submit(work, job, chunk, pure=False)
        fetched = asyncio.run_coroutine_threadsafe(
            self._fetch(future), self._client.loop.asyncio_loop
        )
        self._waiting[fetched] = chunk
        fetched.add_done_callback(self._ended.put)

    async def _fetch(self, future: Any) -> Done | Failed:
        """Wait for the answer of a worker.

        Where the worker dies between its answer and the fetch, the scheduler would look for it for
        30 s; asked anew, it has the chunk computed by another one.
        """
        while True:
            with contextlib.suppress(TimeoutError):
                answer: Done | Failed = await asyncio.wait_for(
                    self._client.gather(future, asynchronous=True), _ASK_ANEW
                )
                return answer

    def answers(self, seconds: float) -> list[Done | Failed | Lost]:
        ended = []
        with contextlib.suppress(queue.Empty):
            ended.append(self._ended.get(timeout=seconds))
            while True:
                ended.append(self._ended.get_nowait())
        return [self._answer(future) for future in ended]

    def _answer(self, fetched: Future[Done | Failed]) -> Done | Failed:
        chunk = self._waiting.pop(fetched)
        try:
            return fetched.result()
        except (OSError, CancelledError) as error:
            raise self._gone() from error
        except need("distributed").KilledWorker as error:
            return Failed(f"{chunk} ended {error.allowed_failures + 1} workers, one after another")
        except Exception as error:
            return Failed(f"a worker of {self._address} cannot compute: {reason(error)}")

    def _threads_of_workers(self) -> list[int]:
        if time.monotonic() >= self._looked + _LOOK:
            try:
                self._threads = list(self._client.nthreads().values())
            except (OSError, RuntimeError) as error:
                raise self._gone() from error
            self._looked = time.monotonic()
        return self._threads

    def _gone(self) -> StudyError:
        return StudyError(
            f"the scheduler {self._address} has ended; what is computed is kept, and the study "
            "resumes"
        )


@contextmanager
def cluster(address: str) -> Iterator[Crew]:
    """Give the workers of a dask scheduler; at the end of the block, no chunk is asked of them.

    Raises
    ------
    StudyError
        If the extra `cluster` is not installed, or no scheduler answers within 10 s.
    """
    _knock(address)
    try:
        distributed = need("distributed", "cluster")
    except ExtraMissingError as error:
        raise StudyError(f"--cluster: {error}") from error
    with _unlogged():
        try:
            # Its warning of other versions is less strict than our check on the workers.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                client = distributed.Client(address, timeout=_PATIENCE, set_as_default=False)
        # A TLS that is not set up is a TypeError.
        except Exception as error:
            raise StudyError(f"no dask scheduler answers at {address}: {reason(error)}") from error
        try:
            yield _Cluster(client, address)
        finally:
            # One that hangs is left behind.
            with contextlib.suppress(OSError):
                client.close(timeout=_PATIENCE)


def _knock(address: str) -> None:
    """Try whether a dask scheduler listens at an address.

    Dask itself tries for its whole time limit where nothing listens, and without end where another
    kind of server does.

    Raises
    ------
    StudyError
        If the address is none, or no scheduler greets there.
    """
    scheme, host, port = "", None, None
    with contextlib.suppress(ValueError):
        parts = urlsplit(address)
        scheme, host, port = parts.scheme, parts.hostname, parts.port
    if host is None or port is None:
        raise StudyError(f"{address!r} is no address of a scheduler, such as tcp://host:8786")
    at = host, port
    obstacles: queue.SimpleQueue[str] = queue.SimpleQueue()

    def knock() -> None:
        try:
            with socket.create_connection(at, timeout=_PATIENCE) as connection:
                # A scheduler begins with the number of its frames; over TLS it waits to be asked.
                greeting = connection.recv(8) if scheme == "tcp" else b""
            frames = int.from_bytes(greeting, "little")
            obstacles.put("another kind of server does" if frames > _MOST_FRAMES else "")
        except TimeoutError:
            # Told below, where the same time has passed.
            return
        except OSError as error:
            obstacles.put(reason(error))

    # A look-up of a name has no time limit, so that it is left behind where it takes too long.
    threading.Thread(target=knock, daemon=True).start()
    obstacle = f"nothing comes within {_PATIENCE:g} s"
    with contextlib.suppress(queue.Empty):
        obstacle = obstacles.get(timeout=_PATIENCE)
    if obstacle:
        raise StudyError(f"no dask scheduler answers at {address}: {obstacle}")


@contextmanager
def _unlogged() -> Iterator[None]:
    """Silence what dask logs of lost connections: it is told as an error, in one line."""
    handlers = logging.getLogger("distributed").handlers
    levels = [handler.level for handler in handlers]
    for handler in handlers:
        handler.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for handler, level in zip(handlers, levels, strict=True):
            handler.setLevel(level)
