"""Studies of many points, as datasets of xarray with units: maps, scatter and sweeps."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from stickslip.parameters import Parameters, above_zero
from stickslip_design.chunks import Computing, Results, run
from stickslip_design.maps.study import computed, study_of

if TYPE_CHECKING:
    import xarray

    from stickslip_design import scatter as scatter
    from stickslip_design import sweep as sweep
    from stickslip_design.axis import AxisSource
    from stickslip_design.maps.study import GridStudy
else:
    # What a map does not need takes half a second to import.
    from stickslip_design import __getattr__  # noqa: F401 - of this module


def map(  # noqa: A001 - the name of the command
    over: Mapping[str, str | Sequence[float]],
    p: Parameters | None = None,
    *,
    axis: AxisSource | None = None,
    feed: float | str | None = None,
    limit: bool | None = None,
    folder: Path | str | None = None,
    compute: Callable[[GridStudy, str | None], Results] | None = None,
    **how: Unpack[Computing],
) -> xarray.Dataset:
    """Map jump, period and regime of the block, or of an axis, over two parameters or more.

    Parameters
    ----------
    over
        By name a range, such as ``"0.1..50 mm/s log 400"`` (lin where it is not said, and 200
        values), or rising values [SI]. Of an axis: numbers that its file states
        (``axis.mass``), and ``feed``.
    p
        The block, but for what the map is over.
    axis, feed
        The axis file, its path or a dictionary of its tables, in place of the block, and its feed
        [m/s] where the map is not over it.
    limit
        Whether the critical velocity of the block is computed. None: where it has a closed form,
        or at most 1000 are searched, at 10 to 100 ms.
    folder
        Where the study is kept, a folder or an address of fsspec: chunk files, from which it
        resumes, and the dataset as ``map.zarr``, which is read when it is used.
    compute
        Computes the study in the folder of its chunks, in place of `stickslip_design.chunks.run`.
    how
        ``workers``, ``cluster``, ``fresh``, ``progress``: as of that.

    Returns
    -------
    xarray.Dataset
        One dimension a parameter, in the order of `over`; variables with ``units`` and
        ``long_name``: `stickslip_design.points.columns`.

    Raises
    ------
    ValueError
        If a range or a value cannot be taken, or the study cannot be computed to its end.
    """
    p = p or Parameters()
    values = p.values
    if axis is not None:
        values = {} if feed is None else {"feed": above_zero(feed, "m/s", "feed")}
    study = study_of(over, values=values, law=p.law, axis=axis, limit=limit)
    return computed(study, folder, compute or partial(run, **how))
