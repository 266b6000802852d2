"""Worker processes: a crash or a hang of an FMU costs its task and nothing else.

A pool gives tasks to its workers; every task returns an `Answer`, also where the worker crashed.
Without an FMU the workers compute the truth and run the reference.

Where the system has `fork`, the process that holds an FMU has a guard as its parent. The guard is
the subreaper of all its descendants (Linux, prctl(2)): a daemon that leaves its session and its
parent becomes a child of the guard. The guard ends all of them once the worker ends or is to be
ended. Without subreapers it ends the session of the worker; Windows has neither. An FMU that kills
its guard is ended with it, but a daemon of it is not.
"""

import contextlib
import ctypes
import itertools
import math
import multiprocessing
import multiprocessing.util
import os
import pickle
import select
import shutil
import signal
import socket
import struct
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from multiprocessing import forkserver, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import BaseContext
from pathlib import Path
from typing import Any, Final, Generic, TypeVar

T = TypeVar("T")


class NotApplicableError(Exception):
    """The FMU lacks what a case or an invariant needs; the text says what."""


@dataclass(frozen=True)
class Answer(Generic[T]):
    """The value of a task, its error on one line, or what the FMU lacks for it.

    ``late`` is a task that failed by its time limit.
    """

    value: T | None = None
    failure: str | None = None
    not_applicable: str | None = None
    late: bool = False


def answer_of(task: Callable[..., T], *arguments: Any) -> Answer[T]:
    """Do a task in this process; what it raises is an answer."""
    try:
        return Answer(task(*arguments))
    except NotApplicableError as error:
        return Answer(not_applicable=str(error))
    except MemoryError:
        return Answer(failure="MemoryError: more memory than --memory gives")
    except (Exception, SystemExit, KeyboardInterrupt) as error:
        # Code that a fault brings along may try to leave; Ctrl-C does not reach this process.
        return Answer(failure=reason(error))


def discard_prints() -> None:
    """Discard what this process prints, and an FMU in it."""
    with Path(os.devnull).open("wb") as nowhere:
        for stream in (1, 2):
            os.dup2(nowhere.fileno(), stream)


