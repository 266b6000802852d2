"""The stage: block, teeth, spring, force bar, marks, and the curve of the setting before."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import pytest

from stickslip_ref import Parameters
from tests.page import drawing
from tests.page.drawing import PIXEL, SIZES
from tests.page.settings import CORNERS, corner, presets
from tests.page.using import drawn, look, pause, set_values, setting

if TYPE_CHECKING:
    from playwright.sync_api import Page

_STAGE = """
shares => {
  const scrub = document.querySelector("#scrub");
  const schematic = document.querySelector("#schematic");
  const part = (selector, name) => schematic.querySelector(selector).getAttribute(name);
  const { from, to } = window.stickslip.view;
  return shares.map(share => {
    scrub.value = 1000 * share;
    scrub.dispatchEvent(new Event("input", { bubbles: true }));
    const state = window.stickslip.at(from + scrub.value / 1000 * (to - from));
    const points = part(".spring", "points").split(" ").map(each => Number(each.split(",")[0]));
    return {
      state,
      block: Number(part(".mass", "transform").match(/[(]([-\\d.]+)/)[1]),
      wide: Number(part(".mass rect", "width")),
      spring: [points[0], points.at(-1)],
      gauge: Number(part(".gauge", "transform").match(/[(]([-\\d.]+)/)[1]),
      bar: [Number(part(".bar", "x")), Number(part(".bar", "width"))],
      limit: Number(part(".limit", "d").match(/M([-\\d.]+)/)[1]),
      places: (part(".places", "d").match(/M[-\\d.]+/g) ?? []).map(each => Number(each.slice(1))),
      teeth: part(".mass path.body", "d"),
    };
  });
}
"""
SHARES = [n / 40 for n in range(40)]


def stage(page: Page) -> list[dict[str, Any]]:
    """Give state and drawing at 40 moments of the view."""
    found: list[dict[str, Any]] = page.evaluate(_STAGE, SHARES)
    return found


def scale(moments: list[dict[str, Any]]) -> float:
    """Give pixels per metre of the stage, from two places of the block in one window."""
    first, last = moments[0], moments[-1]
    return float((last["block"] - first["block"]) / (last["state"]["x"] - first["state"]["x"]))


def test_the_block_stands_where_the_motion_has_it(page: Page) -> None:
    """In every preset block, spring and pulled end are drawn to one scale over the whole view."""
    pause(page)
    for name in presets():
        page.click(f"[data-preset={name}]")
        drawn(page)
        moments = stage(page)
        per_metre = scale(moments)
        origin = moments[0]
        for each in moments:
            state = each["state"]
            moved = per_metre * (state["x"] - origin["state"]["x"])
            assert each["block"] - origin["block"] == pytest.approx(moved, abs=2 * PIXEL)
            assert each["spring"][0] == pytest.approx(each["block"] + each["wide"], abs=2 * PIXEL)
            pulled = per_metre * (state["x_pull"] - origin["state"]["x_pull"])
            assert each["spring"][1] - origin["spring"][1] == pytest.approx(pulled, abs=3 * PIXEL)


def test_the_teeth_give_where_the_bar_meets_its_mark(page: Page) -> None:
    """The force bar ends at the pulled end; it reaches the mark F_s exactly at break-away."""
    pause(page)
    for each in stage(page):
        end = each["gauge"] + each["bar"][0] + each["bar"][1]
        assert end == pytest.approx(each["spring"][1], abs=3 * PIXEL)
    start, end = (page.evaluate("window.stickslip.view")[side] for side in ("from", "to"))
    events = page.evaluate("([a, b]) => window.stickslip.events(a, b)", [start, end])
    t = next(each["t"] for each in events if each["kind"] == "break-away")
    look(page, t, t + 1.0)
    moment = stage(page)[0]
    assert moment["state"]["t"] == t
    assert sum(moment["bar"]) == pytest.approx(moment["limit"], abs=2 * PIXEL)


def test_the_bar_ends_at_the_pulled_end_in_every_preset(page: Page) -> None:
    """Bar and spring have one scale, also where the picture begins at a spring that is not relaxed.

    Its mark lies ahead of its end by the extension that is missing to break-away.
    """
    pause(page)
    cut = set()
    for name in presets():
        page.click(f"[data-preset={name}]")
        drawn(page)
        moments = stage(page)
        per_metre = scale(moments)
        longest = page.evaluate("window.stickslip.cycle.F_s / window.stickslip.setting.k")
        for each in moments:
            # A pushed spring has its bar on the other side of no force.
            end = each["bar"][0] + (each["bar"][1] if each["state"]["z"] > 0.0 else 0.0)
            assert each["gauge"] + end == pytest.approx(each["spring"][1], abs=3 * PIXEL), name
            missing = per_metre * (longest - each["state"]["z"])
            assert each["limit"] - end == pytest.approx(missing, abs=4 * PIXEL), name
        relaxed = moments[0]["spring"][1] - per_metre * moments[0]["state"]["z"]
        if relaxed < moments[0]["block"] + moments[0]["wide"]:
            cut.add(name)
    assert cut
    assert cut != set(presets())


def test_the_ruler_reads_the_position_of_the_mass(page: Page) -> None:
    """The pointer below the middle of the block stands at x on the ruler, in every window."""
    pause(page)
    for name in presets():
        page.click(f"[data-preset={name}]")
        drawn(page)
        unit = SIZES[page.text_content("#schematic .ruler .unit") or ""]
        per_metre = scale(stage(page))
        for step in (0, 450, 999):
            page.fill("#scrub", str(step))
            (moment,) = page.evaluate(_STAGE, [step / 1000])
            pointer = moment["block"] + 0.5 * moment["wide"]
            labels = page.eval_on_selector_all(
                "#schematic .ruler text:not(.unit)",
                "all => all.map(each => [each.textContent, +each.getAttribute('x')])",
            )
            text, at = next(each for each in labels if each[0])
            read = unit * float(text.replace("−", "-")) + (pointer - at) / per_metre
            slack = 3 * PIXEL / per_metre
            assert read == pytest.approx(moment["state"]["x"], abs=slack), (name, step)


def test_the_centre_of_the_portrait_is_steady_sliding(page: Page) -> None:
    """There the mass moves with the pull, and the spring holds friction and damping."""
    pause(page)
    for values in ({}, {"c": 20.0}, {"c": 20.0, "v": 0.3}):
        set_values(page, **values)
        p = Parameters(**setting(page))
        path = page.get_attribute("#phase-chart .centre", "d") or ""
        left, top = (float(each) for each in re.findall(r"[\d.]+", path)[:2])
        z, slack = drawing.value_at(page, "phase-chart", "x", left + 5.0)
        assert z == pytest.approx((float(p.mu_k_used * p.N) + p.c * p.v) / p.k, abs=slack)
        x_dot, slack = drawing.value_at(page, "phase-chart", "y", top)
        assert x_dot == pytest.approx(p.v, abs=slack)


def test_the_marks_are_the_places_where_the_mass_stood(page: Page) -> None:
    """Each outline is a whole jump from the next, all behind the block, none in front of it."""
    pause(page)
    moments = stage(page)
    jump = scale(moments) * page.evaluate("window.stickslip.cycle.delta_x")
    most = 0
    for each in moments:
        behind = [*each["places"], each["block"]] if each["state"]["mode"] == 0 else each["places"]
        gaps = [b - a for a, b in pairwise(behind)]
        assert gaps == pytest.approx([jump] * len(gaps), abs=3 * PIXEL)
        assert all(place < each["block"] for place in each["places"])
        most = max(most, len(each["places"]))
    assert most == 6


def test_in_stick_the_teeth_of_the_block_stand_in_those_of_the_ground(page: Page) -> None:
    """Wherever the block stops, its teeth begin where a tooth of the ground does."""
    pause(page)
    for each in stage(page):
        if each["state"]["mode"] != 0:
            continue
        begin = float(re.match(r"M([-\d.]+)", each["teeth"])[1])  # type: ignore[index]
        place = (each["block"] + begin) / 8.0
        assert place == pytest.approx(round(place), abs=0.01)


def test_the_stage_lives_at_the_corners(page: Page) -> None:
    """Without friction, without a gap, without a cycle: every number drawn is a number."""
    pause(page)
    for name in CORNERS:
        set_values(page, **corner(name))
        for each in stage(page):
            assert "NaN" not in str(each), name
            assert -1e4 < each["block"] < 1e4, name


def test_the_first_frame_is_not_before_the_start(page: Page) -> None:
    """A frame whose stamp lies before Play was pressed shows the start, not a time before it."""
    pause(page)
    page.fill("#scrub", "0")
    earliest = page.evaluate(
        """() => new Promise(done => {
          const ask = window.requestAnimationFrame;
          window.requestAnimationFrame = act => ask(stamp => act(stamp - 40));
          const cursor = document.querySelector("#x-chart .cursor");
          const left = () => Number(cursor.getAttribute("d").match(/M([-\\d.]+)/)[1]);
          let least = left();
          document.querySelector("#play").click();
          const look = frames => ask(() => {
            least = Math.min(least, left());
            if (frames) look(frames - 1); else done(least);
          });
          look(5);
        })"""
    )
    assert earliest >= float(page.get_attribute("#x-chart clipPath rect", "x") or "")
    assert page.text_content("#play") == "Pause"


def test_the_setting_before_stays_as_a_ghost_until_it_is_removed(page: Page) -> None:
    """A preset's countermeasure leaves the old curves: the very paths, from the same corner on."""
    pause(page)
    before = page.evaluate("window.stickslip.cycle")
    page.evaluate("window.stickslip.compare({ k: 2000 })")
    drawn(page)
    ghost = drawing.curve(page, "#x-chart .curve.ghost")
    axis = drawing.time_axis(page)
    cycle = page.evaluate("window.stickslip.cycle")
    assert page.is_visible("#forget")
    start = axis.start
    # The first stick of the ghost begins with that of the curve and lasts as long as it did.
    (first, *_) = drawing.lines(ghost)
    assert first.start[0] == pytest.approx(axis.place(start), abs=PIXEL)
    assert first.end[0] == pytest.approx(axis.place(start + before["t_stick"]), abs=PIXEL)
    rise = first.start[1] - drawing.lines(ghost)[1].start[1]
    (own, next_own, *_) = drawing.lines(drawing.curve(page, "#x-chart .curve.mass"))
    jump = before["delta_x"] / cycle["delta_x"]
    assert rise / (own.start[1] - next_own.start[1]) == pytest.approx(jump, abs=0.01)
    # Of both some cycles are seen.
    assert axis.span >= 5.9 * before["T"]
    page.click("#forget")
    drawn(page)
    assert not page.is_visible("#forget")
    assert drawing.curve(page, "#x-chart .curve.ghost") == []
