"""A map as one HTML page: slices chosen by sliders, without anything outside itself."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from stickslip_fmu.release import VERSION
from stickslip_verification.report.files import environment, text_of

from ..points.columns import Regime
from ..shown import number
from .pictures import COLOUR_MAP, EVEN, SWINGS, UNKNOWN
from .views import VALID, Side, Unit, View, colours, contours

if TYPE_CHECKING:
    import xarray
    from matplotlib.colors import Colormap, Normalize

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
    """Return a map as a page for the browser.

    Parameters
    ----------
    view
        The map.
    places
        The slices that the page holds, as of `View.places`.
    told
        What the whole map says, a line each.
    """
    from matplotlib.colors import LogNorm, to_hex

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
    from matplotlib.ticker import LogLocator, MaxNLocator

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


def _picture(view: View, part: xarray.Dataset, name: str, norm: Normalize, unit: Unit) -> str:
    """Return a variable in a slice as PNG, as an address of data."""
    from matplotlib.colors import to_rgb
    from PIL import Image

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
    import matplotlib as mpl

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
