"""The measured points of a curve of friction over speed, and the bands between them."""

from typing import List, Optional, Tuple

from fmi.model import ModelError

from ...settings import Settings
from .band import Band

MOST_POINTS = 12

Points = Tuple[Tuple[float, float], ...]
"""Speeds [m/s], from 0 on, with the friction coefficients there."""

Line = Tuple[float, float, float, float]
"""Speed at which a straight line of the curve begins and the one at which it ends [m/s], its slope
[s/m], and the coefficient at its beginning."""


def names_of(point: int) -> Tuple[str, ...]:
    """Return the names of the parameters of a point, numbered from 1."""
    return ("mu_1",) if point == 1 else (f"u_{point}", f"mu_{point}")


def points_of(settings: Settings) -> Points:
    """Return the points that count; raises ModelError where the speeds do not rise."""
    points = [(0.0, settings.mu_1)]
    for point in range(2, int(settings.n_points) + 1):
        speed, mu = (getattr(settings, name) for name in names_of(point))
        before = points[-1][0]
        if not speed > before:
            raise ModelError(
                f"u_{point} = {speed!r} m/s is out of range: it must be above "
                f"u_{point - 1} = {before!r} m/s"
            )
        points.append((speed, mu))
    return tuple(points)


def first_ignored(settings: Settings) -> Optional[str]:
    """Return the name of the first parameter of a point beyond the last that is set, or None."""
    rows = settings.table.by_name
    for point in range(int(settings.n_points) + 1, MOST_POINTS + 1):
        for name in names_of(point):
            if getattr(settings, name) != rows[name].start:
                return name
    return None


def lines_of(points: Points) -> Tuple[Line, ...]:
    """Return the straight lines of the curve; neighbours with one slope are one line."""
    lines: List[Line] = []
    for position in range(len(points) - 1):
        low, mu = points[position]
        high, mu_high = points[position + 1]
        slope = (mu_high - mu) / (high - low)
        if lines and lines[-1][2] == slope:
            low, _, _, mu = lines.pop()
        lines.append((low, high, slope, mu))
    last, mu = points[-1]
    if lines[-1][2] == 0.0:
        last, _, _, mu = lines.pop()
    lines.append((last, float("inf"), 0.0, mu))
    return tuple(lines)


def band_of(line: Line, mu_1: float, normal: float) -> Band:
    """Return the band of a line under a normal force [N]."""
    low, high, slope, mu = line
    rise = (mu - mu_1) - slope * low
    return Band(low, high, rise * normal, slope * normal, mu * normal)
