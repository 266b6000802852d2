"""The guided story: its steps, their links, and that it changes nothing before it is asked."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from tests.page.browser import opened
from tests.page.settings import presets, table
from tests.page.using import drawn, press, setting, shown

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

ROWS = table("story")["step"]
STEPS = {
    n: {**presets()[row.get("preset", "default")], **row.get("set", {})}
    for n, row in enumerate(ROWS, 1)
}
"""The setting of each step, SI, as it is written down."""


def open_steps(page: Page) -> list[int]:
    """Give the numbers of the steps that can be seen."""
    return [n for n in STEPS if page.is_visible(f"[id='step={n}']")]


def address(page: Page, wanted: str) -> None:
    """Wait until the address asks for this."""
    page.wait_for_function("wanted => location.hash.startsWith(wanted)", arg=f"#{wanted}")


def test_the_story_waits_until_it_is_started(page: Page) -> None:
    """At first its first step is read and the start button seen; setting and address are others."""
    assert 10 <= len(STEPS) <= 12
    assert open_steps(page) == [1]
    assert setting(page) == presets()["default"] != STEPS[1]
    address(page, "k=1000")
    assert page.is_visible("#story-start")
    assert not page.is_visible("#story-next")


def test_next_and_back_lead_through_the_steps(page: Page) -> None:
    """Each step sets exactly its setting, shows its text alone, and its heading has the focus."""
    page.click("#story-start")
    assert not page.is_visible("#story-start")
    way = [*STEPS, *reversed(range(1, len(STEPS)))]
    for before, n in zip([0, *way], way, strict=False):
        if n > 1 or before > 1:
            page.press("#story-next" if n > before else "#story-back", "Enter")
        assert open_steps(page) == [n]
        assert setting(page) == STEPS[n]
        heading = page.evaluate("document.activeElement.textContent")
        assert heading == f"Step {n} of {len(STEPS)} {ROWS[n - 1]['title']}"
        assert page.is_disabled("#story-back") == (n == 1)
        assert page.is_disabled("#story-next") == (n == len(STEPS))
        assert page.locator(".steps [aria-current=step]").count() == 1
        drawn(page)
        from_start = ROWS[n - 1].get("from") == "start"
        if from_start or page.evaluate("window.stickslip.cycle.exists"):
            assert (page.evaluate("window.stickslip.view.from") == 0.0) == from_start, n
        assert "NaN" not in page.inner_text("body")
        assert all("NaN" not in str(path) for path in shown(page).values())
    address(page, "step=1")


def test_a_link_opens_any_step(browser: Browser, page_file: Path) -> None:
    """In a fresh window, of a phone or a desktop, its step is set and stands beneath the stage."""
    for n, values in STEPS.items():
        width = 390 if n % 2 else 1280
        with opened(browser, page_file, width=width, fragment=f"step={n}") as page:
            assert setting(page) == values
            assert open_steps(page) == [n]
            page.wait_for_function(
                """step => {
                  const stage = document.querySelector("#stage").getBoundingClientRect();
                  const { top } = document.getElementById(step).getBoundingClientRect();
                  return top >= stage.bottom && top < 0.6 * innerHeight;
                }""",
                arg=f"step={n}",
            )
            address(page, f"step={n}")


def test_the_dotted_curve_is_the_step_that_is_named(browser: Browser, page_file: Path) -> None:
    """A step that compares shows the same dotted curves by Next and by a link in a fresh window."""
    comparing = [n for n, row in enumerate(ROWS, 1) if "over" in row]
    assert len(comparing) >= 3
    with opened(browser, page_file) as page:
        page.click("#story-start")
        for n in range(2, len(STEPS) + 1):
            page.click("#story-next")
            assert all(dotted(page)) == (n in comparing)
            if n in comparing:
                with opened(browser, page_file, fragment=f"step={n}") as other:
                    assert dotted(other) == dotted(page)


def dotted(page: Page) -> list[str]:
    """Give the curves of the setting before, as they are drawn."""
    drawn(page)
    found: list[str] = page.eval_on_selector_all(
        ".curve.ghost", "all => all.map(each => each.getAttribute('d') ?? '')"
    )
    return found


def test_the_list_of_steps_opens_any_and_the_browser_leads_back(page: Page) -> None:
    """The titles in the list are links; Back of the browser leads to the step before."""
    page.click(".steps summary")
    for n in (9, 4):
        page.click(f".steps a[href='#step={n}']")
        page.wait_for_function("n => !document.getElementById(`step=${n}`).hidden", arg=n)
        assert setting(page) == STEPS[n]
    page.evaluate("history.back()")
    page.wait_for_function("!document.getElementById('step=9').hidden")
    assert setting(page) == STEPS[9]


def test_what_is_tried_leaves_the_step_and_its_link_leads_back(page: Page) -> None:
    """A moved slider puts the setting into the address; the text stays; the link sets it again."""
    page.click("#story-start")
    page.click("#story-next")
    address(page, "step=2")
    press(page, "k", "ArrowRight")
    address(page, "k=")
    assert open_steps(page) == [2]
    page.click("[id='step=2'] a[href='#step=2']")
    page.wait_for_function("window.stickslip.setting.k === 1000")
    assert setting(page) == STEPS[2]
    address(page, "step=2")


def test_a_step_that_there_is_not_is_told(browser: Browser, page_file: Path) -> None:
    """An address with a wrong number says so and sets nothing."""
    for wrong in ("step=0", "step=99", "step=x"):
        with opened(browser, page_file, fragment=wrong) as page:
            assert "step" in page.inner_text("#address-said")
            assert setting(page) == presets()["default"]
            assert page.is_visible("#story-start")


def test_the_story_is_read_on_paper_and_without_a_script(browser: Browser, page_file: Path) -> None:
    """Both show every step, one after the other, and no button that does nothing there."""
    with opened(browser, page_file) as page:
        page.emulate_media(media="print")
        drawn(page)
        assert open_steps(page) == list(STEPS)
        assert not page.is_visible("#story-pager")
    with browser.new_context(java_script_enabled=False) as context:
        page = context.new_page()
        page.goto(page_file.as_uri())
        assert open_steps(page) == list(STEPS)
        assert not page.is_visible("#story-start")
