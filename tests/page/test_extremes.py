"""At the ends of what can be set and zoomed: the page lives, and what it draws is the motion."""

from __future__ import annotations

import re
import tomllib
from importlib.resources import files
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pytest

from tests.page import drawing
from tests.page.browser import WIDTH, opened
from tests.page.drawing import PIXEL
from tests.page.settings import corner, log_uniform
from tests.page.test_access import NARROW
from tests.page.using import look, pause, press, said, set_values, setting, shown, type_in

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from numpy.typing import NDArray
    from playwright.sync_api import Browser, Page

    Floats = NDArray[np.float64]

FINE, COARSE = 0.4, 0.8
"""Radians of the motion that one drawn cubic spans, at most: where it is seen, and in a crowd.

Between exact points with exact slopes a cubic errs by h^4/384 of the fourth derivative, for a swing
by 7e-5 and 1.1e-3 of its amplitude (C. de Boor, A Practical Guide to Splines, chapter V).
"""

MOST_DRAWN = 201 * 9 * 6 * 8
"""Characters of a curve of 201 cycles: 2 pi / COARSE cubics each and one for the stick; six numbers
a cubic, of up to eight characters."""

UNREACHED = {"k": 42.5, "v": 8.25e-8, "mu_s": 0.259, "mu_k": 0.259, "m": 41824.0, "g": 3.26e11}
"""A setting whose first load-up is longer than 1e9 of its cycles."""

ENDLESS: dict[str, tuple[Mapping[str, float], int]] = {
    "lightly damped": ({"c": 0.5, "v": 0.6}, 0),
    "damped": ({"c": 3.2, "v": 0.3}, 0),
    "creeping": ({"c": 2000.0}, 0),
    "crowded": ({"c": 0.1, "v": 0.9}, 8),
}
"""Slips without end: the setting, the rest as the FMU starts, and how often it is zoomed out."""

_SHOW_ALL = """
(cases) => {
  const complaints = [];
  const nonsense = /NaN|Infinity|undefined/;
  const byId = (id) => document.getElementById(id);
  const acts = {
    zoom: ({ way }) => byId(way < 0.6 ? "zoom-in" : "zoom-out").click(),
    move: ({ way }) => byId(way < 0.5 ? "earlier" : "later").click(),
    scrub: ({ way }) => {
      byId("scrub").value = Math.round(1000 * way);
      byId("scrub").dispatchEvent(new Event("input"));
    },
    wheel: ({ way, place }) => wheelOrPoint(place, (clientX) =>
      new WheelEvent("wheel", { ctrlKey: true, clientX, deltaY: 3000 * (way - 0.6) ** 3 })),
    point: ({ place }) => wheelOrPoint(place, (clientX) =>
      new PointerEvent("pointermove", { clientX })),
  };
  const wheelOrPoint = (place, event) => {
    const { left, width } = byId("x-chart").getBoundingClientRect();
    byId("x-chart").dispatchEvent(event(left + place * width));
  };
  const check = (say) => {
    for (const element of document.querySelectorAll("svg, svg *")) {
      for (const { name, value } of element.attributes) {
        if (nonsense.test(value)) say(`${element.tagName} ${name}=${value.slice(0, 60)}`);
      }
    }
    const text = document.body.innerText.match(/.{0,30}(NaN|Infinity|undefined)/);
    if (text) say(text[0]);
    const { from, to } = window.stickslip.view;
    if (!(from >= 0 && from < to && to < Infinity)) say(`from ${from} to ${to}`);
    for (const { value, textContent } of document.querySelectorAll("data")) {
      if (!Number.isFinite(Number(value)) && !/^(–|none)$/.test(textContent)) say(`data ${value}`);
    }
    for (const chart of document.querySelectorAll("#charts .chart, #results .chart")) {
      const box = chart.getBoundingClientRect();
      const marks = [...chart.querySelectorAll(".ticks text")];
      const level = marks.filter((mark) => mark.getAttribute("y") === marks[0].getAttribute("y"));
      for (const axis of [level, marks.filter((mark) => !level.includes(mark))]) {
        const texts = axis.map((mark) => mark.textContent);
        const { size } = new Set(texts);
        if (size !== texts.length || size < 2 || size > 50) say(`marks of ${chart.id}: ${texts}`);
      }
      for (const mark of marks) {
        const { left, right } = mark.getBoundingClientRect();
        if (left < box.left - 1 || right > box.right + 1) say(`cut: ${mark.textContent}`);
      }
    }
    if (document.scrollingElement.scrollWidth > innerWidth) say("wider than the window");
  };
  let refused = 0;
  for (const { p, after } of cases) {
    const say = (what) => {
      if (complaints.length < 20) complaints.push(`${what} at ${JSON.stringify({ p, after })}`);
    };
    try {
      window.stickslip.set(p);
    } catch (error) {
      if (!(error instanceof RangeError)) say(String(error));
      refused++;
      continue;
    }
    check(say);
    for (const act of after) acts[act.kind](act);
    check(say);
    byId("zoom-auto").click();
  }
  return { complaints, refused };
}
"""


