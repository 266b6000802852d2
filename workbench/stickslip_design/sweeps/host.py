"""The process beside a worker that holds the FMUs: started, watched, and started again.

A worker of a cluster may not start processes of multiprocessing, so this one is a program of its
own, `child`. A run that crashes it, or takes longer than the plan allows, costs that run alone.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip_verification import FmuError
from stickslip_verification.drive.fmu.description import new_folder, unpack

from .child import ENDED, FAILED, READY, TAKEN, receive, send
from .job import Job
from .refusal import SweepError

STARTING: Final = 60.0
"""Seconds that loading the FMUs may take, beside the time limit of a run."""

_PERIOD: Final = 0.02
"""Seconds between two looks at the clock."""

_ATTEMPTS: Final = 3
"""Processes that are started for some runs until one takes them."""

_LONGEST_REASON: Final = 300
"""Characters of a reason that are kept."""

_ENDING: Final = 2.0
"""Seconds in which a process that was told to end has to."""


class Outcome(NamedTuple):
    """What a run gave: its results, or why there are none."""

    values: NDArray[np.float64] | None
    failure: str


class Host:
    """Runs a job in a process of its own.

    Parameters
    ----------
    job
        What the runs have in common.
    content, is_system
        The bytes of the FMU or SSP file.
    time_limit
        Seconds that a run may take.

    Raises
    ------
    SweepError
        If the FMUs cannot be unpacked.
    """

    def __init__(self, job: Job, content: bytes, is_system: bool, time_limit: float) -> None:
        self._job = job
        self._limit = time_limit
        self._child: subprocess.Popen[bytes] | None = None
        self._ready = self._fresh = False
        self._lock = threading.Lock()
        self._deadline: float | None = None
        self._late = False
        self._closed = threading.Event()
        try:
            self._folder = new_folder()
            try:
                self._folders = _unpacked(job, content, is_system, self._folder)
            except BaseException:
                shutil.rmtree(self._folder, ignore_errors=True)
                raise
        except FmuError as error:
            raise SweepError(str(error)) from None
        self._watch = threading.Thread(target=self._watched, daemon=True)
        self._watch.start()

    def runs(self, values: NDArray[np.float64]) -> Iterator[Outcome]:
        """Yield the outcome of each run, in order.

        Parameters
        ----------
        values
            Of the swept variables, shape (runs, variables).

        Raises
        ------
        SweepError
            If the FMUs cannot be loaded.
        """
        rows = np.ascontiguousarray(values, dtype=np.float64)
        if not rows.shape[1]:
            # A frame says how many runs there are by its length alone.
            rows = np.zeros((len(rows), 1))
        done = 0
        while done < len(rows):
            child = self._given(rows[done:].tobytes())
            while done < len(rows):
                answer = self._answer(child)
                if answer is not None and answer[:1] != ENDED:
                    self._fresh = False
                    done += 1
                    yield _outcome(answer)
                    continue
                used, reason = not self._fresh, self._ended(child, answer)
                # What an earlier run left behind must not decide: it is done again on its own.
                if not used:
                    done += 1
                    yield Outcome(None, reason)
                break

    def _given(self, runs: bytes) -> subprocess.Popen[bytes]:
        """Return the process, which has taken these runs.

        One that ends before it takes them, as when it is killed from elsewhere, is replaced: what
        is left in its pipes is unknown.
        """
        for _ in range(_ATTEMPTS):
            child = self._started()
            self._late = False
            with contextlib.suppress(OSError):
                send(_pipe(child.stdin), runs)
                if self._answer(child, STARTING) == TAKEN:
                    return child
            self._drop()
        raise SweepError(f"the process that holds the model ended {_ATTEMPTS} times before a run")

    def close(self, *, at_once: bool = False) -> None:
        """End the process, at once or after its FMUs are freed, and remove the unpacked FMUs."""
        if self._child is not None and not at_once:
            with contextlib.suppress(OSError):
                send(_pipe(self._child.stdin), b"")
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._child.wait(_ENDING)
        self._drop()
        self._closed.set()
        self._watch.join()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _drop(self) -> None:
        """End the process at once."""
        child, self._child, self._ready = self._child, None, False
        if child is not None:
            child.kill()
            _reap(child)

    def _started(self) -> subprocess.Popen[bytes]:
        """Return the process, ready for runs."""
        if self._child is None:
            self._child = subprocess.Popen(
                [sys.executable, "-m", f"{__package__}.child", self._folder],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                # Threads of a library would not be there in a fork.
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
            )
            with contextlib.suppress(OSError):
                send(_pipe(self._child.stdin), pickle.dumps((self._job, self._folders)))
        child = self._child
        if not self._ready:
            answer = self._answer(child, STARTING + self._limit)
            if answer is None or answer[:1] == ENDED:
                raise SweepError(f"while it was loaded the model {self._ended(child, answer)}")
            if answer[:1] != READY:
                raise SweepError(answer[1:].decode())
            self._ready = self._fresh = True
        return child

    def _answer(self, child: subprocess.Popen[bytes], limit: float | None = None) -> bytes | None:
        """Return the next answer; None if the process ended, or was ended for being late."""
        self._deadline = time.monotonic() + (self._limit if limit is None else limit)
        try:
            return receive(_pipe(child.stdout))
        finally:
            with self._lock:
                self._deadline = None

    def _ended(self, child: subprocess.Popen[bytes], answer: bytes | None) -> str:
        """Return why a process has ended, or its fork, as its last answer says."""
        late, self._late = self._late, False
        self._ready = False
        if answer is not None:
            code = int(answer[1:])
        else:
            self._child = None
            try:
                code = child.wait(_ENDING)
            except subprocess.TimeoutExpired:
                child.kill()
                code = -signal.SIGKILL
            _reap(child)
        if late:
            return f"took longer than {self._limit:g} s"
        if code < 0:
            with contextlib.suppress(ValueError):
                return f"crashed ({signal.Signals(-code).name})"
        return f"ended the process with exit code {code}"

    def _watched(self) -> None:
        """End the process where an answer is late."""
        while not self._closed.wait(_PERIOD):
            with self._lock:
                child = self._child
                late = self._deadline is not None and time.monotonic() > self._deadline
                if late and child is not None:
                    self._late, self._deadline = True, None
                    child.terminate()


def _outcome(answer: bytes) -> Outcome:
    if answer[:1] == FAILED:
        said = " ".join(answer[1:].decode().split())
        cut = said if len(said) <= _LONGEST_REASON else f"{said[: _LONGEST_REASON - 3]}..."
        return Outcome(None, cut)
    return Outcome(np.frombuffer(answer[1:]), "")


def _unpacked(job: Job, content: bytes, is_system: bool, folder: Path) -> list[Path]:
    """Unpack the FMUs of the components, and return where each is."""
    archive = folder / "model"
    archive.write_bytes(content)
    if is_system:
        (folder / "system").mkdir()
        unpack(archive, folder / "system")
    folders = []
    for index, component in enumerate(job.components):
        target = folder / str(index)
        target.mkdir()
        unpack(folder / "system" / component.source if is_system else archive, target)
        folders.append(target)
    return folders


def _pipe(stream: Any) -> Any:
    assert stream is not None
    return stream


def _reap(child: subprocess.Popen[bytes]) -> None:
    child.wait()
    for stream in (child.stdin, child.stdout):
        if stream is not None:
            with contextlib.suppress(OSError):
                stream.close()
