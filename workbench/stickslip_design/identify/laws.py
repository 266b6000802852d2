"""Which friction law explains friction over the speed best: linear parts by linear algebra."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from .model import Floats
from .noise import Estimate, least_squares

_SPEEDS: Final = 60
"""Stribeck speeds that are tried, evenly in their logarithm."""
_CLEARLY: Final = 4.0
"""By how much more Akaike's criterion a law with more numbers must be better."""


class Law(NamedTuple):
    """A friction law, its numbers by name and their estimate."""

    words: str
    names: tuple[str, ...]
    estimate: Estimate
    columns: Floats
    """Shape (n, p)."""
    criterion: float
    """Akaike's, for few samples."""
    v_s: float = math.nan
    """Stribeck speed [m/s]; NaN where the law has none."""

    @property
    def fitted(self) -> Floats:
        """Friction [N], shape (n,)."""
        return np.asarray(self.columns @ self.estimate.value)

    def number(self, name: str) -> tuple[float, float]:
        """Return a number by its name, and half its interval; ValueError if the law has none."""
        at = self.names.index(name)
        unit = np.eye(len(self.names))[at]
        return float(self.estimate.value[at]), self.estimate.reach(unit)


def law_of(speed: Floats, force: Floats, deviation: Floats) -> Law:
    """Return the law that explains friction [N] at signed speeds [m/s] best.

    `deviation` are the standard deviations of the forces. By Akaike's criterion for few samples: a
    law of more numbers must be better by `_CLEARLY`. Friction that scatters by more than that about
    the law widens the intervals.
    """
    sign, size = np.sign(speed), np.abs(speed)
    both = bool(np.any(speed > 0.0) and np.any(speed < 0.0))
    parts = {"F_k": sign} | ({"offset": np.ones_like(speed)} if both else {})
    ways = {"c forward": np.maximum(speed, 0.0), "c backward": np.minimum(speed, 0.0)}
    slopes = {"": {"c": speed}} | ({", its slope another in each direction": ways} if both else {})
    laws = [_fitted("Coulomb friction", parts, force, deviation)]
    for words, slope in slopes.items():
        own = parts | slope
        laws.append(_fitted(f"Coulomb and viscous friction{words}", own, force, deviation))
    for words, slope in slopes.items():
        own = parts | slope
        tried = [
            _fitted(words, own | {"fall": sign * np.exp(-size / v_s)}, force, deviation, v_s)
            for v_s in np.geomspace(0.5 * size.min(), size.max(), _SPEEDS)
        ]
        best = min(tried, key=lambda law: law.criterion)
        fall, reach = best.number("fall")
        # A fall below the slowest feed is not seen.
        if abs(fall) > reach and best.v_s > size.min():
            way = "falls" if fall > 0.0 else "rises steeply"
            name = f"friction that {way} at low speed, and viscous{words}"
            laws.append(best._replace(words=name))
    chosen = laws[0]
    for law in laws[1:]:
        if law.criterion < chosen.criterion - _CLEARLY * (chosen.criterion > -math.inf):
            chosen = law
    return chosen


def _fitted(
    words: str, parts: dict[str, Floats], force: Floats, deviation: Floats, v_s: float = math.nan
) -> Law:
    columns = np.stack(list(parts.values()), axis=1)
    found = least_squares(columns / deviation[:, None], force / deviation, np.zeros(force.size))
    n, p = columns.shape
    # The deviations are known; a scatter above them widens, one below them is luck.
    chi = float(found.residual @ found.residual)
    scale = chi / max(n - p, 1)
    covariance = found.covariance * (1.0 / scale if 0.0 < scale < 1.0 else 1.0)
    count = p + (not math.isnan(v_s))
    few = 2.0 * count * (count + 1) / (n - count - 1) if n > count + 1 else math.inf
    freedom = found.freedom if scale > 1.0 else 1e6
    estimate = found._replace(covariance=covariance, freedom=freedom)
    return Law(words, tuple(parts), estimate, columns, chi + 2.0 * count + few, v_s)
