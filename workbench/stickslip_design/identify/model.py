"""What a record is, and what it tells of an axis."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

Kind = Literal["steady runs", "stick-slip", "excitation"]


@dataclass(frozen=True, kw_only=True)
class Record:
    """Samples of an axis or of a pull test, shape (n,); at the slide, SI."""

    t: Floats
    """Time [s], rising."""
    position: Floats | None = None
    """Measured position of the table; of a drive where it is measured, as the axis says [m]."""
    velocity: Floats | None = None
    """Measured speed [m/s]; None: from the position."""
    command: Floats | None = None
    """Commanded position, that of the pulled end on a rigid drive [m]."""
    force: Floats | None = None
    """Force on the table: of the motor at the slide, of the spring on a rigid drive [N]."""
    rounding: Mapping[str, float] = field(default_factory=dict)
    """Half a unit in the last digit of a column, by its name here."""
    force_spread: float = 0.0
    """The ± of the scale of the force, relative: of the torque constant."""
    notes: tuple[str, ...] = ()
    """What was found in reading: gaps, jitter, what was converted by what."""


@dataclass(frozen=True, kw_only=True)
class Number:
    """A number that a record tells, with its interval of 95 %."""

    name: str
    """Its key in an axis file, as "axis.mass"; else its symbol, as "k/m"."""
    meaning: str
    """What it is, in words."""
    unit: str
    """Its SI unit."""
    value: float
    """The best value."""
    low: float
    high: float
    """Ends of the interval."""
    why: str = ""
    """What its width comes from, or why it cannot be told."""

    @property
    def width(self) -> float:
        """Half the interval over the value, relative."""
        return 0.5 * (self.high - self.low) / abs(self.value) if self.value else math.inf

    @property
    def identified(self) -> bool:
        """Whether the interval is at most half as wide as the value: it is a number, no range."""
        return self.width <= 0.25


@dataclass(frozen=True, kw_only=True)
class Trace:
    """Measured values and the fit over them, shape (n,), at most some thousands, SI."""

    name: str
    """"force" or "position"; of friction the law that explains it best, in words."""
    unit: str
    """"N" or "m"."""
    at: Floats
    """Time [s], of friction signed speed [m/s]; rising."""
    measured: Floats
    fitted: Floats
    """What was measured; what the fit says, NaN where it says nothing."""
    band: Floats = field(default_factory=lambda: np.zeros(0))
    """Half the interval of 95 % of what was measured; empty: not told."""


@dataclass(frozen=True, kw_only=True)
class Identified:
    """What a record tells, each number with its interval, and what it cannot tell."""

    kind: Kind
    reason: str
    """Why it is taken for that."""
    numbers: tuple[Number, ...]
    missing: tuple[tuple[str, str], ...]
    """What the record cannot tell, and why."""
    traces: tuple[Trace, ...]
    """Columns of the record over time."""
    noise: float
    """Root mean square of what the fit leaves of the last of them, in its unit."""
    segments: tuple[tuple[float, float, str], ...]
    """Parts of the record: begin and end [s], and what they are."""
    faults: tuple[str, ...] = ()
    """What the record shows that the model has not; empty: the model explains it."""
    friction: Trace | None = None
    """Friction over the speed, with its sign, the weight in it."""
    notes: tuple[str, ...] = ()
    """What else was found, a sentence each: directions that differ, a zero that drifts."""
    next_measurement: str = ""
    """What to measure next, in a sentence."""

    @property
    def explained(self) -> bool:
        """Whether the model explains the record."""
        return not self.faults

    def number(self, name: str) -> Number:
        """Return a number by its name; KeyError if it is not told."""
        return {each.name: each for each in self.numbers}[name]
