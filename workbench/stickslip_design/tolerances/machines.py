"""Axes whose numbers vary, drawn at random, and what each does: the study that scatter is made of.

Distributions as people write them:

``normal 0.20 0.02``, ``normal 0.20 10 %``
    Mean and standard deviation.
``lognormal 40 N/um 10 %``
    Median and, in parts of it, the standard deviation of the logarithm.
``uniform 450..550 kg``
    Lowest and highest.
``triangular 1 1.4 3 %``
    Lowest, likeliest, highest.
``± 10 %``
    Around the number that the file states; or with a number before it, around that.
``fixed``
    The ± of the file does not count.

Random numbers come from the seed and the number of the machine alone, by Philox, which counts:
Salmon, Moraes, Dror, Shaw, Parallel random numbers: as easy as 1, 2, 3, SC'11, 2011,
doi:10.1145/2063384.2063405. Correlated numbers are those of a Gaussian copula: the correlation is
that of the normal scores, which for normal distributions is Pearson's.
"""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from functools import cached_property
from typing import Any, Final, Literal

import numpy as np
from scipy import stats
from scipy.special import ndtr, ndtri

from stickslip_units import QuantityError, parts_of

from ..axis import AxisError, AxisFile, Number
from ..axis.keys import UNITS, key_of
from ..chunks import Columns
from ..points.axes import axis_points, check, has_closed_form, read_number
from ..points.columns import WITHOUT_FEED, Floats

SpreadIs = Literal["uniform", "normal"]
"""What a ± means: every value within it is as likely as another, or it is two sigma of a normal."""

_SIGMAS: Final = 2.0
"""Standard deviations of a ± that is taken as normal: 95 % are within it."""
_MOST_CUT: Final = 0.1
"""A distribution of which more than this part is out of the range of its number is refused."""

_KINDS: Final[dict[str, tuple[int, Callable[..., Any]]]] = {
    "normal": (2, stats.norm),
    "lognormal": (2, lambda median, sigma: stats.lognorm(sigma, scale=median)),
    "uniform": (2, lambda low, high: stats.uniform(low, high - low)),
    "triangular": (
        3,
        lambda low, mode, high: stats.triang((mode - low) / (high - low), low, high - low),
    ),
}
"""Kinds of distributions: how many numbers each has, and the one of SciPy with these."""
_WRITTEN: Final = (
    '"normal MEAN SIGMA", "lognormal MEDIAN SIGMA", "uniform LOW..HIGH", '
    '"triangular LOW LIKELIEST HIGH", "± SPREAD" or "fixed"'
)
_NEXT: Final = re.compile(r"\s+(?=[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?![\d./eE]))")
"""A blank before a number; in `25 1/s` there is none before the unit."""
_PLUS_MINUS: Final = re.compile(r"±|\+/-|\+-")


@dataclass(frozen=True)
class Distribution:
    """The distribution of a number, in the SI unit in which the file states it.

    Its `kind` is normal (mean, standard deviation), lognormal (median, standard deviation of the
    logarithm), uniform (lowest, highest) or triangular (lowest, likeliest, highest): the `numbers`.
    The part of a normal that is beyond `low` and `high` is left out.
    """

    kind: str
    numbers: tuple[float, ...]
    low: float = -math.inf
    high: float = math.inf

    @property
    def nominal(self) -> float:
        """Its mean, median or likeliest value; of a uniform distribution the middle."""
        if self.kind == "uniform":
            return 0.5 * (self.numbers[0] + self.numbers[1])
        return self.numbers[1] if self.kind == "triangular" else self.numbers[0]

    @property
    def cut(self) -> float:
        """The part that is beyond its range and left out [-]."""
        below, above = self._ends
        return below + (1.0 - above)

    @property
    def _frozen(self) -> Any:
        return _KINDS[self.kind][1](*self.numbers)

    @property
    def _ends(self) -> tuple[float, float]:
        """The probabilities up to the ends of the range."""
        below, above = self._frozen.cdf([self.low, self.high]).tolist()
        return below, above

    def values(self, share: Floats) -> Floats:
        """Return the values below which shares of all lie, above 0 and below 1 [-]."""
        below, above = self._ends
        # With nothing cut off the share stays as it is, to the bit.
        if (below, above) != (0.0, 1.0):
            share = below + share * (above - below)
        return np.asarray(np.clip(self._frozen.ppf(share), self.low, self.high))


