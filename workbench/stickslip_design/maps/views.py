"""Slices of a map over two of its parameters, in the units in which engineers read them."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..datasets import need
from ..points.columns import Regime
from ..quantity import on_data_sheet
from ..shown import number
from .grid import boxes

if TYPE_CHECKING:
    import xarray
    from matplotlib.colors import Normalize

Floats = NDArray[np.float64]

VALID: Final = 0.1
"""The simplified formula counts as good up to this relative error."""

_MOST_PIXELS: Final = 400
"""Values of a parameter that a picture shows."""

_SLAB: Final = 2**20
"""Points that are read at a time."""

_BESIDE: Final = ("regime", "at_limit", "simplified_error", "v_c", "critical_feed")
"""Variables that pictures and summary use beside those shown."""

_FASTEST: Final = ("v", "feed")
"""Parameters whose values follow each other in the order of computing."""

_PREFIXES: Final = ((1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
_PREFIXED: Final = ("m", "m/s", "s", "N", "Hz")
_OF_STIFFNESS: Final = ((1e6, "N/µm"), (1e3, "N/mm"), (1.0, "N/m"))
_FACTOR: Final = 50.0
"""From this ratio of largest to smallest on, colours are spaced by ratios."""


class Unit(NamedTuple):
    """A unit to show values in: its size in SI, and its symbol, "" for a plain number."""

    size: float
    symbol: str

    def label(self, name: str) -> str:
        """Return a name with the unit behind it."""
        return f"{name} [{self.symbol}]" if self.symbol else name

    def told(self, value: float) -> str:
        """Return a value [SI] with its unit."""
        return f"{number(value / self.size)} {self.symbol}".rstrip()


def unit_of(unit: str, largest: float, typed: str = "") -> Unit:
    """Return the unit to show values in: the typed one, else one with a prefix.

    Parameters
    ----------
    unit
        SI unit of the values.
    largest
        The largest of them [SI].
    typed
        The unit in which a person typed them, "" for none.
    """
    written, plain = on_data_sheet(typed) if typed else None, on_data_sheet(unit)
    if written is not None and plain is not None:
        return Unit(float(written.factor / plain.factor), typed)
    ladder: Sequence[tuple[float, str]] = ((1.0, "" if unit == "1" else unit),)
    if unit == "N/m":
        ladder = _OF_STIFFNESS
    if unit in _PREFIXED:
        # Metres and seconds have no larger units in a workshop.
        least = 0 if unit in ("N", "Hz") else 2
        ladder = [(size, f"{sign}{unit}") for size, sign in _PREFIXES[least:]]
    return next((Unit(*each) for each in ladder if largest >= each[0]), Unit(*ladder[-1]))


@dataclass(frozen=True)
class Side:
    """A side of a picture, or a parameter that stays in it.

    Attributes
    ----------
    name, description, values
        The parameter, and its values [SI].
    unit, log
        The unit that they are shown in, and whether on a logarithmic scale.
    """

    name: str
    description: str
    values: Floats
    unit: Unit
    log: bool

    @property
    def shown(self) -> Floats:
        """The values in the unit shown."""
        return self.values / self.unit.size

    @property
    def label(self) -> str:
        """Name and unit."""
        return self.unit.label(self.name)


class Slice(NamedTuple):
    """A part of a map over two parameters.

    Attributes
    ----------
    place
        Number of the value of each further parameter.
    data
        The variables [SI], by y and x.
    """

    place: Mapping[str, int]
    data: xarray.Dataset

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """The variables [SI] by name, arrays (values of y, values of x)."""
        return {str(name): each.values for name, each in self.data.data_vars.items()}


class Mark(NamedTuple):
    """Values of x and y [SI] that are marked in the picture, and what they are."""

    x: float
    y: float
    label: str


class Variable(NamedTuple):
    """A variable that pictures show, by its name in the dataset and in words."""

    name: str
    words: str


VARIABLES: Final = (
    *(Variable("delta_x", "Jump"), Variable("jump", "Jump")),
    *(Variable("f", "Frequency"), Variable("rate", "Frequency")),
    Variable("stick_share", "Stick share"),
    Variable("regime", "Regime"),
    *(Variable("v_c", "Critical velocity"), Variable("critical_feed", "Critical feed")),
)
"""What pictures show, in this order, where a map has it."""

JUMPS: Final = ("delta_x", "jump")
_LIMITS: Final = (("v_c", "v"), ("critical_feed", "feed"))


class View:
    """How the dataset of a map is looked at: its first two parameters are the sides of a picture.

    Attributes
    ----------
    x, y, further
        The first and the second parameter, and the others.
    variables
        What there is to show; the first one is the main one.
    point
        The values [SI] that the block or axis itself has, by parameter.
    """

    def __init__(self, dataset: xarray.Dataset) -> None:
        self.dataset = dataset
        self._order: list[str] = json.loads(dataset.attrs["over"])
        x, y, *self.further = (_side(dataset, name) for name in self._order)
        self._columns, self._rows = _thinned(x.values.size), _thinned(y.values.size)
        self.x = replace(x, values=x.values[self._columns])
        self.y = replace(y, values=y.values[self._rows])
        self.point: dict[str, float] = json.loads(dataset.attrs["point"])
        self.variables = [
            each
            for each in VARIABLES
            if each.name in dataset.variables
            # The limit is a line in the picture of the jump.
            and not (each.name in dict(_LIMITS) and any(name in dataset for name in JUMPS))
        ]

    @property
    def title(self) -> str:
        """What is mapped, in words."""
        return str(self.dataset.attrs["title"])

    @property
    def mark(self) -> Mark | None:
        """Where the block or the axis itself is, if that is in the picture."""
        sides = (self.x, self.y)
        values = [self.point.get(side.name, math.nan) for side in sides]
        both = list(zip(sides, values, strict=True))
        if not all(side.values[0] <= value <= side.values[-1] for side, value in both):
            return None
        told = ", ".join(f"{side.name} = {side.unit.told(value)}" for side, value in both)
        return Mark(values[0], values[1], told)

    def units(self, name: str) -> str:
        """Return the SI unit of a variable."""
        return str(self.dataset[name].attrs["units"])

    def places(self, most: int) -> list[dict[str, int]]:
        """Return which slices are shown: values of the further parameters, thinned evenly.

        Parameters
        ----------
        most
            How many slices at most; every parameter keeps both of its ends.
        """
        counts = [each.values.size for each in self.further]
        while math.prod(counts) > most and max(counts) > 2:
            largest = counts.index(max(counts))
            counts[largest] = max(2, (counts[largest] + 1) // 2)
        chosen = [
            np.unique(np.linspace(0, each.values.size - 1, count).round().astype(int)).tolist()
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

    def slices(self, places: Sequence[Mapping[str, int]]) -> list[Slice]:
        """Read some slices, all combinations of some values of the further parameters.

        Of a side with more values than a picture has room for some are chosen evenly.
        """
        used = dict.fromkeys([*(each.name for each in self.variables), *_BESIDE])
        names = [name for name in used if name in self.dataset.data_vars]
        chosen = {
            each.name: sorted({place[each.name] for place in places}) for each in self.further
        }
        sides = {self.y.name: self._rows, self.x.name: self._columns}
        read = self.dataset[names].isel({**sides, **chosen}).load()
        found = []
        for place in places:
            # What does not depend on a side is the same all along it.
            cut = read.isel({name: chosen[name].index(n) for name, n in place.items()})
            (part,) = need("xarray").broadcast(cut)
            found.append(Slice(place, part.transpose(*sides)))
        return found

    def border(self, part: Slice) -> Floats | None:
        """Return what is 0 where stick-slip ends: ln(v / v_c), else the border of the regime."""
        for limit, speed in _LIMITS:
            if limit in part.data and speed in (self.x.name, self.y.name):
                with np.errstate(divide="ignore", invalid="ignore"):
                    ratio = abs(part.data[speed]) / part.data[limit]
                    log = np.log(ratio.transpose(self.y.name, self.x.name).values)
                # Where the search of a limit has failed there is none to draw.
                return np.asarray(np.clip(log, -30.0, 30.0))
        if "regime" not in part.data:
            return None
        return np.where(part.data["regime"].values == Regime.STICKS, -0.5, 0.5)

    def told(self, place: Mapping[str, int]) -> str:
        """Return the values of the further parameters of a slice, in words."""
        return ", ".join(
            f"{each.name} = {each.unit.told(float(each.values[place[each.name]]))}"
            for each in self.further
        )

    def summary(self, part: Slice) -> str:
        """Return what a slice shows, in words."""
        return "; ".join(self._seen([part.data])[1])

    def overall(self) -> list[str]:
        """Return what the whole map says, a line each; it is read a slab at a time."""
        names = [self.variables[0].name, "regime", "at_limit"]
        data = self.dataset[[name for name in names if name in self.dataset]]
        fast = [name for name in self._order if name in _FASTEST]
        order = [*(name for name in self._order if name not in fast), *fast]
        sizes = tuple(data.sizes[name] for name in order)
        points, (*lines,), at_limit = self._seen(
            data.isel(dict(zip(order, box.slices, strict=True))).load()
            for box in boxes(sizes, 0, math.prod(sizes), _SLAB)
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
        main = self.variables[0]
        counts, points, at_limit = Counter[int](), 0, 0
        largest, where = 0.0, dict[str, float]()
        for part in parts:
            points += math.prod(part.sizes.values())
            if "regime" in part:
                kinds, numbers = np.unique(part["regime"].values, return_counts=True)
                counts.update(dict(zip(kinds.tolist(), numbers.tolist(), strict=True)))
            if "at_limit" in part:
                at_limit += int(np.count_nonzero(part["at_limit"].values))
            values = np.abs(np.where(np.isfinite(part[main.name]), part[main.name], 0.0))
            if values.max() > largest:
                largest = float(values.max())
                places = np.unravel_index(int(np.argmax(values)), values.shape)
                where = {
                    str(name): float(part[name].values[place])
                    for name, place in zip(part[main.name].dims, places, strict=True)
                }
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
            unit = unit_of(self.units(main.name), largest)
            lines.append(f"largest {main.words.lower()} {unit.told(largest)} at {at}")
        return points, lines, at_limit


def _thinned(size: int) -> NDArray[np.intp]:
    return np.unique(np.linspace(0, size - 1, min(size, _MOST_PIXELS)).round().astype(np.intp))


_VERBS: Final = {
    Regime.STICKS: "sticks and slips",
    Regime.SWINGS: "swings",
    Regime.EVEN: "moves evenly",
    Regime.UNKNOWN: "unknown",
}


class Colours(NamedTuple):
    """How values of a variable become colours: a norm of matplotlib, for values in `unit`."""

    norm: Normalize
    unit: Unit

    def shown(self, values: NDArray[Any]) -> Floats:
        """Return magnitudes of values [SI] in the unit."""
        return np.asarray(np.abs(values) / self.unit.size)


def colours(unit: str, samples: Sequence[NDArray[Any]]) -> Colours:
    """Return the colours of a variable over some slices, by its magnitudes above 0.

    Parameters
    ----------
    unit
        SI unit of the variable.
    samples
        Its values in the slices that are shown.
    """
    from matplotlib.colors import LogNorm, Normalize

    low, high = math.inf, 0.0
    for each in samples:
        magnitudes = np.abs(each)
        magnitudes = magnitudes[np.isfinite(magnitudes) & (magnitudes > 0.0)]
        if magnitudes.size:
            low, high = min(low, float(magnitudes.min())), max(high, float(magnitudes.max()))
    if high == 0.0:
        low, high = 0.0, 1.0
    shown = unit_of(unit, high)
    log = unit != "1" and high > _FACTOR * low > 0.0
    # Below the largest by more than four powers of ten colours would tell nothing.
    low = max(low, 1e-4 * high) if log else 0.0
    norm = (LogNorm if log else Normalize)(low / shown.size, high / shown.size, clip=True)
    return Colours(norm, shown)


def contours(field: NDArray[Any], level: float) -> Iterator[Floats]:
    """Yield the lines at a level of a field as (points, 2): columns and rows of the field."""
    from contourpy import contour_generator

    if min(field.shape) < 2:
        return
    masked = np.ma.masked_invalid(field)
    for line in contour_generator(z=masked).lines(level):
        yield np.asarray(line)


def _side(dataset: xarray.Dataset, name: str) -> Side:
    coordinate = dataset[name]
    values = np.asarray(coordinate.values, dtype=np.float64)
    attributes = coordinate.attrs
    unit = unit_of(attributes["units"], float(np.abs(values).max()), attributes.get("shown_in", ""))
    return Side(name, attributes["long_name"], values, unit, attributes.get("spacing") == "log")
