"""Slices of a map over two of its parameters, in the units in which engineers read them."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..points.blocks import Regime
from ..quantity import on_data_sheet
from ..shown import number
from .grid import boxes

if TYPE_CHECKING:
    import xarray

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
    if unit == "1":
        return Unit(1.0, "")
    ladder: Sequence[tuple[float, str]] = ((1.0, unit),)
    if unit == "N/m":
        ladder = _OF_STIFFNESS
    if unit in _PREFIXED:
        # Metres and seconds have no larger units in a workshop.
        large = unit not in ("m", "m/s", "s")
        ladder = tuple((size, f"{sign}{unit}") for size, sign in _PREFIXES if large or size <= 1.0)
    return next((Unit(*each) for each in ladder if largest >= each[0]), Unit(*ladder[-1]))


@dataclass(frozen=True)
class Side:
    """A side of a picture, or a parameter that stays in it.

    Attributes
    ----------
    name, description
        The parameter.
    values
        Its values [SI].
    unit
        The unit that they are shown in.
    log
        Whether they are drawn on a logarithmic scale.
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
    """A part of a map over two parameters: arrays (values of y, values of x).

    Attributes
    ----------
    place
        Number of the value of each further parameter.
    columns
        The variables [SI] by name.
    """

    place: Mapping[str, int]
    columns: Mapping[str, NDArray[Any]]


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
    """How a dataset of `map_` is looked at: its first two parameters are the sides of a picture.

    Attributes
    ----------
    x, y
        The first and the second parameter.
    further
        The others.
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
        combined = np.meshgrid(*chosen, indexing="ij") if chosen else [np.zeros(1, int)]
        rows = np.stack([each.ravel() for each in combined], axis=1).tolist()
        return [dict(zip(names, row, strict=False)) for row in rows]

    def nearest(self) -> dict[str, int]:
        """Return the slice nearest to the block or axis itself; else that in the middle."""
        return {
            each.name: int(np.argmin(np.abs(each.values - self.point[each.name])))
            if each.name in self.point
            else each.values.size // 2
            for each in self.further
        }

    def read(self, places: Sequence[Mapping[str, int]]) -> tuple[list[Slice], list[str]]:
        """Read some slices, and what the whole map says in words, a line each.

        The map is gone through once, a slab at a time. Of a side with more values than a picture
        has room for some are chosen evenly.
        """
        used = dict.fromkeys([*(each.name for each in self.variables), *_BESIDE])
        names = [name for name in used if name in self.dataset.data_vars]
        shape = (self.y.values.size, self.x.values.size)
        slices = [
            Slice(place, {name: np.empty(shape, self.dataset[name].dtype) for name in names})
            for place in places
        ]
        seen = _Seen(self)
        # The order in which the dataset was computed and is stored.
        order = [name for name in self._order if name not in _FASTEST]
        order += [name for name in self._order if name in _FASTEST]
        sizes = tuple(self.dataset.sizes[name] for name in order)
        for box in boxes(sizes, 0, math.prod(sizes), _SLAB):
            there = dict(zip(order, box.slices, strict=True))
            part = self.dataset[names].isel(there).load()
            seen.add(part)
            for each in slices:
                self._fill(each, part, there)
        return slices, seen.told()

    def _fill(self, part: Slice, slab: xarray.Dataset, there: Mapping[str, slice]) -> None:
        """Take over what a slab has of a slice."""
        held = {name: n - there[name].start for name, n in part.place.items()}
        if not all(0 <= n < slab.sizes[name] for name, n in held.items()):
            return
        chosen, cuts = {}, []
        for side, places in ((self.y, self._rows), (self.x, self._columns)):
            cut = there[side.name]
            first, last = np.searchsorted(places, [cut.start, cut.stop])
            chosen[side.name] = places[first:last] - cut.start
            cuts.append(slice(first, last))
        for name, target in part.columns.items():
            each = slab[name]
            kept = [side.name for side in (self.y, self.x) if side.name in each.dims]
            wanted = {**held, **chosen}
            values = each.isel({dim: wanted[str(dim)] for dim in each.dims}).transpose(*kept).values
            shape = [len(chosen[s.name]) if s.name in kept else 1 for s in (self.y, self.x)]
            target[tuple(cuts)] = values.reshape(shape)

    def above_limit(self, part: Slice) -> Floats | None:
        """Return ln(v / v_c) over a slice, which is 0 at the limit; None where it has none."""
        for limit, speed in _LIMITS:
            if limit not in part.columns:
                continue
            side = next((each for each in (self.x, self.y) if each.name == speed), None)
            if side is None:
                continue
            v = np.abs(side.values)
            v = v[np.newaxis, :] if side is self.x else v[:, np.newaxis]
            with np.errstate(divide="ignore", invalid="ignore"):
                ratio = np.log(v / part.columns[limit])
            # Where the search of a limit has failed there is none to draw.
            return np.asarray(np.clip(ratio, -30.0, 30.0))
        return None

    def border(self, part: Slice) -> Floats | None:
        """Return what is 0 where stick-slip ends: `above_limit`, else the border of the regime."""
        exact = self.above_limit(part)
        if exact is not None or "regime" not in part.columns:
            return exact
        return np.where(part.columns["regime"] == Regime.STICKS, -0.5, 0.5)

    def told(self, place: Mapping[str, int]) -> str:
        """Return the values of the further parameters of a slice, in words."""
        return ", ".join(
            f"{each.name} = {each.unit.told(float(each.values[place[each.name]]))}"
            for each in self.further
        )

    def summary(self, part: Slice) -> str:
        """Return what a slice shows, in words."""
        name = self.variables[0].name
        regime = part.columns.get("regime")
        told = [] if regime is None else [_shares(Counter(regime.ravel().tolist()))]
        values = _magnitudes(part.columns[name])
        if values.max() > 0.0:
            row, column = np.unravel_index(int(np.argmax(values)), values.shape)
            at = {self.x.name: float(self.x.values[column]), self.y.name: float(self.y.values[row])}
            told.append(self.largest(float(values.max()), at))
        return "; ".join(told)

    def largest(self, value: float, at: Mapping[str, float]) -> str:
        """Return in words the largest value of the main variable, and where it is [SI]."""
        main = self.variables[0]
        units = {each.name: each.unit for each in (self.x, self.y, *self.further)}
        where = ", ".join(f"{name} = {units[name].told(each)}" for name, each in at.items())
        unit = unit_of(self.units(main.name), value)
        return f"largest {main.words.lower()} {unit.told(value)} at {where}"


class _Seen:
    """What slabs of a map say together."""

    def __init__(self, view: View) -> None:
        self._view, self._name = view, view.variables[0].name
        self._counts = Counter[int]()
        self._points = self._at_limit = 0
        self._largest, self._where = 0.0, dict[str, float]()

    def add(self, slab: xarray.Dataset) -> None:
        """Look at a slab."""
        values = _magnitudes(slab[self._name].values)
        self._points += math.prod(slab.sizes.values())
        if "regime" in slab:
            kinds, counts = np.unique(slab["regime"].values, return_counts=True)
            self._counts.update(dict(zip(kinds.tolist(), counts.tolist(), strict=True)))
        if "at_limit" in slab:
            self._at_limit += int(np.count_nonzero(slab["at_limit"].values))
        if values.max() > self._largest:
            self._largest = float(values.max())
            places = np.unravel_index(int(np.argmax(values)), values.shape)
            self._where = {
                str(name): float(slab[name].values[place])
                for name, place in zip(slab[self._name].dims, places, strict=True)
            }

    def told(self) -> list[str]:
        """Return it in words."""
        lines = [f"{self._points} points"]
        if self._counts:
            lines[0] += f": {_shares(self._counts)}"
        if self._largest > 0.0:
            lines.append(self._view.largest(self._largest, self._where))
        if self._at_limit:
            lines.append(f"within 1e-6 of a limit: {self._at_limit} points, marked at_limit")
        return lines


def _shares(counts: Mapping[int, int]) -> str:
    points = sum(counts.values())
    return ", ".join(
        f"{verb} at {100.0 * counts[kind] / points:.1f} %"
        for kind, verb in _VERBS.items()
        if counts.get(kind)
    )


def _magnitudes(values: NDArray[Any]) -> Floats:
    """Return magnitudes, 0 for what is not finite."""
    return np.abs(np.where(np.isfinite(values), values, 0.0))


def _thinned(size: int) -> NDArray[np.intp]:
    return np.unique(np.linspace(0, size - 1, min(size, _MOST_PIXELS)).round().astype(np.intp))


_VERBS: Final = {
    Regime.STICKS: "sticks and slips",
    Regime.SWINGS: "swings",
    Regime.EVEN: "moves evenly",
    -1: "unknown",
}


class Colours(NamedTuple):
    """How values of a variable become colours: from `low` to `high` in `unit`."""

    low: float
    high: float
    log: bool
    unit: Unit

    def part(self, values: NDArray[Any]) -> Floats:
        """Return where values [SI] stand between the ends, 0 to 1."""
        with np.errstate(divide="ignore", invalid="ignore"):
            shown = np.abs(values) / self.unit.size
            if self.log:
                part = np.log(shown / self.low) / math.log(self.high / self.low)
            else:
                part = (shown - self.low) / (self.high - self.low)
        return np.asarray(np.clip(part, 0.0, 1.0))


def colours(unit: str, samples: Sequence[NDArray[Any]]) -> Colours:
    """Return the colours of a variable over some slices, by its magnitudes above 0.

    Parameters
    ----------
    unit
        SI unit of the variable.
    samples
        Its values in the slices that are shown.
    """
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
    return Colours(low / shown.size, high / shown.size, log, shown)


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
