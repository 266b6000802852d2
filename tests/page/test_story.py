"""The guided story, the applications and the questions: what their links and buttons set."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tests.page.settings import PRESETS, START, table
from tests.page.window import Window

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Browser

ROWS = table("story", "step")
STEPS = {
    n: {**PRESETS[row.get("preset", "default")], **row.get("set", {})}
    for n, row in enumerate(ROWS, 1)
}
APPLICATIONS = {row["id"]: row for row in table("applications", "application")}


def open_steps(window: Window) -> list[int]:
    return [n for n in STEPS if window.page.is_visible(f"[id='step={n}']")]


def address(window: Window, begin: str) -> None:
    window.until("begin => location.hash.startsWith(begin)", f"#{begin}")


def dotted(window: Window) -> Any:
    window.drawn()
    return window.js("[...document.querySelectorAll('.ghost')].map(e => e.getAttribute('d') ?? '')")


def test_the_story_waits_until_it_is_started_and_leads_through_its_steps(window: Window) -> None:
    assert open_steps(window) == [1]
    assert window.setting == START != STEPS[1]
    assert not window.page.is_visible("#story-next")
    window.page.click("#story-start")
    way = [*STEPS, *reversed(range(1, len(STEPS)))]
    ghosts = {}
    for before, n in zip([0, *way], way, strict=False):
        if n > 1 or before > 1:
            window.page.press("#story-next" if n > before else "#story-back", "Enter")
        row = ROWS[n - 1]
        assert open_steps(window) == [n]
        assert window.setting == STEPS[n]
        heading = window.js("document.activeElement.textContent")
        assert heading == f"Step {n} of {len(STEPS)} {row['title']}"
        assert window.page.is_disabled("#story-back") == (n == 1)
        assert window.page.is_disabled("#story-next") == (n == len(STEPS))
        assert not window.has_nonsense()
        if row.get("from") == "start" or window.cycle["exists"]:
            assert (window.view[0] == 0.0) == (row.get("from") == "start"), n
        ghosts[n] = dotted(window)
        assert all(ghosts[n]) == ("over" in row)
    # A link shows the same in a fresh window, its text beneath the stage.
    for n in [1, *(n for n, row in enumerate(ROWS, 1) if "over" in row), len(STEPS)]:
        window.open(f"step={n}")
        assert (window.setting, open_steps(window)) == (STEPS[n], [n])
        assert dotted(window) == ghosts[n]
        address(window, f"step={n}")


def test_any_step_is_opened_by_its_link_and_left_by_what_is_tried(window: Window) -> None:
    window.page.click(".steps summary")
    for n in (9, 4):
        window.page.click(f".steps a[href='#step={n}']")
        window.until("n => !document.getElementById(`step=${n}`).hidden", n)
        assert window.setting == STEPS[n]
    window.page.go_back()
    window.until("!document.getElementById('step=9').hidden")
    assert window.setting == STEPS[9]
    address(window, "step=9")
    window.press("k", "ArrowRight")
    address(window, "k=")
    assert open_steps(window) == [9]
    window.open("step=4&v=0.05")
    assert (window.setting, open_steps(window)) == ({**STEPS[4], "v": 0.05}, [4])
    for wrong in ("step=0", "step=99", "step=x"):
        window.open(wrong)
        assert "step" in window.text("#address-said")
        assert window.setting == START


def test_the_address_that_a_link_has_led_to_is_not_written_over(window: Window) -> None:
    # The page is held up until the write of the press before is due, and left at once.
    window.press("k", "ArrowRight")
    window.drawn()
    window.js("""new Promise(done => {
      addEventListener("hashchange", () => setTimeout(() => {
        location.hash = "step=4";
        done();
      }), { once: true });
      location.hash = "step=9";
      for (const start = performance.now(); performance.now() < start + 400;);
    })""")
    window.until("!document.getElementById('step=4').hidden")
    window.page.go_back()
    window.until("!document.getElementById('step=9').hidden")
    assert window.setting == STEPS[9]


def test_the_story_is_read_on_paper_and_without_a_script(
    window: Window, browser: Browser, page_file: Path
) -> None:
    window.page.emulate_media(media="print")
    window.drawn()
    assert open_steps(window) == list(STEPS)
    assert not window.page.is_visible("#story-pager")
    with browser.new_context(java_script_enabled=False) as context:
        page = context.new_page()
        page.goto(page_file.as_uri())
        assert all(page.is_visible(f"[id='step={n}']") for n in STEPS)
        assert not page.is_visible("#story-start")


def test_the_entry_of_an_application_and_its_preset_belong_together(window: Window) -> None:
    def unfolded() -> Any:
        window.drawn()
        return window.js("[...document.querySelectorAll('.application[open]')].map(e => e.id)")

    assert unfolded() == ["application-default"]
    for name in APPLICATIONS:
        if name != "default":
            window.page.press(f"#application-{name} summary", "Enter")
        assert unfolded() == [f"application-{name}"]
        assert window.setting == PRESETS[name]
    window.preset("default")
    assert unfolded() == ["application-default"]


def test_a_countermeasure_does_what_it_says_from_any_setting(window: Window) -> None:
    for name, row in APPLICATIONS.items():
        window.preset(name)
        before = window.cycle["delta_x"]
        items = window.page.locator(f"#application-{name} li").all()
        for item, cure in zip(items, row.get("cures", ()), strict=True):
            if "set" not in cure:
                assert item.locator("button").count() == 0
                assert "no parameter" in item.inner_text()
                continue
            window.press("v", "ArrowRight")
            item.locator("button").click()
            assert window.setting == {**PRESETS[name], **cure["set"]} != PRESETS[name]
            window.drawn()
            assert window.part("#x-chart .curve.ghost", "d")
            ends = "cycle ends" in item.inner_text()
            assert window.text("#lead").startswith("It moves evenly") == ends
            assert ends or window.cycle["delta_x"] < before
