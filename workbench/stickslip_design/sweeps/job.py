"""What a process needs to do the runs of a sweep: resolved, and small enough to be sent."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.drive.fmu.instance import FLOATING as FLOATING


@dataclass(frozen=True)
class Variable:
    """A variable of the model.

    Attributes
    ----------
    name
        Its name in the model.
    component
        Index of its component.
    own
        Its name in the component's FMU.
    reference, kind, causality, variability, unit, description
        As the FMU declares them; texts are empty where it does not.
    obstacle
        Why it is no number that can be set and read, in words; empty where it is one.
    starts
        Whether it can be set before a run.
    start
        Its start value as the FMU spells it, empty where it gives none.
    """

    name: str
    component: int
    own: str
    reference: int
    kind: str
    causality: str
    variability: str
    unit: str
    description: str
    obstacle: str
    starts: bool
    start: str

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
    """An FMU of the model.

    Attributes
    ----------
    name
        Its name, for messages: that of the component, of an FMU alone that of the file.
    source
        Its FMU in the SSP file; empty for an FMU alone.
    fmi_version
        2.0 or 3.0.
    token, identifier
        What it is instantiated with.
    """

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
class Table:
    """An input that a file gives: a value for each communication step, set before it."""

    name: str
    values: NDArray[np.float64]


@dataclass(frozen=True)
class Job:
    """All that runs have in common.

    Attributes
    ----------
    components
        The FMUs.
    variables
        Those that are set, read or connected, by name.
    wires
        The connections.
    fixed
        Values that all runs have, by name, in the FMU's units.
    swept
        Names of the variables that each run sets, in the order of its values.
    tables
        Inputs from files.
    times
        Communication points [s], shape (steps + 1,).
    steps
        Communication steps [s], shape (steps,).
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
    tables: tuple[Table, ...]
    times: NDArray[np.float64]
    steps: NDArray[np.float64]
    settled: int
    outputs: Mapping[str, tuple[str, ...]]
    reset: bool = True

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the results: the variable for its last value, else variable.reduction."""
        return tuple(
            column_of(name, reduction)
            for name, all_of in self.outputs.items()
            for reduction in all_of
        )


def column_of(name: str, reduction: str) -> str:
    """Return the name of a result."""
    return name if reduction == "last" else f"{name}.{reduction}"