def varying(
    file: AxisFile, vary: dict[str, str], spread_is: SpreadIs = "uniform"
) -> dict[str, Distribution]:
    """Return how the numbers of an axis file vary, by name in the order of the file.

    `vary` are distributions as people write them, by the name of a number in the file; the ± of the
    file, whose meaning is `spread_is`, count where nothing else is said. AxisError if the file
    states no such number, a text is no distribution, or nothing varies.
    """
    for path in vary:
        if path.startswith("demand."):
            raise AxisError("is asked of the axis and does not vary", key=path, name=file.name)
        check(file, path)
    found: dict[str, Distribution] = {}
    for path, number in file.values.items():
        if not isinstance(number, Number) or path.startswith("demand."):
            continue
        if path in vary:
            text = vary[path].strip()
            if text != "fixed":
                found[path] = _within(file, path, _read(file, path, number, text, spread_is))
        # That of a torque constant is of records, and moves nothing.
        elif number.spread and path != "drive.torque_constant":
            found[path] = _within(file, path, _around(number.value, number.spread, spread_is))
    if not found:
        raise AxisError(
            "nothing varies: no number of the file has a ±", name=file.name,
            remedy='write a ± there, or --vary "friction.mu_s=normal 0.2 0.02"',
        )  # fmt: skip
    return found


def range_of(file: AxisFile, path: str, text: str) -> tuple[float, float]:
    """Return the ends of a text such as ``36..44 N/um`` in the unit of the file; AxisError."""
    low, high = _read(file, path, check(file, path), f"uniform {text}", "uniform").numbers
    check(file, path, [low, high])
    return low, high


def _around(value: float, spread: float, spread_is: SpreadIs) -> Distribution:
    if spread_is == "normal":
        return Distribution("normal", (value, spread / _SIGMAS))
    return Distribution("uniform", (value - spread, value + spread))


def _read(
    file: AxisFile, path: str, number: Number, text: str, spread_is: SpreadIs
) -> Distribution:
    try:
        if not _PLUS_MINUS.search(text):
            return _of_kind(number, text)
        centre, _, around = _PLUS_MINUS.sub("±", text).partition("±")
        value = read_number(number, centre) if centre.strip() else number.value
        spread = _scatter(number, value, around.strip(), _unit(centre))
        if not spread > 0.0:
            raise QuantityError("has a ± that is not above 0")
        return _around(value, spread, spread_is)
    except QuantityError as error:
        raise AxisError(str(error), key=path, value=text, name=file.name, within=_WRITTEN) from None


def _of_kind(number: Number, text: str) -> Distribution:
    kind, _, rest = text.partition(" ")
    if kind not in _KINDS:
        raise QuantityError("is no distribution")
    parts = _NEXT.split(rest.replace("..", " ").strip())
    if len(parts) != (count := _KINDS[kind][0]):
        raise QuantityError(f"has {len(parts)} numbers in place of {count}")
    last = _unit(parts[-1])
    if kind in {"normal", "lognormal"}:
        centre = parts[0] if _unit(parts[0]) or last == "%" else f"{parts[0]} {last}"
        value = read_number(number, centre)
        sigma = _scatter(number, value, parts[1], _unit(centre))
        if not sigma > 0.0:
            raise QuantityError("has a standard deviation that is not above 0")
        if kind == "lognormal":
            if not value > 0.0:
                raise QuantityError("has a median that is not above 0")
            return Distribution(kind, (value, sigma / value))
        return Distribution(kind, (value, sigma))
    values = tuple(read_number(number, part if _unit(part) else f"{part} {last}") for part in parts)
    if not values[0] < values[-1] or list(values) != sorted(values):
        raise QuantityError("is empty or reversed")
    return Distribution(kind, values)


def _unit(text: str) -> str:
    return parts_of(text)[1] if text.strip() else ""


def _scatter(number: Number, value: float, text: str, unit_of_value: str) -> float:
    """Return a scatter in the unit of its number; percent are of the value, if that has none."""
    if _unit(text) == "%" != unit_of_value:
        return abs(value) * UNITS.read(text, (UNITS.kinds["1"],), None)[0]
    return read_number(number, text if _unit(text) else f"{text} {unit_of_value}")


