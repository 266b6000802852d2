"""Which friction law explains friction over the speed best: linear parts by linear algebra."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np

from .model import Floats
from .noise import Estimate, least_squares

_SPEEDS: Final = 60
"""Stribeck speeds that are tried, evenly in their logarithm."""
_PROFILE: Final = 3.84
"""Of the sum of squares: the profile of a number ends 95 % of its interval."""
_CLEARLY: Final = 6.0
"""By how much Akaike's criterion of a law with more numbers must be better."""


class Law(NamedTuple):
    """A friction law, with its numbers: F_k, offset, c or c forward and c backward, fall."""

    words: str
    estimate: Estimate
    criterion: float
    """Akaike's, for few samples."""
    v_s: float = math.nan
    """Speed over which the fall is to 1/e [m/s]; NaN where the law has none."""
    others: tuple[Estimate, ...] = ()
    """Numbers at other speeds of the fall that explain the friction about as well."""


def law_of(speed: Floats, force: Floats, deviation: Floats) -> Law:
    """Return the law that explains friction [N] at signed speeds [m/s] best.

    `deviation` are the standard deviations of the forces. By Akaike's criterion for few samples: a
    law of more numbers must be clearly better. Friction that scatters by more than the deviations
    about a law widens its intervals.
    """
    sign, size = np.sign(speed), np.abs(speed)
    both = bool(np.any(speed > 0.0) and np.any(speed < 0.0))
    parts = {"F_k": sign} | ({"offset": np.ones_like(speed)} if both else {})
    ways = {"c forward": np.maximum(speed, 0.0), "c backward": np.minimum(speed, 0.0)}
    slopes = {"": {"c": speed}} | ({", its slope another in each direction": ways} if both else {})
    laws = [_fitted("Coulomb friction", parts, force, deviation)]
    for words, slope in slopes.items():
        name = f"Coulomb and viscous friction{words}"
        laws.append(_fitted(name, parts | slope, force, deviation))
    for words, slope in slopes.items():
        tried = [
            _fitted(
                words,
                parts | slope | {"fall": sign * np.exp(-((size / v_s) ** delta))},
                force,
                deviation,
                v_s=float(v_s),
            )
            for v_s in np.geomspace(size.min(), size.max(), _SPEEDS)
            for delta in (1.0, 2.0)
        ]
        best = min(tried, key=lambda law: law.criterion)
        fall = best.estimate.number("fall")
        # A fall below the slowest feed is not seen.
        if abs(fall) > best.estimate.reach("fall") and best.v_s > size.min():
            way = "falls" if fall > 0.0 else "rises steeply"
            name = f"friction that {way} at low speed, and viscous{words}"
            near = [law.estimate for law in tried if law.criterion < best.criterion + _PROFILE]
            laws.append(best._replace(words=name, others=tuple(near)))
    chosen = laws[0]
    for law in laws[1:]:
        chosen = law if law.criterion < chosen.criterion - _CLEARLY else chosen
    return chosen


def _fitted(
    words: str,
    parts: Mapping[str, Floats],
    force: Floats,
    deviation: Floats,
    v_s: float = math.nan,
) -> Law:
    weighed = {name: column / deviation for name, column in parts.items()}
    found = least_squares(weighed, force / deviation, np.arange(force.size, dtype=float))
    chi, left = float(found.residual @ found.residual), force.size - len(parts)
    count = len(parts) + (not math.isnan(v_s))
    few = 2.0 * count * (count + 1) / max(left - 1, 1)
    if 0.0 < chi < left:
        # Less scatter than the deviations is luck.
        found = found._replace(covariance=found.covariance * left / chi, freedom=math.inf)
    found = found._replace(fitted=found.fitted * deviation, residual=found.residual * deviation)
    return Law(words, found, chi + 2.0 * count + few, v_s)
