"""What every importer runs: cases of the block, as data."""

from collections.abc import Mapping
from dataclasses import dataclass, field

STEP = 0.01
"""The communication step [s]."""


@dataclass(frozen=True)
class Case:
    """A run of so many communication steps; inputs are set at the start and before step NUMBER."""

    name: str
    start: Mapping[str, float]
    steps: int
    changes: Mapping[int, Mapping[str, float]] = field(default_factory=dict)


_DAMPED = {"c": 2.0, "mu_k": 0.25, "v": 0.03}
_PULLED_ABOUT: Mapping[int, Mapping[str, float]] = {
    # In stick, before the second break-away: from here on F_s is higher.
    50: {"load": 6.0},
    90: {"v": -0.03},
    150: {"F_ext": 3.0},
    170: {"F_ext": 0.0},
    # F_s falls below the spring force: the mass breaks away at this communication point.
    200: {"load": -4.0, "v": 0.05},
    # A pulse against the pull turns a slip round.
    260: {"F_ext": -9.0},
    263: {"F_ext": 0.0},
    300: {"v": 0.0},
    330: {"v": -0.015, "load": 0.0},
}

CASES: Mapping[str, Case] = {
    "default": Case("default", {}, 1000),
    "inputs": Case("inputs", _DAMPED, 400, _PULLED_ABOUT),
    # Ends in a slip, with every input away from its start: what a restart must undo.
    "restart": Case("restart", _DAMPED, 270, _PULLED_ABOUT),
}
"""Cases by name. `restart` begins as `inputs`, and is run twice in one process."""
