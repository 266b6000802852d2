"""Results as files with names, units and provenance: zarr for grids, Parquet for points."""

from __future__ import annotations

import json
import platform
import shlex
import sys
from collections.abc import Mapping
from hashlib import sha256
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    import xarray

_PACKAGES: Final = ("stickslip", "numpy", "scipy", "fmpy")
"""Packages whose versions may change a result."""


class ExtraMissingError(ImportError):
    """A package of an extra is not installed; the message names the extra."""


def need(module: str, extra: str = "studies") -> Any:
    """Import a module that an extra of the project brings; ExtraMissingError if not installed."""
    try:
        return import_module(module)
    except ImportError as error:
        package = (error.name or module).partition(".")[0]
        raise ExtraMissingError(
            f"the package {package} is not installed; pip install 'stickslip[{extra}]' brings it",
            name=error.name,
        ) from error


def versions() -> dict[str, str]:
    """Return the versions that a result may depend on, by package."""
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "none"
    return found


def digest_of(identity: Mapping[str, Any]) -> str:
    """Return the SHA-256 of what a study depends on, as hexadecimal digits."""
    text = json.dumps(identity, sort_keys=True, ensure_ascii=True, allow_nan=True)
    return sha256(text.encode()).hexdigest()


def provenance(identity: Mapping[str, Any]) -> dict[str, str]:
    """Return where a result comes from, as attributes of its file; some are JSON."""
    program = Path(sys.argv[0])
    name = program.parent.name if program.stem == "__main__" else program.name
    return {
        "versions": json.dumps(versions()),
        "inputs": json.dumps(identity, sort_keys=True),
        "inputs_digest": digest_of(identity),
        # The words behind another program, such as the kernel of a notebook, are not for people.
        "command": shlex.join([name, *sys.argv[1:]]) if name == "stickslip" else name,
    }


def read_grid(source: Path | str) -> xarray.Dataset:
    """Read a dataset of zarr: a folder, or an address of fsspec."""
    need("zarr")
    dataset: xarray.Dataset = need("xarray").open_zarr(source, consolidated=False)
    return dataset


def write_points(points: xarray.Dataset, target: Path | str) -> None:
    """Write a dataset of one dimension as Parquet, units and provenance in its metadata.

    Pandas gives them back as `DataFrame.attrs`: ``units`` and ``long_names`` by column, and the
    attributes of the dataset.
    """
    need("pyarrow")
    need("pandas")
    frame = points.reset_coords().to_dataframe()
    columns = points.variables.items()
    frame.attrs = {
        "units": {name: column.attrs.get("units", "") for name, column in columns},
        "long_names": {name: column.attrs.get("long_name", "") for name, column in columns},
        **points.attrs,
    }
    frame.to_parquet(target)
