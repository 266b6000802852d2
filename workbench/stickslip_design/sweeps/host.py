"""The process that holds the FMUs of a sweep: started, given runs, and replaced where it ends.

A run that crashes it, or takes longer than the plan allows, costs that run alone: the runs that it
was given with are done one by one.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import shutil
import signal
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip_verification import FmuError
from stickslip_verification.drive.description import new_folder, unpack
from stickslip_verification.drive.processes import LostError, Worker

from .refusal import SweepError
from .runner import Runner
from .runs import Runs

_STARTING: Final = 60.0
"""Seconds that loading the FMUs may take, beside the time limit of a run."""
_ENDING: Final = 2.0
"""Seconds in which the FMUs have to be freed."""
_LONGEST_REASON: Final = 300
"""Characters of a reason that are kept."""

_Result: TypeAlias = tuple[list[float], str]
"""Results and reason of failure of a run, NaN and empty where there is none."""


class Host:
    """Does runs of a sweep in a process of its own; `SweepError` if FMUs cannot be unpacked."""

    def __init__(self, study: Runs) -> None:
        # The process needs neither the archive nor all values.
        self._study, self._limit = replace(study, content=b"", values=()), study.time_limit
        self._worker: Worker | None = None
        try:
            self._folder = new_folder()
            try:
                self._folders = _unpacked(study, self._folder)
            except BaseException:
                self.close()
                raise
        except FmuError as error:
            raise SweepError(str(error)) from None

    def runs(self, rows: NDArray[np.float64]) -> tuple[NDArray[np.float64], list[str]]:
        """Return results and reason of failure of each run, NaN and empty where there is none.

        `rows` are values of the swept variables, shape (runs, variables). `SweepError` if the FMUs
        cannot be loaded.
        """
        values, failures = zip(*self._results(rows), strict=True)
        return np.array(values), list(failures)

    def _results(self, rows: NDArray[np.float64]) -> list[_Result]:
        is_fresh = self._worker is None
        worker = self._worker or self._loaded()
        try:
            results: list[_Result] = self._ask(worker, self._limit * len(rows), _run, rows)
        except LostError as error:
            if len(rows) == 1 and is_fresh:
                return [([np.nan] * len(self._study.columns), str(error))]
            # What an earlier run left behind must not decide: each is done on its own.
            return [result for row in rows for result in self._results(row[np.newaxis])]
        return results

    def close(self) -> None:
        """End the process, after its FMUs are freed, and remove the unpacked FMUs."""
        if self._worker is not None:
            with contextlib.suppress(LostError):
                self._ask(self._worker, _ENDING - _STARTING, _free)
        self.drop()
        shutil.rmtree(self._folder, ignore_errors=True)

    def drop(self) -> None:
        """End the process at once."""
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.end()

    def _loaded(self) -> Worker:
        """Return a new process, ready for runs."""
        # A nanny of dask forbids its worker to have children: they would outlive it, and these
        # end with their connection.
        multiprocessing.current_process()._config["daemon"] = False  # type: ignore[attr-defined]
        self._worker = worker = Worker(_begin, (self._limit,), sys.maxsize, self._folder)
        try:
            failure = self._ask(worker, self._limit, _load, self._study, self._folders)
        except LostError as error:
            failure = str(error)
        if failure:
            self.drop()
            raise SweepError(failure)
        return worker

    def _ask(
        self, worker: Worker, seconds: float, task: Callable[..., Any], *arguments: Any
    ) -> Any:
        """Return what a task answers; a `LostError` says how the process ended."""
        worker.give(task, arguments)
        reason = "SIGALRM"
        try:
            if wait(worker.handles, _STARTING + seconds):
                return worker.answer()
        except LostError as error:
            reason = str(error)
        self.drop()
        late = f"took longer than {self._limit:g} s"
        raise LostError(late if "SIGALRM" in reason else reason)


def _unpacked(study: Runs, folder: Path) -> list[Path]:
    """Unpack the FMUs of the components, and return where each is."""
    archive, system = folder / "model", folder / "system"
    archive.write_bytes(study.content)
    if study.is_system:
        system.mkdir()
        unpack(archive, system)
    folders = [folder / str(index) for index in range(len(study.components))]
    for component, target in zip(study.components, folders, strict=True):
        target.mkdir()
        unpack(system / component.source if study.is_system else archive, target)
    return folders


_STATE: list[Any] = []
"""In the process of the FMUs: the time limit, and what does the runs."""


def _begin(limit: float) -> None:
    _STATE[:] = [limit]
    if sys.platform != "win32":
        signal.signal(signal.SIGALRM, signal.SIG_DFL)


def _load(study: Runs, folders: Sequence[Path]) -> str:
    try:
        _STATE.append(Runner(study, folders))
    except FmuError as error:
        return str(error)
    return ""


def _run(rows: NDArray[np.float64]) -> list[_Result]:
    limit, runner = _STATE
    results = []
    for row in rows:
        _end_after(limit)
        try:
            results.append((runner.run(row), ""))
        except FmuError as error:
            said = " ".join(str(error).split())[:_LONGEST_REASON]
            results.append(([np.nan] * len(runner.study.columns), said))
    _end_after(0.0)
    return results


def _end_after(seconds: float) -> None:
    """End this process after so many seconds whatever the FMU does; 0: not."""
    if sys.platform != "win32":
        signal.setitimer(signal.ITIMER_REAL, seconds)


def _free() -> None:
    _STATE[-1].close()
