"""Scaling and mirror, docs/theory.md (18): factors on what is set, and what they make of outputs.

Every factor is a power of two or a sign, so it changes no digit of a double.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from stickslip_verification.model.quantities import OUTPUTS, Quantity
from stickslip_verification.model.units import spelled
from stickslip_verification.truth.parameters import PARAMETERS, Parameter


def outputs_in(unit: str) -> tuple[str, ...]:
    """Return the names of the outputs in this unit that are not discrete."""
    return tuple(each.name for each in OUTPUTS if each.unit == unit and not each.discrete)


LENGTHS = outputs_in("m")
SPEEDS = outputs_in("m/s")
FORCES = outputs_in("N")
TIMES = outputs_in("s")
ENERGIES = outputs_in("J")


@dataclass(frozen=True)
class Symmetry:
    """A change of everything that is set, under which the motion is the same but for factors.

    ``values`` are the factors on parameters and inputs, ``pace`` that on the lengths of steps,
    ``outputs`` those on outputs; a name that is absent has the factor 1.
    """

    name: str
    values: Mapping[str, float]
    pace: float
    outputs: Mapping[str, float]

    def scaled(self, setting: Mapping[str, float]) -> dict[str, float]:
        """Return `setting` with its factors."""
        return {name: value * self.values.get(name, 1.0) for name, value in setting.items()}


def _scaling(name: str, mass: float = 1.0, time: float = 1.0) -> Symmetry:
    """Return the change of the units of mass and time by these factors."""

    def factor(of: Parameter | Quantity) -> float:
        unit = spelled(of.unit)
        assert unit is not None
        return float(mass ** unit.dimension[0] * time ** unit.dimension[2])

    return Symmetry(
        name,
        {each.name: factor(each) for each in PARAMETERS if factor(each) != 1.0},
        time,
        {each.name: factor(each) for each in OUTPUTS if factor(each) != 1.0},
    )


MIRROR = Symmetry(
    "mirror",
    {each.name: -1.0 for each in PARAMETERS if each.directed},
    1.0,
    {each.name: -1.0 for each in OUTPUTS if each.directed},
)
HEAVIER = _scaling("m, k, c, load, F_ext times 4", mass=4.0)
QUICKER = _scaling("k, g, load, F_ext times 4, v, c, x_dot_start times 2, time halved", time=0.5)
