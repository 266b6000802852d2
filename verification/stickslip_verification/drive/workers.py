"""Worker processes: a crash or a hang of an FMU costs its task and nothing else.

One kind of worker computes the truth and runs the reference, the other holds an FMU. Every task
returns an `Answer`, also where the worker crashed.
"""

import contextlib
import math
import os
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache, partial
from multiprocessing import Pipe
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any, Self, TypeVar

from stickslip_verification.drive import convergence, nearby
from stickslip_verification.drive.answer import Answer, answer_of, discard_prints
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.fmu.variables import Variable
from stickslip_verification.drive.kept import kept
from stickslip_verification.drive.masters import MANNERS, RUNS, Master, run_case
from stickslip_verification.drive.probes.table import PROBES
from stickslip_verification.drive.processes import LostError, Worker
from stickslip_verification.drive.reference import run_reference
from stickslip_verification.drive.stepping import Setting
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.faults import Hook
from stickslip_verification.suite.invariants import Probe

T = TypeVar("T")

NOT_MADE = "not finished"
"""Beginning of what is said of a run for which no time was left."""

TIME_LIMIT = 60.0
"""Seconds that one run of a case may take; the longest of the suite takes a few."""

PROBE_LIMIT = 60.0
"""Seconds that one probe may take; the longest, of the memory of 1e5 steps, takes two."""

MOST_PER_PROCESSOR = 4
"""Processes for each processor; more of them only take memory from each other."""

_GIGABYTE = 1e9


@dataclass(frozen=True)
class Limits:
    """What an FMU may take.

    Attributes
    ----------
    budget
        Seconds that all its runs without a result may take together: an FMU that hangs everywhere
        is at its end then, whereas a slow one that finishes its runs is not.
    memory
        Gigabytes for each process that holds it, with all that it starts, see `processes`. None on
        Windows.
    """

    budget: float = 120.0
    memory: float = 4.0


USUAL = Limits()


