"""Circles as the circular test draws them: the deviation of the radius enlarged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from stickslip_units import EXACT, number, told
from stickslip_verification.report.svg import BLUE, GREY, INK, ORANGE, STYLE

from ..loop.follower import Matrix
from .circle import ANGLES, Circle

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_RINGS, _RING = 4, 0.12
"""Rings on either side of the circle, and their distance over the radius that is drawn."""
_SIDE, _EACH = 3.4, 4
"""Side of a panel [in]; of so many points one is drawn."""


def circles(tests: Sequence[Circle], paths: Sequence[Matrix]) -> Figure:
    """Draw each circle: in a row the parts that are fed forward, or of a single part the feeds."""
    several = len({each.share for each in tests}) > 1
    pairs = zip(tests, paths, strict=True)
    grouped = groupby(pairs, lambda pair: (pair[0].radius, pair[0].feed * several))
    rows = [list(row) for _, row in grouped]
    columns = max(map(len, rows))
    # All panels have one scale: 1, 2 or 5 of a decade.
    step = max(float(np.abs(paths).max()) / _RINGS, 1e-9)
    decade = 10.0 ** math.floor(math.log10(step))
    step = next(each * decade for each in (1.0, 2.0, 5.0, 10.0) if each * decade >= step)
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(_SIDE * columns, (_SIDE + 0.3) * len(rows)), layout="constrained")
        panels = page.subplots(len(rows), columns, squeeze=False)
        for row, places in zip(rows, panels, strict=True):
            for panel, (test, both) in zip(places, row, strict=True):
                _draw(panel, test, both, step)
        names = panels[0, 0].get_legend_handles_labels()
        page.legend(*names, loc="outside lower center", ncols=2, frameon=False)
        page.suptitle(f"from ring to ring {told(step, 'm', EXACT)}", fontsize=9.0, color=INK)
    return page


def _draw(panel: Axes, test: Circle, both: Matrix, step: float) -> None:
    angles = np.append(ANGLES[::_EACH], 0.0)
    for ring in range(-_RINGS, _RINGS + 1):
        at, width = 1.0 + _RING * ring, 0.4 if ring else 0.9
        panel.plot(at * np.cos(angles), at * np.sin(angles), color=GREY, lw=width)
    looks = (BLUE, "counterclockwise"), (ORANGE, "clockwise")
    for path, (color, label) in zip(both, looks, strict=True):
        away = 1.0 + _RING / step * np.append(path[::_EACH], path[0])
        x, y = away * np.cos(angles), away * np.sin(angles)
        panel.plot(x, y, color=color, lw=1.2, label=label)
    lengths = {"G(b)": test.G_b, "H": test.H, "glitch": test.glitch.height}
    said = "\n".join(f"{name} {told(length, 'm')}" for name, length in lengths.items())
    panel.text(0.0, 0.0, said, ha="center", va="center", fontsize=8.5)
    forward = f"{number(100.0 * test.share, EXACT)} %" if test.share else "none"
    panel.set_title(f"{test.name}\nfriction fed forward: {forward}", fontsize=9.0)
    panel.set_aspect("equal")
    panel.set_axis_off()
