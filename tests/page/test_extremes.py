"""At the ends of what can be set and zoomed: the page lives, and what it draws is the motion."""

from collections.abc import Callable, Mapping
from random import Random
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.page import drawing
from tests.page.drawing import PIXEL, Piece
from tests.page.settings import CORNERS, log_uniform, table
from tests.page.window import Window

Floats = NDArray[np.float64]

COARSE = 0.8
"""Radians of the motion that one drawn cubic spans, at most.

Between exact points with exact slopes a cubic errs by h^4/384 of the fourth derivative, for a swing
by 1.1e-3 of its amplitude (C. de Boor, A Practical Guide to Splines, chapter V).
"""

MOST_DRAWN = 201 * 9 * 6 * 8
"""Characters of a curve of 201 cycles: 2 pi / COARSE cubics each and one for the stick; six numbers
a cubic, of up to eight characters."""

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
    p = {"g": 9.81}
    for control in table("controls", "control"):
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


def deeds(draw: Random) -> list[dict[str, Any]]:
    """Draw what a restless person does to a picture."""
    kinds = ["zoom", "zoom", "move", "scrub", "wheel", "point"]
    return [
        {"kind": draw.choice(kinds), "way": draw.random(), "place": draw.random()}
        for _ in range(draw.randrange(12))
    ]


@pytest.mark.parametrize("width", [320, 1280])
def test_whatever_may_be_typed_is_shown_or_refused(
    window: Window, width: int, sized: Callable[[int], int]
) -> None:
    draw = Random(f"extremes {width}")
    cases = [{"p": typed_anywhere(draw), "after": deeds(draw)} for _ in range(sized(120))]
    cases += [{"p": values, "after": []} for values in CORNERS.values()]
    window.page.set_viewport_size({"width": width, "height": 800})
    window.drawn()
    found = window.js(_SHOW_ALL, cases)
    assert found["complaints"] == []
    # Refusing all would pass the rest.
    assert found["refused"] < 0.2 * len(cases)


def test_a_force_that_is_constant_to_the_last_bit_has_a_short_and_true_axis(
    window: Window,
) -> None:
    window.look(0.0, 10.0)
    window.set(c=100.0)
    for button, times in {"zoom-in": 9, "later": 60}.items():
        clicks = "([id, n]) => { while (n--) document.getElementById(id).click(); }"
        window.js(clicks, [button, times])
    start, end = (each["F"] for each in window.states(window.view))
    assert start == end
    for chart in ("x-chart", "F-chart", "phase-chart"):
        marks = window.page.locator(f"#{chart} .ticks text").all_text_contents()
        assert 4 <= len(set(marks)) <= 30
    levels = window.page.locator("#F-chart .ticks text[text-anchor='start']").all_text_contents()
    # The axis spans 1e-9 of its values or little more: less is rounding, more would hide a motion.
    assert all(abs(float(level) - start) < 1e-8 * start for level in levels)
    assert len(levels) >= 2


def test_the_furthest_view_is_of_200_cycles_and_little_is_drawn(window: Window) -> None:
    window.set(**{**CORNERS["no gap"], "v": 1e-9})
    longest = 0
    for _ in range(40):
        window.js("document.getElementById('zoom-out').click()")
        longest = max(longest, *(len(path) for path in window.paths().values()))
    assert longest < MOST_DRAWN
    events = window.js("v => stickslip.events(...v)", [*window.view])
    slips = sum(each["kind"] == "break-away" for each in events)
    # A break-away at either end is one more than the cycles between them.
    assert 190 <= slips <= 201


def points_on(piece: Piece, count: int = 8) -> Floats:
    """Return points on a straight or cubic piece [px], by de Casteljau's construction."""
    s = np.linspace(0.0, 1.0, count)[:, None, None]
    level = np.broadcast_to(np.array(piece.points), (count, len(piece.points), 2))
    while level.shape[1] > 1:
        level = (1.0 - s) * level[:, :-1] + s * level[:, 1:]
    found: Floats = level[:, 0]
    return found


@pytest.mark.parametrize("name", ENDLESS)
def test_a_slip_without_end_is_drawn_as_it_moves(window: Window, name: str) -> None:
    values, zoomed_out = ENDLESS[name]
    window.set(**values)
    assert window.cycle["exists"] is False
    for _ in range(zoomed_out):
        window.page.click("#zoom-out")
    axis = drawing.time_axis(window, "F-chart")
    curve = drawing.curve(window, "#F-chart .curve.force")
    points = np.concatenate([points_on(piece) for piece in curve])
    near, far = (drawing.value_at(window, "F-chart", "y", at)[0] for at in (0.0, 1000.0))
    offset, per_newton = -1000.0 * near / (far - near), 1000.0 / (far - near)
    # A place is rounded by 0.01 px either way; where the force is steep that is much force.
    around = [
        [
            offset + per_newton * state["F"]
            for state in window.states([axis.time(x + shift) for x in points[:, 0]])
        ]
        for shift in (-PIXEL, 0.0, PIXEL)
    ]
    height = float(window.part("#F-chart clipPath rect", "height"))
    # No swing is higher than the plot; 0.05 px is the reading of the axis.
    tolerance = COARSE**4 / 384.0 * 0.5 * height + PIXEL + 0.05
    assert tolerance < 0.3
    assert float(np.max(np.min(around, axis=0) - points[:, 1])) <= tolerance
    assert float(np.max(points[:, 1] - np.max(around, axis=0))) <= tolerance
    ends = [axis.left, axis.left + axis.width]
    assert [points[0, 0], points[-1, 0]] == pytest.approx(ends, abs=PIXEL)
