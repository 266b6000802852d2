"""How a number of an axis file varies: distributions as people write them.

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
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from ..axis import AxisError, AxisFile, Number
from ..axis.keys import UNITS, key_of
from ..points.axes import check, read_number
from ..quantity import QuantityError, parts_of

Floats = NDArray[np.float64]
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

    Attributes
    ----------
    kind
        "normal" (mean, standard deviation), "lognormal" (median, standard deviation of the
        logarithm), "uniform" (lowest, highest) or "triangular" (lowest, likeliest, highest).
    numbers
        These.
    low, high
        The range of the number; the part of a normal that is beyond it is left out.
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
        """Return the values below which shares of all lie.

        Parameters
        ----------
        share
            Shares, above 0 and below 1 [-].
        """
        below, above = self._ends
        # With nothing cut off the share stays as it is, to the bit.
        if (below, above) != (0.0, 1.0):
            share = below + share * (above - below)
        return np.asarray(np.clip(self._frozen.ppf(share), self.low, self.high))


def varying(
    file: AxisFile, vary: dict[str, str], spread_is: SpreadIs = "uniform"
) -> dict[str, Distribution]:
    """Return how the numbers of an axis file vary, by name in the order of the file.

    Parameters
    ----------
    file
        The axis file; its ± count where nothing else is said.
    vary
        Distributions as people write them, by the name of a number in the file.
    spread_is
        What a ± means.

    Raises
    ------
    AxisError
        If the file states no such number, a text is no distribution, or nothing varies.
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
        elif number.spread:
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
