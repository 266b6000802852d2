"""What a sample of machines says: probabilities, Sobol indices, and a number solved for backwards.

Probabilities and quantiles have intervals of confidence of 95 %.

Which number's scatter matters: the estimators of Saltelli et al., Comput. Phys. Commun. 181 (2010)
259, doi:10.1016/j.cpc.2009.09.018, by `scipy.stats.sobol_indices`. They split a variance between
independent numbers: correlations of the series are left out here.

A share of machines that must run evenly: each machine of the sample has a factor on one number of
the axis file at which it turns from jumping to even motion, the rest of it held. The share of even
machines over the factor is the distribution of these turns, the factor looked for one of its
quantiles, and its interval that of an order statistic. The number keeps its relative scatter.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import qmc, quantile_test, sobol_indices

from ..axis import AxisError, AxisFile
from ..chunks import Columns, Results, Study
from ..points.axes import axis_points, check
from ..points.columns import Floats, Regime
from .machines import Distribution, Machines, Population, Samples

CONFIDENCE: Final = 0.95
"""Share of the samples whose interval holds the truth."""
_TAIL: Final = 0.5 * (1.0 - CONFIDENCE)


class Probability(NamedTuple):
    """A probability that was counted, and its interval [-]."""

    value: float
    low: float
    high: float


def probability(hits: int, count: int) -> Probability:
    """Return a probability from how often something happened in so many independent samples."""
    low, high = interval(np.array(float(hits)), np.array(float(count)))
    return Probability(hits / count, float(low), float(high))


def interval(hits: Floats, count: Floats) -> tuple[Floats, Floats]:
    """Return the ends of the intervals of probabilities, arrays of one shape.

    Notes
    -----
    Wilson's score interval: J. Am. Stat. Assoc. 22 (1927) 209, doi:10.1080/01621459.1927.10502953.
    Over all probabilities it holds the truth in 95.0 to 95.7 % of samples, also of rare events,
    where the exact interval of Clopper and Pearson does so in more than 97 %.
    """
    z = float(ndtri(1.0 - _TAIL))
    share = hits / count
    scale = 1.0 + z * z / count
    middle = (share + 0.5 * z * z / count) / scale
    half = z / scale * np.sqrt(share * (1.0 - share) / count + 0.25 * z * z / (count * count))
    # At the ends middle and half are the same number, but for rounding.
    low = np.where(hits == 0.0, 0.0, middle - half)
    high = np.where(hits == count, 1.0, middle + half)
    return low, high


_RESAMPLES: Final = 200
"""Resamples of the rows, out of which the intervals come."""
_SHIFT, _RESAMPLING = 0, 1
"""What a seed is used for here."""


@dataclass(frozen=True)
class Indices:
    """Sobol indices of one result, arrays by the numbers that vary.

    Attributes
    ----------
    first, total
        Parts of the variance that a number makes alone, and alone and together with others [-].
    first_range, total_range
        Intervals of confidence of 95 %, shape (numbers, 2), by resampling the rows.
    """

    first: Floats
    total: Floats
    first_range: Floats
    total_range: Floats


@dataclass(frozen=True)
class Mixed(Machines):
    """The study of the machines that Sobol indices are made from; columns as of `Samples`.

    Correlations are left out. Point ``block * rows + row`` is of the sample A, of B, or of A with
    one number of B; `rows` is a power of two.
    """

    feeds: tuple[float, ...]
    rows: int

    @property
    def count(self) -> int:
        """Points: rows times the numbers that vary and two."""
        return self.rows * (len(self.population.varied) + 2)

    def _block(self, start: int, stop: int) -> Columns:
        count = len(self.population.varied)
        drawn = mixed(self.population.seed, self.rows, count, start, stop)
        return self.population.answered(self.population.at(drawn), self.feeds)


def mixed(seed: int, rows: int, count: int, start: int, stop: int) -> Floats:
    """Return the shares of the points from `start` up to `stop`, as `Mixed` numbers them.

    Of `count` numbers that vary: (stop - start, count), above 0 and below 1 [-].
    """
    both = _rows(seed, rows, 2 * count)
    block, row = np.divmod(np.arange(start, stop), rows)
    of_B = (block == 1)[:, np.newaxis] | (block[:, np.newaxis] == np.arange(count) + 2)
    return np.where(of_B, both[row, count:], both[row, :count])


@lru_cache(maxsize=2)
def _rows(seed: int, rows: int, count: int) -> Floats:
    """Return a Sobol sequence, moved by a random way in each direction."""
    # Moved, not scrambled: the name of SciPy's argument for a generator depends on its version.
    sequence = qmc.Sobol(count, scramble=False).random_base2(rows.bit_length() - 1)
    moved = (sequence + _generator(seed, _SHIFT).random(count)) % 1.0
    return np.asarray(np.clip(moved, 2.0**-54, 1.0 - 2.0**-53))


def _generator(seed: int, use: int) -> np.random.Generator:
    # Far from the counts that draw the machines.
    return np.random.Generator(np.random.Philox(key=seed, counter=[0, 0, use, 1]))


def indices(values: Floats, rows: int, seed: int) -> Indices | None:
    """Return the Sobol indices of a result at the points of `mixed`, of so many rows, in order.

    `seed` is that of the resamples. None where the result is not finite at each point, or the same.
    """
    if not np.isfinite(values).all() or values.min() == values.max():
        return None
    parts = values.reshape(-1, rows)
    first, total = _estimated(parts)
    generator = _generator(seed, _RESAMPLING)
    again = [_estimated(parts[:, generator.integers(rows, size=rows)]) for _ in range(_RESAMPLES)]
    ranges = np.nanquantile(np.array(again), [_TAIL, 1.0 - _TAIL], axis=0)
    return Indices(first, total, ranges[:, 0].T, ranges[:, 1].T)


def _estimated(parts: Floats) -> tuple[Floats, Floats]:
    """Return the indices of first and total order from the results at A, B and each mixture."""
    if len(parts) == 3:
        # A number that varies alone carries all of it; SciPy fails there.
        return np.ones(1), np.ones(1)
    with np.errstate(invalid="ignore", divide="ignore"):
        found = sobol_indices(
            func={"f_A": parts[:1], "f_B": parts[1:2], "f_AB": parts[2:, np.newaxis]},
            n=parts.shape[1],
        )
    # Of one result SciPy leaves out the axis of results.
    return found.first_order.reshape(-1), found.total_order.reshape(-1)


_WIDEST: Final = 10.0
"""How far from its nominal value a number is looked for, as a factor."""
_STEPS_CLOSED, _STEPS = 20, 13
"""Halvings of that range: to 4e-6 with closed forms; to 6e-4 else, as a limit in the loop is."""


@dataclass(frozen=True)
class Turns(Machines):
    """The study of where each machine turns from jumping to even motion at a feed [m/s].

    The number `path` of the axis file is multiplied by factors from `low` to `high`. Columns:
    ``even at low`` and ``even at high``; ``turn``, the even end of the halved range [-], NaN where
    both ends are alike.
    """

    feed: float
    count: int
    path: str
    low: float
    high: float

    def _block(self, start: int, stop: int) -> Columns:
        count = stop - start
        drawn = self.population.drawn(start, stop)

        def even(factors: Floats) -> NDArray[np.bool_]:
            changes = self.population.scaled(drawn, self.path, factors)
            found = axis_points(self.population.file, changes, [self.feed], regimes_only=True)
            return np.asarray(found["regime"][:, 0] == Regime.EVEN)

        between = 1.0 if self.low < 1.0 < self.high else math.sqrt(self.low * self.high)
        low, middle, high = (np.full(count, each) for each in (self.low, between, self.high))
        at_low, at_middle, at_high = even(low), even(middle), even(high)
        turns = at_low != at_high
        steps = _STEPS_CLOSED if self.population.block > 1 else _STEPS
        for step in range(steps if turns.any() else 0):
            as_low = (even(middle) if step else at_middle) == at_low
            low, high = np.where(as_low, middle, low), np.where(as_low, high, middle)
            middle = np.sqrt(low * high)
        return {
            "even at low": at_low,
            "even at high": at_high,
            "turn": np.where(turns, np.where(at_low, low, high), math.nan),
            "turns back": ~turns & (at_middle != at_low),
        }


class Hold(NamedTuple):
    """What must hold: at `feed` [m/s] a `share` of machines runs evenly, by the number `path`.

    The number is looked for between `low` and `high` times its nominal value `now`.
    """

    share: float
    feed: float
    path: str
    now: float
    low: float
    high: float


@dataclass(frozen=True)
class Solved:
    """The nominal value of a number at which enough machines run evenly.

    It is `value`, with an interval of confidence of 95 % from `low` to `high`, in the SI unit in
    which the file states the number `path`; its scatter grows and shrinks with it. An end is NaN
    where the sample is too small for it, or it is beyond the range. More machines run evenly below
    it if `at_most`, else above. Counted anew there the share [-] is `checked`: another one than
    `share` where a machine turns more than once. It was looked for `within` two values, with the
    shares `at_ends`. Without a value, which is NaN then, `unsolved` says why.
    """

    path: str
    unit: str
    share: float
    feed: float
    value: float
    low: float
    high: float
    now: float
    share_now: Probability
    at_most: bool
    checked: Probability
    within: tuple[float, float]
    at_ends: tuple[float, float]
    unsolved: str = ""


def hold_of(
    file: AxisFile, path: str, distribution: Distribution | None, share: float, feed: float,
    within: tuple[float, float] | None,
) -> Hold:  # fmt: skip
    """Return what must hold, the number looked for `within` a lowest and a highest value.

    None: a tenth to ten times its nominal value, in the SI unit in which the file states it.
    AxisError if the file states no such number, or the range is not one of its.
    """
    stated = check(file, path)
    now = stated.value if distribution is None else distribution.nominal
    if now == 0.0:
        raise AxisError(
            "is 0, and a number is solved for as a factor on its nominal value", key=path,
            name=file.name,
        )  # fmt: skip
    if within is None:
        return Hold(share, feed, path, now, 1.0 / _WIDEST, _WIDEST)
    check(file, path, within)
    low, high = sorted(each / now for each in within)
    if not within[0] < within[1] or not low > 0.0:
        raise AxisError(
            "is looked for in an empty or reversed range, or one that holds 0", key=path,
            value=f"{within[0]:g} to {within[1]:g}", name=file.name,
        )  # fmt: skip
    return Hold(share, feed, path, now, low, high)


def solved(
    population: Population, hold: Hold, count: int, compute: Callable[[Study, str], Results]
) -> Solved:
    """Return the nominal value at which a share of `count` machines runs evenly at a feed.

    The same machines are drawn for each value. `compute` computes a study; the text says what for.
    """
    share, feed, path, now, low, high = hold

    def even(factor: float, name: str) -> Probability:
        study = Samples(population, (feed,), count, (path, factor), regimes_only=True)
        regimes = compute(study, name).read()["regime 1"]
        return probability(int((regimes == Regime.EVEN).sum()), count)

    found = compute(Turns(population, feed, count, path, low, high), "turns").read()
    at_low, at_high = (found[name].astype(np.bool_) for name in ("even at low", "even at high"))
    turn = found["turn"].astype(np.float64)
    falling, rising = int((at_low & ~at_high).sum()), int((at_high & ~at_low).sum())
    back = int(found["turns back"].sum()) + min(falling, rising)
    at_most = falling >= rising
    # Machines that are even everywhere turn before the range begins, those that never are after it.
    always, never = (math.inf, 0.0) if at_most else (0.0, math.inf)
    turn = np.where(np.isnan(turn), np.where(at_low, always, never), turn)
    signed = -turn if at_most else turn
    at = min(max(math.ceil(share * count - 1e-9), 1), count)
    factor = abs(float(np.sort(signed)[at - 1]))
    unsolved = ""
    if back:
        unsolved = f"{back} of {count} machines turn back again in its range, which is too wide"
    elif factor == never:
        unsolved = "no value in its range does it"
    elif factor == always:
        unsolved = "every value in its range does it"
    # Order statistics of a binomial count: David and Nagaraja, Order Statistics, 2003, section 7.1.
    ends = map(abs, quantile_test(signed, p=share).confidence_interval(CONFIDENCE))
    bounds = [now * end if 0.0 < end < math.inf else math.nan for end in ends]
    share_now = even(1.0, "now")
    at_most = at_most == (now > 0.0)
    tried = sorted([(now * low, float(at_low.mean())), (now * high, float(at_high.mean()))])
    return Solved(
        path=path, unit=check(population.file, path).unit, share=share, feed=feed,
        value=math.nan if unsolved else now * factor,
        low=math.nan if unsolved else bounds[at_most],
        high=math.nan if unsolved else bounds[not at_most],
        now=now, share_now=share_now, at_most=at_most,
        checked=share_now if unsolved else even(factor, "solved"),
        within=(tried[0][0], tried[1][0]), at_ends=(tried[0][1], tried[1][1]),
        unsolved=unsolved,
    )  # fmt: skip
