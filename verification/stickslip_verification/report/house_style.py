"""The look of every picture in the report, and how a picture becomes a part of the page."""

from __future__ import annotations

import io
from typing import Any, Final

import numpy as np
from matplotlib.axis import Axis
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from stickslip_verification.report.svg import tidy

INK: Final = "#2b2f36"
GREY: Final = "#9aa1ab"
SOFT: Final = "#5d646e"
BLUE: Final = "#0072b2"
ORANGE: Final = "#d55e00"
"""Blue and vermillion of Okabe and Ito, told apart with every colour vision and in grey."""

STYLE: Final[Any] = {
    "font.family": "sans-serif",
    "font.size": 9.0,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.unicode_minus": True,
    "grid.color": "#e6e9ed",
    "grid.linewidth": 0.6,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "legend.frameon": False,
    # Lines are thinned here, so that corners stay corners and a stick stays flat.
    "path.simplify": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "stickslip",
}


def label_decades(axis: Axis, limits: tuple[float, float], most: int) -> None:
    """Label at most so many decades, and none of the lines between them."""
    axis.set_major_locator(LogLocator(numticks=most + 1))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(lambda value, _: f"1e{round(float(np.log10(value)))}")


def as_svg(page: Figure, prefix: str, title: str) -> str:
    """Return a picture as SVG for the page; `prefix` makes its ids its own, `title` names it."""
    stream = io.StringIO()
    FigureCanvasSVG(page)
    page.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return tidy(stream.getvalue(), prefix, title)
