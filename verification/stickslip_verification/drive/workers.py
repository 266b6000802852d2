"""Worker processes: a crash or a hang of an FMU costs its task and nothing else.

One kind of worker computes the truth and runs the reference, the other holds an FMU. Every task
returns an `Answer`, also where the worker crashed.
"""

import contextlib
import math
import os
import signal
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any, Self, TypeVar

from stickslip_verification.drive import convergence, nearby
from stickslip_verification.drive.answer import Answer, answer_of, discard_prints, reason
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.fmu.variables import Variable
from stickslip_verification.drive.kept import kept
from stickslip_verification.drive.masters import MANNERS, RUNS, Master, run_case
from stickslip_verification.drive.probes.table import PROBES
from stickslip_verification.drive.processes import OUT_OF_MEMORY, Worker
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
    return max(
        1, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    )


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

    Leaving its `with` block ends whatever still runs, and what an FMU left behind.

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
        self._jobs = allowed(jobs)
        self._limit = time_limit
        self._budget = limits.budget if fmu is not None else math.inf
        self._memory = None if fmu is None else round(limits.memory * _GIGABYTE)
        self._fresh = fresh
        self._folder = tempfile.TemporaryDirectory(prefix="stickslip-", ignore_cleanup_errors=True)
        opened = fmu and partial(FmuFile, fmu, names, hooks, own_starts=own_starts)
        self._arguments = (self._folder.name, opened)
        self._waiting: deque[_Order] = deque()
        self._idle: list[Worker] = []
        self._busy: dict[Worker, _Order] = {}
        self._lost = 0.0

    def each(
        self,
        task: Callable[..., T],
        arguments: Sequence[tuple[Any, ...]],
        most: float = math.inf,
    ) -> Iterator[Answer[T]]:
        """Run the task for each tuple of arguments; yield the answers in the same order.

        All tasks are scheduled at once. `most` [s] is a time limit below the pool's.
        """
        orders = [_Order(task, each, min(self._limit, most)) for each in arguments]
        self._waiting += orders
        self._assign()
        return map(self._answer_to, orders)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._waiting.clear()
        _end_all([*self._idle, *self._busy])
        self._folder.cleanup()

    def _answer_to(self, order: "_Order") -> Answer[Any]:
        while order.answer is None:
            self._assign()
            self._wait()
        return order.answer

    def _assign(self) -> None:
        """Give each process a task, starting those that may be started."""
        while self._waiting and (self._idle or len(self._busy) < self._jobs):
            new = not self._idle
            worker = Worker(_begin, self._arguments, self._memory) if new else self._idle.pop()
            order = self._waiting.popleft()
            order.begun = time.monotonic()
            self._busy[worker] = order
            # One that has ended in the meantime is found by `_wait`.
            with contextlib.suppress(OSError):
                worker.give(answer_of, (order.task, *order.arguments))

    def _wait(self) -> None:
        """Wait for an answer, the end of a process, a time limit or the end of the budget."""
        now = time.monotonic()
        first = min(order.begun + order.limit for order in self._busy.values())
        # A loss grows as fast as time does, in each process at once.
        left = self._budget - self._lost_till(now)
        handles = [handle for worker in self._busy for handle in worker.handles]
        ready = wait(handles, max(0.0, min(first - now, left)))
        now = time.monotonic()
        for worker, order in list(self._busy.items()):
            if any(handle in ready for handle in worker.handles):
                answer, lost = _taken(worker)
                self._settle(worker, answer, now, ends=lost or self._fresh)
            elif now >= order.begun + order.limit:
                failure = f"no answer within {order.limit:g} s; the process was ended"
                self._settle(worker, Answer(failure=failure, late=True), now)
        if self._lost_till(now) >= self._budget:
            self._give_up()

    def _lost_till(self, now: float) -> float:
        """Return the time [s] spent on tasks that failed or are not answered yet."""
        running = sum(now - order.begun for order in self._busy.values())
        return (self._lost + running) / max(1, len(self._busy) + len(self._idle))

    def _settle(self, worker: Worker, answer: Answer[Any], now: float, ends: bool = True) -> None:
        """Note the answer to the task of a process, which ends or is free for another."""
        order = self._busy.pop(worker)
        order.answer = answer
        if answer.failure is not None:
            self._lost += now - order.begun
        if ends:
            worker.end()
        else:
            self._idle.append(worker)

    def _give_up(self) -> None:
        """Answer all tasks that are left with the end of the budget."""
        failure = (
            f"{NOT_MADE}: runs without a result took {self._budget:g} s, all that the FMU has "
            "for them; --budget gives more"
        )
        _end_all(list(self._busy))
        for order in (*self._busy.values(), *self._waiting):
            order.answer = Answer(failure=failure, late=True)
        self._busy.clear()
        self._waiting.clear()


@dataclass(eq=False)
class _Order:
    """A task, since when it runs, and its answer."""

    task: Callable[..., Any]
    arguments: tuple[Any, ...]
    limit: float
    begun: float = 0.0
    answer: Answer[Any] | None = None


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


def _end_all(workers: Sequence[Worker]) -> None:
    for worker in workers:
        worker.stop()
    for worker in workers:
        worker.end()


def _taken(worker: Worker) -> tuple[Answer[Any], bool]:
    """Return the answer of a process, or why it gives none, and whether it is lost."""
    try:
        answer = worker.answer()
    except (EOFError, OSError):
        code = worker.exit_code()
        end = "gave half an answer and was ended" if code is None else _end(code)
        return Answer(failure=f"the process {end}"), True
    except Exception as error:
        return Answer(failure=f"no readable answer: {reason(error)}"), True
    if not isinstance(answer, Answer):
        return Answer(failure="no readable answer"), True
    return answer, False


def _end(code: int) -> str:
    if code == OUT_OF_MEMORY:
        return "was ended: the FMU had more memory than --memory gives"
    if code < 0:
        with contextlib.suppress(ValueError):
            return f"crashed ({signal.Signals(-code).name})"
    return f"ended by itself with exit code {code}"
