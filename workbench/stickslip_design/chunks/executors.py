"""Who computes chunks: worker processes of this machine, or the workers of a dask scheduler."""

from __future__ import annotations

import asyncio
import logging
import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import (
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
)
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing.connection import Connection
from typing import Any, Final, TypeVar

from stickslip_verification.drive.processes import discard_prints, fast_context

from ..datasets import ExtraMissingError, need
from .store import StudyError, reason

_PATIENCE: Final = 4.5
"""Seconds in which a scheduler must answer."""
_AHEAD: Final = 2
"""Chunks that a dask worker has at most: one that it computes, one that waits."""
_LOOK: Final = 2.0
"""Seconds between two looks at who works for a scheduler."""

T = TypeVar("T")


def cores() -> int:
    """Return how many cores of this machine this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


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
def cluster(address: str) -> Iterator[Workers]:
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
