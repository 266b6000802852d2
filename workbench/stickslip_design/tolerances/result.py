"""What came out for a series of machines, as attributes, datasets and JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from ..chunks import Columns
from ..datasets import need, provenance
from ..points.axes import check
from ..points.columns import AXIS, Regime
from ..report.record import plain
from .indices import Indices
from .nominal import Hold, Solved
from .probability import Probability, probability
from .samples import Population, Samples

if TYPE_CHECKING:
    import xarray

QUANTILES: Final = (0.05, 0.5, 0.95)
"""The quantiles of the jump that are told."""
_PROBABILITY: Final = {
    "probability": "probability of jumping",
    "probability_low": "lower end of its interval of 95 %",
    "probability_high": "upper end of its interval of 95 %",
}


@dataclass(frozen=True)
class Question:
    """What is asked of a series of machines.

    Attributes
    ----------
    population, count
        The machines, and how many are drawn.
    feeds
        Feeds at which each is judged [m/s].
    rows
        Rows of the Sobol indices, a power of two; 0: none.
    hold
        What must hold; None: nothing is solved for.
    """

    population: Population
    feeds: tuple[float, ...]
    count: int
    rows: int
    hold: Hold | None = None

    @property
    def samples(self) -> Samples:
        """The study of the machines."""
        return Samples(self.population, self.feeds, self.count)


@dataclass(frozen=True)
class Outcome:
    """What the machines do at a feed.

    Attributes
    ----------
    feed
        The feed [m/s].
    jumps, even
        The probabilities that a machine jumps there, and that it runs evenly: its jump is 0.
    swings, unknown
        How many swing without rest, or have an unstable loop; how many could not be computed.
    jump
        The `QUANTILES` of the jump [m] of those that jump; NaN where none does.
    unmeasured
        How many jump by an unknown way: a drive turns the table back between two jumps.
    """

    feed: float
    jumps: Probability
    even: Probability
    swings: int
    unknown: int
    jump: tuple[float, ...]
    unmeasured: int


@dataclass(frozen=True)
class Scatter:
    """The answer.

    Attributes
    ----------
    question, outcomes
        What was asked, and what the machines do, by feed.
    columns
        The numbers and results of each machine, as `Samples` describes them.
    clamped
        How many had their mu_k above their mu_s, and it was taken as that.
    indices
        Sobol indices by result: ``critical_feed``, ``jump 1`` of the first feed, and so on; a
        result that is the same at all machines, or not finite, has none.
    solved
        The number that was solved for.
    """

    question: Question
    columns: Columns
    outcomes: tuple[Outcome, ...]
    clamped: int
    indices: Mapping[str, Indices]
    solved: Solved | None

    @property
    def provenance(self) -> dict[str, str]:
        """Versions, inputs, their digest, command and seed, as attributes of a file."""
        seed = str(self.question.population.seed)
        return {**provenance(self.question.samples.identity), "seed": seed}

    def _about(self, name: str) -> dict[str, str]:
        if name in AXIS:
            return {"units": AXIS[name].unit, "long_name": AXIS[name].description}
        return {"units": check(self.question.population.file, name).unit}

    def dataset(self) -> xarray.Dataset:
        """Return the answer with names and units, by ``sample``, ``feed`` and ``parameter``."""
        feeds = self.question.feeds
        varied = list(self.question.population.varied)
        data: dict[str, Any] = {}
        for name in (*varied, *AXIS):
            if name in self.columns:
                data[name] = "sample", self.columns[name], self._about(name)
            else:
                table = [self.columns[f"{name} {n}"] for n in range(1, len(feeds) + 1)]
                data[name] = ("sample", "feed"), np.stack(table, axis=1), self._about(name)
        for place, (name, words) in enumerate(_PROBABILITY.items()):
            column = [each.jumps[place] for each in self.outcomes]
            data[name] = "feed", column, {"units": "1", "long_name": words}
        words = "quantile of the jump of machines that jump"
        jumps = [each.jump for each in self.outcomes]
        data["jump_quantile"] = ("feed", "quantile"), jumps, {"units": "m", "long_name": words}
        jumps_of = [self.indices.get(f"jump {n}") for n in range(1, len(feeds) + 1)]
        none = np.full(len(varied), math.nan)
        for order in ("first", "total") if self.indices else ():
            rows = [none if each is None else getattr(each, order) for each in jumps_of]
            about = {"units": "1", "long_name": f"Sobol index of {order} order of the jump"}
            data[f"sobol_{order}"] = ("feed", "parameter"), np.array(rows), about
        coordinates = {
            "sample": np.arange(self.question.count),
            "feed": ("feed", list(feeds), {"units": "m/s"}),
            "quantile": list(QUANTILES),
            "parameter": varied,
        }
        attributes: dict[str, Any] = {**self.provenance, "clamped": self.clamped}
        if self.solved is not None:
            attributes["solved"] = json.dumps(plain(self.solved))
        dataset: xarray.Dataset = need("xarray").Dataset(data, coordinates, attributes)
        return dataset

    def table(self) -> xarray.Dataset:
        """Return numbers and results of the machines by ``sample`` alone, a column for each."""
        data: dict[str, Any] = {}
        for name, column in self.columns.items():
            kind, _, place = name.partition(" ")
            about = self._about(kind)
            if place:
                about["long_name"] += f" (at {self.question.feeds[int(place) - 1]:.6g} m/s)"
            data[name.replace(" ", "_")] = "sample", column, about
        coordinates = {"sample": np.arange(self.question.count)}
        table: xarray.Dataset = need("xarray").Dataset(data, coordinates, self.provenance)
        return table


def outcome(feed: float, regime: NDArray[Any], jump: NDArray[np.float64]) -> Outcome:
    """Return what machines do at a feed [m/s], from regime and jump [m] of each."""
    sticks = regime == Regime.STICKS
    known = jump[sticks & np.isfinite(jump)]
    return Outcome(
        feed=feed,
        jumps=probability(int(sticks.sum()), len(regime)),
        even=probability(int((regime == Regime.EVEN).sum()), len(regime)),
        swings=int((regime == Regime.SWINGS).sum()),
        unknown=int((regime == Regime.UNKNOWN).sum()),
        jump=tuple(np.quantile(known, QUANTILES).tolist()) if len(known) else (math.nan,) * 3,
        unmeasured=int(sticks.sum()) - len(known),
    )
