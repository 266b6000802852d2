"""Circles as the circular test draws them: the deviation of the radius enlarged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Final

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from stickslip_units import EXACT, number, told
from stickslip_verification.report.svg import BLUE, GREY, INK, ORANGE, STYLE

from .circle import ANGLES, Circle

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_RINGS: Final = 4
"""Rings on either side of the circle."""
_RING: Final = 0.12
"""Distance of two rings, over the radius that is drawn."""
_SIDE: Final = 3.4
"""Side of a panel [in]."""


def circles(tests: Sequence[Circle]) -> Figure:
    """Draw each circle: in a row the parts that are fed forward, or of a single part the feeds."""
    several = len({each.share for each in tests}) > 1
    grouped = groupby(tests, lambda each: (each.radius, each.feed * several))
    rows = [list(row) for _, row in grouped]
    columns = max(map(len, rows))
    # All panels have one scale: 1, 2 or 5 of a decade.
    most = max(np.abs((each.counterclockwise, each.clockwise)).max() for each in tests)
    step = max(float(most) / _RINGS, 1e-9)
    decade = 10.0 ** math.floor(math.log10(step))
    step = next(each * decade for each in (1.0, 2.0, 5.0, 10.0) if each * decade >= step)
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(_SIDE * columns, (_SIDE + 0.3) * len(rows)), layout="constrained")
        panels = page.subplots(len(rows), columns, squeeze=False)
        for panel in panels.flat:
            panel.set_axis_off()
        for row, places in zip(rows, panels, strict=True):
            for test, panel in zip(row, places, strict=False):
                _draw(panel, test, step)
        handles, labels = panels[0, 0].get_legend_handles_labels()
        page.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False)
        page.suptitle(f"from ring to ring {told(step, 'm', EXACT)}", fontsize=9.0, color=INK)
    return page


def _draw(panel: Axes, test: Circle, step: float) -> None:
    angles = np.append(ANGLES, ANGLES[0])
    for ring in range(-_RINGS, _RINGS + 1):
        at, width = 1.0 + _RING * ring, 0.9 if ring == 0 else 0.4
        panel.plot(at * np.cos(angles), at * np.sin(angles), color=GREY, lw=width)
    for path, color, label in (
        (test.counterclockwise, BLUE, "counterclockwise"),
        (test.clockwise, ORANGE, "clockwise"),
    ):
        radius = 1.0 + _RING / step * np.append(path, path[0])
        x, y = radius * np.cos(angles), radius * np.sin(angles)
        panel.plot(x, y, color=color, lw=1.2, label=label)
    said = f"G(b) {told(test.G_b, 'm')}\nH {told(test.H, 'm')}\nglitch "
    panel.text(0.0, 0.0, said + told(test.glitch.height, "m"), ha="center", va="center")
    forward = f"{number(100.0 * test.share, EXACT)} %" if test.share else "none"
    where = f"{number(60.0 * test.feed, EXACT)} m/min, R {told(test.radius, 'm', EXACT)}"
    panel.set_title(f"{where}\nfriction fed forward: {forward}", fontsize=9.0)
    panel.set_aspect("equal")
