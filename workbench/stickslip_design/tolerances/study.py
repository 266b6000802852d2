"""How likely an axis jumps where its numbers vary: a question, and its answer."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Unpack

import numpy as np
from numpy.typing import NDArray

from stickslip_units import QuantityError

from ..axis import AxisFile, AxisSource, read_axis_file
from ..axis.keys import KEYS, UNITS
from ..chunks import Columns, Computing, Results, Study, run
from ..datasets import need, provenance
from ..points.axes import check, has_closed_form
from ..points.columns import AXIS, Regime
from ..report.page import plain
from .machines import Population, Samples, SpreadIs, range_of, varying
from .statistics import (
    Hold,
    Indices,
    Mixed,
    Probability,
    Solved,
    hold_of,
    indices,
    probability,
    solved,
)

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
    """What is asked of a series of machines, of which `count` are drawn, at feeds [m/s].

    Sobol indices have `rows`, a power of two, or 0: none; `hold` is what is solved for.
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
    """What the machines do at a feed [m/s].

    `jumps` and `even` are the probabilities that a machine jumps there, and that it runs evenly.
    `swings` swing without rest, or have an unstable loop; `unknown` could not be computed. `jump`
    are the `QUANTILES` of the jump [m] of those that jump, NaN where none does; `unmeasured` jump
    by an unknown way: a drive turns the table back between two jumps.
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
    """The answer: what the machines do, by feed; `columns` of each machine as of `Samples`.

    Of `clamped` machines mu_k came above mu_s and was taken as that. Sobol indices by result:
    ``critical_feed``, ``jump 1`` of the first feed, and so on; a result that is the same at all
    machines, or not finite, has none.
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


SAMPLES_CLOSED, SAMPLES = 100_000, 1_000
"""Machines drawn by default: where closed forms answer, and where each takes up to a second."""
_ROWS_CLOSED: Final = 4096
"""Rows of the Sobol indices by default, where closed forms answer."""
_SEEDS: Final = 2**128
"""How many seeds Philox has."""

Computed = Callable[[Study, str], Results]
"""Computes a study; the text says what for, and names its folder."""


def scatter(
    axis: AxisSource,
    *,
    vary: Mapping[str, str] | None = None,
    spread_is: SpreadIs = "uniform",
    correlation: Mapping[tuple[str, str], float] | None = None,
    feeds: Sequence[float | str] = (),
    samples: int | None = None,
    indices: int | None = None,
    seed: int = 0,
    hold: str | tuple[float, float] | None = None,
    solve: str | None = None,
    within: str | tuple[float, float] | None = None,
    folder: str | None = None,
    **how: Unpack[Computing],
) -> xarray.Dataset:
    """Return how likely an axis jumps where its numbers vary, and by how much.

    Parameters
    ----------
    axis
        The axis file, its path or a dictionary of its tables; its ± count as scatter.
    vary
        Distributions by the name of a number, as `machines` has them: ``{"friction.mu_s":
        "normal 0.2 0.02"}``; they come before a ± of the file.
    spread_is
        What a ± means: "uniform" within it, or "normal" with two sigma.
    correlation
        Correlations of pairs of numbers that vary, -1 to 1.
    feeds
        Feeds to judge at: in m/s, or with a unit; by default those of the file.
    samples
        Machines drawn; by default 100,000 where closed forms answer, else 1,000.
    indices
        Rows of the Sobol indices, a power of two, of which each costs as many points as numbers
        vary and two; 0: none. By default 4,096 where closed forms answer, else 0.
    seed
        Seed of the random numbers.
    hold, solve, within
        What must hold, as ``"99 % at 2 mm/min"`` or (share, feed [m/s]); the name of the number
        whose nominal value is solved for; the lowest and the highest value to look among, with a
        unit as ``"36..44 N/um"``; by default a tenth and ten times the nominal value.
    folder, how
        As of `chunks.run`: ``workers``, ``cluster``, ``fresh``, ``progress``.

    Returns
    -------
    xarray.Dataset
        By ``sample``: the numbers that vary, ``critical_feed``, ``jump``, ``rate``, ``regime``,
        ``stable`` and ``clamped``. By ``feed``: ``probability`` of jumping with its interval,
        ``jump_quantile``, Sobol indices. Versions, inputs and seed are attributes.

    Raises
    ------
    AxisError, ValueError
        If the file, a distribution or another argument cannot be used; one line.
    """
    file = read_axis_file(axis)
    need("xarray")
    asked = question(
        file, vary=vary, spread_is=spread_is, correlation=correlation, feeds=feeds,
        samples=samples, indices=indices, seed=seed, hold=hold, solve=solve, within=within,
    )  # fmt: skip

    def computed(study: Study, name: str) -> Results:
        return run(study, None if folder is None else f"{folder}/{name}", **how)

    return answer(asked, computed).dataset()