def reason(error: BaseException) -> str:
    """Return kind and text of an error on one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


NOT_MADE = "not finished"  # beginning of the failure of a run for which no time was left
TIME_LIMIT = PROBE_LIMIT = 60.0
"""Seconds that one run of a case, or one probe, may take; the longest of the suite takes a few."""
MOST_PER_PROCESSOR = 4
"""Processes for each processor; more of them only take memory from each other."""


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


MOST_ANSWERED: Final = 2**30
"""Bytes of one answer that are taken; the longest record of the suite has some 10^7."""
ENDING: Final = 5.0  # seconds in which a guard ends its descendants; then it is ended itself
LONGEST_SILENCE: Final = 20  # seconds in which nothing comes of an answer that was begun
SHORT_FOLDER, LONGEST_FOLDER = "/tmp", 70
"""Where sockets go if the folder for temporary files has a name of more bytes: the path of a socket
has 103 (macOS; 107 on Linux, unix(7)), and multiprocessing appends 32."""
_GUARD_PERIOD, _LOOKS_FOR_MEMORY = 20.0, 25
"""Milliseconds between two looks of a guard at its worker; at each so many looks it adds up the
memory, which takes some milliseconds."""
OUT_OF_MEMORY: Final = 251
"""Exit code of a guard whose worker, with what it started, had more memory than it may."""
_SIGNALLED: Final = 128
"""Exit code of a guard whose worker was ended by signal 0, as shells count: 139 is SIGSEGV."""

_PR_SET_PDEATHSIG: Final = 1
_PR_SET_CHILD_SUBREAPER: Final = 36

Task = Callable[..., Any]


class LostError(Exception):
    """A process ended without an answer, or gave one that cannot be read; the text says how."""


class Worker:
    """A process that calls ``begin(*arguments)`` and then does one task after another.

    It and what it starts may have `memory` bytes; None is for no FMU, no limits and no guard. The
    guard removes `folder` when nobody asks any more.
    """

    def __init__(
        self,
        begin: Task,
        arguments: tuple[Any, ...],
        memory: int | None,
        folder: Path | None = None,
    ) -> None:
        context = fast_context()
        self.connection, theirs = context.Pipe()
        self._process = context.Process(  # type: ignore[attr-defined]  # typeshed leaves it out
            target=_serve, args=(theirs, memory, folder, begin, *arguments)
        )
        self._process.start()
        # With a copy here, the end of the process would not end the connection.
        theirs.close()
        # For `multiprocessing.connection.wait`: an answer, and the end of the process.
        self.handles = self.connection, self._process.sentinel
        self._has_guard = memory is not None and sys.platform != "win32"
        if sys.platform != "win32":
            # A wait for the rest of what is sent or taken ends with an `OSError`: socket(7).
            seconds = struct.pack("ll", LONGEST_SILENCE, 0)
            with socket.fromfd(self.connection.fileno(), socket.AF_UNIX, socket.SOCK_STREAM) as own:
                own.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, seconds)
                own.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, seconds)

    def give(self, task: Task, arguments: tuple[Any, ...]) -> None:
        """Send a task; one to a process that has ended is lost, which `answer` says."""
        with contextlib.suppress(OSError):
            self.connection.send((task, arguments))

    def answer(self) -> Any:
        """Return what the process answered; `LostError` if it did not."""
        try:
            if self.connection.poll():
                return pickle.loads(self.connection.recv_bytes(MOST_ANSWERED))
        except (EOFError, OSError):
            pass
        except Exception as error:
            raise LostError(f"gave no readable answer: {reason(error)}") from None
        self._process.join(ENDING)
        code = self._process.exitcode
        if code is None:
            raise LostError("gave half an answer and was ended")
        if code == OUT_OF_MEMORY:
            raise LostError("was ended: the FMU had more memory than --memory gives")
        code = _SIGNALLED - code if code < 0 else code
        with contextlib.suppress(ValueError):
            raise LostError(f"crashed ({signal.Signals(code - _SIGNALLED).name})")
        raise LostError(f"ended by itself with exit code {code}")

    def end(self) -> None:
        """End the process and what it started."""
        self.connection.close()
        if not self._has_guard:
            self._process.terminate()
        self._process.join(ENDING + 1.0)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._process.close()


def _serve(
    connection: Connection, memory: int | None, folder: Path | None, begin: Task, *arguments: Any
) -> None:
    # Ctrl-C is for the process that asks.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    discard_prints()
    if memory is not None and sys.platform != "win32":
        _fork_guarded(connection, memory, folder)
    begin(*arguments)
    with contextlib.suppress(EOFError, ConnectionError):
        while True:
            task, of = connection.recv()
            connection.send_bytes(pickle.dumps(task(*of)))


def _fork_guarded(connection: Connection, memory: int, folder: Path | None) -> None:
    """Return in a child with limits, in a session of its own; this process becomes its guard."""
    import resource

    # RLIMIT_AS would also count what is merely reserved: runtimes with a garbage collector reserve
    # tens of gigabytes. Shared memory and the sum over processes are left to the guard, on Linux.
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    most = memory if hard == resource.RLIM_INFINITY else min(memory, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (most, most))
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)
    worker = os.fork()
    if worker == 0:
        os.setsid()
        _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        return
    # Whoever ends all processes at once ends the one that asks, and then this one ends as well.
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    code = _watch(worker, connection, memory)
    _end_descendants(worker)
    if folder is not None and code == -signal.SIGKILL:
        shutil.rmtree(folder, ignore_errors=True)
    # A signal gives the code that a shell gives.
    os._exit(code if code >= 0 else _SIGNALLED - code)


def _watch(worker: int, connection: Connection, memory: int) -> int:
    """Return the exit code of the worker, or why it is to end: no one asks, too much memory."""
    asking = select.poll()
    # Without any event of interest, poll(2) reports that the other end was closed.
    asking.register(connection, 0)
    for look in itertools.count():
        if asking.poll(_GUARD_PERIOD):
            break
        # Of other processes this reaps what the worker left behind.
        ended, status = os.waitpid(-1, os.WNOHANG)
        if ended == worker:
            return os.waitstatus_to_exitcode(status)
        if look % _LOOKS_FOR_MEMORY == 0 and _memory_of_descendants() > memory:
            return OUT_OF_MEMORY
    return -signal.SIGKILL


def _end_descendants(worker: int) -> None:
    """Kill the session of the worker and all children, and theirs, which become this process's."""
    last = time.monotonic() + ENDING
    while time.monotonic() < last:
        with contextlib.suppress(OSError):
            os.killpg(worker, signal.SIGKILL)
        for child in (process for process, parent, _ in _processes() if parent == os.getpid()):
            with contextlib.suppress(OSError):
                os.kill(child, signal.SIGKILL)
        try:
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        except ChildProcessError:
            return
        time.sleep(0.002)


