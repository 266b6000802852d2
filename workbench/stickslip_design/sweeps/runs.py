"""The runs of a sweep: what they have in common, and what each of them sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .model import Component, Variable, Wire
from .reductions import column_of


@dataclass(frozen=True)
class Runs:
    """The runs of a sweep.

    Attributes
    ----------
    content, is_system
        The bytes of the model's file, and whether it is an SSP file.
    components, variables, wires
        The FMUs; the variables that are set, read or connected, by name; the connections.
    fixed
        Values that all runs have, by name, in the FMU's units.
    swept, values, on_grid
        Names of the variables that each run sets, and their values: columns of points, or axes of a
        grid, whose points are all combinations of them, the last one running fastest.
    tables
        Inputs from files, by name: a value for each communication step, set before it.
    times, steps, settled
        Communication points [s], shape (steps + 1,), and communication steps [s], shape (steps,);
        index of the first communication point that reductions see.
    outputs, reduces
        Names of reductions by variable, and whether one needs the samples on the way.
    time_limit
        Seconds that a run may take.
    reset
        Whether an instance does run after run, reset between.
    identity
        All that the results depend on.
    """

    content: bytes = field(repr=False)
    is_system: bool
    components: tuple[Component, ...]
    variables: Mapping[str, Variable]
    wires: tuple[Wire, ...]
    fixed: Mapping[str, float]
    swept: tuple[str, ...]
    values: tuple[NDArray[np.float64], ...]
    on_grid: bool
    tables: Mapping[str, NDArray[np.float64]]
    times: NDArray[np.float64]
    steps: NDArray[np.float64]
    settled: int
    outputs: Mapping[str, tuple[str, ...]]
    reduces: bool
    time_limit: float
    reset: bool
    identity: Mapping[str, Any]

    @property
    def results(self) -> list[tuple[str, str]]:
        """Variable and reduction of each result of a run, in order."""
        return [(name, one) for name, reductions in self.outputs.items() for one in reductions]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the results."""
        return tuple(column_of(*result) for result in self.results)

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of values along the axes of a grid; of points how many there are."""
        return tuple(axis.size for axis in (self.values if self.on_grid else self.values[:1]))

    @property
    def count(self) -> int:
        """How many runs there are."""
        return int(np.prod(self.shape, dtype=np.int64))

    def rows(self, start: int, stop: int) -> NDArray[np.float64]:
        """Return the values of runs, shape (stop - start, swept variables)."""
        rows, runs = np.empty((stop - start, len(self.values))), np.arange(start, stop)
        # A plan may sweep nothing.
        places = np.unravel_index(runs, self.shape) if self.values else ()
        for column, values in enumerate(self.values):
            rows[:, column] = values[places[column if self.on_grid else 0]]
        return rows