def answer(asked: Question, computed: Computed) -> Scatter:
    """Return the answer to a question, its studies computed by `computed`."""
    columns = computed(asked.samples, "samples").read()
    machines, hold, places = asked.population, asked.hold, range(1, len(asked.feeds) + 1)
    parts: dict[str, Indices | None] = {}
    if asked.rows:
        mixed = computed(Mixed(machines, asked.feeds, asked.rows), "indices").read()
        parts = {
            name: indices(mixed[name].astype(np.float64), asked.rows, machines.seed)
            for name in ("critical_feed", *(f"jump {n}" for n in places))
        }
    return Scatter(
        question=asked,
        columns=columns,
        outcomes=tuple(
            outcome(feed, columns[f"regime {n}"], columns[f"jump {n}"].astype(np.float64))
            for n, feed in zip(places, asked.feeds, strict=True)
        ),
        clamped=int(columns["clamped"].sum()),
        indices={name: found for name, found in parts.items() if found is not None},
        solved=None if hold is None else solved(machines, hold, asked.count, computed),
    )


def question(
    axis: AxisFile,
    *,
    vary: Mapping[str, str] | None = None,
    spread_is: SpreadIs = "uniform",
    correlation: Mapping[tuple[str, str], float] | None = None,
    feeds: Sequence[float | str] = (),
    samples: int | None = None,
    indices: int | None = None,
    seed: int = 0,
    hold: str | tuple[float, float] | None = None,
    solve: str | None = None,
    within: str | tuple[float, float] | None = None,
) -> Question:
    """Return what is asked; arguments and errors as of `scatter`."""
    base = axis.axis()
    axis.refuse_turning("a scatter")
    varied = varying(axis, dict(vary or {}), spread_is)
    population = Population(axis, varied, dict(correlation or {}), seed)
    closed = has_closed_form(base)
    found = tuple(sorted({_feed(each) for each in feeds} or set(base.demand.feeds)))
    if not found:
        raise ValueError(
            f"{axis.name}: no feed is named: state demand.feeds there, or give feeds to judge at"
        )
    count = samples if samples is not None else SAMPLES_CLOSED if closed else SAMPLES
    if count < 1:
        raise ValueError(f"{count} samples: at least 1 is needed")
    rows = indices if indices is not None else _ROWS_CLOSED if closed else 0
    if rows < 0 or rows & (rows - 1):
        raise ValueError(f"{rows} rows for Sobol indices: a power of two is needed, or 0 for none")
    if not 0 <= seed < _SEEDS:
        raise ValueError(f"the seed {seed} is out of range; it must be 0 to 2^128 - 1")
    if (hold is None) != (solve is None):
        raise ValueError("what must hold and the number to solve for are given together")
    wanted = None
    if hold is not None and solve is not None:
        share, feed = _held(hold) if isinstance(hold, str) else hold
        if not 0.0 < share < 1.0:
            raise ValueError(f"a share of {share:g} is out of range; it must be above 0, below 1")
        if isinstance(within, str):
            within = range_of(axis, solve, within)
        wanted = hold_of(axis, solve, varied.get(solve), share, _feed(feed), within)
    elif within is not None:
        raise ValueError("a range to look within goes with a number to solve for")
    return Question(population, found, count, rows, wanted)


def _feed(written: float | str) -> float:
    """Return a feed [m/s]; raises ValueError if it is not above 0."""
    kind = UNITS.kinds["m/s"]
    try:
        value = UNITS.read(written, (kind,), None)[0] if isinstance(written, str) else written
    except QuantityError as error:
        raise ValueError(f"feed {written} {error}; expected {kind.expected('above 0')}") from None
    if value not in KEYS["demand.feeds"].within:
        raise ValueError(f"feed {written} is out of range; it must be above 0")
    return float(value)


def _held(text: str) -> tuple[float, str]:
    """Return share and feed of ``99 % at 2 mm/min``."""
    match = re.fullmatch(r"\s*(.+?)\s+at\s+(.+?)\s*", text)
    if match is None:
        raise ValueError(f'"{text}" does not say what must hold; write such as "99 % at 2 mm/min"')
    kind = UNITS.kinds["1"]
    try:
        return UNITS.read(match[1], (kind,), kind)[0], match[2]
    except QuantityError as error:
        raise ValueError(f'"{text}": {match[1]} {error}; expected a share, such as 99 %') from None
