"""The plots of the findings, as SVG text: the same on every run, and free of fonts.

The library that draws is imported when something is drawn.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from stickslip_verification.report.svg import BASE, as_svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from stickslip_design.claims.finding import Axis, Finding, Panel, Series

# Told apart by the colour-blind too: M. Okabe and K. Ito, Color Universal Design, 2008.
_PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")
_GREY = "#666666"
_FAINT = "#E4E4E4"

_STYLE: Any = BASE | {
    "axes.edgecolor": _GREY,
    "axes.grid": True,
    "axes.grid.which": "major",
    "axes.labelcolor": "black",
    "axes.labelsize": 9.0,
    "axes.linewidth": 0.8,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "figure.facecolor": "white",
    "font.size": 9.0,
    "grid.color": _FAINT,
    "grid.linewidth": 0.8,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    "lines.solid_capstyle": "round",
    "xtick.color": _GREY,
    "xtick.labelcolor": "black",
    "ytick.color": _GREY,
    "ytick.labelcolor": "black",
}

# Inches; 7 in are 504 pt in SVG, which is 672 px on a page.
_WIDTH = 7.0
_HEIGHT_ALONE, _HEIGHT_IN_ROW = 3.4, 2.9


def draw(finding: Finding) -> str:
    """Return the plot of a finding as the text of an SVG file."""
    import matplotlib

    with matplotlib.rc_context(_STYLE):
        return as_svg(_compose(finding), Title=finding.title)


def _compose(finding: Finding) -> Figure:
    from matplotlib.figure import Figure

    columns = 1 if len(finding.panels) == 1 else 2
    rows = -(-len(finding.panels) // columns)
    height = _HEIGHT_ALONE if columns == 1 else _HEIGHT_IN_ROW * rows
    figure = Figure(figsize=(_WIDTH, height), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel().tolist()
    for panel, on in itertools.zip_longest(finding.panels, axes):
        if panel is None:
            _legend(finding.panels, on)
        else:
            _panel(panel, on)
    return figure


def _panel(panel: Panel, on: Axes) -> None:
    _axis(panel.x, on, "x")
    _axis(panel.y, on, "y")
    if panel.title:
        on.set_title(panel.title)
    for series in panel.series:
        _series(series, on)
        if series.name_at is not None:
            on.annotate(series.name, series.name_at, color=_colour(series), va="bottom")


def _axis(axis: Axis, on: Axes, which: str) -> None:
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

    on.set(
        **{
            f"{which}label": axis.label,
            f"{which}scale": "log" if axis.log else "linear",
            f"{which}lim": (axis.low, axis.high),
        }
    )
    scale = on.xaxis if which == "x" else on.yaxis
    if axis.ticks:
        scale.set_major_locator(FixedLocator(axis.ticks))
    scale.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    scale.set_minor_formatter(NullFormatter())


def _series(series: Series, on: Axes) -> None:
    colour = _colour(series)
    if series.kind == "points":
        many = len(series.x) > 30
        on.plot(
            series.x,
            series.y,
            linestyle="none",
            marker="o",
            markersize=2.6 if many else 6.0,
            markeredgewidth=0.0 if many else 1.2,
            markeredgecolor="white",
            color=colour,
            clip_on=False,
            label=series.name,
        )
    else:
        dashes = (0, (4, 2)) if series.kind == "dashed" else "-"
        on.plot(series.x, series.y, linestyle=dashes, color=colour, label=series.name)


def _colour(series: Series) -> str:
    return _GREY if series.colour < 0 else _PALETTE[series.colour % len(_PALETTE)]


def _legend(panels: tuple[Panel, ...], on: Axes) -> None:
    """Show in a place without a panel what the series without a name beside them are."""
    seen: dict[str, Line2D] = {}
    for series in _nameless(panels):
        if series.name not in seen:
            (seen[series.name],) = on.plot(
                [], [], linestyle="none", marker="o", markersize=6.0, color=_colour(series)
            )
    on.set_axis_off()
    on.legend(list(seen.values()), list(seen), loc="center left")


def _nameless(panels: tuple[Panel, ...]) -> Iterator[Series]:
    for panel in panels:
        yield from (series for series in panel.series if series.name_at is None)
