"""A sweep: its plan resolved, its runs done in chunks, its results as a dataset.

The FMUs are in a process of their own, replaced where it ends. A run that crashes it, or takes
longer than the plan allows, costs that run alone: the runs that it was given with are done one by
one.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import multiprocessing
import shutil
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from hashlib import sha256
from multiprocessing.connection import wait
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeAlias, Unpack

import numpy as np
from numpy.typing import NDArray

from stickslip_verification import FmuError
from stickslip_verification.drive.description import new_folder, unpack
from stickslip_verification.drive.processes import LostError, Worker

from ..chunks import Columns, Computing, Results, run
from ..datasets import digest_of, need, provenance, write_points
from .model import Model, SweepError, read_model
from .plan import TIME_LIMIT
from .resolve import Resolver
from .runs import REDUCTIONS, Runner, Runs

if TYPE_CHECKING:
    import xarray

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
        self._study, self._limit = (
            replace(study, model=replace(study.model, content=b""), values=()),
            study.time_limit,
        )
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
    archive.write_bytes(study.model.content)
    if study.model.is_system:
        system.mkdir()
        unpack(archive, system)
    folders = [folder / str(index) for index in range(len(study.model.components))]
    for component, target in zip(study.model.components, folders, strict=True):
        target.mkdir()
        unpack(system / component.source if study.model.is_system else archive, target)
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


_LONGEST_TRIAL: Final = 5.0
"""Seconds that a run may take which tries whether a reset works."""
_STEPS_OF_TRIAL: Final = 200
"""Communication steps of such a run."""

CHUNKS: Final = "chunks"
"""Name of the folder of the chunk files in that of the sweep."""

POINT: Final = "point"
FAILURE: Final = "failure"


@dataclass(frozen=True)
class Sweep(Runs):
    """A sweep as `chunks.run` computes it."""

    quantum = 1

    def compute(self, start: int, stop: int) -> Columns:
        """Do the runs from `start` up to but not including `stop`.

        `SweepError` if the model cannot be loaded here.
        """
        with _host(self) as host:
            results, failures = host.runs(self.rows(start, stop))
        names = enumerate(self.columns)
        columns: Columns = {name: results[:, place].copy() for place, name in names}
        return {**columns, FAILURE: np.array(failures, dtype=np.str_)}


_LOCK = threading.Lock()
_HOSTS: dict[str, Host] = {}
"""The host of the last sweep of this process, by the digest of its study."""


@contextmanager
def _host(study: Sweep) -> Iterator[Host]:
    """Lend the host that did other runs of the sweep in this process, or a new one."""
    key = digest_of({**study.identity, "reset": study.reset})
    with _LOCK:
        if key not in _HOSTS:
            _release()
            _HOSTS[key] = Host(study)
        try:
            yield _HOSTS[key]
        except BaseException:
            _HOSTS[key].drop()
            _release()
            raise


def _release() -> None:
    while _HOSTS:
        _HOSTS.popitem()[1].close()


@atexit.register
def release() -> None:
    """End the process that holds the FMUs of a sweep that is done."""
    with _LOCK:
        _release()


def prepare(model: Model | Path | str, plan: Path | str | Mapping[str, Any]) -> Sweep:
    """Return the study of a sweep, without a run of it; arguments and errors as of `sweep`."""
    if not isinstance(model, Model):
        model = read_model(model)
    resolver = Resolver(plan, model)
    says = resolver.says
    fixed, axes, by_table = resolver.values()
    times, steps, settled = resolver.times(varying=bool(by_table))
    tables = {name: resolver.table(name, of, times) for name, of in by_table.items()}
    resolver.check_outputs(axes)
    used = {*fixed, *axes, *by_table, *says.outputs}
    used |= {name for wire in model.wires for name in (wire.output, wire.input)}
    return Sweep(
        model=replace(model, variables={name: model.variables[name] for name in sorted(used)}),
        fixed=fixed,
        swept=tuple(axes),
        values=tuple(axes.values()),
        on_grid=not says.points,
        tables=tables,
        times=times,
        steps=steps,
        settled=settled,
        outputs=dict(says.outputs),
        time_limit=says.times.get("time_limit", TIME_LIMIT),
        reset=says.reset is not False,
        identity={
            "study": "sweep",
            "model": model.path.name,
            "model_digest": sha256(model.content).hexdigest(),
            "plan": says.as_json,
            # A digest does not see in which order a plan has them.
            "axes": list(axes),
            "tables": {name: columns.digest for name, columns in resolver.files.items()},
        },
    )


def tried(study: Sweep) -> Sweep:
    """Return the study with new instances for each run where a reset does not work.

    Some points are run in one process, then again. The first of them that comes to its end did so
    in a new instance: where it has other bits the second time, something outlived the reset. Of
    long runs only the first steps are tried. `SweepError` if the model cannot be loaded.
    """
    steps = study.steps[:_STEPS_OF_TRIAL]
    places = sorted({0, study.count // 2, study.count - 1})
    rows = np.concatenate([study.rows(place, place + 1) for place in (*places, *places)])
    short = replace(
        study,
        times=study.times[: steps.size + 1],
        steps=steps,
        settled=min(study.settled, steps.size),
        time_limit=min(study.time_limit, _LONGEST_TRIAL),
    )
    host = Host(short)
    try:
        results, failures = host.runs(rows)
    finally:
        host.close()
    first = failures.index("") if "" in failures[: len(places)] else 0
    again = first + len(places)
    works = not failures[again] and results[first].tobytes() == results[again].tobytes()
    return study if works else replace(study, reset=False)


def sweep(
    model: Path | str,
    plan: Path | str | Mapping[str, Any],
    *,
    folder: Path | str | None = None,
    **how: Unpack[Computing],
) -> xarray.Dataset:
    """Run a model with many settings.

    Parameters
    ----------
    model
        A co-simulation FMU 2.0 or 3.0, or an SSP file with such FMUs.
    plan
        What to set, how long to run and what to keep: a file, or what its TOML says; see
        `stickslip_design.sweeps.plan`.
    folder
        Where the study is kept, a folder or an address of fsspec: chunk files, from which it
        resumes, and the dataset as ``sweep.zarr`` (a grid) or ``sweep.parquet`` (points).
    how
        ``workers``, ``cluster``, ``fresh``, ``progress``: as of `stickslip_design.chunks.run`.

    Returns
    -------
    xarray.Dataset
        A variable for each result, in the unit that the model declares; ``failure`` says why a run
        has none, and is empty where it has. Of a grid the dimensions are the swept variables, of
        points it is ``point``. What a run set, and where the results come from, is in the
        attributes.

    Raises
    ------
    SweepError
        If model or plan cannot be used, or they do not go together.
    StudyError
        As `stickslip_design.chunks.run`.
    ExtraMissingError
        If xarray is not installed.
    """
    return computed(prepare(model, plan), folder, partial(run, **how))


def computed(
    study: Sweep, folder: Path | str | None, run: Callable[[Sweep, str | None], Results]
) -> xarray.Dataset:
    """Return the dataset of a study that `run` computes, given the folder of its chunk files."""
    need("xarray")
    if folder is not None:
        need("zarr" if study.on_grid else "pyarrow")
        folder = str(folder if "://" in str(folder) else Path(folder))
    if study.reset:
        study = tried(study)
    try:
        results = run(study, None if folder is None else f"{folder}/{CHUNKS}")
    finally:
        release()
    dataset = _dataset(study, results.read())
    if folder is not None:
        target = f"{folder}/{file_of(study)}"
        if study.on_grid:
            dataset.to_zarr(target, mode="w", consolidated=False)
        else:
            write_points(dataset, target)
    return dataset


def file_of(study: Sweep) -> str:
    """Return the name of the dataset in the folder of a sweep."""
    return "sweep.zarr" if study.on_grid else "sweep.parquet"


def _dataset(study: Sweep, columns: Columns) -> xarray.Dataset:
    variables = study.model.variables
    about = {}
    for (name, reduction), column in zip(study.results, study.columns, strict=True):
        of, text = REDUCTIONS[reduction], variables[name].description or name
        if reduction != "last":
            text = f"{text}: {of.meaning}"
        about[column] = {"units": of.unit or variables[name].unit, "long_name": text}
    about[FAILURE] = {"long_name": "why the run failed"}
    coordinates = {}
    for name, values in zip(study.swept, study.values, strict=True):
        meant = {"units": variables[name].unit, "long_name": variables[name].description or name}
        coordinates[name] = (name if study.on_grid else POINT, values, meant)
    fixed = {
        name: f"{value!r} {variables[name].unit}".strip() for name, value in study.fixed.items()
    }
    # Texts of any length have a specification in zarr.
    columns = {**columns, FAILURE: columns[FAILURE].astype(object)}
    dims = study.swept if study.on_grid else (POINT,)
    dataset: xarray.Dataset = need("xarray").Dataset(
        {name: (dims, columns[name].reshape(study.shape), about[name]) for name in columns},
        coords=coordinates,
        attrs={**provenance(study.identity), "fixed": json.dumps(fixed)},
    )
    return dataset
