"""Worker processes: a crash or a hang of an FMU costs its task and nothing else.

One kind of worker computes the truth and runs the reference, the other holds an FMU. Every task
returns an `Answer`, also where the worker crashed.
"""

import contextlib
import math
import multiprocessing
import os
import signal
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import TimeoutError as Late
from dataclasses import dataclass
from multiprocessing import forkserver, resource_tracker
from multiprocessing.context import BaseContext
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

from pebble import ProcessExpired, ProcessFuture, ProcessPool

from stickslip_verification.drive import convergence
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact, exact_motion
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.kept import kept
from stickslip_verification.drive.other_runs import RUNS
from stickslip_verification.drive.probes import PROBES
from stickslip_verification.drive.reference import run_reference
from stickslip_verification.drive.stepping import NotApplicableError, run_case
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import ObservedOrder
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.faults import Hook
from stickslip_verification.suite.invariants import Order, Probe

T = TypeVar("T")

TIME_LIMIT = 60.0
"""Seconds that one run of a case may take; the longest of the suite takes a few."""

PROBE_LIMIT = 60.0
"""Seconds that one probe may take; the longest, of the memory of 1e5 steps, takes two."""

_ERRORS = 2
"""The descriptor of standard error."""


def jobs_here() -> int:
    """Return the number of processes that may work at once: one per processor."""
    return max(
        1, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    )


def exact(case: Case) -> Answer[Exact]:
    """Compute the exact motion of a case."""
    return _answer(kept, exact_motion, case)


def reference(case: Case) -> Answer[Run]:
    """Run the reference on a case."""
    return _answer(kept, run_reference, case)


def observed_order(case: Case, invariant: Order) -> Answer[ObservedOrder]:
    """Observe how the reference's error falls with its tolerance."""
    return _answer(kept, convergence.observe, case, invariant)


def plain_run(case: Case) -> Answer[Run]:
    """Run the FMU of this process on a case."""
    return _answer(lambda: run_case(_fmu(), case))


def other_run(case: Case, run: str) -> Answer[Run]:
    """Run the FMU of this process on a case in another way, a key of `RUNS`."""
    return _answer(lambda: RUNS[run](_fmu(), case))


def probe(invariant: Probe) -> Answer[list[str]]:
    """Try a probe on the FMU of this process."""
    return _answer(lambda: PROBES[invariant.probe](_fmu(), **invariant.arguments))


class Pool:
    """A few processes that work through tasks.

    Leaving its `with` block stops whatever still runs.

    Parameters
    ----------
    jobs
        How many processes.
    time_limit
        Seconds that one task may take.
    fmu, names, hooks
        The FMU that the processes hold, and the map to its names; None for those without. Faults
        planted between the suite and the FMU.
    fresh
        Whether each task gets a new process, for an FMU that lives only once in one.
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
    ) -> None:
        self._limit = time_limit
        self._folder = tempfile.TemporaryDirectory(prefix="stickslip-")
        self._pool = ProcessPool(
            max_workers=jobs,
            max_tasks=1 if fresh else 0,
            initializer=_begin,
            initargs=(self._folder.name, fmu, names, hooks),
            context=_context(),
        )

    def each(
        self,
        task: Callable[..., Answer[T]],
        arguments: Sequence[tuple[Any, ...]],
        most: float = math.inf,
    ) -> Iterator[Answer[T]]:
        """Run the task for each tuple of arguments; yield the answers in the same order.

        All tasks are scheduled at once. `most` [s] is a time limit below the pool's.
        """
        limit = min(self._limit, most)
        futures: list[ProcessFuture[Answer[T]]] = [
            self._pool.schedule(task, args=each, timeout=limit) for each in arguments
        ]
        return (_outcome(future, limit) for future in futures)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._pool.stop()  # type: ignore[no-untyped-call]  # pebble leaves it without types
        self._pool.join()
        self._folder.cleanup()


@dataclass
class _Held:
    """The FMU of a worker, opened at its first use."""

    path: Path | None = None
    names: NameMap | None = None
    hooks: Sequence[Hook] = ()
    file: FmuFile | None = None


_HELD = _Held()


def _outcome(future: ProcessFuture[Answer[T]], limit: float) -> Answer[T]:
    try:
        return future.result()
    except Late:
        return Answer(failure=f"no answer within {limit:g} s; the process was ended", late=True)
    except ProcessExpired as error:
        return Answer(failure=f"the process {_end(error.exitcode)}")
    except Exception as error:
        return Answer(failure=_reason(error))


def _begin(folder: str, fmu: Path | None, names: NameMap | None, hooks: Sequence[Hook]) -> None:
    """Set up a worker: it ignores Ctrl-C, and an FMU's prints are discarded."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tempfile.tempdir = folder
    _HELD.path, _HELD.names, _HELD.hooks = fmu, names, hooks
    if fmu is not None:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for stream in (1, 2):
            os.dup2(nowhere, stream)
        os.close(nowhere)


def _fmu() -> FmuFile:
    if _HELD.file is None:
        assert _HELD.path is not None
        _HELD.file = FmuFile(_HELD.path, _HELD.names, _HELD.hooks)
    return _HELD.file


def _answer(function: Callable[..., T], *arguments: Any) -> Answer[T]:
    try:
        return Answer(function(*arguments))
    except NotApplicableError as error:
        return Answer(not_applicable=str(error))
    except (Exception, SystemExit, KeyboardInterrupt) as error:
        # Code that a fault brings along may try to leave; Ctrl-C does not reach this process.
        return Answer(failure=_reason(error))


def _reason(error: BaseException) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def _end(code: int) -> str:
    if code < 0:
        with contextlib.suppress(ValueError):
            return f"crashed ({signal.Signals(-code).name})"
    return f"ended by itself with exit code {code}"


def _context() -> BaseContext:
    """Return the context that starts workers fastest: forks of a server with all modules loaded."""
    methods: Mapping[str, None] = dict.fromkeys(multiprocessing.get_all_start_methods())
    context = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    if "forkserver" in methods:
        context.set_forkserver_preload([__name__])
        _start_server()
    return context


def _start_server() -> None:
    """Start the fork server with Ctrl-C blocked and standard error discarded from the start.

    By itself it ignores Ctrl-C only once its modules are loaded, after about a second. A worker
    that it forks during an interrupt would print a traceback of no use.
    """
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        with _silent():
            forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Discard the standard error of processes started in this block."""
    try:
        kept = os.dup(_ERRORS)
    except OSError:  # closed already
        yield
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, _ERRORS)
    os.close(nowhere)
    try:
        yield
    finally:
        os.dup2(kept, _ERRORS)
        os.close(kept)
