"""Worker processes: a crash or a hang of an FMU costs its task and nothing else.

One kind of worker computes the truth and runs the reference, the other holds an FMU. Every task
returns an `Answer`, also where the worker crashed.
"""

import contextlib
import math
import os
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any, TypeVar

from stickslip_verification.drive import exact as motions
from stickslip_verification.drive.exact import kept
from stickslip_verification.drive.fmu.description import FmuError, NameMap, Variable
from stickslip_verification.drive.fmu.instance import FmuFile
from stickslip_verification.drive.masters import MANNERS, Master, Setting, run_case
from stickslip_verification.drive.other_runs import RUNS
from stickslip_verification.drive.probes.environments import PROBES
from stickslip_verification.drive.processes import Answer, LostError, Worker, answer_of
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.faults import Hook
from stickslip_verification.suite.invariants import Probe

T = TypeVar("T")

NOT_MADE = "not finished"  # beginning of the failure of a run for which no time was left
TIME_LIMIT = PROBE_LIMIT = 60.0
"""Seconds that one run of a case, or one probe, may take; the longest of the suite takes a few."""
MOST_PER_PROCESSOR = 4
"""Processes for each processor; more of them only take memory from each other."""

_GIGABYTE = 1e9


@dataclass(frozen=True)
class Limits:
    """What an FMU may take.

    ``budget`` is the time [s] of all its runs without a result together, so that a slow FMU that
    finishes its runs is not ended; ``memory`` that of each process with all that it starts [GB].
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


# Tasks about a case, without an FMU.
exact = partial(kept, motions.exact_motion)
reference = partial(kept, motions.run_reference)
spreads = partial(kept, motions.spreads)
changes = partial(kept, motions.changes)
observed_order = partial(kept, motions.observe)


def open_fmu() -> None:
    """Open the FMU of this process, if it can be opened."""
    with contextlib.suppress(FmuError):
        _fmu()


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


@dataclass(eq=False)
class _Task:
    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    limit: float
    begun: float = 0.0
    answer: Answer[Any] | None = None

    @property
    def seconds(self) -> float:
        return time.monotonic() - self.begun


class Pool(contextlib.AbstractContextManager["Pool"]):
    """A few processes, `jobs` at most, that work through tasks while an answer is waited for.

    Leaving the `with` block ends whatever still runs, and what an FMU left behind. A task may take
    `time_limit` [s]; with `fresh` each gets a new process, for an FMU that lives only once in one.
    The processes open an FMU, see `FmuFile`, which may take `limits`; without one time alone is
    limited.
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
        self._jobs, self._limit, self._fresh = allowed(jobs), time_limit, fresh
        self._budget = limits.budget if fmu is not None else math.inf
        self._folder = tempfile.TemporaryDirectory(prefix="stickslip-", ignore_cleanup_errors=True)
        opened = fmu and partial(FmuFile, fmu, names, hooks, own_starts=own_starts)
        memory = None if fmu is None else round(limits.memory * _GIGABYTE)
        self._start = partial(Worker, _begin, (self._folder.name, opened), memory)
        self._waiting: deque[_Task] = deque()
        self._idle: list[Worker] = []
        self._busy: dict[Worker, _Task] = {}
        self._lost, self._over = 0.0, False

    def each(
        self, task: Callable[..., T], arguments: Sequence[tuple[Any, ...]], most: float = math.inf
    ) -> Iterator[Answer[T]]:
        """Yield the answers of a task to tuples of arguments; `most` [s] is a lower time limit."""
        tasks = [_Task(task, each, min(self._limit, most)) for each in arguments]
        self._waiting.extend(tasks)
        return map(self._answer, tasks)

    def __exit__(self, *_: object) -> None:
        for worker in (*self._idle, *self._busy):
            worker.end()
        self._folder.cleanup()

    def _answer(self, task: _Task) -> Answer[Any]:
        while task.answer is None and not self._over:
            self._work()
        failure = (
            f"{NOT_MADE}: runs without a result took {self._budget:g} s, all that the FMU has "
            "for them; --budget gives more"
        )
        return task.answer or Answer(failure=failure, late=True)

    def _work(self) -> None:
        """Have processes begin what is waiting, wait for one, and end those without time left."""
        while self._waiting and len(self._busy) < self._jobs:
            worker = self._idle.pop() if self._idle else self._start()
            self._busy[worker] = task = self._waiting.popleft()
            task.begun = time.monotonic()
            worker.give(answer_of, (task.function, *task.arguments))
        # A loss grows as fast as time does, in each process at once.
        left = [task.limit - task.seconds for task in self._busy.values()]
        seconds = max(0.0, min(self._budget - self._lost_now(), *left))
        wait([each for worker in self._busy for each in worker.handles], seconds)
        for worker, task in list(self._busy.items()):
            ends = True
            if wait(worker.handles, 0.0):
                try:
                    task.answer, ends = worker.answer(), self._fresh
                    if not isinstance(task.answer, Answer):
                        raise LostError("gave no readable answer")
                except LostError as lost:
                    task.answer, ends = Answer(failure=f"the process {lost}"), True
            elif task.seconds >= task.limit:
                failure = f"no answer within {task.limit:g} s; the process was ended"
                task.answer = Answer(failure=failure, late=True)
            else:
                continue
            del self._busy[worker]
            if task.answer.failure is not None:
                self._lost += task.seconds
            if ends:
                worker.end()
            else:
                self._idle.append(worker)
        self._over = self._lost_now() >= self._budget

    def _lost_now(self) -> float:
        """Return the time [s] spent on tasks that failed or are not answered yet."""
        running = sum(task.seconds for task in self._busy.values())
        return (self._lost + running) / max(1, len(self._busy) + len(self._idle))


_OPENED: list[Callable[[], FmuFile]] = []  # opens the FMU of a worker, once


def _begin(folder: str, opened: Callable[[], FmuFile] | None) -> None:
    tempfile.tempdir = folder
    if opened is not None:
        _OPENED.append(cache(opened))


def _fmu() -> FmuFile:
    return _OPENED[0]()
