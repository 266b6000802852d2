"""What the page remembers, and what it lets go: address, asked mu_k, zoom, cursor, complaints."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from tests.page import drawing
from tests.page.browser import opened
from tests.page.drawing import PIXEL
from tests.page.settings import presets
from tests.page.test_cursor import check_readings
from tests.page.test_presets import START, pressed
from tests.page.test_zoom import choose, place, view
from tests.page.using import (
    drag,
    drawn,
    look,
    pause,
    press,
    said,
    set_values,
    setting,
    shown,
    type_in,
)

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


def go_to(page: Page, fragment: str, ready: str) -> None:
    """Put a setting into the address bar of an open page, and wait till it is taken."""
    page.evaluate("fragment => (location.hash = fragment)", fragment)
    page.wait_for_function(ready)
    drawn(page)


def again(page: Page) -> None:
    """Load the page anew, with the address that it has now."""
    page.reload()
    page.wait_for_function("window.stickslip !== undefined")
    pause(page)


def test_a_pasted_address_shows_its_whole_picture(
    browser: Browser, page_file: Path, page: Page
) -> None:
    """A link shows in a used and zoomed window what it shows in a fresh one."""
    pause(page)
    look(page, 0.0, 10.0)
    choose(page, "x-chart", 4.0, 4.2)
    fragment = "k=2000&v=0.05"
    go_to(page, fragment, "window.stickslip.setting.k === 2000")
    with opened(browser, page_file, fragment=fragment) as fresh:
        assert view(page) == view(fresh)
        assert setting(page) == setting(fresh)
        assert shown(page) == shown(fresh)


@pytest.mark.parametrize("way", ["typed", "slid", "preset", "script"])
def test_a_complaint_about_an_address_ends_with_something_good(page: Page, way: str) -> None:
    """What was wrong with a link is past once another setting is in use."""
    go_to(page, "k=-5", "document.querySelector('#address-said').textContent !== ''")
    assert page.is_visible("#address-said")
    if way == "typed":
        type_in(page, "k", "2000")
    elif way == "slid":
        press(page, "v", "ArrowRight")
    elif way == "preset":
        page.click("[data-preset=violin-bow]")
    else:
        set_values(page, k=2000.0)
    assert page.inner_text("#address-said") == ""


def test_a_bad_part_of_an_address_costs_no_good_part(browser: Browser, page_file: Path) -> None:
    """Each part that can be taken is; each that cannot is named with its reason."""
    fragment = "k=2000&v=abc&stiffness=5&m=2&mu_s=-1&g=1e99&c="
    with opened(browser, page_file, fragment=fragment) as page:
        assert setting(page) == {**START, "k": 2000.0, "m": 2.0}
        complaint = page.inner_text("#address-said")
        for part in ("v=abc", "stiffness", "mu_s", "g:", "c="):
            assert part in complaint
        assert "k" not in [word.strip(":") for word in complaint.split()]


def test_the_asked_kinetic_coefficient_outlives_a_reload(page: Page) -> None:
    """The address keeps the mu_k that was asked, not the one in use, so it can come back."""
    pause(page)
    drag(page, "mu_s", 0.1)
    low = setting(page)
    assert low["mu_k"] == low["mu_s"] - 0.01
    page.wait_for_function("location.hash.includes('mu_s=0.15&mu_k=0.3&')")
    again(page)
    assert setting(page) == low
    assert "0.3" in said(page, "mu_k")
    drag(page, "mu_s", 0.5)
    assert setting(page)["mu_k"] == 0.3
    assert said(page, "mu_k") == ""


def test_a_preset_outlives_a_reload(page: Page) -> None:
    """Loaded anew, the page shows the same preset, chosen, and its whole picture."""
    page.click("[data-preset=fault-block]")
    page.wait_for_function("location.hash.includes('k=3000000000000')")
    before = view(page)
    again(page)
    assert setting(page) == presets()["fault-block"]
    assert pressed(page) == ["fault-block"]
    assert view(page) == before


def test_of_many_presets_pressed_fast_the_last_holds(page: Page) -> None:
    """A hundred presses in one breath end in one setting, one chosen preset and one address."""
    page.evaluate(
        """() => {
          const all = document.querySelectorAll("[data-preset]");
          for (let i = 0; i < 100; i++) all[i % all.length].click();
        }"""
    )
    drawn(page)
    last = list(presets())[99 % len(presets())]
    assert pressed(page) == [last]
    assert setting(page) == presets()[last]
    page.wait_for_function("k => location.hash.startsWith('#k=' + k)", arg=presets()[last]["k"])


def test_two_pages_do_not_share_their_memory(browser: Browser, page_file: Path, page: Page) -> None:
    """What is set in one window is not set in another."""
    with opened(browser, page_file) as other:
        type_in(page, "k", "2000")
        other.click("[data-preset=brake-pad]")
        assert setting(page) == {**START, "k": 2000.0}
        assert setting(other) == presets()["brake-pad"]


def test_scrubbing_while_it_plays_stops_at_the_chosen_place(page: Page) -> None:
    """The cursor stays where it was put, not where the play had come to."""
    assert page.text_content("#play") == "Pause"
    look(page, 0.0, 10.0)
    page.fill("#scrub", "732")
    assert page.text_content("#play") == "Play"
    for _ in range(3):
        drawn(page)
    assert page.input_value("#scrub") == "732"
    axis = drawing.time_axis(page)
    assert abs(drawing.cursor(page, "x-chart") - axis.place(7.32)) <= PIXEL
    check_readings(page, 7.32)


def test_the_cursor_stays_under_a_resting_pointer(page: Page) -> None:
    """Where the picture changes under the pointer, years to seconds, it reads what is there."""
    pause(page)
    look(page, 0.0, 10.0)
    left, top = place(page, "x-chart", 4.0)
    page.mouse.move(round(left), top)
    before = drawing.cursor(page, "x-chart")
    share = (before - drawing.time_axis(page).left) / drawing.time_axis(page).width
    for name in ("fault-block", "violin-bow", "default"):
        page.evaluate("id => document.querySelector(`[data-preset=${id}]`).click()", name)
        drawn(page)
        axis = drawing.time_axis(page)
        assert abs(drawing.cursor(page, "x-chart") - before) <= PIXEL
        # The cursor's place is known to half a fiftieth of a pixel; the read-out to a thousandth.
        shown_time = drawing_time(page)
        assert abs(shown_time - axis.start - share * axis.span) <= 2e-3 * axis.span


def drawing_time(page: Page) -> float:
    """Give the time [s] that is read at the cursor."""
    number, unit = page.inner_text("#now").split(",")[0].replace("\u00a0", " ").split()
    return float(number) * drawing.SIZES[unit]


def test_escape_ends_a_choice_that_has_begun(page: Page) -> None:
    """Who drags over a chart by mistake presses Escape, and the picture stays."""
    pause(page)
    look(page, 0.0, 10.0)
    page.mouse.move(*place(page, "x-chart", 3.0))
    page.mouse.down()
    page.mouse.move(*place(page, "x-chart", 5.0), steps=3)
    page.keyboard.press("Escape")
    assert page.get_attribute("#x-chart .choice", "visibility") == "hidden"
    page.mouse.up()
    assert view(page) == (0.0, 10.0)


def test_what_changes_from_frame_to_frame_is_not_announced(page: Page) -> None:
    """While it plays, no live region changes: a screen reader is not talked to sixty times."""
    assert page.locator("output").count() == 0
    spoken = page.evaluate(
        """() => new Promise(done => {
          const heard = [];
          const live = "[aria-live]:not([aria-live=off]), [role=status], [role=alert], output";
          const changed = new Set();
          new MutationObserver(all => all.forEach(({ target }) => {
            const element = target.nodeType === 1 ? target : target.parentElement;
            changed.add(element.id);
            const region = element.closest(live);
            if (region) heard.push(region.id);
          })).observe(document.body, { subtree: true, childList: true, characterData: true });
          const after = (frames) => requestAnimationFrame(() => {
            if (frames > 20 && changed.has("x-now") || frames > 1000) {
              done({ heard, changed: [...changed] });
            } else {
              after(frames + 1);
            }
          });
          after(0);
        })"""
    )
    assert "x-now" in spoken["changed"]
    # The one sentence on the whole cycle is said once, after loading.
    assert [each for each in spoken["heard"] if each != "told"] == []
    assert spoken["heard"].count("told") <= 1


def test_what_is_told_of_the_cursor_is_fresh(page: Page) -> None:
    """Paused, a new value changes at once what a screen reader says of the scrubber."""
    pause(page)
    look(page, 0.0, 10.0)
    page.fill("#scrub", "600")
    before = page.get_attribute("#scrub", "aria-valuetext")
    type_in(page, "v", "25")
    drawn(page)
    after = page.get_attribute("#scrub", "aria-valuetext") or ""
    assert after != before
    assert "pulled end at 150" in after


def test_a_number_given_as_text_becomes_a_number(page: Page) -> None:
    """A script that hands over "1000" gets the setting, the cycle and the address of 1000."""
    for name, text in {"k": "2000", "mu_k": "0.2", "v": " 0.05 "}.items():
        page.evaluate("values => window.stickslip.set(values)", {name: text})
    used: dict[str, Any] = page.evaluate("window.stickslip.setting")
    assert used == {**START, "k": 2000.0, "mu_k": 0.2, "v": 0.05}
    assert {type(value) for value in used.values()} <= {int, float}
    by_text = page.evaluate("window.stickslip.cycle")
    set_values(page, k=2000.0, mu_k=0.2, v=0.05)
    assert page.evaluate("window.stickslip.cycle") == by_text


def test_the_browsers_back_undoes_a_press(page: Page) -> None:
    """Own values that a preset has replaced come back, and with them no ghost."""
    pause(page)
    type_in(page, "k", "2345")
    type_in(page, "v", "12")
    own = setting(page)
    page.click("[data-preset=brake-pad]")
    drawn(page)
    assert setting(page) == presets()["brake-pad"]
    page.evaluate("history.back()")
    page.wait_for_function("window.stickslip.setting.k === 2345")
    assert setting(page) == own
    page.evaluate("window.stickslip.compare({ k: 4000 })")
    drawn(page)
    assert page.is_visible("#forget")
