"""At the ends of what can be set and zoomed: the page lives, and what it draws is the motion."""

from collections.abc import Callable, Mapping
from random import Random
from typing import Any

import numpy as np
import pytest

from tests.fmu.blocks import log_uniform
from tests.page import drawing
from tests.page.drawing import PIXEL
from tests.page.settings import CORNERS, table
from tests.page.window import Window

COARSE = 0.8
"""Radians of the motion that one drawn cubic spans, at most.

Between exact points with exact slopes a cubic errs by h^4/384 of the fourth derivative, for a swing
by 1.1e-3 of its amplitude (C. de Boor, A Practical Guide to Splines, chapter V).
"""


ENDLESS: dict[str, tuple[Mapping[str, float], int]] = {
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
    wheel: ({ way, place }) => {
      const { left, width } = byId("x-chart").getBoundingClientRect();
      const [clientX, deltaY] = [left + place * width, 3000 * (way - 0.6) ** 3];
      byId("x-chart").dispatchEvent(new WheelEvent("wheel", { ctrlKey: true, clientX, deltaY }));
    },
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
      const marks = [...chart.querySelectorAll(".ticks text")];
      const level = marks.filter((mark) => mark.getAttribute("y") === marks[0].getAttribute("y"));
      for (const axis of [level, marks.filter((mark) => !level.includes(mark))]) {
        const texts = axis.map((mark) => mark.textContent);
        const { size } = new Set(texts);
        if (size !== texts.length || size < 2 || size > 50) say(`marks of ${chart.id}: ${texts}`);
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
    kinds = ["zoom", "zoom", "move", "scrub", "wheel"]
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


def test_the_furthest_view_is_of_200_cycles_and_little_is_drawn(window: Window) -> None:
    window.set(**{**CORNERS["no gap"], "v": 1e-9})
    window.js("() => { for (let n = 0; n < 40; n++) document.getElementById('zoom-out').click(); }")
    # 201 cycles of 2 pi / COARSE cubics and one for the stick, of six numbers of 8 characters.
    assert max(len(path) for path in window.paths().values()) < 201 * 9 * 6 * 8
    events = window.js("v => stickslip.events(...v)", [*window.view])
    slips = sum(each["kind"] == "break-away" for each in events)
    # A break-away at either end is one more than the cycles between them.
    assert 190 <= slips <= 201


@pytest.mark.parametrize("name", ENDLESS)
def test_a_slip_without_end_is_drawn_as_it_moves(window: Window, name: str) -> None:
    values, zoomed_out = ENDLESS[name]
    window.set(**values)
    assert window.cycle["exists"] is False
    for _ in range(zoomed_out):
        window.page.click("#zoom-out")
    axis = drawing.time_axis(window, "F-chart")
    curve = drawing.curve(window, "#F-chart .curve.force")
    # The ends of its pieces, and their middles by de Casteljau's construction.
    weights = {2: np.array([1, 1]) / 2, 4: np.array([1, 3, 3, 1]) / 8}
    middles = [weights[len(piece.points)] @ np.array(piece.points) for piece in curve]
    points = np.array([*(piece.end for piece in curve), *middles])
    near, far = (drawing.value_at(window, "F-chart", "y", at)[0] for at in (0.0, 1000.0))
    # A place is rounded by 0.01 px either way; where the force is steep that is much force.
    around = []
    for shift in (-PIXEL, 0.0, PIXEL):
        states = window.states([axis.time(x + shift) for x in points[:, 0]])
        around.append([1000.0 * (state["F"] - near) / (far - near) for state in states])
    height = float(window.part("#F-chart clipPath rect", "height"))
    # No swing is higher than the plot; 0.05 px is the reading of the axis.
    tolerance = COARSE**4 / 384.0 * 0.5 * height + PIXEL + 0.05
    assert tolerance < 0.3
    assert float(np.max(np.min(around, axis=0) - points[:, 1])) <= tolerance
    assert float(np.max(points[:, 1] - np.max(around, axis=0))) <= tolerance
