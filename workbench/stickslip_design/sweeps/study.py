"""A sweep from its plan to its dataset."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ..chunks import Columns, Computing, Results, run
from ..datasets import need, provenance, write_points
from .model import Model, read_model
from .plan import PlanFile
from .runs import FAILURE, REDUCTIONS, Sweep

if TYPE_CHECKING:
    import xarray


def prepare(model: Model | Path | str, plan: Path | str | Mapping[str, Any]) -> Sweep:
    """Return the study of a sweep, without a run of it; arguments and errors as of `sweep`."""
    return PlanFile(plan, model if isinstance(model, Model) else read_model(model)).sweep()


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
    if folder is None:
        return _dataset(study, run(study, None).read())
    need("zarr" if study.on_grid else "pyarrow")
    dataset = _dataset(study, run(study, f"{folder}/chunks").read())
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
    about = {FAILURE: {"long_name": "why the run failed"}}
    for column, (name, reduction) in study.results.items():
        of, text = REDUCTIONS[reduction], variables[name].description or name
        if reduction != "last":
            text = f"{text}: {of.meaning}"
        about[column] = {"units": of.unit or variables[name].unit, "long_name": text}
    coordinates = {}
    for name, values in zip(study.swept, study.values, strict=True):
        meant = {"units": variables[name].unit, "long_name": variables[name].description or name}
        coordinates[name] = (name if study.on_grid else "point", values, meant)
    fixed = {
        name: f"{value!r} {variables[name].unit}".strip() for name, value in study.fixed.items()
    }
    # Texts of any length have a specification in zarr.
    columns = {**columns, FAILURE: columns[FAILURE].astype(object)}
    dims = study.swept if study.on_grid else ("point",)
    dataset: xarray.Dataset = need("xarray").Dataset(
        {name: (dims, columns[name].reshape(study.shape), about[name]) for name in columns},
        coords=coordinates,
        attrs={**provenance(study.identity), "fixed": json.dumps(fixed)},
    )
    return dataset
