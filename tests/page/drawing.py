"""Reads the charts back: what their paths, bands, axes and cursors say, in seconds and SI."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from playwright.sync_api import Page

PIXEL = 0.02
"""How far a coordinate may be off [px]: it is written to a fiftieth, so 0.01 is rounding; the time
axis of the deepest zoom, a 1e-9 of its time, makes 730 px 2e-16/1e-9 of this coarse, which is less.
"""

SIZES = {
    **{f"{prefix}m": size for prefix, size in {"k": 1e3, "": 1.0, "m": 1e-3, "µ": 1e-6}.items()},
    **{f"{prefix}N": size for prefix, size in {"T": 1e12, "k": 1e3, "": 1.0, "m": 1e-3}.items()},
    **{f"{prefix}m/s": size for prefix, size in {"": 1.0, "m": 1e-3, "µ": 1e-6}.items()},
    **{f"{prefix}s": size for prefix, size in {"": 1.0, "m": 1e-3, "µ": 1e-6}.items()},
    "years": 31557600.0,
    "days": 86400.0,
}
"""SI size of the units that the tests meet on an axis."""

Point = tuple[float, float]


@dataclass(frozen=True)
class Piece:
    """A piece of a path between two points [px]; straight, or curved with two controls."""

    kind: Literal["line", "cubic"]
    start: Point
    end: Point


@dataclass(frozen=True)
class Phase:
    """A stick or a slip as the page's numbers have it, cut to what is seen [s]."""

    kind: Literal["stick", "slip"]
    start: float
    end: float


@dataclass(frozen=True)
class TimeAxis:
    """Where a time lies: `left` and `width` of the plot [px], `start` and `end` of the view [s]."""

    left: float
    width: float
    start: float
    end: float

    @property
    def span(self) -> float:
        """Length of the view [s]."""
        return self.end - self.start

    def place(self, t: float) -> float:
        """Give the pixel of a time [s]."""
        return self.left + (t - self.start) / self.span * self.width

    def time(self, place: float) -> float:
        """Give the time [s] of a pixel."""
        return self.start + (place - self.left) / self.width * self.span


def time_axis(page: Page, chart: str = "x-chart") -> TimeAxis:
    """Give the time axis of a chart, from its clipping rectangle and the page's view."""
    clip = page.locator(f"#{chart} clipPath rect")
    left, width = (float(clip.get_attribute(name) or "") for name in ("x", "width"))
    view = page.evaluate("window.stickslip.view")
    return TimeAxis(left, width, float(view["from"]), float(view["to"]))


def phases(page: Page) -> list[Phase]:
    """Give the sticks and slips that are seen, from the page's own events and states."""
    found = page.evaluate(
        """() => {
          const { from, to } = window.stickslip.view;
          const dates = window.stickslip.events(from, to).map(event => event.t);
          const edges = [from, ...dates.filter(t => t > from && t < to), to];
          return edges.slice(1).map((end, i) => {
            const { mode } = window.stickslip.at(0.5 * (edges[i] + end));
            return { kind: mode === 0 ? "stick" : "slip", start: edges[i], end };
          });
        }"""
    )
    return [Phase(each["kind"], float(each["start"]), float(each["end"])) for each in found]


def pieces(path: str) -> list[Piece]:
    """Take the data of a path apart; pieces without length are left out."""
    found: list[Piece] = []
    here: Point | None = None
    for command, numbers in re.findall(r"([MLC])([^MLC]*)", path):
        values = [float(each) for each in numbers.split()]
        end = (values[-2], values[-1])
        if here is not None and command != "M" and (end != here or command == "C"):
            found.append(Piece("line" if command == "L" else "cubic", here, end))
        here = end
    return found


def curve(page: Page, selector: str) -> list[Piece]:
    """Give the pieces of one drawn curve."""
    return pieces(page.get_attribute(selector, "d") or "")


def lines(found: list[Piece]) -> list[Piece]:
    """Give the straight pieces."""
    return [each for each in found if each.kind == "line"]


def bands(page: Page, chart: str, kind: Literal["stick", "slip"]) -> list[Point]:
    """Give left and right edge [px] of each shaded band."""
    shade = ".stick-band" if kind == "stick" else "path[fill^='url']"
    path = page.get_attribute(f"#{chart} {shade}", "d") or ""
    return [(float(a), float(b)) for a, b in re.findall(r"M(\S+) \S+?H([^VHZM]+)V", path)]


def height_of(page: Page, selector: str) -> float:
    """Give the height [px] of a level line."""
    match = re.match(r"M\S+ ([\d.]+)H", page.get_attribute(selector, "d") or "")
    assert match
    return float(match[1])


def cursor(page: Page, chart: str) -> float:
    """Give the place [px] of a chart's cursor line."""
    match = re.match(r"M([\d.]+) ", page.get_attribute(f"#{chart} .cursor", "d") or "")
    assert match
    return float(match[1])


def dot(page: Page, chart: str) -> Point:
    """Give the place [px] of the mark of the mass."""
    mark = page.locator(f"#{chart} .dot:not(.pull)")
    return float(mark.get_attribute("cx") or ""), float(mark.get_attribute("cy") or "")


def value_at(page: Page, chart: str, axis: Literal["x", "y"], place: float) -> tuple[float, float]:
    """Read a value [SI] off an axis by its labels, as an eye does, and what 0.05 px are worth."""
    anchor, side, back = ("middle", "end", 0.0) if axis == "x" else ("end", "start", 4.0)
    labels = page.eval_on_selector_all(
        f"#{chart} .ticks text[text-anchor='{anchor}']",
        "(labels, axis) => labels.map(l => [l.textContent, +l.getAttribute(axis)])",
        axis,
    )
    title = page.text_content(f"#{chart} .axis[text-anchor='{side}']") or ""
    unit = title.split(" in ")[1]
    marks = [(float(text.replace("−", "-")), at - back) for text, at in labels]
    (low, first), (high, last) = marks[0], marks[-1]
    per_pixel = SIZES[unit] * (high - low) / (last - first)
    return SIZES[unit] * low + (place - first) * per_pixel, abs(0.05 * per_pixel)


def corners(seen: list[Phase]) -> list[float]:
    """Give the times [s] at which one phase ends and the next begins."""
    return [before.end for before, _ in pairwise(seen)]
