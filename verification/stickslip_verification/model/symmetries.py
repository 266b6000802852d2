"""Scaling and mirror, docs/theory.md (18): factors on what is set, and what they make of outputs.

Every factor is a power of two or a sign, so it changes no digit of a double.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

LENGTHS = ("x", "x_pull", "z", "delta_x", "spring_drop")
SPEEDS = ("x_dot", "x_dot_peak")
FORCES = ("F", "F_friction", "F_s")
TIMES = ("t_stick", "t_slip", "T", "t_event")
ENERGIES = ("W_pull", "W_k", "Q_friction")
DIRECTED = ("x", "x_dot", "x_pull", "z", "F", "F_friction", "mode", "delta_x", "spring_drop")
DIRECTED_VALUES = ("v", "F_ext", "x_start", "x_dot_start", "z_start")


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
        """Give `setting` with its factors."""
        return {name: value * self.values.get(name, 1.0) for name, value in setting.items()}


def _factors(*groups: tuple[Iterable[str], float]) -> dict[str, float]:
    return {name: factor for names, factor in groups for name in names}


MIRROR = Symmetry(
    "mirror", _factors((DIRECTED_VALUES, -1.0)), 1.0, _factors(((*DIRECTED, "x_dot_peak"), -1.0))
)
HEAVIER = Symmetry(
    "m, k, c, load, F_ext times 4",
    _factors((("m", "k", "c", "load", "F_ext"), 4.0)),
    1.0,
    _factors(((*FORCES, *ENERGIES), 4.0)),
)
QUICKER = Symmetry(
    "k, g, load, F_ext times 4, v, c, x_dot_start times 2, time halved",
    _factors((("k", "g", "load", "F_ext"), 4.0), (("v", "c", "x_dot_start"), 2.0)),
    0.5,
    _factors(((*FORCES, *ENERGIES), 4.0), ((*SPEEDS, "f"), 2.0), (TIMES, 0.5)),
)