def typed_anywhere(draw: Random) -> dict[str, float]:
    """Draw a setting [SI] from all that may be typed: each decade alike, often at an end."""
    text = (files("stickslip.page") / "controls" / "controls.toml").read_text(encoding="utf-8")
    p = {"g": 9.81}
    for control in tomllib.loads(text)["control"]:
        ends = control["least"], control["most"]
        # What may be 0 is drawn down to 1e-9 as well.
        inside = log_uniform(draw, max(ends[0], 1e-9), ends[1])
        usual = log_uniform(draw, max(control["low"], 1e-3), control["high"])
        p[control["name"]] = draw.choice([*ends, *[inside] * 8, *[usual] * 5])
    p["load"] = max(p.pop("N") - p["m"] * p["g"], -p["m"] * p["g"])
    # Independent draws seldom meet: no gap, no damping, and a damping that counts.
    p["mu_k"] = draw.choice([p["mu_k"], p["mu_s"], p["mu_s"] * draw.random()])
    swinging = 2.0 * log_uniform(draw, 1e-6, 10.0) * float(np.sqrt(p["k"] * p["m"]))
    p["c"] = min(draw.choice([p["c"], 0.0, swinging]), 1e18)
    return p


def deeds(draw: Random) -> Iterator[dict[str, Any]]:
    """Draw what a restless person does to a picture."""
    for _ in range(draw.randrange(12)):
        kind = draw.choice(["zoom", "zoom", "move", "scrub", "wheel", "point"])
        yield {"kind": kind, "way": draw.random(), "place": draw.random()}


@pytest.mark.parametrize("width", [WIDTH, NARROW])
def test_whatever_may_be_typed_is_shown_or_refused(
    browser: Browser, page_file: Path, width: int, sized: Callable[[int], int]
) -> None:
    """Over all that may be typed, and however it is looked at, every number drawn is a number."""
    draw = Random(f"extremes {width}")
    cases = [{"p": typed_anywhere(draw), "after": list(deeds(draw))} for _ in range(sized(120))]
    with opened(browser, page_file, width=width) as page:
        found = page.evaluate(_SHOW_ALL, cases)
    assert found["complaints"] == []
    # Refusing all would pass the rest.
    assert found["refused"] < 0.2 * len(cases)


def marks(page: Page, chart: str) -> list[str]:
    """Give the texts of all marks on the axes of a chart."""
    return page.locator(f"#{chart} .ticks text").all_text_contents()


def test_a_force_that_is_constant_to_the_last_bit_has_an_axis(page: Page) -> None:
    """Damped to rest and zoomed in 2^9 times, F is one number; its axis is still short and true."""
    pause(page)
    look(page, 0.0, 10.0)
    press(page, "c", "End")
    assert setting(page)["c"] == 100.0
    for button, times in {"zoom-in": 9, "later": 60}.items():
        page.evaluate(
            "([id, n]) => { while (n--) document.getElementById(id).click(); }",
            [f"{button}", times],
        )
    start, end = page.evaluate(
        "[window.stickslip.view.from, window.stickslip.view.to].map(t => window.stickslip.at(t).F)"
    )
    assert start == end
    for chart in ("x-chart", "F-chart", "phase-chart"):
        assert 4 <= len(set(marks(page, chart))) <= 30
    levels = page.locator("#F-chart .ticks text[text-anchor='start']").all_text_contents()
    # The axis spans 1e-9 of its values or little more: less is rounding, more would hide a motion.
    assert all(abs(float(level) - start) < 1e-8 * start for level in levels)
    assert len(levels) >= 2
    set_values(page, c=0.0)
    assert "jumps" in page.inner_text("#lead")


