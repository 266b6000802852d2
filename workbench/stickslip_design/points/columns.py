"""What is computed at a point: regimes, and the columns of a block and of an axis."""

from __future__ import annotations

from enum import IntEnum
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Regime(IntEnum):
    """What the mass does: a cycle with a stick where there is one, else by the steady sliding."""

    EVEN = 0
    STICKS = 1
    SWINGS = 2
    UNKNOWN = -1


class Column(NamedTuple):
    """A column of results: SI unit, description, and the dimensions it does not depend on."""

    unit: str
    description: str
    without: tuple[str, ...] = ()


BLOCK: Final = {
    "delta_x": Column("m", "Jump of the mass in a slip; 0 where it never sticks"),
    "T": Column("s", "Period of the stick-slip cycle"),
    "f": Column("Hz", "Frequency of the stick-slip cycle"),
    "t_stick": Column("s", "Length of a stick"),
    "t_slip": Column("s", "Time from break-away to re-stick"),
    "stick_share": Column(
        "1", "Part of the period in which the mass sticks; 0 where it never does"
    ),
    "regime": Column("1", "What the mass does: 0 slides evenly, 1 sticks and slips, 2 swings"),
    "at_limit": Column("1", "Whether a limit is within 1e-6 of the pulling velocity"),
    "delta_x_simplified": Column("m", "Jump as designers write it, 2 (mu_s - mu_k) N/k"),
    "simplified_error": Column("1", "Relative error of that jump"),
    "v_c": Column(
        "m/s", "Critical velocity: the highest at which a cycle with a stick exists", ("v",)
    ),
}
"""Columns of `blocks.block_points`."""

FEED: Final = "feed"

AXIS: Final = {
    "jump": Column("m", "Jump of the table; 0 where it never jumps"),
    "rate": Column("Hz", "Jumps in a second; 0 where it never jumps"),
    "regime": Column("1", "What the table does: 0 moves evenly, 1 sticks and slips, 2 swings"),
    "critical_feed": Column(
        "m/s", "Critical feed: the highest at which the table jumps", without=(FEED,)
    ),
    "stable": Column("1", "Whether the servo loop is stable", without=(FEED,)),
    "clamped": Column("1", "Whether mu_k came above mu_s and was taken as that", without=(FEED,)),
}
"""Columns of `axes.axis_points`."""

WITHOUT_FEED: Final = ("critical_feed", "stable", "clamped")
"""Those that an axis has whatever its feed."""
