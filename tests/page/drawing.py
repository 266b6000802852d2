"""Reads the charts back: what their paths, bands, axes and cursors say, in seconds and SI."""

import re
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, NamedTuple

from tests.page.window import Window

PIXEL = 0.02
"""How far a coordinate may be off [px]: it is written to a fiftieth, so 0.01 is rounding; the time
axis of the deepest zoom, a 1e-9 of its time, makes 730 px 2e-16/1e-9 of this coarse, which is less.
"""

SIZES = {
    **{f"{prefix}m": size for prefix, size in {"k": 1e3, "": 1.0, "m": 1e-3, "µ": 1e-6}.items()},
    **{f"{prefix}N": size for prefix, size in {"T": 1e12, "k": 1e3, "": 1.0, "m": 1e-3}.items()},
    **{f"{prefix}m/s": size for prefix, size in {"": 1.0, "m": 1e-3, "µ": 1e-6}.items()},
    **{f"{prefix}s": size for prefix, size in {"": 1.0, "m": 1e-3, "µ": 1e-6}.items()},
    "nm": 1e-9,
    "kHz": 1e3,
    "Hz": 1.0,
    "%": 0.01,
    "": 1.0,
    "years": 31557600.0,
    "days": 86400.0,
    "min": 60.0,
}
"""SI size of the units that the tests meet on the page."""

Point = tuple[float, float]
Kind = Literal["stick", "slip"]


class Piece(NamedTuple):
    """A piece of a path [px], straight or cubic: its ends, and its points with the controls."""

    start: Point
    end: Point
    points: tuple[Point, ...]

    @property
    def is_line(self) -> bool:
        return len(self.points) == 2


@dataclass(frozen=True)
class TimeAxis:
    """Where a time lies: `left` and `width` of the plot [px], `start` and `end` of the view [s]."""

    left: float
    width: float
    start: float
    end: float

    @property
    def span(self) -> float:
        return self.end - self.start

    def place(self, t: float) -> float:
        return self.left + (t - self.start) / self.span * self.width

    def time(self, place: float) -> float:
        return self.start + (place - self.left) / self.width * self.span


def time_axis(window: Window, chart: str = "x-chart") -> TimeAxis:
    """Return the time axis of a chart, from its clipping rectangle and the page's view."""
    left, width = (float(window.part(f"#{chart} clipPath rect", name)) for name in ("x", "width"))
    return TimeAxis(left, width, *window.view)


def place(window: Window, chart: str, t: float) -> Point:
    window.page.locator(f"#{chart}").scroll_into_view_if_needed()
    left, top, _, height = window.box(f"#{chart}")
    return left + time_axis(window, chart).place(t), top + 0.5 * height


def phases(window: Window) -> list[tuple[Kind, float, float]]:
    """Return kind, start and end [s] of the sticks and slips seen, from the page's own numbers."""
    start, end = window.view
    dates = [each["t"] for each in window.js("v => stickslip.events(v[0], v[1])", [start, end])]
    edges = [start, *(t for t in dates if start < t < end), end]
    states = window.states([0.5 * (a + b) for a, b in pairwise(edges)])
    kinds: list[Kind] = ["stick" if each["mode"] == 0 else "slip" for each in states]
    return [(kind, a, b) for kind, (a, b) in zip(kinds, pairwise(edges), strict=True)]


def curve(window: Window, selector: str) -> list[Piece]:
    """Return the pieces of one drawn curve; those without length are left out."""
    found: list[Piece] = []
    here: tuple[Point, ...] = ()
    for command, numbers in re.findall(r"([MLC])([^MLC]*)", window.part(selector, "d")):
        values = [float(each) for each in numbers.split()]
        points = tuple(zip(values[::2], values[1::2], strict=True))
        if command == "C" or (command == "L" and points != here):
            found.append(Piece(here[0], points[-1], (*here, *points)))
        here = points[-1:]
    return found


def lines(window: Window, selector: str) -> list[Piece]:
    return [each for each in curve(window, selector) if each.is_line]


def bands(window: Window, chart: str, kind: Kind) -> list[Point]:
    """Return left and right edge [px] of each shaded band."""
    shade = ".stick-band" if kind == "stick" else "path[fill^='url']"
    path = window.part(f"#{chart} {shade}", "d")
    return [(float(a), float(b)) for a, b in re.findall(r"M(\S+) \S+?H([^VHZM]+)V", path)]


def start_of(window: Window, selector: str) -> Point:
    """Return where a drawn line begins [px], such as a level or the cursor."""
    left, top = re.findall(r"-?[\d.]+", window.part(selector, "d"))[:2]
    return float(left), float(top)


def cursor(window: Window) -> float:
    """Return the place [px] of the cursor line, the same on both charts."""
    places = {start_of(window, f"#{chart} .cursor")[0] for chart in ("x-chart", "F-chart")}
    assert len(places) == 1
    return places.pop()


def dot(window: Window, chart: str) -> Point:
    mark = f"#{chart} .dot:not(.pull)"
    return float(window.part(mark, "cx")), float(window.part(mark, "cy"))


def value_at(window: Window, chart: str, axis: Literal["x", "y"], at: float) -> tuple[float, float]:
    """Read a value [SI] off an axis by its labels, as an eye does, and what 0.05 px are worth."""
    anchor, side, back = ("middle", "end", 0.0) if axis == "x" else ("end", "start", 4.0)
    marks = window.js(
        "([where, axis]) => [...document.querySelectorAll(where)]"
        ".map(each => [each.textContent.replace('−', '-'), +each.getAttribute(axis)])",
        [f"#{chart} .ticks text[text-anchor='{anchor}']", axis],
    )
    title = window.page.text_content(f"#{chart} .axis[text-anchor='{side}']") or ""
    size = SIZES[title.split(" in ")[1]]
    low, high = float(marks[0][0]), float(marks[-1][0])
    per_pixel = size * (high - low) / (marks[-1][1] - marks[0][1])
    return size * low + (at - marks[0][1] + back) * per_pixel, abs(0.05 * per_pixel)


def quantity(words: str, pattern: str) -> tuple[float, float]:
    """Return a quantity [SI] behind the pattern in a text, and half of its last digit."""
    match = re.search(pattern + r"(−?[\d.]+)\s?([^\s,:;)]*)", words.replace("\u00a0", " "))
    assert match, (pattern, words)
    size = SIZES[match[2].rstrip(".")]
    half = 0.5 * 10.0 ** -len(match[1].rstrip(".").partition(".")[2]) * size
    return float(match[1].replace("−", "-").rstrip(".")) * size, 1.001 * half
