"""The process that holds the FMUs of a sweep: started, given runs, and replaced where it ends.

A run that crashes it, or takes longer than the plan allows, costs that run alone: what each run
gave is in a file that both processes have in memory.
"""

from __future__ import annotations

import multiprocessing
import shutil
import signal
import sys
from collections.abc import Callable, Sequence
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from stickslip_verification import FmuError
from stickslip_verification.drive.fmu.description import new_folder, unpack
from stickslip_verification.drive.processes import LostError, Worker

from .job import Job
from .refusal import SweepError
from .runner import Runner

_STARTING: Final = 60.0
"""Seconds that loading the FMUs may take, beside the time limit of a run."""
_ATTEMPTS: Final = 3
"""Processes that are started for a run until one begins it."""
_ENDING: Final = 2.0
"""Seconds in which the FMUs have to be freed."""
_WAITS, _BEGUN, _DONE = range(3)
"""States of a run."""
_LONGEST_REASON: Final = 300
"""Characters of a reason that are kept."""


def _table(folder: Path, job: Job, mode: Any, runs: int | None = None) -> NDArray[Any]:
    """Return state, reason of failure and results of each run, in the memory of two processes."""
    results = ("values", np.float64, (len(job.columns),))
    record = np.dtype([("state", "u1"), ("failure", f"U{_LONGEST_REASON}"), results])
    table = np.memmap(folder / "runs", record, mode, shape=runs and (runs,))
    # Of a plain array a value is written in a tenth of the time.
    return table.view(np.ndarray)


class Host:
    """Runs a job in a process of its own; `SweepError` if its FMUs cannot be unpacked.

    Parameters
    ----------
    job
        What the runs have in common.
    content, is_system
        The bytes of the FMU or SSP file.
    time_limit
        Seconds that a run may take.
    """

    def __init__(self, job: Job, content: bytes, is_system: bool, time_limit: float) -> None:
        self._job, self._limit = job, time_limit
        self._worker: Worker | None = None
        self._is_fresh = False
        try:
            self._folder = new_folder()
            try:
                self._folders = _unpacked(job, content, is_system, self._folder)
            except BaseException:
                self.close()
                raise
        except FmuError as error:
            raise SweepError(str(error)) from None

    def runs(self, rows: NDArray[np.float64]) -> tuple[NDArray[np.float64], list[str]]:
        """Return results and reason of failure of each run, NaN and empty where there is none.

        Parameters
        ----------
        rows
            Values of the swept variables, shape (runs, variables).

        Raises
        ------
        SweepError
            If the FMUs cannot be loaded.
        """
        table = _table(self._folder, self._job, "w+", len(rows))
        done = lost = 0
        while done < len(rows):
            limit = _STARTING + self._limit * (len(rows) - done)
            worker, was_fresh = self._loaded(), self._is_fresh
            self._is_fresh = False
            end = self._ask(worker, limit, _run, rows[done:], done)
            begun, done = done, int(np.count_nonzero(table["state"] == _DONE))
            if end is None:
                break
            if done > begun or not was_fresh:
                # What an earlier run left behind must not decide: it is done again on its own.
                lost = 0
            elif table["state"][done] == _BEGUN:
                table[done] = (_DONE, end, np.nan)
                done, lost = done + 1, 0
            else:
                lost += 1
                if lost == _ATTEMPTS:
                    raise SweepError(f"the process of the model {end}, {lost} times before a run")
        return np.array(table["values"]), table["failure"].tolist()

    def close(self) -> None:
        """End the process, after its FMUs are freed, and remove the unpacked FMUs."""
        if self._worker is not None:
            self._ask(self._worker, _ENDING, _free)
        self.drop()
        shutil.rmtree(self._folder, ignore_errors=True)

    def drop(self) -> None:
        """End the process at once."""
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.end()

    def _loaded(self) -> Worker:
        """Return the process, ready for runs."""
        if self._worker is None:
            # A nanny of dask forbids its worker to have children: they would outlive it, and these
            # end with their connection.
            multiprocessing.current_process()._config["daemon"] = False  # type: ignore[attr-defined]
            begin = (self._job, self._folder, self._limit)
            self._worker = Worker(_begin, begin, sys.maxsize, self._folder)
            failure = self._ask(self._worker, _STARTING + self._limit, _load, self._folders)
            if failure is not None:
                self.drop()
                raise SweepError(failure)
            self._is_fresh = True
        return self._worker

    def _ask(
        self, worker: Worker, seconds: float, task: Callable[..., str | None], *arguments: Any
    ) -> str | None:
        """Return what a task answers, or how the process ended."""
        worker.give(task, arguments)
        if not wait(worker.handles, seconds):
            self.drop()
            return f"took longer than {self._limit:g} s"
        try:
            answer: str | None = worker.answer()
        except LostError as error:
            self.drop()
            if "SIGALRM" in str(error):
                return f"took longer than {self._limit:g} s"
            return str(error)
        return answer


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


_JOB: list[Any] = []
"""In the process of the FMUs: the job, its folder, the time limit, and what does the runs."""


def _begin(*job: Any) -> None:
    _JOB[:] = job
    if sys.platform != "win32":
        signal.signal(signal.SIGALRM, signal.SIG_DFL)


def _load(folders: Sequence[Path]) -> str | None:
    try:
        _JOB.append(Runner(_JOB[0], folders))
    except FmuError as error:
        return str(error)
    return None


def _run(rows: NDArray[np.float64], first: int) -> None:
    job, folder, limit, runner = _JOB
    table = _table(folder, job, "r+")
    states, failures, results = (table[name] for name in ("state", "failure", "values"))
    for place, row in enumerate(rows, first):
        states[place] = _BEGUN
        _end_after(limit)
        try:
            results[place] = runner.run(row)
        except FmuError as error:
            said = " ".join(str(error).split())
            cut = said if len(said) <= _LONGEST_REASON else f"{said[: _LONGEST_REASON - 3]}..."
            failures[place], results[place] = cut, np.nan
        states[place] = _DONE
    _end_after(0.0)


def _end_after(seconds: float) -> None:
    """End this process after so many seconds whatever the FMU does; 0: not."""
    if sys.platform != "win32":
        signal.setitimer(signal.ITIMER_REAL, seconds)


def _free() -> None:
    _JOB[-1].close()