def _within(file: AxisFile, path: str, found: Distribution) -> Distribution:
    """Return a distribution within the range of its number; raises AxisError if much is outside."""
    within = key_of(path).within
    bounded = found.kind in {"uniform", "triangular"}
    check(file, path, [found.numbers[0], found.numbers[-1]] if bounded else found.nominal)
    if found.kind != "normal":
        return found
    low = math.nextafter(within.low, math.inf) if within.strict else within.low
    found = replace(found, low=low, high=within.high)
    if found.cut > _MOST_CUT:
        raise AxisError(
            f"has {100.0 * found.cut:.0f} % of its distribution out of range", key=path,
            name=file.name, within=str(within), remedy="a lognormal one stays above 0",
        )  # fmt: skip
    return found


Factor = tuple[tuple[float, ...], ...]
"""Rows of a lower triangular matrix."""

_WORDS: Final = 4
"""Random numbers of a count of Philox."""
_ROUNDING: Final = 1e-12
"""A matrix is taken as one of correlations if its factor misses 0 by no more than this."""
_HALF: Final = 2.0**-54
"""Half of the step between two shares: they are never 0 or 1."""
_BLOCK: Final = 16384
"""Points of a closed form that are computed together, whatever the chunk: some vector loops round
by the place of a number in its array."""


@dataclass(frozen=True)
class Population:
    """The machines of a series: an axis file, and the distributions of its numbers that vary.

    The `correlation` has those of pairs of them, -1 to 1, others are 0; ValueError if they cannot
    be. The random numbers have a `seed`.
    """

    file: AxisFile
    varied: Mapping[str, Distribution]
    correlation: Mapping[tuple[str, str], float]
    seed: int

    def __post_init__(self) -> None:
        # Told where it is stated, and not by a worker.
        self._factor  # noqa: B018

    @cached_property
    def _factor(self) -> Factor:
        return factor_of(list(self.varied), self.correlation)

    @cached_property
    def block(self) -> int:
        """How many points are computed together."""
        return _BLOCK if has_closed_form(self.file.axis()) else 1

    @property
    def identity(self) -> dict[str, Any]:
        """All that the machines depend on, as JSON knows it."""
        return {
            "axis": self.file.identity,
            # In their order, by which each has its own random numbers.
            "varied": [[path, each.kind, *each.numbers] for path, each in self.varied.items()],
            "factor": self._factor,
            "seed": self.seed,
        }

    def drawn(self, start: int, stop: int) -> dict[str, Floats]:
        """Return the numbers that vary, of the machines from `start` up to `stop`."""
        drawn = correlated(shares(self.seed, start, stop, len(self.varied)), self._factor)
        return self.at(drawn)

    def at(self, drawn: Floats) -> dict[str, Floats]:
        """Return the numbers at shares of their distributions, (machines, numbers)."""
        return {
            path: each.values(np.ascontiguousarray(drawn[:, place]))
            for place, (path, each) in enumerate(self.varied.items())
        }

    def scaled(
        self, changes: dict[str, Floats], path: str, by: float | Floats
    ) -> dict[str, Floats]:
        """Return changes with one number multiplied, one that does not vary too; "" for none."""
        if not path:
            return changes
        count = len(next(iter(changes.values())))
        stated = np.full(count, check(self.file, path).value)
        return {**changes, path: changes.get(path, stated) * by}

    def answered(
        self, changes: Mapping[str, Floats], feeds: tuple[float, ...], *, regimes_only: bool = False
    ) -> Columns:
        """Return numbers and what each machine does at some feeds, as the columns of `Samples`."""
        found = axis_points(self.file, changes, feeds, regimes_only=regimes_only)
        columns: Columns = {**changes, **{name: found[name] for name in WITHOUT_FEED}}
        for name in ("jump", "rate", "regime"):
            for place, column in enumerate(found[name].T, 1):
                columns[f"{name} {place}"] = np.ascontiguousarray(column)
        return columns


