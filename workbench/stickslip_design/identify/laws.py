"""Which friction law explains friction over the speed best: linear parts by linear algebra."""

from __future__ import annotations

import math
from itertools import product
from typing import Final

import numpy as np

from .evened import Columns
from .model import Floats
from .noise import Estimate, least_squares

_SPEEDS: Final = 60
"""Stribeck speeds that are tried, evenly in their logarithm; then the nearest one is corrected."""
_CLEARLY: Final = 6.0
"""By how much Akaike's criterion of a law with more numbers must be better."""


def friction(speed: Floats) -> Columns:
    """Return what friction [N] depends on at signed speeds [m/s], shape (n,).

    Coulomb friction "F_k"; slope "c"; of motion in both directions "uneven", by how much the slope
    is higher forward and lower backward, and "offset".
    """
    columns = {"F_k": np.sign(speed), "c": speed}
    if speed.min() < 0.0 < speed.max():
        columns |= {"offset": np.ones_like(speed), "uneven": np.abs(speed)}
    return columns


def law_of(speed: Floats, force: Floats, deviation: Floats) -> tuple[str, Estimate]:
    """Return the law that explains friction [N] at signed speeds [m/s] best, in words; its numbers.

    Those of `friction`, and "fall". `deviation` are the standard deviations of the forces. By
    Akaike's criterion for few samples: a law of more numbers must be clearly better. Friction that
    scatters by more than the deviations about a law widens its intervals.
    """

    def fitted(columns: Columns) -> tuple[float, Estimate]:
        weighed = {name: column / deviation for name, column in columns.items()}
        found = least_squares(weighed, force / deviation, np.arange(force.size, dtype=float))
        chi, count = float(found.residual @ found.residual), len(columns)
        left = force.size - count
        if 0.0 < chi < left:
            # Less scatter than the deviations is luck.
            found = found._replace(covariance=found.covariance * left / chi, freedom=math.inf)
        few = count * (count + 1) / (left - 1) if left > 1 else math.inf
        return chi + 2.0 * (count + few), found._replace(fitted=found.fitted * deviation)

    viscous, size, tried = friction(speed), np.abs(speed), []
    dry = {name: column for name, column in viscous.items() if name in ("F_k", "offset")}
    laws = {"Coulomb friction": fitted(dry), "Coulomb and viscous friction": fitted(viscous)}
    for v_s, power in product(np.geomspace(size.min(), size.max(), _SPEEDS)[1:], (1.0, 2.0)):
        part = (size / v_s) ** power
        columns = viscous | {"fall": np.sign(speed) * np.exp(-part)}
        # What a Stribeck speed moves that is a little higher.
        tried.append((fitted(columns)[0], columns | {"v_s": part * columns["fall"]}))
    falling = fitted(min(tried, key=lambda one: one[0])[1])
    fall, _, reach = falling[1].number("fall")
    if abs(fall) > reach:
        way = "falls" if fall > 0.0 else "rises steeply"
        laws[f"friction that {way} at low speed, and viscous"] = falling
    best = min(laws, key=lambda words: laws[words][0] + _CLEARLY * list(laws).index(words))
    return best, laws[best][1]
