"""What a process needs to do the runs of a sweep: resolved, and small enough to be sent."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.drive.fmu import names
from stickslip_verification.drive.fmu.instance import FLOATING as FLOATING


@dataclass(frozen=True)
class Variable(names.Variable):
    """A variable of the model, `name`, with the numbers that the FMU of a component has.

    Texts are empty where it declares nothing. An `obstacle` says why it is no number that can be
    set and read; one that `starts` can be set before a run.
    """

    unit: str
    component: int
    description: str
    obstacle: str
    starts: bool
    start_text: str

    @property
    def changes(self) -> bool:
        """Whether it can be set in a run: an input, or a tunable parameter."""
        return self.causality == "input" or (
            self.causality == "parameter" and self.variability == "tunable"
        )

    @property
    def is_continuous(self) -> bool:
        """Whether a file of inputs is read along straight lines; else each value holds."""
        return self.kind in FLOATING and self.variability == "continuous"


@dataclass(frozen=True)
class Component:
    """An FMU of the model, in an SSP file at `source`, and what it is instantiated with."""

    name: str
    source: str
    fmi_version: str
    token: str
    identifier: str


@dataclass(frozen=True)
class Wire:
    """A connection: the input gets ``factor * output + offset``, both by their names."""

    output: str
    input: str
    factor: float
    offset: float


@dataclass(frozen=True)
class Job:
    """All that runs have in common.

    Attributes
    ----------
    components, variables, wires
        The FMUs; the variables that are set, read or connected, by name; the connections.
    fixed
        Values that all runs have, by name, in the FMU's units.
    swept
        Names of the variables that each run sets, in the order of its values.
    tables
        Inputs from files, by name: a value for each communication step, set before it.
    times, steps
        Communication points [s], shape (steps + 1,), and communication steps [s], shape (steps,).
    settled
        Index of the first communication point that reductions see.
    outputs
        Names of reductions by variable.
    reset
        Whether an instance does run after run, reset between.
    """

    components: tuple[Component, ...]
    variables: Mapping[str, Variable]
    wires: tuple[Wire, ...]
    fixed: Mapping[str, float]
    swept: tuple[str, ...]
    tables: Mapping[str, NDArray[np.float64]]
    times: NDArray[np.float64]
    steps: NDArray[np.float64]
    settled: int
    outputs: Mapping[str, tuple[str, ...]]
    reset: bool = True

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the results: the variable for its last value, else variable.reduction."""
        return tuple(column_of(name, each) for name in self.outputs for each in self.outputs[name])


def column_of(name: str, reduction: str) -> str:
    """Return the name of a result."""
    return name if reduction == "last" else f"{name}.{reduction}"