def _memory_of_descendants() -> int:
    """Return the bytes in memory of all descendants; pages that they share count for each."""
    family, pages = {os.getpid()}, 0
    others = list(_processes())
    while members := [each for each in others if each[1] in family]:
        others = [each for each in others if each[1] not in family]
        family = {process for process, _, _ in members}
        pages += sum(resident for _, _, resident in members)
    return pages * os.sysconf("SC_PAGE_SIZE")


def _processes() -> Iterator[tuple[int, int, int]]:
    """Yield number, parent and pages in memory of each process: proc(5), fields of stat."""
    for file in Path("/proc").glob("[0-9]*/stat"):
        # It may have ended since it was listed.
        with contextlib.suppress(OSError):
            # The second field, a name, may hold blanks and brackets.
            fields = file.read_bytes().rpartition(b")")[2].split()
            yield int(file.parent.name), int(fields[1]), int(fields[21])


def _prctl(option: int, value: int) -> None:
    """Set an option of this process where the kernel has it: Linux, prctl(2)."""
    if sys.platform == "linux":
        zero = ctypes.c_ulong(0)
        ctypes.CDLL(None).prctl(option, ctypes.c_ulong(value), zero, zero, zero)


def fast_context() -> BaseContext:
    """Return the context that starts workers fastest: forks of a server with all modules loaded.

    The server is started with Ctrl-C blocked, for it and all workers: by itself it ignores Ctrl-C
    only once its modules are loaded, after about a second.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    # The modules with the tasks.
    rooms = ("exact", "other_runs", "environments")
    preloaded = [f"stickslip_verification.drive.{room}" for room in rooms]
    context.set_forkserver_preload([*preloaded, "stickslip_ref"])
    usual = tempfile.gettempdir()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        # The folder of the sockets is made in that for temporary files, once in a process.
        if len(os.fsencode(usual)) > LONGEST_FOLDER:
            tempfile.tempdir = SHORT_FOLDER
        multiprocessing.util.get_temp_dir()
        # It lets Ctrl-C through again once it has started its process.
        resource_tracker.ensure_running()
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        forkserver.ensure_running()
    finally:
        tempfile.tempdir = usual
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    return context


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
    Each task gets what `fmu` opens, once in a process, as its first argument; the FMU may take
    `limits`. Without one time alone is limited.
    """

    def __init__(
        self,
        jobs: int,
        time_limit: float = TIME_LIMIT,
        fmu: Callable[[], Any] | None = None,
        *,
        fresh: bool = False,
        limits: Limits = USUAL,
    ) -> None:
        self._jobs, self._limit, self._fresh = allowed(jobs), time_limit, fresh
        self._budget = limits.budget if fmu is not None else math.inf
        self._folder = tempfile.TemporaryDirectory(prefix="stickslip-", ignore_cleanup_errors=True)
        memory = None if fmu is None else round(1e9 * limits.memory)
        self._start = partial(Worker, _begin, (self._folder.name, fmu), memory)
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
            worker.give(_answer, (task.function, *task.arguments))
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
                failure = f"no answer within {task.limit:g} s (--time-limit); the process was ended"
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


_OPENED: list[Callable[[], Any]] = []  # opens the FMU of a worker, once


def _begin(folder: str, fmu: Callable[[], Any] | None) -> None:
    tempfile.tempdir = folder
    if fmu is not None:
        _OPENED.append(cache(fmu))


def _answer(task: Task, *arguments: Any) -> Answer[Any]:
    return answer_of(lambda: task(*(opened() for opened in _OPENED), *arguments))


def open_fmu(_: object) -> None:
    """Do nothing with an FMU but open it."""
