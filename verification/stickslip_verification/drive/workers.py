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
from multiprocessing.connection import wait
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

from stickslip_verification.drive import convergence, nearby
from stickslip_verification.drive.answer import Answer, answer_of, reason
from stickslip_verification.drive.exact import Exact, exact_motion
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
from stickslip_verification.model.run import Run, Series
from stickslip_verification.model.verdict import ObservedOrder
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.faults import Hook
from stickslip_verification.suite.invariants import Order, Probe

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


def exact(case: Case) -> Answer[Exact]:
    """Compute the exact motion of a case."""
    return answer_of(kept, exact_motion, case)


def reference(case: Case) -> Answer[Run]:
    """Run the reference on a case."""
    return answer_of(kept, run_reference, case)


def spreads(case: Case) -> Answer[dict[str, Series]]:
    """Follow motions near the exact one of a case."""
    return answer_of(kept, nearby.spreads, case)


def changes(case: Case) -> Answer[dict[str, dict[str, Series]]]:
    """Follow a case with each of its parameters a little larger."""
    return answer_of(kept, nearby.changes, case)


def observed_order(case: Case, invariant: Order) -> Answer[ObservedOrder]:
    """Observe how the reference's error falls with its tolerance."""
    return answer_of(kept, convergence.observe, case, invariant)


def open_fmu() -> Answer[bool]:
    """Read the description of the FMU of this process; whether that is possible."""
    try:
        return Answer(_fmu() is not None)
    except FmuError:
        return Answer(False)


def plain_run(case: Case) -> Answer[Run]:
    """Run the FMU of this process on a case."""
    return answer_of(lambda: run_case(_fmu(), case))


def other_run(case: Case, run: str) -> Answer[Run]:
    """Run the FMU of this process on a case in another way, a key of `RUNS`."""
    return answer_of(lambda: RUNS[run](_fmu(), case))


def in_manner(case: Case, manner: str) -> Answer[Run]:
    """Run the FMU of this process on a case in a manner, a key of `MANNERS`."""
    return answer_of(lambda: MANNERS[manner](_fmu(), case))


def probe(invariant: Probe) -> Answer[list[str]]:
    """Try a probe on the FMU of this process."""
    return answer_of(lambda: PROBES[invariant.probe](_fmu(), **invariant.arguments))


def trial_run(
    setting: Setting, variables: Mapping[str, Variable], names: Sequence[str]
) -> Answer[Run]:
    """Run the FMU of this process through a setting, by `variables` under any names."""

    def whole() -> Run:
        fmu = _fmu()
        fmu.variables = variables
        master = Master(fmu, setting)
        master.names = names
        return master.run()

    return answer_of(whole)


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
        self._arguments = (self._folder.name, fmu, names, hooks, own_starts)
        self._waiting: deque[_Order] = deque()
        self._idle: list[Worker] = []
        self._busy: dict[Worker, _Order] = {}
        self._lost = 0.0

    def each(
        self,
        task: Callable[..., Answer[T]],
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

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._waiting.clear()
        workers = (*self._idle, *self._busy)
        for worker in workers:
            worker.stop()
        for worker in workers:
            worker.end()
        self._folder.cleanup()

    def _answer_to(self, order: "_Order") -> Answer[Any]:
        while order.answer is None:
            self._assign()
            self._wait()
        return order.answer

    def _assign(self) -> None:
        """Give each process a task, starting those that may be started."""
        while self._waiting and (self._idle or len(self._busy) < self._jobs):
            worker = self._idle.pop() if self._idle else self._start()
            order = self._waiting.popleft()
            order.begun = time.monotonic()
            self._busy[worker] = order
            # One that has ended in the meantime is found by `_wait`.
            with contextlib.suppress(OSError):
                worker.give(order.task, order.arguments)

    def _start(self) -> Worker:
        return Worker(_begin, self._arguments, self._memory)

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
                self._take(worker, order, now)
            elif now >= order.begun + order.limit:
                failure = f"no answer within {order.limit:g} s; the process was ended"
                self._drop(worker, order, Answer(failure=failure, late=True), now)
        if self._lost_till(now) >= self._budget:
            self._give_up()

    def _lost_till(self, now: float) -> float:
        """Return the time [s] spent on tasks that failed or are not answered yet."""
        running = sum(now - order.begun for order in self._busy.values())
        return (self._lost + running) / max(1, len(self._busy) + len(self._idle))

    def _take(self, worker: Worker, order: "_Order", now: float) -> None:
        """Take the answer of a process, or the reason why it gives none."""
        try:
            answer = worker.answer()
        except (EOFError, OSError):
            code = worker.exit_code()
            end = "gave half an answer and was ended" if code is None else _end(code)
            self._drop(worker, order, Answer(failure=f"the process {end}"), now)
            return
        except Exception as error:
            self._drop(worker, order, Answer(failure=f"no readable answer: {reason(error)}"), now)
            return
        if not isinstance(answer, Answer):
            self._drop(worker, order, Answer(failure="no readable answer"), now)
        elif self._fresh:
            self._drop(worker, order, answer, now)
        else:
            self._settle(order, answer, now)
            del self._busy[worker]
            self._idle.append(worker)

    def _drop(self, worker: Worker, order: "_Order", answer: Answer[Any], now: float) -> None:
        """Settle a task and end its process."""
        self._settle(order, answer, now)
        del self._busy[worker]
        worker.end()

    def _settle(self, order: "_Order", answer: Answer[Any], now: float) -> None:
        order.answer = answer
        if answer.failure is not None:
            self._lost += now - order.begun

    def _give_up(self) -> None:
        """Answer all tasks that are left with the end of the budget."""
        failure = (
            f"{NOT_MADE}: runs without a result took {self._budget:g} s, all that the FMU has "
            "for them; --budget gives more"
        )
        for worker in self._busy:
            worker.stop()
        for worker in self._busy:
            worker.end()
        for order in (*self._busy.values(), *self._waiting):
            order.answer = Answer(failure=failure, late=True)
        self._busy.clear()
        self._waiting.clear()


@dataclass(eq=False)
class _Order:
    """A task, since when it runs, and its answer."""

    task: Callable[..., Answer[Any]]
    arguments: tuple[Any, ...]
    limit: float
    begun: float = 0.0
    answer: Answer[Any] | None = None


@dataclass
class _Held:
    """The FMU of a worker, opened at its first use."""

    path: Path | None = None
    names: NameMap | None = None
    hooks: Sequence[Hook] = ()
    own_starts: bool | None = None
    file: FmuFile | None = None


_HELD = _Held()


def _begin(
    folder: str,
    fmu: Path | None,
    names: NameMap | None,
    hooks: Sequence[Hook],
    own_starts: bool | None,
) -> None:
    """Set up a worker: an FMU's prints are discarded."""
    tempfile.tempdir = folder
    _HELD.path, _HELD.names, _HELD.hooks, _HELD.own_starts = fmu, names, hooks, own_starts
    if fmu is not None:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for stream in (1, 2):
            os.dup2(nowhere, stream)
        os.close(nowhere)


def _fmu() -> FmuFile:
    if _HELD.file is None:
        assert _HELD.path is not None
        _HELD.file = FmuFile(_HELD.path, _HELD.names, _HELD.hooks, own_starts=_HELD.own_starts)
    return _HELD.file


def _end(code: int) -> str:
    if code == OUT_OF_MEMORY:
        return "was ended: the FMU had more memory than --memory gives"
    if code < 0:
        with contextlib.suppress(ValueError):
            return f"crashed ({signal.Signals(-code).name})"
    return f"ended by itself with exit code {code}"
