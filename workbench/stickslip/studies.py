"""Studies of many points, as datasets of xarray with units: maps, scatter and sweeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.parameters import Parameters, above_zero
from stickslip_design.maps.study import map_ as mapped
from stickslip_design.sweeps.study import sweep as sweep
from stickslip_design.tolerances.study import scatter as scatter

if TYPE_CHECKING:
    import xarray

    from stickslip_design.axis import AxisFile


def map(  # noqa: A001 - the name of the command
    over: Mapping[str, str | Sequence[float]],
    p: Parameters | None = None,
    *,
    axis: AxisFile | Path | str | None = None,
    feed: float | str | None = None,
    **options: Any,
) -> xarray.Dataset:
    """Map jump, period and regime of the block, or of an axis, over two parameters or more.

    Parameters
    ----------
    over
        By name a range, such as ``"0.1..50 mm/s log 400"``, or rising values [SI].
    p
        The block, but for what the map is over.
    axis, feed
        The axis file in place of the block, and its feed [m/s] where the map is not over it.
    options
        ``folder``, ``workers``, ``cluster``, ``fresh``, ``limit``, ``progress``, as of
        `stickslip_design.maps.study.map_`.

    Returns
    -------
    xarray.Dataset
        One dimension a parameter; variables with ``units`` and ``long_name``.

    Raises
    ------
    ValueError
        If a range or a value cannot be taken, or the study cannot be computed to its end.
    """
    p = p or Parameters()
    held = p.values.items() - Parameters(law=p.law).values.items()
    values = {name: value for name, value in held if name not in over}
    if axis is not None:
        values = {} if feed is None else {"feed": above_zero(feed, "m/s", "feed")}
    return mapped(over, values=values, law=p.law, axis=axis, **options)
