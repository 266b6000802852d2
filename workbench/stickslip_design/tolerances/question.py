"""What is asked of a series of machines, and checked before anything is computed."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from ..axis import AxisFile
from ..axis.keys import KEYS, UNITS
from ..points.axes import has_closed_form
from ..quantity import QuantityError
from .distributions import SpreadIs, range_of, varying
from .nominal import Hold, hold_of
from .samples import Population, Samples

SAMPLES_CLOSED, SAMPLES = 100_000, 1_000
"""Machines drawn by default: where closed forms answer, and where each takes up to a second."""
_ROWS_CLOSED: Final = 4096
"""Rows of the Sobol indices by default, where closed forms answer."""
_SEEDS: Final = 2**128
"""How many seeds Philox has."""


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
