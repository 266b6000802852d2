"""A figure as an SVG file."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np

from stickslip_verification.model.run import Series
from stickslip_verification.report.svg.line import thinned
from stickslip_verification.report.svg.text import standalone

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def as_svg(figure: Figure, title: str) -> str:
    """Return a figure as the text of an SVG file, its lines thinned.

    The same figure gives the same text, without a date.
    """
    # Distances are seen on the page: ranges and layout are there once it is drawn.
    figure.draw_without_rendering()
    thin(figure)
    text = io.StringIO()
    nothing = {"Creator": None, "Date": None, "Format": None, "Type": None}
    figure.savefig(text, format="svg", metadata=nothing)
    return standalone(text.getvalue(), title)


def thin(figure: Figure) -> None:
    """Leave of each line the points that tell its shape on the page; see `thinned`.

    Ranges and places of the panels must be settled. Lines of markers and of steps stay whole: their
    points are seen themselves.
    """
    for panel in figure.axes:
        for line in panel.lines:
            x, y = (np.asarray(values) for values in line.get_data())
            plain = line.get_marker() in ("None", "") and line.get_drawstyle() == "default"
            if len(x) > 2 and plain:
                kept = thinned(*_in_points(panel, x, y))
                line.set_data(x[kept], y[kept])


def _in_points(panel: Axes, x: Series, y: Series) -> tuple[Series, Series]:
    """Return where on the page a line in the units of the panel is drawn [pt]."""
    dpi = panel.get_figure(root=True).dpi  # type: ignore[union-attr]
    drawn = panel.transData.transform(np.column_stack((x, y))) * 72.0 / dpi
    return drawn[:, 0], drawn[:, 1]