@dataclass(frozen=True)
class Machines(ABC):
    """A study of a population, whose other fields say all that its results depend on beside it.

    A subclass computes so many points at a time as `Population.block` says, whatever the chunk.
    Its `count` is that of its points; `feeds` are those at which each machine is judged [m/s].
    """

    population: Population

    @property
    def quantum(self) -> int:
        """A chunk is a multiple of so many points."""
        return self.population.block

    @property
    def identity(self) -> Mapping[str, Any]:
        """All that the results depend on, but for versions."""
        own = {each.name: getattr(self, each.name) for each in fields(self)[1:]}
        name = type(self).__name__.lower()
        return {"study": f"scatter: {name}", **self.population.identity, **own}

    def compute(self, start: int, stop: int) -> Columns:
        """Return the columns of the machines from `start` up to `stop`."""
        starts = range(start, stop, self.quantum)
        parts = [self._block(each, min(each + self.quantum, stop)) for each in starts]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    @abstractmethod
    def _block(self, start: int, stop: int) -> Columns:
        """Return the columns of the machines of one quantum."""


@dataclass(frozen=True)
class Samples(Machines):
    """The study of machines drawn at random; a number of the file is `scaled` by a factor in all.

    Columns: the numbers that vary by their names; ``critical_feed``, ``stable``, ``clamped``;
    ``jump 1``, ``rate 1``, ``regime 1`` of the first feed, and so on; `points.axes.axis_points`
    describes them.
    """

    feeds: tuple[float, ...]
    count: int
    scaled: tuple[str, float] = ("", 1.0)
    regimes_only: bool = False

    def _block(self, start: int, stop: int) -> Columns:
        drawn = self.population.drawn(start, stop)
        changes = self.population.scaled(drawn, *self.scaled)
        return self.population.answered(changes, self.feeds, regimes_only=self.regimes_only)


def shares(seed: int, start: int, stop: int, count: int) -> Floats:
    """Return the random shares of samples [-], above 0 and below 1.

    `count` of them for each sample from `start` up to `stop`; the seed is 0 to 2^128 - 1.
    """
    counts = -(-count // _WORDS)
    generator = np.random.Philox(key=seed)
    generator.advance(start * counts)
    drawn = np.random.Generator(generator).random((stop - start, counts * _WORDS))
    return drawn[:, :count] + _HALF


def factor_of(names: Sequence[str], correlation: Mapping[tuple[str, str], float]) -> Factor:
    """Return the lower triangular L of L L^T = R, the correlations of numbers that vary.

    `correlation` has those of pairs, -1 to 1 [-]; others are 0. ValueError if a name does not vary,
    a correlation is out of range, or they exclude each other.
    """
    R = np.eye(len(names))
    for pair, value in correlation.items():
        for name in pair:
            if name not in names:
                near = get_close_matches(name, names, 3, 0.4) or list(names)
                raise ValueError(
                    f"{name} does not vary, and a correlation is of two numbers that do; "
                    f"nearest: {', '.join(near)}"
                )
        one, other = (list(names).index(name) for name in pair)
        if one == other:
            raise ValueError(f"{pair[0]} is correlated with itself; name two numbers")
        if not -1.0 <= value <= 1.0:
            raise ValueError(
                f"the correlation of {pair[0]} and {pair[1]} is {value:g}; it must be -1 to 1"
            )
        R[one, other] = R[other, one] = value
    L = np.zeros_like(R)
    for row in range(len(names)):
        for column in range(row + 1):
            rest = R[row, column] - math.fsum(L[row, :column] * L[column, :column])
            excluded = False
            if row == column:
                excluded = rest < -_ROUNDING
                L[row, row] = math.sqrt(max(rest, 0.0))
            elif L[column, column] > math.sqrt(_ROUNDING):
                L[row, column] = rest / L[column, column]
            else:
                excluded = abs(rest) > math.sqrt(_ROUNDING)
            if excluded:
                raise ValueError("the correlations exclude each other: no numbers have all of them")
    return tuple(tuple(map(float, row[: place + 1])) for place, row in enumerate(L))


def correlated(independent: Floats, factor: Factor) -> Floats:
    """Return shares with the correlations of a factor, from independent ones; of one shape.

    A share that is correlated with none before it stays as it is, to the bit.
    """
    if all(not any(row[:-1]) for row in factor):
        return independent
    scores = [np.ascontiguousarray(each) for each in ndtri(independent).T]
    found = independent.copy()
    for place, row in enumerate(factor):
        if any(row[:-1]):
            # Term by term, not as a product of matrices: its bits would depend on their size.
            total = np.zeros(len(independent))
            for weight, score in zip(row, scores, strict=False):
                if weight:
                    total = total + weight * score
            found[:, place] = np.clip(ndtr(total), _HALF, 1.0 - 2.0 * _HALF)
    return found
