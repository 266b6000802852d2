"""Runs of the two FMUs, and what is read off them."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .masters import NAMES, run_in_fmpy
from .system import Values, write_ssp

Array = NDArray[np.float64]
Run = Mapping[str, Array]
"""Columns by name: `time` [s], and the outputs `masters.NAMES` without their component [SI]."""


class Creep(NamedTuple):
    """An axis at constant feed, in the second half of a run.

    Completed slips; mean jump [m] and mean time between two [s], NaN where there are none; mean
    following error of the table, and the root of the mean square of the rest [m].
    """

    jumps: int
    jump: float
    period: float
    error: float
    unevenness: float


class Hold(NamedTuple):
    """An axis that holds a target, in the last half of a run.

    Whether the table has come to rest for good; mean length of a jump either way [m]; mean time
    between two in the same direction [s]; mean distance of the table from the target [m].
    """

    stops: bool
    jump: float
    period: float
    offset: float


def simulate(fmus: Path, values: Values, stop_time: float, step: float | None = None) -> Run:
    """Run both FMUs, which are in a folder, in fmpy.

    Parameters
    ----------
    fmus
        Folder with StickSlip.fmu and ServoDrive.fmu.
    values
        Their start values, `system.start_values`.
    stop_time
        End [s].
    step
        Communication step [s]; the sample time of the controller where None.
    """
    with tempfile.TemporaryDirectory(prefix="feed-axis-") as folder:
        file = write_ssp(Path(folder) / "FeedAxis.ssp", values, fmus)
        return columns(np.array(run_in_fmpy(file, stop_time, step or values["drive"]["T_s"])))


def columns(rows: Array) -> Run:
    """Return rows of a master by the names of their columns."""
    names = ("time", *(name.partition(".")[2] for name in NAMES))
    return dict(zip(names, rows.T, strict=True))


def creep(run: Run) -> Creep:
    """Measure an axis at constant feed."""
    late = _late(run)
    error = (run["x_command"] - run["x"])[late]
    times, lengths = jumps(run, late)
    return Creep(
        len(times),
        _mean(lengths),
        _mean(np.diff(times)),
        float(error.mean()),
        float(np.sqrt(np.mean((error - error.mean()) ** 2))),
    )


def hold(run: Run) -> Hold:
    """Measure an axis that holds a target."""
    late = _late(run)
    times, lengths = jumps(run, late)
    between = _mean(np.diff(times[lengths > 0.0]))
    offset = _mean((run["x"] - run["x_command"])[late])
    return Hold(len(times) == 0, _mean(np.abs(lengths)), between, offset)


def jumps(run: Run, late: NDArray[np.bool_] | None = None) -> tuple[Array, Array]:
    """Return ends [s] and lengths [m] of the slips, all or those of a part of the rows."""
    ended = np.flatnonzero(np.diff(run["delta_x"])) + 1
    ended = ended if late is None else ended[late[ended]]
    return run["time"][ended], run["delta_x"][ended]


def _late(run: Run) -> NDArray[np.bool_]:
    late: NDArray[np.bool_] = run["time"] >= 0.5 * run["time"][-1]
    return late


def _mean(values: Array) -> float:
    return float(values.mean()) if len(values) else math.nan
