"""The picture of a map: jump, where stick-slip ends, where the simplified formula is good."""

from __future__ import annotations

import io
from functools import cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.report.svg import STYLE

from ..datasets import need
from ..points.columns import Regime
from ..shown import number
from .views import VALID, Side, View, colours, contours

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOUR_MAP: Final = "cividis"
"""Alike for every colour vision, and rising in grey."""

EVEN: Final = "#f1f3f5"
SWINGS: Final = "#b9c0c8"
UNKNOWN: Final = "#ffffff"
"""Colours of what has no jump: told apart in grey too."""

_LIMIT: Final = "#d55e00"
_VALID: Final = "#ffffff"
_INK: Final = "#2b2f36"
_SIZE: Final = (7.2, 5.2)
_DOTS: Final = 150


class Accessor:
    """``dataset.stickslip``, where the dataset of xarray is that of a map."""

    def __init__(self, dataset: xarray.Dataset) -> None:
        self._dataset = dataset

    def plot(self) -> Figure:
        """Draw the jump over the first two parameters, further ones as the block or axis has them.

        Raises
        ------
        ValueError
            If the dataset is not that of a map.
        """
        if "over" not in self._dataset.attrs:
            raise ValueError("the dataset is not that of a map; its variables have .plot()")
        view = View(self._dataset)
        (part,) = view.slices([view.nearest()])
        return figure(view, part)


@cache
def register() -> None:
    """Give the datasets of xarray their `Accessor`."""
    need("xarray").register_dataset_accessor("stickslip")(Accessor)


def picture(view: View, part: xarray.Dataset) -> bytes:
    """Draw a slice of a map as PNG; `figure`."""
    import matplotlib as mpl

    stream = io.BytesIO()
    drawn = figure(view, part)
    with mpl.rc_context(STYLE):
        drawn.savefig(stream, format="png", dpi=_DOTS, metadata={"Software": None})
    return stream.getvalue()


def figure(view: View, part: xarray.Dataset) -> Figure:
    """Draw a slice of a map, the first parameter to the right, the second one upward."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        drawn = Figure(figsize=_SIZE, layout="constrained")
        FigureCanvasAgg(drawn)
        _draw(drawn.add_subplot(), view, part)
    return drawn


def _draw(axes: Axes, view: View, part: xarray.Dataset) -> None:
    import matplotlib as mpl
    from matplotlib.colors import ListedColormap
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    values = part[view.main].values
    norm, unit = colours([part[view.main]])
    x, y = view.x.shown, view.y.shown
    regime = view.regime(part)
    hidden = (regime != Regime.STICKS) | ~np.isfinite(values)
    mesh = axes.pcolormesh(
        x,
        y,
        np.ma.masked_where(hidden, np.abs(values) / unit.size),
        cmap=COLOUR_MAP,
        norm=norm,
        shading="nearest",
        rasterized=True,
    )
    axes.set_facecolor(EVEN)
    legend: list[Any] = []
    if np.any(regime == Regime.EVEN):
        legend.append(Patch(facecolor=EVEN, edgecolor=_INK, linewidth=0.5, label="moves evenly"))
    swings = regime == Regime.SWINGS
    if swings.any():
        only = ListedColormap([SWINGS])
        axes.pcolormesh(x, y, np.ma.masked_where(~swings, swings), cmap=only, shading="nearest")
        if min(values.shape) > 1:
            # Cells have no hatch.
            inside = swings.astype(float)
            axes.contourf(x, y, inside, levels=[0.5, 1.5], colors="none", hatches=["////"])
        legend.append(
            Patch(facecolor=SWINGS, hatch="////", edgecolor=_INK, linewidth=0.5, label="swings")
        )
    border = view.border(part)
    if border is not None and _lines(axes, view, border, 0.0, color=_LIMIT, linewidth=2.0):
        legend.append(Line2D([], [], color=_LIMIT, linewidth=2.0, label="stick-slip ends"))
    error = view.error(part)
    if error is not None:
        if min(error.shape) > 1:
            within = np.nan_to_num(error, nan=np.inf).clip(max=1.0)
            with mpl.rc_context({"hatch.color": _VALID, "hatch.linewidth": 0.6}):
                axes.contourf(x, y, within, levels=[-1.0, VALID], colors="none", hatches=["."])
        look: dict[str, Any] = {"color": _VALID, "linewidth": 1.4, "linestyle": (0, (5, 2))}
        if _lines(axes, view, error, VALID, **look) or np.any(error < VALID):
            label = f"simplified formula within {VALID:.0%}"
            grey = "#6b7280"
            legend.append(
                Patch(facecolor=grey, hatch="..", edgecolor=_VALID, linewidth=0.0, label=label)
            )
    if view.mark is not None:
        at_x, at_y, words = view.mark
        legend += axes.plot(
            at_x / view.x.unit.size,
            at_y / view.y.unit.size,
            marker="o",
            markersize=9,
            color="white",
            markeredgecolor=_LIMIT,
            markeredgewidth=2.5,
            linestyle="none",
            label=words,
        )
    for side, axis in ((view.x, axes.xaxis), (view.y, axes.yaxis)):
        _name(axis, side)
    bar = axes.figure.colorbar(mesh, ax=axes)
    bar.set_label(unit.label(view.variables[view.main]))
    bar.outline.set_visible(False)
    title = "\n".join(filter(None, (view.dataset.attrs["title"], view.told(part))))
    axes.set_title(title, fontsize=10, loc="left")
    if legend:
        axes.legend(
            handles=legend, loc="upper left", bbox_to_anchor=(0.0, -0.12), ncols=2, fontsize=8.5
        )


def _lines(axes: Axes, view: View, field: NDArray[Any], level: float, **look: Any) -> bool:
    """Draw the lines at a level; tell whether there are any."""
    lines = list(contours(field, level))
    for line in lines:
        x, y = (side.at(places) for side, places in zip((view.x, view.y), line.T, strict=True))
        axes.plot(x, y, **look, solid_capstyle="round")
    return bool(lines)


def _name(axis: Any, side: Side) -> None:
    from matplotlib.ticker import FuncFormatter, NullFormatter

    if side.log:
        axis.set_tick_params(which="minor", labelsize=7)
        axis.axes.set(**{f"{axis.axis_name}scale": "log"})
        plain = FuncFormatter(lambda value, _: number(value, 4))
        axis.set_major_formatter(plain)
        short = side.values[-1] <= 20.0 * side.values[0]
        axis.set_minor_formatter(plain if short else NullFormatter())
    axis.set_label_text(side.label)
