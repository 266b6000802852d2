"""Lines with fewer points and the same look, in points on the page."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.model.run import Series

SHAPE = 0.03
"""Distance [pt] by which a thinned line may leave the full one: a 30th of a thin line's width.

With a tenth, smooth curves show corners."""

Chosen = NDArray[np.intp]
"""Indices of points, rising."""


def thinned(x: Series, y: Series) -> Chosen:
    """Choose the points of a line that tell its shape to `SHAPE`.

    Ramer, Comput. Graph. Image Process. 1 (1972) 244, and Douglas and Peucker, Cartographica 10
    (1973) 112: corners stay, and what is straight becomes two points. A gap (NaN) splits the line.

    Parameters
    ----------
    x, y
        The line [pt], shape ``(n,)`` each.
    """
    finite = np.isfinite(x) & np.isfinite(y)
    keep = np.zeros(len(x), dtype=bool)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], finite.astype(int), [0]))))
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        _mark(x, y, keep, int(begin), int(end) - 1)
        if end < len(x):
            keep[end] = True
    return np.flatnonzero(keep)


def _mark(x: Series, y: Series, keep: NDArray[np.bool_], first: int, last: int) -> None:
    keep[[first, last]] = True
    waiting = [(first, last)]
    while waiting:
        a, b = waiting.pop()
        if b - a < 2:
            continue
        dx, dy = x[b] - x[a], y[b] - y[a]
        length = float(np.hypot(dx, dy))
        inner_x, inner_y = x[a + 1 : b] - x[a], y[a + 1 : b] - y[a]
        if length > 0.0:
            away = np.abs(inner_x * dy - inner_y * dx) / length
        else:
            away = np.hypot(inner_x, inner_y)
        furthest = int(np.argmax(away))
        if away[furthest] > SHAPE:
            middle = a + 1 + furthest
            keep[middle] = True
            waiting += [(a, middle), (middle, b)]
