"""Scaling and mirror, docs/theory.md (18): factors on what is set, and what they make of outputs.

Every factor is a power of two or a sign, so it changes no digit of a double.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from stickslip_verification.model.quantities import OUTPUTS, Quantity
from stickslip_verification.model.units import spelled
from stickslip_verification.truth.parameters import PARAMETERS, Parameter


@dataclass(frozen=True)
class Symmetry:
    """A change of everything that is set, under which the motion is the same but for factors.

    ``mass`` and ``pace`` are the factors on the units of mass and time; ``pace`` is also that on
    the lengths of steps. ``mirrored``: what is directed changes its sign.
    """

    name: str
    mass: float = 1.0
    pace: float = 1.0
    mirrored: bool = False

    def factor(self, of: Parameter | Quantity) -> float:
        """Return the factor on a parameter, an input or an output."""
        unit = spelled(of.unit)
        assert unit is not None
        sign = -1.0 if self.mirrored and of.directed else 1.0
        return sign * float(self.mass ** unit.dimension[0] * self.pace ** unit.dimension[2])

    @cached_property
    def outputs(self) -> Mapping[str, float]:
        """The factors on outputs by name."""
        return {each.name: self.factor(each) for each in OUTPUTS}

    def scaled(
        self, setting: Mapping[str, float], own: Sequence[Parameter] = ()
    ) -> dict[str, float]:
        """Return `setting` with its factors; `own` are the friction law's parameters in it."""
        factors = {each.name: self.factor(each) for each in (*PARAMETERS, *own)}
        return {name: value * factors[name] for name, value in setting.items()}


MIRROR = Symmetry("mirror", mirrored=True)
HEAVIER = Symmetry("m, k, c, load, F_ext times 4", mass=4.0)
QUICKER = Symmetry("k, g, load, F_ext times 4, v, c, x_dot_start times 2, time halved", pace=0.5)
