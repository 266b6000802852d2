"""A map as one HTML page: slices chosen by sliders, without anything outside itself."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from stickslip_fmu.release import VERSION
from stickslip_verification.report.environment import environment, text_of

from ..points.blocks import Regime
from ..shown import number
from .pictures import COLOUR_MAP, EVEN, SWINGS, UNKNOWN
from .views import VALID, Colours, Floats, Side, Slice, Variable, View, colours, contours

MOST_SLICES: Final = 60
"""Slices that a page holds; of more, some are chosen evenly."""

_WIDTH, _HEIGHT = 640.0, 440.0
"""Size of the picture, in the units of the SVG."""

_LEVELS: Final = 250
_CODES: Final = {Regime.EVEN: 250, Regime.SWINGS: 251, -1: 252}
"""Colours of a picture: those of the values, then those of what has none."""

_STICKS: Final = "#2c6a9b"
_NICE: Final = (1.0, 2.0, 5.0)
_LEAST_TICKS: Final = 2
_MOST_TICKS: Final = 7


class Tick(NamedTuple):
    """A tick: where it stands on its side, in the units of the SVG, and its label."""

    at: float
    label: str


class _Bar(NamedTuple):
    """The bar of colours of a variable."""

    label: str
    ticks: list[Tick]
    classes: list[tuple[str, str]]


def page(view: View, slices: Sequence[Slice], told: Sequence[str]) -> str:
    """Return a map as a page for the browser.

    Parameters
    ----------
    view
        The map.
    slices
        Those of `View.places` that the page holds.
    told
        What the whole map says, a line each.
    """
    places = [each.place for each in slices]
    variables = list(view.variables)
    bars: dict[str, _Bar] = {}
    pictures: dict[str, list[str]] = {}
    for variable in variables:
        samples = [each.columns[variable.name] for each in slices]
        scale = colours(view.units(variable.name), samples)
        bars[variable.name] = _bar(variable, scale)
        pictures[variable.name] = [_picture(each, variable, scale) for each in slices]
    chosen = {each.name: sorted({place[each.name] for place in places}) for each in view.further}
    data = {
        "pictures": pictures,
        "limits": [_path(view.border(each), 0.0) for each in slices],
        "valid": [_path(_error(each), VALID) for each in slices],
        "told": [view.summary(each) for each in slices],
        "counts": [len(chosen[each.name]) for each in view.further],
    }
    nearest = view.nearest()
    sliders = [
        {
            "name": each.name,
            "description": each.description,
            "labels": [each.unit.told(float(each.values[n])) for n in chosen[each.name]],
            "start": int(np.argmin(np.abs(np.array(chosen[each.name]) - nearest[each.name]))),
            "left_out": each.values.size - len(chosen[each.name]),
        }
        for each in view.further
    ]
    versions: dict[str, str] = json.loads(view.dataset.attrs["versions"])
    folder = Path(__file__).parent / "templates"
    return environment(folder).get_template("map.html.j2").render(
        title=view.title,
        told=told,
        variables=variables,
        bars=bars,
        sliders=sliders,
        x=view.x,
        y=view.y,
        x_ticks=ticks(view.x, _WIDTH),
        y_ticks=[each._replace(at=_HEIGHT - each.at) for each in ticks(view.y, _HEIGHT)],
        width=_WIDTH,
        height=_HEIGHT,
        point=_point(view),
        gradient=_gradient(),
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


def ticks(side: Side, length: float) -> list[Tick]:
    """Return the ticks of a side of so many units, on which the values stand evenly.

    A tick stands where its number would: between two values by the scale of the side.
    """
    shown = side.shown
    slack = 1e-9 * abs(shown[-1])

    def inside(numbers: Floats) -> Floats:
        return np.asarray(numbers[(numbers >= shown[0] - slack) & (numbers <= shown[-1] + slack)])

    numbers = shown
    if shown.size > _MOST_TICKS:
        numbers = inside(_decades(shown)) if side.log else shown[:0]
        # A side of a fraction of a decade may have none of them.
        if numbers.size < _LEAST_TICKS:
            numbers = inside(_steps(shown))
    scale = np.log if side.log else np.asarray
    places = np.interp(scale(numbers), scale(shown), np.arange(shown.size))
    ways = (places + 0.5) / shown.size * length
    return [
        Tick(round(float(at), 2), number(float(value), 4))
        for at, value in zip(ways, numbers, strict=True)
    ]


def _decades(shown: Floats) -> Floats:
    """Return powers of ten, on a short side 1, 2 and 5 times them."""
    low, high = np.floor(np.log10(shown[0])), np.ceil(np.log10(shown[-1]))
    decades = 10.0 ** np.arange(low, high + 1.0)
    return np.sort(np.outer(decades, _NICE).ravel()) if high - low <= 2.0 else decades


def _steps(shown: Floats) -> Floats:
    """Return the multiples of 1, 2 or 5 times a power of ten of which there are few enough."""
    span = shown[-1] - shown[0]
    step = 10.0 ** np.floor(np.log10(span / _MOST_TICKS))
    step *= next(each for each in (*_NICE, 10.0) if span / (step * each) <= _MOST_TICKS)
    multiples = np.arange(np.ceil(shown[0] / step), np.floor(shown[-1] / step) + 1.0)
    return np.asarray(multiples * step)


def _picture(part: Slice, variable: Variable, scale: Colours) -> str:
    """Return a variable in a slice as PNG, as an address of data."""
    from PIL import Image

    values = part.columns[variable.name]
    regime = part.columns.get("regime", np.full(values.shape, Regime.STICKS))
    if variable.name == "regime":
        codes = np.full(values.shape, _LEVELS - 1)
        palette = [*([_STICKS] * _LEVELS), EVEN, SWINGS, UNKNOWN]
    else:
        finite = np.where(np.isfinite(values), values, 0.0)
        codes = np.round(scale.part(finite) * (_LEVELS - 1)).astype(int)
        codes[~np.isfinite(values)] = _CODES[-1]
        palette = [*_palette(), EVEN, SWINGS, UNKNOWN]
    for kind, code in _CODES.items():
        codes[regime == kind] = code
    # The first row of a picture is its top.
    image = Image.fromarray(codes[::-1].astype(np.uint8))
    image.putpalette(bytes.fromhex("".join(each.removeprefix("#") for each in palette)))
    stream = io.BytesIO()
    image.save(stream, format="png", optimize=True)
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode("ascii")


def _palette() -> list[str]:
    import matplotlib as mpl
    from matplotlib.colors import to_hex

    return [to_hex(each) for each in mpl.colormaps[COLOUR_MAP](np.linspace(0.0, 1.0, _LEVELS))]


def _gradient() -> list[str]:
    return _palette()[:: (_LEVELS - 1) // 6]


def _error(part: Slice) -> NDArray[Any] | None:
    error = part.columns.get("simplified_error")
    return None if error is None else np.abs(error)


def _path(field: NDArray[Any] | None, level: float) -> str:
    """Return the lines at a level of a field as the path of an SVG."""
    if field is None:
        return ""
    rows, columns = field.shape
    texts = []
    for line in contours(field, level):
        x = (line[:, 0] + 0.5) / columns * _WIDTH
        y = _HEIGHT - (line[:, 1] + 0.5) / rows * _HEIGHT
        points = _slim(np.stack([x, y], axis=1))
        texts.append("M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in points))
    return "".join(texts)


def _slim(points: NDArray[Any]) -> NDArray[Any]:
    """Return a line without points that are nearer than a unit to the one before."""
    kept = [0]
    for place in range(1, len(points) - 1):
        if np.hypot(*(points[place] - points[kept[-1]])) >= 1.0:
            kept.append(place)
    return points[[*kept, len(points) - 1]]


def _bar(variable: Variable, scale: Colours) -> _Bar:
    if variable.name == "regime":
        classes = [("sticks", "sticks and slips"), ("swings", "swings"), ("even", "moves evenly")]
        return _Bar(variable.words, [], classes)
    spaced = np.geomspace if scale.log else np.linspace
    values = spaced(scale.low, scale.high, _LEVELS) * scale.unit.size
    whole = Side(variable.name, "", values, scale.unit, scale.log)
    return _Bar(scale.unit.label(variable.words), ticks(whole, _WIDTH), [])


def _point(view: View) -> tuple[float, float, str] | None:
    """Return where the block or axis itself stands in the picture, and what it is."""
    found = []
    for side, length in ((view.x, _WIDTH), (view.y, _HEIGHT)):
        value = view.point.get(side.name)
        if value is None or not side.values[0] <= value <= side.values[-1]:
            return None
        scale = np.log if side.log else np.asarray
        place = float(np.interp(scale(value), scale(side.values), np.arange(side.values.size)))
        found.append((place + 0.5) / side.values.size * length)
    told = ", ".join(
        f"{each.name} = {each.unit.told(view.point[each.name])}" for each in (view.x, view.y)
    )
    return found[0], _HEIGHT - found[1], told
