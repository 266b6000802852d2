"""Which friction law explains friction over the speed best: linear parts by linear algebra."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product
from typing import Final, NamedTuple

import numpy as np

from .model import Floats
from .noise import Estimate, least_squares

_SPEEDS: Final = 60
"""Stribeck speeds that are tried, evenly in their logarithm; then the nearest one is corrected."""
_CLEARLY: Final = 6.0
"""By how much Akaike's criterion of a law with more numbers must be better."""


class Law(NamedTuple):
    """A friction law."""

    words: str
    estimate: Estimate
    """Of F_k, offset, c or c forward and c backward, fall."""
    criterion: float
    """Akaike's, for few samples."""


def law_of(speed: Floats, force: Floats, deviation: Floats) -> Law:
    """Return the law that explains friction [N] at signed speeds [m/s] best.

    `deviation` are the standard deviations of the forces. By Akaike's criterion for few samples: a
    law of more numbers must be clearly better. Friction that scatters by more than the deviations
    about a law widens its intervals.
    """

    def fitted(words: str, columns: Mapping[str, Floats]) -> Law:
        weighed = {name: column / deviation for name, column in columns.items()}
        found = least_squares(weighed, force / deviation, np.arange(force.size, dtype=float))
        chi, count = float(found.residual @ found.residual), len(columns)
        left = force.size - count
        if 0.0 < chi < left:
            # Less scatter than the deviations is luck.
            found = found._replace(covariance=found.covariance * left / chi, freedom=math.inf)
        found = found._replace(fitted=found.fitted * deviation, residual=found.residual * deviation)
        few = count * (count + 1) / max(left - 1, 1)
        return Law(words, found, chi + 2.0 * (count + few))

    sign, size = np.sign(speed), np.abs(speed)
    parts, slopes = {"F_k": sign}, {"": {"c": speed}}
    if np.any(speed > 0.0) and np.any(speed < 0.0):
        parts["offset"] = np.ones_like(speed)
        ways = {"c forward": np.maximum(speed, 0.0), "c backward": np.minimum(speed, 0.0)}
        slopes[", its slope another in each direction"] = ways
    laws = [fitted("Coulomb friction", parts)]
    for words, slope in slopes.items():
        laws.append(fitted(f"Coulomb and viscous friction{words}", parts | slope))
    for words, slope in slopes.items():
        tried = []
        for v_s, power in product(np.geomspace(size.min(), size.max(), _SPEEDS)[1:], (1.0, 2.0)):
            part = (size / v_s) ** power
            columns = parts | slope | {"fall": sign * np.exp(-part)}
            # What a Stribeck speed moves that is a little higher.
            tried.append((fitted(words, columns), columns | {"v_s": part * columns["fall"]}))
        estimate = (best := fitted(words, min(tried, key=lambda one: one[0].criterion)[1])).estimate
        fall = estimate.number("fall")
        if abs(fall) > estimate.reach("fall"):
            way = "falls" if fall > 0.0 else "rises steeply"
            name = f"friction that {way} at low speed, and viscous{words}"
            laws.append(best._replace(words=name))
    chosen = laws[0]
    for law in laws[1:]:
        chosen = law if law.criterion < chosen.criterion - _CLEARLY else chosen
    return chosen
