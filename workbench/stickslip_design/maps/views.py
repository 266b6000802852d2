"""Slices of a map over two of its parameters, in the units in which engineers read them."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from contourpy import contour_generator
from matplotlib.colors import LogNorm, Normalize
from numpy.typing import ArrayLike, NDArray

from stickslip_units import Scale, on_data_sheet, scale_for

from ..datasets import need
from ..points.columns import Floats, Regime
from .study import SLAB, boxes

if TYPE_CHECKING:
    import xarray

VALID: Final = 0.1
"""The simplified formula counts as good up to this relative error."""

_MOST_PIXELS: Final = 400
"""Values of a parameter that a picture shows."""

_BESIDE: Final = ("regime", "at_limit", "simplified_error", "v_c", "critical_feed")
"""Variables that pictures and summary use beside those shown."""

_FASTEST: Final = ("v", "feed")
"""Parameters whose values follow each other in the order of computing."""

_FACTOR: Final = 50.0
"""From this ratio of largest to smallest on, colours are spaced by ratios."""


@dataclass(frozen=True)
class Side:
    """A side of a picture, or a parameter that stays in it: values [SI], shown in a unit."""

    name: str
    description: str
    values: Floats
    unit: Scale
    log: bool

    @property
    def shown(self) -> Floats:
        """The values in the unit shown."""
        return self.values / self.unit.size

    @property
    def label(self) -> str:
        """Name and unit."""
        return self.unit.label(self.name)

    def places(self, values: ArrayLike) -> Floats:
        """Return where values [SI] stand among those of the side, by its scale, from 0 on."""
        scale = np.log if self.log else np.asarray
        numbers = np.asarray(values, dtype=np.float64)
        return np.interp(scale(numbers), scale(self.values), np.arange(self.values.size))

    def at(self, places: Floats) -> Floats:
        """Return the values in the unit shown that stand at places."""
        scale, back = (np.log, np.exp) if self.log else (np.asarray, np.asarray)
        return np.asarray(back(np.interp(places, np.arange(self.values.size), scale(self.shown))))


VARIABLES: Final = {
    "delta_x": "Jump",
    "jump": "Jump",
    "f": "Frequency",
    "rate": "Frequency",
    "stick_share": "Stick share",
    "regime": "Regime",
    "v_c": "Critical velocity",
    "critical_feed": "Critical feed",
}
"""What pictures show, in this order, where a map has it: name in the dataset, and words."""

JUMPS: Final = ("delta_x", "jump")
_LIMITS: Final = (("v_c", "v"), ("critical_feed", "feed"))


class View:
    """How the dataset of a map is looked at: its first two parameters, x and y, are the sides.

    `variables` are what there is to show, by name in words, `main` the first one; `point` has the
    values [SI] of the block or axis itself, by parameter.
    """

    def __init__(self, dataset: xarray.Dataset) -> None:
        self.dataset = dataset
        self._order: list[str] = json.loads(dataset.attrs["over"])
        x, y, *self.further = (_side(dataset, name) for name in self._order)
        self._columns, self._rows = (_thinned(each.values.size, _MOST_PIXELS) for each in (x, y))
        self.x = replace(x, values=x.values[self._columns])
        self.y = replace(y, values=y.values[self._rows])
        self.point: dict[str, float] = json.loads(dataset.attrs["point"])
        # The limit is a line in the picture of the jump.
        hidden = dict(_LIMITS) if any(name in dataset for name in JUMPS) else {}
        self.variables = {
            name: words
            for name, words in VARIABLES.items()
            if name in dataset.variables and name not in hidden
        }
        self.main = next(iter(self.variables))

    @property
    def mark(self) -> tuple[float, float, str] | None:
        """The x and y [SI] of the block or the axis itself, and words, if in the picture."""
        both = [(side, self.point.get(side.name, math.nan)) for side in (self.x, self.y)]
        if not all(side.values[0] <= value <= side.values[-1] for side, value in both):
            return None
        words = ", ".join(f"{side.name} = {side.unit.told(value)}" for side, value in both)
        return both[0][1], both[1][1], words

    def places(self, most: int) -> list[dict[str, int]]:
        """Return `most` slices or less: values of the further parameters, thinned evenly.

        Every parameter keeps both of its ends.
        """
        counts = [each.values.size for each in self.further]
        while math.prod(counts) > most and max(counts) > 2:
            largest = counts.index(max(counts))
            counts[largest] = max(2, (counts[largest] + 1) // 2)
        chosen = [
            _thinned(each.values.size, count).tolist()
            for each, count in zip(self.further, counts, strict=True)
        ]
        names = [each.name for each in self.further]
        return [dict(zip(names, row, strict=True)) for row in product(*chosen)]

    def nearest(self) -> dict[str, int]:
        """Return the slice nearest to the block or axis itself; else that in the middle."""
        return {
            each.name: int(np.argmin(np.abs(each.values - self.point[each.name])))
            if each.name in self.point
            else each.values.size // 2
            for each in self.further
        }

    def slices(self, places: Sequence[Mapping[str, int]]) -> list[xarray.Dataset]:
        """Read some slices, all combinations of some values of the further parameters.

        Variables [SI] by y and x, and the further parameters as coordinates. Of a side with more
        values than a picture has room for some are chosen evenly.
        """
        used = dict.fromkeys([*self.variables, *_BESIDE])
        names = [name for name in used if name in self.dataset.data_vars]
        chosen = {
            each.name: sorted({place[each.name] for place in places}) for each in self.further
        }
        sides = {self.y.name: self._rows, self.x.name: self._columns}
        read = self.dataset[names].isel({**sides, **chosen}).load()
        # What does not depend on a side is the same all along it.
        (full,) = need("xarray").broadcast(read)
        full = full.transpose(*sides, ...)
        return [
            full.isel({name: chosen[name].index(n) for name, n in place.items()})
            for place in places
        ]

    def border(self, part: xarray.Dataset) -> Floats | None:
        """Return what is 0 where stick-slip ends: ln(v / v_c), else the border of the regime."""
        for limit, speed in _LIMITS:
            if limit in part and speed in (self.x.name, self.y.name):
                with np.errstate(divide="ignore", invalid="ignore"):
                    ratio = abs(part[speed]) / part[limit]
                    log = np.log(ratio.transpose(self.y.name, self.x.name).values)
                # Where the search of a limit has failed there is none to draw.
                return np.asarray(np.clip(log, -30.0, 30.0))
        if "regime" not in part:
            return None
        return np.where(part["regime"].values == Regime.STICKS, -0.5, 0.5)

    def regime(self, part: xarray.Dataset) -> NDArray[Any]:
        """Return the regimes of a slice; a map without counts as one that sticks and slips."""
        if "regime" in part:
            return part["regime"].values
        return np.full(part[self.main].shape, Regime.STICKS)

    def error(self, part: xarray.Dataset) -> Floats | None:
        """Return the magnitude of the error of the simplified formula."""
        return np.abs(part["simplified_error"].values) if "simplified_error" in part else None

    def told(self, part: xarray.Dataset) -> str:
        """Return the values of the further parameters of a slice, in words."""
        return ", ".join(
            f"{each.name} = {each.unit.told(float(part[each.name]))}" for each in self.further
        )

    def summary(self, part: xarray.Dataset) -> str:
        """Return what a slice shows, in words."""
        return "; ".join(self._seen([part])[1])

    def overall(self) -> list[str]:
        """Return what the whole map says, a line each; it is read a slab at a time."""
        names = [self.main, "regime", "at_limit"]
        data = self.dataset[[name for name in names if name in self.dataset]]
        fast = [name for name in self._order if name in _FASTEST]
        order = [*(name for name in self._order if name not in fast), *fast]
        sizes = tuple(data.sizes[name] for name in order)
        points, (*lines,), at_limit = self._seen(
            data.isel(dict(zip(order, box.slices, strict=True))).load()
            for box in boxes(sizes, 0, math.prod(sizes), SLAB)
        )
        first = f"{points} points"
        if "regime" in data:
            first += f": {lines.pop(0)}"
        found = [first, *lines]
        if at_limit:
            found.append(f"within 1e-6 of a limit: {at_limit} points, marked at_limit")
        return found

    def _seen(self, parts: Iterable[xarray.Dataset]) -> tuple[int, list[str], int]:
        """Return what parts of a map say together: points, regimes and largest value, at limits."""
        counts, points, at_limit = Counter[int](), 0, 0
        largest, where = 0.0, dict[str, float]()
        for part in parts:
            points += math.prod(part.sizes.values())
            if "regime" in part:
                kinds, numbers = np.unique(part["regime"].values, return_counts=True)
                counts.update(dict(zip(kinds.tolist(), numbers.tolist(), strict=True)))
            if "at_limit" in part:
                at_limit += int(np.count_nonzero(part["at_limit"].values))
            main = abs(part[self.main])
            main = main.where(np.isfinite(main), 0.0)
            peak = main[main.argmax(...)]
            if peak > largest:
                largest = float(peak)
                where = {str(name): float(peak[name]) for name in main.dims}
        lines = []
        if counts:
            shares = (
                f"{verb} at {100.0 * counts[kind] / points:.1f} %"
                for kind, verb in _VERBS.items()
                if counts[kind]
            )
            lines.append(", ".join(shares))
        if largest > 0.0:
            units = {each.name: each.unit for each in (self.x, self.y, *self.further)}
            at = ", ".join(
                f"{name} = {units[name].told(where[name])}" for name in self._order if name in where
            )
            unit = scale_for(largest, self.dataset[self.main].attrs["units"])
            lines.append(
                f"largest {self.variables[self.main].lower()} {unit.told(largest)} at {at}"
            )
        return points, lines, at_limit


def _thinned(size: int, most: int) -> NDArray[np.intp]:
    return np.unique(np.linspace(0, size - 1, min(size, most)).round().astype(np.intp))


_VERBS: Final = {
    Regime.STICKS: "sticks and slips",
    Regime.SWINGS: "swings",
    Regime.EVEN: "moves evenly",
    Regime.UNKNOWN: "unknown",
}


def colours(parts: Sequence[xarray.DataArray]) -> tuple[Normalize, Scale]:
    """Return how magnitudes of a variable in some slices become colours, and in which unit.

    The norm of matplotlib takes magnitudes in that unit.
    """
    low, high = math.inf, 0.0
    for part in parts:
        magnitudes = np.abs(part.values)
        magnitudes = magnitudes[np.isfinite(magnitudes) & (magnitudes > 0.0)]
        if magnitudes.size:
            low, high = min(low, float(magnitudes.min())), max(high, float(magnitudes.max()))
    if high == 0.0:
        low, high = 0.0, 1.0
    symbol = parts[0].attrs["units"]
    unit = scale_for(high, symbol)
    log = symbol != "1" and high > _FACTOR * low > 0.0
    # Below the largest by more than four powers of ten colours would tell nothing.
    low = max(low, 1e-4 * high) if log else 0.0
    return (LogNorm if log else Normalize)(low / unit.size, high / unit.size, clip=True), unit


def contours(field: NDArray[Any], level: float) -> Iterator[Floats]:
    """Yield the lines at a level of a field as (points, 2): columns and rows of the field."""
    if min(field.shape) < 2:
        return
    masked = np.ma.masked_invalid(field)
    for line in contour_generator(z=masked).lines(level):
        yield np.asarray(line)


def _side(dataset: xarray.Dataset, name: str) -> Side:
    coordinate = dataset[name]
    values = np.asarray(coordinate.values, dtype=np.float64)
    attributes = coordinate.attrs
    unit = scale_for(float(np.abs(values).max()), attributes["units"])
    # As it was typed, where it was.
    written, plain = (on_data_sheet(attributes.get(each, "")) for each in ("shown_in", "units"))
    if written is not None and plain is not None:
        unit = Scale(float(written.factor / plain.factor), attributes["shown_in"])
    return Side(name, attributes["long_name"], values, unit, attributes.get("spacing") == "log")
