"""A sweep: its plan resolved, its runs done in chunks, its results as a dataset."""

from __future__ import annotations

import atexit
import json
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ..chunks import Columns, Progress, Results, run
from ..datasets import digest_of, need, provenance, write_grid, write_points
from .host import Host
from .model import Model, read_model
from .plan import TIME_LIMIT, PlanFile
from .reductions import REDUCTIONS
from .resolve import Resolver
from .runs import Runs

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
    file = PlanFile(plan)
    says, resolver = file.says, Resolver(file, model)
    fixed, axes, by_table = resolver.values()
    times, steps, settled = resolver.times(varying=bool(by_table))
    tables = {name: resolver.table(name, of, times) for name, of in by_table.items()}
    resolver.check_outputs(axes)
    used = {*fixed, *axes, *by_table, *says.outputs}
    used |= {name for wire in model.wires for name in (wire.output, wire.input)}
    return Sweep(
        content=model.content,
        is_system=model.is_system,
        components=model.components,
        variables={name: model.variables[name] for name in sorted(used)},
        wires=model.wires,
        fixed=fixed,
        swept=tuple(axes),
        values=tuple(axes.values()),
        on_grid=not says.points,
        tables=tables,
        times=times,
        steps=steps,
        settled=settled,
        outputs=dict(says.outputs),
        reduces=says.reduces,
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
        partial(run, workers=workers, cluster=cluster, fresh=fresh, progress=progress),
    )


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
        write = write_grid if study.on_grid else write_points
        write(dataset, f"{folder}/{file_of(study)}")
    return dataset


def file_of(study: Sweep) -> str:
    """Return the name of the dataset in the folder of a sweep."""
    return "sweep.zarr" if study.on_grid else "sweep.parquet"


def _dataset(study: Sweep, columns: Columns) -> xarray.Dataset:
    variables = study.variables
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
