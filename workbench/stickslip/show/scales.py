"""Units in which a value is neither tiny nor huge."""

from collections.abc import Sequence
from typing import Final, NamedTuple, TypeAlias


class Scale(NamedTuple):
    """A unit to show values in: its size in SI and its symbol."""

    size: float
    symbol: str

    def text(self, value: float, form: str = ".6g") -> str:
        """Write a value [SI] with the unit."""
        return f"{value / self.size:{form}} {self.symbol}"


Scales: TypeAlias = Sequence[Scale]
"""Scales of one dimension, the largest unit first."""


def _ladder(*steps: tuple[float, str]) -> tuple[Scale, ...]:
    return tuple(Scale(*step) for step in steps)


LENGTHS: Final = _ladder((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))
FORCES: Final = _ladder((1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN"), (1e-6, "µN"))
TIMES: Final = _ladder((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))
FREQUENCIES: Final = _ladder((1e6, "MHz"), (1e3, "kHz"), (1.0, "Hz"), (1e-3, "mHz"))
VELOCITIES: Final = _ladder((1.0, "m/s"), (1e-3, "mm/s"), (1e-6, "µm/s"))
STIFFNESSES: Final = _ladder((1e6, "N/µm"), (1e3, "kN/m"), (1.0, "N/m"))


def scale_for(value: float, scales: Scales, enough: float = 1.0) -> Scale:
    """Choose the largest unit of which `value` has at least `enough`; else the smallest.

    Parameters
    ----------
    value
        The value to show, or the largest of many, SI; its sign does not count.
    scales
        The units to choose from, largest first. A value of 0 takes the one of size 1.
    enough
        How many of the unit `value` must hold.
    """
    if value == 0.0:
        return next(scale for scale in scales if scale.size == 1.0)
    return next((scale for scale in scales if abs(value) >= enough * scale.size), scales[-1])
