"""How likely an axis jumps where its numbers vary: a question, and its answer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..axis import AxisFile, read_axis_file
from ..chunks import Progress, Results, Study, run
from ..datasets import need
from .distributions import SpreadIs
from .indices import Indices, Mixed, indices
from .nominal import solved
from .question import Question, question
from .result import Scatter, outcome

if TYPE_CHECKING:
    import xarray

Computed = Callable[[Study, str], Results]
"""Computes a study; the text says what for, and names its folder."""


def scatter(
    axis: AxisFile | Path | str,
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
    workers: int | None = None,
    cluster: str | None = None,
    fresh: bool = False,
    progress: Callable[[Progress], None] | None = None,
) -> xarray.Dataset:
    """Return how likely an axis jumps where its numbers vary, and by how much.

    Parameters
    ----------
    axis
        The axis file; its ± count as scatter.
    vary
        Distributions by the name of a number, as `distributions` has them: ``{"friction.mu_s":
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
    folder, workers, cluster, fresh, progress
        As of `chunks.run`.

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
    file = axis if isinstance(axis, AxisFile) else read_axis_file(axis)
    need("xarray")
    asked = question(
        file, vary=vary, spread_is=spread_is, correlation=correlation, feeds=feeds,
        samples=samples, indices=indices, seed=seed, hold=hold, solve=solve, within=within,
    )  # fmt: skip

    def computed(study: Study, name: str) -> Results:
        place = None if folder is None else f"{folder}/{name}"
        return run(study, place, workers=workers, cluster=cluster, fresh=fresh, progress=progress)

    return answer(asked, computed).dataset()


def answer(asked: Question, computed: Computed) -> Scatter:
    """Return the answer to a question, its studies computed by `computed`."""
    columns = computed(asked.samples, "samples").read()
    found: dict[str, Indices] = {}
    if asked.rows:
        mixed = computed(Mixed(asked.population, asked.feeds, asked.rows), "indices").read()
        for name in ("critical_feed", *(f"jump {n + 1}" for n in range(len(asked.feeds)))):
            values = mixed[name].astype(np.float64)
            one = indices(values, asked.rows, asked.population.seed)
            if one is not None:
                found[name] = one
    hold = asked.hold
    held = None if hold is None else solved(asked.population, hold, asked.count, computed)
    outcomes = tuple(
        outcome(feed, columns[f"regime {n}"], columns[f"jump {n}"].astype(np.float64))
        for n, feed in enumerate(asked.feeds, 1)
    )
    return Scatter(asked, columns, outcomes, int(columns["clamped"].sum()), found, held)
