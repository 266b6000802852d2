"""What is between motor and table: its way in a turn of the motor, its stiffness over the travel.

Numbers are those of `[drive]` by the names of their keys, SI.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from .model import AxisError


def way(kind: str, numbers: Mapping[str, float]) -> float | None:
    """Return the way of the table in a turn of the motor [m, of a rotary table rad].

    None where that is stated as the pitch, or not at all.
    """
    if kind == "rotary":
        return 2.0 * math.pi / numbers["gear"]
    if kind != "belt" or "pitch" in numbers:
        return None
    if "teeth" in numbers:
        return numbers["teeth"] * numbers["tooth_pitch"] / numbers["gear"]
    return math.pi * numbers["pulley_diameter"] / numbers["gear"]


def stiffnesses(numbers: Mapping[str, float], lengths: Sequence[float], key: str) -> list[float]:
    """Return the stiffness of a screw or a belt at places of the travel [N/m].

    At each of one or two lengths a of the part that pulls, and of two where it is softest between
    them: S/a, or S (1/a + 1/b) where a second part of length b pulls as well; S = A E of a screw
    (THK and others, lecture ME EN 7960, University of Utah), S the specific stiffness of a belt
    (Siegling, Calculation methods: timing belts). What is in series is added as compliance.
    AxisError, which names `key`, where nothing is left of the second part.
    """
    belt = "specific_stiffness" in numbers
    name = "belt_length" if belt else "bearing_distance"
    if belt:
        S = numbers["specific_stiffness"]
    else:
        S = 0.25 * math.pi * numbers["core_diameter"] ** 2 * numbers["modulus"]
    places, whole = list(lengths), numbers.get(name)
    if whole is not None:
        if not max(lengths) < whole:
            raise AxisError(
                "leaves nothing of the other side", key=key, within=f"below {name}",
                remedy=f"correct {key.partition('.')[2]} or {name}",
            )  # fmt: skip
        if len(lengths) > 1:
            places.append(sorted((0.5 * whole, *lengths))[1])
    compliance = 1.0 / numbers["in_series"] if "in_series" in numbers else 0.0
    found = [S / a if whole is None else S * (1.0 / a + 1.0 / (whole - a)) for a in places]
    return [k / (1.0 + k * compliance) for k in found]