def jobs_here() -> int:
    """Return the number of processes that may work at once: one per processor."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def allowed(jobs: int) -> int:
    """Return how many of so many wanted processes may work at once."""
    return min(jobs, MOST_PER_PROCESSOR * jobs_here())


exact = partial(kept, exact_motion)
reference = partial(kept, run_reference)
spreads = partial(kept, nearby.spreads)
changes = partial(kept, nearby.changes)
observed_order = partial(kept, convergence.observe)
"""Tasks about a case, without an FMU."""


def open_fmu() -> bool:
    """Read the description of the FMU of this process; whether that is possible."""
    with contextlib.suppress(FmuError):
        return _fmu() is not None
    return False


def plain_run(case: Case) -> Run:
    """Run the FMU of this process on a case."""
    return run_case(_fmu(), case)


def other_run(case: Case, run: str) -> Run:
    """Run the FMU of this process on a case in another way, a key of `RUNS`."""
    return RUNS[run](_fmu(), case)


def in_manner(case: Case, manner: str) -> Run:
    """Run the FMU of this process on a case in a manner, a key of `MANNERS`."""
    return MANNERS[manner](_fmu(), case)


def probe(invariant: Probe) -> list[str]:
    """Try a probe on the FMU of this process."""
    return PROBES[invariant.probe](_fmu(), **invariant.arguments)


def trial_run(setting: Setting, variables: Mapping[str, Variable], names: Sequence[str]) -> Run:
    """Run the FMU of this process through a setting, by `variables` under any names."""
    fmu = _fmu()
    fmu.variables = variables
    master = Master(fmu, setting)
    master.names = names
    return master.run()


class Pool:
    """A few processes that work through tasks while their answers are waited for.

    Each belongs to a thread, which gives it a task, waits for the answer and ends it where it does
    not answer. Leaving the `with` block ends whatever still runs, and what an FMU left behind.

    Parameters
    ----------
    jobs
        How many processes; no more than `MOST_PER_PROCESSOR` for each processor, and no more than
        there are tasks.
    time_limit
        Seconds that one task may take.
    fmu, names, hooks, own_starts
        The FMU that the processes hold, or None, and how it is opened: see `FmuFile`.
    fresh
        Whether each task gets a new process, for an FMU that lives only once in one.
    limits
        What the FMU may take; nothing is limited without an FMU.
    """

    def __init__(
        self,
        jobs: int,
        time_limit: float = TIME_LIMIT,
        fmu: Path | None = None,
        names: NameMap | None = None,
        *,
        fresh: bool = False,
        hooks: Sequence[Hook] = (),
        own_starts: bool | None = None,
        limits: Limits = USUAL,
    ) -> None:
        self._limit = time_limit
        self._budget = limits.budget if fmu is not None else math.inf
        self._fresh = fresh
        self._folder = tempfile.TemporaryDirectory(prefix="stickslip-", ignore_cleanup_errors=True)
        opened = fmu and partial(FmuFile, fmu, names, hooks, own_starts=own_starts)
        memory = None if fmu is None else round(limits.memory * _GIGABYTE)
        self._start = partial(Worker, _begin, (self._folder.name, opened), memory)
        self._threads = ThreadPoolExecutor(allowed(jobs))
        self._lock = threading.Lock()
        self._idle: list[Worker] = []
        self._busy: dict[Worker, float] = {}
        self._lost = 0.0
        # Closing one end wakes all threads that wait.
        self._over, self._open = Pipe(duplex=False)

    def each(
        self,
        task: Callable[..., T],
        arguments: Sequence[tuple[Any, ...]],
        most: float = math.inf,
    ) -> Iterator[Answer[T]]:
        """Run the task for each tuple of arguments; yield the answers in the same order.

        All tasks are scheduled at once. `most` [s] is a time limit below the pool's.
        """
        return self._threads.map(partial(self._answer, task, min(self._limit, most)), arguments)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()
        self._threads.shutdown(cancel_futures=True)
        for worker in self._idle:
            worker.end()
        self._over.close()
        self._folder.cleanup()

    def _answer(
        self, task: Callable[..., T], limit: float, arguments: tuple[Any, ...]
    ) -> Answer[T]:
        """Have a process do a task, in the thread of the process."""
        with self._lock:
            if self._open.closed:
                return self._not_made()
            worker = self._idle.pop() if self._idle else self._start()
            self._busy[worker] = begun = time.monotonic()
        worker.give(answer_of, (task, *arguments))
        answer, ends = self._waited(worker, begun + limit, limit)
        with self._lock:
            del self._busy[worker]
            if answer.failure is not None:
                self._lost += time.monotonic() - begun
            if not ends:
                self._idle.append(worker)
        if ends:
            worker.end()
        return answer

    def _waited(self, worker: Worker, last: float, limit: float) -> tuple[Answer[Any], bool]:
        """Return the answer of a process or why it has none, and whether it is to end."""
        while True:
            # A loss grows as fast as time does, in each process at once.
            left = min(last - time.monotonic(), self._budget - self._lost_now())
            ready = wait([*worker.handles, self._over], max(0.0, left))
            if self._over in ready:
                return self._not_made(), True
            if ready:
                try:
                    answer = worker.answer()
                    if not isinstance(answer, Answer):
                        raise LostError("gave no readable answer")
                except LostError as lost:
                    return Answer(failure=f"the process {lost}"), True
                return answer, self._fresh
            if time.monotonic() >= last:
                failure = f"no answer within {limit:g} s; the process was ended"
                return Answer(failure=failure, late=True), True
            if self._lost_now() >= self._budget:
                self._open.close()

    def _lost_now(self) -> float:
        """Return the time [s] spent on tasks that failed or are not answered yet."""
        with self._lock:
            now = time.monotonic()
            running = sum(now - begun for begun in self._busy.values())
            return (self._lost + running) / max(1, len(self._busy) + len(self._idle))

    def _not_made(self) -> Answer[Any]:
        failure = (
            f"{NOT_MADE}: runs without a result took {self._budget:g} s, all that the FMU has "
            "for them; --budget gives more"
        )
        return Answer(failure=failure, late=True)


_OPENED: list[Callable[[], FmuFile]] = []
"""Opens the FMU of a worker, once."""


def _begin(folder: str, opened: Callable[[], FmuFile] | None) -> None:
    """Set up a worker: an FMU's prints are discarded."""
    tempfile.tempdir = folder
    if opened is not None:
        _OPENED.append(cache(opened))
        discard_prints()


def _fmu() -> FmuFile:
    return _OPENED[0]()
