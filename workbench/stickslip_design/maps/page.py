"""A map as a picture, and as one HTML page of slices, without anything outside itself."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap, ListedColormap, LogNorm, Normalize, to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import NDArray
from PIL import Image

from stickslip_fmu.release import VERSION
from stickslip_units import Scale, number
from stickslip_verification.report.files import environment, text_of
from stickslip_verification.report.svg import INK, ORANGE, STYLE

from ..points.columns import Regime
from .views import VALID, Side, View, colours, contours

if TYPE_CHECKING:
    import xarray

COLOUR_MAP: Final = "cividis"
"""Alike for every colour vision, and rising in grey."""

EVEN: Final = "#f1f3f5"
SWINGS: Final = "#b9c0c8"
UNKNOWN: Final = "#ffffff"
"""Colours of what has no jump: told apart in grey too."""

_VALID: Final = "#ffffff"
_SIZE: Final = (7.2, 5.2)
_DOTS: Final = 150


def figure_of(dataset: xarray.Dataset) -> Figure:
    """Draw the jump over the first two parameters, further ones as the block or axis has them.

    Raises
    ------
    ValueError
        If the dataset is not that of a map.
    """
    if "over" not in dataset.attrs:
        raise ValueError("the dataset is not that of a map; its variables have .plot()")
    view = View(dataset)
    (part,) = view.slices([view.nearest()])
    return figure(view, part)


def picture(view: View, part: xarray.Dataset) -> bytes:
    """Draw a slice of a map as PNG; `figure`."""
    stream = io.BytesIO()
    drawn = figure(view, part)
    with mpl.rc_context(STYLE):
        drawn.savefig(stream, format="png", dpi=_DOTS, metadata={"Software": None})
    return stream.getvalue()


def figure(view: View, part: xarray.Dataset) -> Figure:
    """Draw a slice of a map, the first parameter to the right, the second one upward."""
    with mpl.rc_context(STYLE):
        drawn = Figure(figsize=_SIZE, layout="constrained")
        FigureCanvasAgg(drawn)
        _draw(drawn.add_subplot(), view, part)
    return drawn


def _draw(axes: Axes, view: View, part: xarray.Dataset) -> None:
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
        legend.append(Patch(facecolor=EVEN, edgecolor=INK, linewidth=0.5, label="moves evenly"))
    swings = regime == Regime.SWINGS
    if swings.any():
        only = ListedColormap([SWINGS])
        axes.pcolormesh(x, y, np.ma.masked_where(~swings, swings), cmap=only, shading="nearest")
        if min(values.shape) > 1:
            # Cells have no hatch.
            inside = swings.astype(float)
            axes.contourf(x, y, inside, levels=[0.5, 1.5], colors="none", hatches=["////"])
        legend.append(
            Patch(facecolor=SWINGS, hatch="////", edgecolor=INK, linewidth=0.5, label="swings")
        )
    border = view.border(part)
    if border is not None and _lines(axes, view, border, 0.0, color=ORANGE, linewidth=2.0):
        legend.append(Line2D([], [], color=ORANGE, linewidth=2.0, label="stick-slip ends"))
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
            markeredgecolor=ORANGE,
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
    if side.log:
        axis.set_tick_params(which="minor", labelsize=7)
        axis.axes.set(**{f"{axis.axis_name}scale": "log"})
        plain = FuncFormatter(lambda value, _: number(value, 4))
        axis.set_major_formatter(plain)
        short = side.values[-1] <= 20.0 * side.values[0]
        axis.set_minor_formatter(plain if short else NullFormatter())
    axis.set_label_text(side.label)


MOST_SLICES: Final = 60
"""Slices that a page holds; of more, some are chosen evenly."""

_WIDTH, _HEIGHT = 640.0, 440.0
"""Size of the picture, in the units of the SVG."""

_LEVELS: Final = 250
"""Colours of the values; with those of what has none they fit into a picture of 256."""
_LOOKS: Final = {Regime.EVEN: EVEN, Regime.SWINGS: SWINGS, Regime.UNKNOWN: UNKNOWN}
_STICKS: Final = "#2c6a9b"
_NICE: Final = (1.0, 2.0, 5.0, 10.0)
_SHORT: Final = 200.0
"""Ratio of the ends of a logarithmic side up to which 2 and 5 are labelled too."""
_LEAST_TICKS: Final = 2
_MOST_TICKS: Final = 7


def page(view: View, places: Sequence[Mapping[str, int]], told: Sequence[str]) -> str:
    """Return slices of a map, those at `places`, as a page for the browser.

    `told` is what the whole map says, a line each.
    """
    slices = view.slices(places)
    bars: dict[str, tuple[str, list[tuple[float, str]]]] = {}
    pictures: dict[str, list[str]] = {}
    for name, words in view.variables.items():
        norm, unit = colours([part[name] for part in slices])
        values = norm.inverse(np.linspace(0.0, 1.0, _LEVELS)) * unit.size
        log = isinstance(norm, LogNorm)
        bars[name] = unit.label(words), ticks(Side(name, words, values, unit, log), _WIDTH)
        pictures[name] = [_picture(view, part, name, norm, unit) for part in slices]
    chosen = {side.name: sorted({place[side.name] for place in places}) for side in view.further}
    data = {
        "pictures": pictures,
        "limits": [_path(view.border(part), 0.0) for part in slices],
        "valid": [_path(view.error(part), VALID) for part in slices],
        "told": [view.summary(part) for part in slices],
        "counts": [len(numbers) for numbers in chosen.values()],
    }
    nearest = view.nearest()
    sliders = [
        {
            "name": side.name,
            "description": side.description,
            "labels": [side.unit.told(float(side.values[n])) for n in chosen[side.name]],
            "start": int(np.argmin(np.abs(np.array(chosen[side.name]) - nearest[side.name]))),
            "left_out": side.values.size - len(chosen[side.name]),
        }
        for side in view.further
    ]
    versions: dict[str, str] = json.loads(view.dataset.attrs["versions"])
    folder = Path(__file__).parent / "templates"
    return environment(folder).get_template("map.html.j2").render(
        view=view,
        told=told,
        bars=bars,
        sliders=sliders,
        x_ticks=ticks(view.x, _WIDTH),
        y_ticks=[(_HEIGHT - at, label) for at, label in ticks(view.y, _HEIGHT)],
        width=_WIDTH,
        height=_HEIGHT,
        point=_point(view),
        gradient=[to_hex(each) for each in _colour_map()(np.linspace(0.0, 1.0, 7))],
        looks={"even": EVEN, "swings": SWINGS, "sticks": _STICKS},
        valid=f"{VALID:.0%}",
        has_valid=any(data["valid"]),
        shown=len(places),
        data=Markup(json.dumps(data).replace("<", "\\u003c")),
        command=view.dataset.attrs["command"],
        versions=", ".join(" ".join(each) for each in versions.items()),
        digest=view.dataset.attrs["inputs_digest"],
        version=VERSION,
        style=text_of("map.css", folder),
        script=text_of("map.js", folder),
    )  # fmt: skip


def ticks(side: Side, length: float) -> list[tuple[float, str]]:
    """Return place and label of the ticks of a side, on which the values stand evenly.

    A tick stands where its number would, between two values by the scale of the side; places are in
    the units of the SVG, of which the side has `length`.
    """
    numbers = shown = side.shown
    if shown.size > _MOST_TICKS:
        low, high = shown[0], shown[-1]
        locators: list[Any] = [MaxNLocator(_MOST_TICKS, steps=_NICE)]
        if side.log:
            # A side of a fraction of a decade may have none of them.
            subs = _NICE[:3] if high <= _SHORT * low else (1.0,)
            locators.insert(0, LogLocator(subs=subs))
        for locator in locators:
            found = np.asarray(locator.tick_values(low, high))
            slack = 1e-9 * abs(high)
            numbers = found[(found >= low - slack) & (found <= high + slack)]
            if numbers.size >= _LEAST_TICKS:
                break
    ways = (side.places(numbers * side.unit.size) + 0.5) / shown.size * length
    return [
        (round(float(at), 2), number(float(value), 4))
        for at, value in zip(ways, numbers, strict=True)
    ]


def _picture(view: View, part: xarray.Dataset, name: str, norm: Normalize, unit: Scale) -> str:
    """Return a variable in a slice as PNG, as an address of data."""
    values = part[name].values
    if name == "regime":
        rgb = np.tile(to_rgb(_STICKS), (*values.shape, 1))
    else:
        known = np.isfinite(values)
        rgb = _colour_map()(norm(np.abs(np.where(known, values, 0.0)) / unit.size))[..., :3]
        rgb[~known] = to_rgb(UNKNOWN)
    regime = view.regime(part)
    for kind, look in _LOOKS.items():
        rgb[regime == kind] = to_rgb(look)
    # The first row of a picture is its top.
    image = Image.fromarray((255.0 * rgb[::-1]).round().astype(np.uint8)).quantize(256)
    stream = io.BytesIO()
    image.save(stream, format="png", optimize=True)
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode("ascii")


def _colour_map() -> Colormap:
    return mpl.colormaps[COLOUR_MAP].resampled(_LEVELS)


def _path(field: NDArray[Any] | None, level: float) -> str:
    """Return the lines at a level of a field as the path of an SVG."""
    if field is None:
        return ""
    rows, columns = field.shape
    texts = []
    for line in contours(field, level):
        x = (line[:, 0] + 0.5) / columns * _WIDTH
        y = _HEIGHT - (line[:, 1] + 0.5) / rows * _HEIGHT
        points = np.stack([x, y], axis=1)
        # Points within a unit of each other are one, but for the end.
        moved = np.any(np.diff(points.round(), axis=0), axis=1)
        moved[-1:] = True
        points = points[[True, *moved]]
        texts.append("M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in points))
    return "".join(texts)


def _point(view: View) -> tuple[float, float, str] | None:
    """Return where the block or axis itself stands in the picture, and what it is."""
    if view.mark is None:
        return None
    x, y, words = view.mark
    x, y = (
        (float(side.places(value)) + 0.5) / side.values.size * length
        for side, value, length in ((view.x, x, _WIDTH), (view.y, y, _HEIGHT))
    )
    return x, _HEIGHT - y, words