@pytest.mark.parametrize(
    "values",
    [
        {"mu_s": 0.5, "mu_k": 0.5, "v": 1e-9},
        pytest.param(
            {"k": 10.0, "m": 100.0, "v": 1e-4, "mu_s": 1.5, "mu_k": 1.5}, marks=pytest.mark.soak
        ),
    ],
    ids=["slow", "soft and heavy"],
)
def test_the_furthest_view_is_of_200_cycles_and_little_is_drawn(
    page: Page, values: Mapping[str, float]
) -> None:
    """However long the first load-up, zooming out ends at 200 cycles, drawn with few points."""
    set_values(page, **{**corner("no gap"), **values})
    longest = 0
    for _ in range(40):
        page.click("#zoom-out")
        longest = max(longest, *(len(path) for path in shown(page).values()))
    assert longest < MOST_DRAWN
    slips = page.evaluate(
        """() => {
          const { from, to } = window.stickslip.view;
          return window.stickslip.events(from, to).filter(e => e.kind === "break-away").length;
        }"""
    )
    # A break-away at either end is one more than the cycles between them.
    assert 190 <= slips <= 201


def test_an_unreachable_cycle_is_refused(browser: Browser, page_file: Path, page: Page) -> None:
    """A first load-up of more than 1e9 cycles is refused by link and by key, with the reason."""
    fragment = "&".join(f"{name}={value}" for name, value in UNREACHED.items())
    with opened(browser, page_file, fragment=fragment) as other:
        assert "1e9 cycles" in other.inner_text("#address-said")
        assert setting(other) == setting(page)
        assert "jumps" in other.inner_text("#lead")
        type_in(other, "k", "2000")
        assert setting(other)["k"] == 2000.0
    set_values(page, **{**UNREACHED, "g": 1.0})
    good, picture = setting(page), shown(page)
    type_in(page, "N", "1.4e13")
    assert "1e9 cycles" in said(page, "N")
    assert page.get_attribute("#N", "aria-invalid") == "true"
    assert (setting(page), shown(page)) == (good, picture)
    page.click("#zoom-in")
    assert page.evaluate("Number.isFinite(window.stickslip.at(window.stickslip.view.to).x)")


def test_a_force_below_its_slider_has_a_thumb_to_move(page: Page) -> None:
    """At N = 0.05, typed, the slider's ends make room, and arrows move it both ways."""
    type_in(page, "N", "0.05")
    assert normal_force(page) == pytest.approx(0.05, rel=1e-12)
    press(page, "N", "ArrowRight")
    above = normal_force(page)
    press(page, "N", "ArrowLeft", "ArrowLeft")
    assert normal_force(page) < 0.05 < above


def normal_force(page: Page) -> float:
    """Give m g + load [N]."""
    p = setting(page)
    return p["m"] * p["g"] + p["load"]


def test_absurd_turns_of_the_wheel_leave_a_view(page: Page) -> None:
    """However far a wheel says it has turned, with Ctrl, a finite stretch of time is seen."""
    for deltas in ([1e308] * 60, [-1e308] * 60, [1e308, -1e308] * 20, [5e-324, -5e-324, 1e308]):
        view = page.evaluate(
            """deltas => {
              const chart = document.getElementById("F-chart");
              const { left, right } = chart.getBoundingClientRect();
              deltas.forEach((deltaY, i) => chart.dispatchEvent(
                new WheelEvent("wheel", { ctrlKey: true, clientX: i % 2 ? left : right, deltaY }),
              ));
              return window.stickslip.view;
            }""",
            deltas,
        )
        assert 0.0 <= view["from"] < view["to"] < 1e6
        assert all("NaN" not in str(path) for path in shown(page).values())


def controls(path: str) -> list[Floats]:
    """Take the data of a path apart into pieces of two or four points [px]."""
    found = []
    here: list[float] = []
    for command, numbers in re.findall(r"([MLC])([^MLC]*)", path):
        values = [float(each) for each in numbers.split()]
        if command != "M":
            found.append(np.array([*here, *values]).reshape(-1, 2))
        here = values[-2:]
    return found


def points_on(piece: Floats, count: int = 8) -> Floats:
    """Give points on a straight or cubic piece, by de Casteljau's construction."""
    s = np.linspace(0.0, 1.0, count)[:, None, None]
    level = np.broadcast_to(piece, (count, *piece.shape))
    while level.shape[1] > 1:
        level = (1.0 - s) * level[:, :-1] + s * level[:, 1:]
    result: Floats = level[:, 0]
    return result


def states(page: Page, times: Floats, *names: str) -> list[Floats]:
    """Give quantities of the motion at some times [s], SI."""
    found = page.evaluate(
        """([times, names]) => {
          const states = times.map(t => window.stickslip.at(t));
          return names.map(name => states.map(state => state[name]));
        }""",
        [[float(t) for t in times], names],
    )
    return [np.array(each, dtype=float) for each in found]


def times(axis: drawing.TimeAxis, places: Floats) -> Floats:
    """Give the times [s] of places [px]."""
    return axis.start + (places - axis.left) / axis.width * axis.span


