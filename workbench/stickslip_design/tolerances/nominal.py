"""A share of machines that must run evenly, solved backwards for one number of the axis file.

Each machine of the sample has a factor on that number at which it turns from jumping to even
motion, the rest of it held. The share of even machines over the factor is the distribution of
these turns, the factor looked for one of its quantiles, and its interval that of an order
statistic. The number keeps its relative scatter.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..axis import AxisError, AxisFile
from ..chunks import Columns, Results, Study
from ..points.axes import axis_points, check
from ..points.columns import Regime
from .distributions import Distribution
from .probability import Probability, probability, ranks
from .samples import Machines, Population, Samples

Floats = NDArray[np.float64]

_WIDEST: Final = 10.0
"""How far from its nominal value a number is looked for, as a factor."""
_STEPS_CLOSED, _STEPS = 20, 13
"""Halvings of that range: to 4e-6 with closed forms; to 6e-4 else, as a limit in the loop is."""


@dataclass(frozen=True)
class Turns(Machines):
    """The study of where each machine turns from jumping to even motion.

    Attributes
    ----------
    feed
        The feed [m/s].
    path, low, high
        The number of the axis file that is multiplied, and the least and the largest factor.

    Notes
    -----
    Columns: ``even at low`` and ``even at high``; ``turn``, the even end of the halved range [-],
    NaN where both ends are alike.
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

    Attributes
    ----------
    path, unit
        The number, and the SI unit in which the file states it.
    share, feed
        What must hold: the share of machines that run evenly [-], at a feed [m/s].
    value
        The nominal value; its scatter grows and shrinks with it.
    low, high
        Its interval of confidence of 95 %; an end is NaN where the sample is too small for it, or
        it is beyond the range.
    now, share_now
        The nominal value of the file, and the share of machines that run evenly there.
    at_most
        Whether more of them run evenly below `value`; else above it.
    checked
        The share of even machines at `value`, counted anew: another one than `share` where a
        machine turns more than once. Without a value that of now.
    within
        The values among which it was looked for.
    at_ends
        The share of even machines at each of them [-].
    unsolved
        Why there is no such value, in words; empty where there is one. Without one `value` is NaN.
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

    Raises
    ------
    AxisError
        If the file states no such number, or the range is not one of its.
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
    """Return the nominal value at which a share of machines runs evenly at a feed.

    Parameters
    ----------
    population
        The machines.
    hold
        What must hold.
    count
        How many machines are drawn: the same for each value.
    compute
        Computes a study; the text says what for.
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
    order = np.sort(turn)[::-1] if at_most else np.sort(turn)
    first, at, last = ranks(count, share)
    factor = float(order[at - 1])
    unsolved = ""
    if back:
        unsolved = f"{back} of {count} machines turn back again in its range, which is too wide"
    elif factor == never:
        unsolved = "no value in its range does it"
    elif factor == always:
        unsolved = "every value in its range does it"
    bounds = [float(order[n - 1]) if 1 <= n <= count else math.nan for n in (first, last)]
    bounds = [now * bound if 0.0 < bound < math.inf else math.nan for bound in bounds]
    share_now = even(1.0, "now")
    at_most = at_most == (now > 0.0)
    ends = (now * low, float(at_low.mean())), (now * high, float(at_high.mean()))
    return Solved(
        path=path, unit=check(population.file, path).unit, share=share, feed=feed,
        value=math.nan if unsolved else now * factor,
        low=math.nan if unsolved else bounds[at_most],
        high=math.nan if unsolved else bounds[not at_most],
        now=now, share_now=share_now, at_most=at_most,
        checked=share_now if unsolved else even(factor, "solved"),
        within=(min(ends)[0], max(ends)[0]), at_ends=(min(ends)[1], max(ends)[1]),
        unsolved=unsolved,
    )  # fmt: skip
