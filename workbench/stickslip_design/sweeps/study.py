"""A sweep: its plan resolved, its runs done in chunks, its results as a dataset."""

from __future__ import annotations

import atexit
import json
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from ..chunks import Columns, Progress, Results, run
from ..datasets import digest_of, need, provenance, write_grid, write_points
from .host import Host
from .job import Job, column_of
from .model import Model, read_model
from .plan import TIME_LIMIT, PlanFile
from .reductions import REDUCTIONS
from .resolve import resolve

if TYPE_CHECKING:
    import xarray

_LONGEST_TRIAL: Final = 5.0
"""Seconds that a run may take which tries whether a reset works."""
_STEPS_OF_TRIAL: Final = 200
"""Communication steps of such a run."""

CHUNKS: Final = "chunks"
"""Name of the folder of the chunk files in that of the sweep."""

POINT: Final = "point"
FAILURE: Final = "failure"


@dataclass(frozen=True)
class Sweep:
    """A sweep as `chunks.run` computes it.

    Attributes
    ----------
    job, identity
        What the runs have in common, and all that the results depend on.
    values, on_grid
        Values of the swept variables: columns of points, or axes of a grid, whose points are all
        combinations of them, the last one running fastest.
    time_limit
        Seconds that a run may take.
    content, is_system
        The bytes of the model's file, and whether it is an SSP file.
    """

    job: Job
    values: tuple[NDArray[np.float64], ...]
    on_grid: bool
    identity: Mapping[str, Any]
    time_limit: float
    content: bytes = field(repr=False)
    is_system: bool

    quantum = 1

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of values along the axes of a grid; of points how many there are."""
        if self.on_grid:
            return tuple(each.size for each in self.values)
        return (self.values[0].size,)

    @property
    def count(self) -> int:
        """How many runs there are."""
        return int(np.prod(self.shape, dtype=np.int64))

    def rows(self, start: int, stop: int) -> NDArray[np.float64]:
        """Return the values of runs, shape (stop - start, swept variables)."""
        rows = np.empty((stop - start, len(self.values)))
        places = (
            np.unravel_index(np.arange(start, stop), self.shape)
            if self.on_grid and self.values
            else (np.arange(start, stop),) * len(self.values)
        )
        for column, (values, at) in enumerate(zip(self.values, places, strict=True)):
            rows[:, column] = values[at]
        return rows

    def compute(self, start: int, stop: int) -> Columns:
        """Do the runs from `start` up to but not including `stop`.

        Raises
        ------
        SweepError
            If the model cannot be loaded here.
        """
        with _host(self) as host:
            found, failures = host.runs(self.rows(start, stop))
        columns: Columns = {
            name: found[:, place].copy() for place, name in enumerate(self.job.columns)
        }
        columns[FAILURE] = np.array(failures, dtype=np.str_)
        return columns


_LOCK = threading.Lock()
_HOSTS: dict[str, Host] = {}
"""The host of the last sweep of this process, by the digest of its study."""


@contextmanager
def _host(study: Sweep) -> Iterator[Host]:
    """Lend the host that did other runs of the sweep in this process, or a new one."""
    key = digest_of({**study.identity, "reset": study.job.reset})
    with _LOCK:
        if key not in _HOSTS:
            _release()
            _HOSTS[key] = Host(study.job, study.content, study.is_system, study.time_limit)
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
    """Return the study of a sweep, without a run of it.

    Parameters
    ----------
    model
        The FMU or SSP file.
    plan
        The plan: a file, or what its TOML says.

    Raises
    ------
    SweepError
        If one of them cannot be used, or they do not go together.
    """
    if not isinstance(model, Model):
        model = read_model(model)
    file = PlanFile(plan)
    job, values, digests = resolve(file, model)
    identity = {
        "study": "sweep",
        "model": model.path.name,
        "model_digest": sha256(model.content).hexdigest(),
        "plan": file.says.as_json,
        # A digest does not see in which order a plan has them.
        "axes": list(job.swept),
        "tables": dict(digests),
    }
    limit = file.says.times.get("time_limit", TIME_LIMIT)
    on_grid = not file.says.points
    return Sweep(job, values, on_grid, identity, limit, model.content, model.is_system)


def tried(study: Sweep) -> Sweep:
    """Return the study with new instances for each run where a reset does not work.

    Some points are run in one process, then again. The first of them that comes to its end did so
    in a new instance: where it has other bits the second time, something outlived the reset. Of
    long runs only the first steps are tried.

    Raises
    ------
    SweepError
        If the model cannot be loaded.
    """
    job = study.job
    points = len(job.times[: _STEPS_OF_TRIAL + 1])
    short = replace(
        job,
        times=job.times[:points],
        steps=job.steps[: points - 1],
        settled=min(job.settled, points - 1),
    )
    places = sorted({0, study.count // 2, study.count - 1})
    rows = np.concatenate([study.rows(place, place + 1) for place in (*places, *places)])
    limit = min(study.time_limit, _LONGEST_TRIAL)
    host = Host(short, study.content, study.is_system, limit)
    try:
        found, failures = host.runs(rows)
    finally:
        host.close()
    count = len(places)
    first = failures.index("") if "" in failures[:count] else 0
    works = not failures[first + count] and found[first].tobytes() == found[first + count].tobytes()
    return study if works else replace(study, job=replace(job, reset=False))


def sweep(
    model: Path | str,
    plan: Path | str | Mapping[str, Any],
    *,
    folder: Path | str | None = None,
    workers: int | None = None,
    cluster: str | None = None,
    fresh: bool = False,
    progress: Callable[[Progress], None] | None = None,
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
    workers, cluster, fresh, progress
        As of `stickslip_design.chunks.run`.

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
    return computed(
        prepare(model, plan),
        folder,
        lambda study, chunks: run(
            study, chunks, workers=workers, cluster=cluster, fresh=fresh, progress=progress
        ),
    )


def computed(
    study: Sweep, folder: Path | str | None, run: Callable[[Sweep, str | None], Results]
) -> xarray.Dataset:
    """Return the dataset of a study that `run` computes, given the folder of its chunk files."""
    need("xarray")
    if folder is not None:
        need("zarr" if study.on_grid else "pyarrow")
    if study.job.reset:
        study = tried(study)
    try:
        results = run(study, None if folder is None else _inside(folder, CHUNKS))
    finally:
        release()
    dataset = dataset_of(study, results.read())
    if folder is not None:
        write = write_grid if study.on_grid else write_points
        write(dataset, _inside(folder, file_of(study)))
    return dataset


def file_of(study: Sweep) -> str:
    """Return the name of the dataset in the folder of a sweep."""
    return "sweep.zarr" if study.on_grid else "sweep.parquet"


def _inside(folder: Path | str, name: str) -> str:
    return f"{folder}/{name}" if "://" in str(folder) else str(Path(folder) / name)


def dataset_of(study: Sweep, columns: Columns) -> xarray.Dataset:
    """Return the results of a sweep as a dataset, see `sweep`."""
    job = study.job
    dims = job.swept if study.on_grid else (POINT,)
    about: dict[str, dict[str, str]] = {FAILURE: {"long_name": "why the run failed"}}
    for name, all_of in job.outputs.items():
        variable = job.variables[name]
        for each in all_of:
            of = REDUCTIONS[each]
            unit = variable.unit if of.unit is None else of.unit
            said = variable.description or name
            text = said if each == "last" else f"{said}: {of.meaning}"
            about[column_of(name, each)] = {"units": unit, "long_name": text}
    coordinates = {}
    for name, values in zip(job.swept, study.values, strict=True):
        variable = job.variables[name]
        meant = {"units": variable.unit, "long_name": variable.description or name}
        coordinates[name] = ((name,) if study.on_grid else (POINT,), values, meant)
    fixed = {
        name: f"{value!r} {job.variables[name].unit}".strip() for name, value in job.fixed.items()
    }
    # Texts of any length have a specification in zarr.
    columns = {**columns, FAILURE: columns[FAILURE].astype(object)}
    dataset: xarray.Dataset = need("xarray").Dataset(
        {name: (dims, columns[name].reshape(study.shape), about[name]) for name in columns},
        coords=coordinates,
        attrs={**provenance(study.identity), "fixed": json.dumps(fixed)},
    )
    return dataset