def scale(page: Page, chart: str, axis: Literal["x", "y"]) -> tuple[float, float]:
    """Give offset [px] and pixels per SI unit of an axis, read off its labels."""
    near, far = (drawing.value_at(page, chart, axis, place)[0] for place in (0.0, 1000.0))
    per_unit = 1000.0 / (far - near)
    return -near * per_unit, per_unit


@pytest.mark.parametrize("name", list(ENDLESS))
def test_a_slip_without_end_is_drawn_over_time_as_it_moves(page: Page, name: str) -> None:
    """Between its exact points the drawn force is the true one, to a fraction of a pixel."""
    values, zoomed_out = ENDLESS[name]
    pause(page)
    set_values(page, **values)
    assert page.evaluate("window.stickslip.cycle.exists") is False
    for _ in range(zoomed_out):
        page.click("#zoom-out")
    axis = drawing.time_axis(page, "F-chart")
    path = page.get_attribute("#F-chart .curve.force", "d") or ""
    drawn_points = np.concatenate([points_on(piece) for piece in controls(path)])
    offset, per_newton = scale(page, "F-chart", "y")
    # A place is rounded by 0.01 px either way; where the force is steep that is much force.
    around = [
        offset + per_newton * states(page, times(axis, drawn_points[:, 0] + shift), "F")[0]
        for shift in (-PIXEL, 0.0, PIXEL)
    ]
    height = float(page.get_attribute("#F-chart clipPath rect", "height") or "")
    # No swing is higher than the plot; 0.05 px is the reading of the axis.
    tolerance = COARSE**4 / 384.0 * 0.5 * height + PIXEL + 0.05
    assert tolerance < 0.3
    off = np.maximum(
        np.min(around, axis=0) - drawn_points[:, 1], drawn_points[:, 1] - np.max(around, axis=0)
    )
    assert float(np.max(off)) <= tolerance
    assert drawn_points[0, 0] == pytest.approx(axis.left, abs=PIXEL)
    assert drawn_points[-1, 0] == pytest.approx(axis.left + axis.width, abs=PIXEL)


def farthest(points: Floats, line: Floats) -> float:
    """Give how far a point is from a line of many points, at most [px]."""
    start, along = line[:-1], np.diff(line, axis=0)
    length = np.maximum(np.sum(along**2, axis=1), 1e-12)
    worst = 0.0
    for few in np.array_split(points, len(points) // 100 + 1):
        apart = few[:, None] - start
        share = np.clip(np.sum(apart * along, axis=2) / length, 0.0, 1.0)
        gap = apart - share[..., None] * along
        worst = max(worst, float(np.max(np.min(np.sum(gap**2, axis=2), axis=1))))
    return float(np.sqrt(worst))


@pytest.mark.parametrize("name", list(ENDLESS))
def test_a_slip_without_end_is_drawn_in_the_portrait_as_it_moves(page: Page, name: str) -> None:
    """The drawn spiral lies on the true one and leaves none of its first swings out."""
    values, _ = ENDLESS[name]
    pause(page)
    set_values(page, **values)
    path = page.get_attribute("#phase-chart .curve.mass", "d") or ""
    slip = controls(path)
    spiral = np.concatenate([points_on(piece, 6) for piece in slip])
    p = setting(page)
    first = float(page.evaluate("window.stickslip.events(0, 1e3)[0].t"))
    w = np.sqrt(p["k"] / p["m"])
    # 19 swings, or where nothing swings every pace from the fast decay to the slow one.
    swings = p["c"] ** 2 < 4.0 * p["k"] * p["m"]
    taus = (np.arange(0.0, 38.0 * np.pi, 0.03) if swings else np.geomspace(1e-6, 3e3, 3000)) / w
    z, x_dot = states(page, first + taus, "z", "x_dot")
    (left, per_metre), (top, per_speed) = (scale(page, "phase-chart", axis) for axis in ("x", "y"))
    true = np.stack([left + per_metre * z, top + per_speed * x_dot], axis=1)
    height = float(page.get_attribute("#phase-chart clipPath rect", "height") or "")
    width = float(page.get_attribute("#phase-chart clipPath rect", "width") or "")
    # Rounding and axis as over time; a chord over h radians is h^2/8 of the radius off.
    size = 0.5 * float(np.hypot(width, height))
    tolerance = FINE**4 / 384.0 * size + PIXEL + 0.07 + (FINE / 5) ** 2 / 8.0 * size
    assert tolerance < 0.3
    assert farthest(true[::3], spiral) <= tolerance
    # A swing takes 15 of the cubics or more, so 18 swings are in the true ones.
    inside = spiral[: 18 * 15 * 6] if swings else spiral
    assert farthest(inside, true) <= tolerance
