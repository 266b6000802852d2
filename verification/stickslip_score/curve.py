"""A curve: samples of a motion in SI units, with the digits that they carry."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

LEAST_SAMPLES = 5
"""Fewer cannot show a stick on either side of a slip and a sample between."""

_LOOKED_AT = 500
"""Samples whose digits are counted; the longest of so many numbers carries all digits."""

_RUNS, _RUN = 4, 500
"""Runs of neighbouring samples in which counts are looked for, and samples of each."""

_ROUNDINGS = 1024.0 * 2.0**-53
"""Of the largest number: moves below it are none."""


_ON_THE_GRID = 0.01
"""Of half a unit: times printed off their grid scatter by nearly the whole of it."""


class CurveError(ValueError):
    """A curve cannot be read or judged; the message says where and why."""


@dataclass(frozen=True)
class Curve:
    """Samples of a motion, at least t and x or F.

    Attributes
    ----------
    t
        Time [s], increasing, shape (n,).
    x, x_dot, F
        Position [m] and velocity [m/s] of the mass, spring force [N], shape (n,); None where not
        given.
    t_rounding, x_rounding, x_dot_rounding, F_rounding
        Half a unit in the last digit that the numbers carry, at their largest, in SI.
    """

    t: Floats
    x: Floats | None = None
    x_dot: Floats | None = None
    F: Floats | None = None
    t_rounding: float = 0.0
    x_rounding: float = 0.0
    x_dot_rounding: float = 0.0
    F_rounding: float = 0.0

    def __post_init__(self) -> None:
        if self.x is None and self.F is None:
            raise CurveError("neither x nor F is given; one of them is needed")
        if self.t.ndim != 1 or self.t.size < LEAST_SAMPLES:
            raise CurveError(f"{self.t.size} samples; at least {LEAST_SAMPLES} are needed")
        for name in ("t", "x", "x_dot", "F"):
            column = getattr(self, name)
            if column is None:
                continue
            if column.shape != self.t.shape:
                raise CurveError(f"{name} has {column.size} samples and t {self.t.size}")
            if not np.all(np.isfinite(column)):
                where = int(np.argmin(np.isfinite(column)))
                raise CurveError(f"{name} is {column[where]} in sample {where + 1}")
        if not np.all(np.diff(self.t) > 0.0):
            where = int(np.argmin(np.diff(self.t) > 0.0)) + 1
            raise CurveError(f"time does not increase in sample {where + 1}: t = {self.t[where]} s")

    @classmethod
    def of(
        cls,
        t: ArrayLike,
        x: ArrayLike | None = None,
        x_dot: ArrayLike | None = None,
        F: ArrayLike | None = None,
    ) -> Curve:
        """Make a curve of arrays in SI units; the digits of its numbers are counted.

        Raises
        ------
        CurveError
            Neither x nor F, fewer than 5 samples, unequal lengths, NaN or infinity, time that
            does not increase.
        """
        columns = {"t": t, "x": x, "x_dot": x_dot, "F": F}
        arrays = {
            name: np.array(column, dtype=np.float64)
            for name, column in columns.items()
            if column is not None
        }
        return with_rounding(arrays, dict.fromkeys(arrays, 1.0))


def with_rounding(columns: Mapping[str, Floats], sizes: Mapping[str, float]) -> Curve:
    """Make a curve of columns as they were printed, counting their digits.

    Parameters
    ----------
    columns
        Of t, x, x_dot, F, in their units.
    sizes
        The units by quantity, in SI.
    """
    si = {
        name: column if sizes[name] == 1.0 else column * sizes[name]
        for name, column in columns.items()
    }
    half = {name: half_unit(column) * sizes[name] for name, column in columns.items()}
    return Curve(
        si["t"],
        si.get("x"),
        si.get("x_dot"),
        si.get("F"),
        t_rounding=half_unit_of_time(columns["t"]) * sizes["t"],
        x_rounding=half.get("x", 0.0),
        x_dot_rounding=half.get("x_dot", 0.0),
        F_rounding=half.get("F", 0.0),
    )


def half_unit(column: Floats) -> float:
    """Return half a unit in the last digit of the numbers of a column, at their largest.

    Numbers are printed to so many digits or to so many decimals. The shortest text of each tells
    both; the coarser of the two is what was printed. Numbers that single precision holds exactly
    carry no more than its 24 bits. Counts of an encoder or converter times its step carry no more
    than the step, whatever was printed.
    """
    finite = column[np.isfinite(column) & (column != 0.0)]
    if not finite.size:
        return 0.0
    largest = float(np.max(np.abs(finite)))
    some = finite[:: -(-finite.size // _LOOKED_AT)]
    digits, last_place = 0, math.inf
    for number in some.tolist():
        mantissa, exponent = _decimal(number)
        digits = max(digits, len(mantissa))
        last_place = min(last_place, exponent)
    unit = max(10.0**last_place, 10.0 ** (math.floor(math.log10(largest)) - digits + 1))
    with np.errstate(over="ignore"):
        in_single = some.size > 1 and np.all(some.astype(np.float32) == some) and digits > 9
    if in_single:
        unit = max(unit, largest * 2.0**-23)
    return 0.5 * max(float(unit), _count_step(column))


def _count_step(column: Floats) -> float:
    """Return the step of which all moves from sample to sample are multiples, by Euclid's division.

    Moves of any size have a step of the size of their rounding. Returns 0 for a column that never
    stays where it is: that of an even motion has one step as well.
    """
    starts = np.linspace(0, max(column.size - _RUN, 0), _RUNS).astype(np.int64)
    moves = np.concatenate([np.abs(np.diff(column[i : i + _RUN])) for i in starts])
    nothing = _ROUNDINGS * float(np.max(np.abs(column)))
    parts = np.unique(moves[moves > nothing])
    if parts.size == 0 or np.all(moves > nothing):
        return 0.0
    while parts.size > 1:
        least = parts[0]
        counts = np.round(parts / least)
        rest = np.abs(parts - least * counts)
        parts = np.unique(np.append(rest[rest > nothing * counts], least))
        if parts[0] == least:
            break
    return float(parts[0])


def half_unit_of_time(t: Floats) -> float:
    """Return half a unit in the last digit of times; an even grid of round numbers has none.

    Steps of 0.1 s are written with one digit and hit to the last bit, while steps of 1/60 s
    written with five digits scatter about their grid by half a unit.
    """
    grid = np.linspace(t[0], t[-1], t.size)
    scatter = float(np.max(np.abs(t - grid)))
    printed = half_unit(t)
    return scatter if scatter < _ON_THE_GRID * printed else printed


def _decimal(number: float) -> tuple[str, int]:
    """Return the significant digits of the shortest text and the place of the last one."""
    head, _, power = repr(abs(number)).partition("e")
    whole, _, decimals = head.partition(".")
    decimals = "" if decimals == "0" else decimals
    significant = (whole + decimals).lstrip("0")
    kept = significant.rstrip("0") or "0"
    place = int(power or 0) - len(decimals) + len(significant) - len(kept)
    return kept, place
