"""Where it happens: entries, drawings and countermeasures of the applications; the questions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.page.settings import presets, table
from tests.page.using import drawn, press, setting, text_of

if TYPE_CHECKING:
    from playwright.sync_api import Page

ROWS = {row["id"]: row for row in table("applications")["application"]}


def open_entries(page: Page) -> list[str]:
    """Give the ids of the applications that are unfolded."""
    drawn(page)
    return [name for name in ROWS if page.get_attribute(entry(name), "open") is not None]


def entry(name: str) -> str:
    """Give the selector of an application's entry."""
    return f"#application-{name}"


def test_the_entry_and_the_preset_belong_together(page: Page) -> None:
    """To open an entry sets its preset, to press the preset opens its entry, and no other is open.

    With the mouse and with the keyboard. A moved slider leaves the entry open.
    """
    assert open_entries(page) == ["default"]
    for name in ROWS:
        if name != "default":
            page.press(f"{entry(name)} summary", "Enter")
        assert open_entries(page) == [name]
        assert setting(page) == presets()[name]
    for name in ROWS:
        page.click(f"[data-preset={name}]")
        assert open_entries(page) == [name]
    press(page, "k", "ArrowRight")
    assert open_entries(page) == [name]
    page.click(f"{entry(name)} summary")
    assert open_entries(page) == []
    assert setting(page) != presets()[name]


@pytest.mark.parametrize("name", [name for name, row in ROWS.items() if row.get("cures")])
def test_a_countermeasure_does_what_it_says(page: Page, name: str) -> None:
    """Pressed from any setting it gives the application's with its values: the jump falls or ends.

    Where the text says that the cycle ends, there is none; else the jump is shorter.
    """
    own = presets()[name]
    page.click(f"[data-preset={name}]")
    drawn(page)
    before = page.evaluate("window.stickslip.cycle.delta_x")
    items = page.locator(f"{entry(name)} li")
    for item, cure in zip(items.all(), ROWS[name]["cures"], strict=True):
        assert cure["name"] in item.inner_text()
        if "set" not in cure:
            assert item.locator("button").count() == 0
            assert "no parameter" in item.inner_text()
            continue
        assert any(own[each] != value for each, value in cure["set"].items())
        press(page, "v", "ArrowRight")
        item.locator("button").click()
        assert setting(page) == {**own, **cure["set"]}
        assert page.get_attribute("#x-chart .curve.ghost", "d")
        ends = "cycle ends" in item.inner_text()
        assert text_of(page, "#lead").startswith("No cycle") == ends
        assert ends or page.evaluate("window.stickslip.cycle.delta_x") < before


def test_every_application_is_drawn_explained_and_sourced(page: Page) -> None:
    """Each has a drawing with a title, what k, m, v, friction and N stand for, and a source."""
    for name, row in ROWS.items():
        page.click(f"[data-preset={name}]")
        drawn(page)
        drawing = page.locator(f"{entry(name)} svg")
        assert drawing.locator("title").text_content() == row["drawn"]
        assert 350 < len(drawing.inner_html()) < 1200
        left, top, right, bottom = drawing.evaluate(
            "svg => (({ x, y, width, height }) => [x, y, x + width, y + height])(svg.getBBox())"
        )
        assert 0 <= left < right <= 320
        assert 0 <= top < bottom <= 110
        assert page.locator(f"{entry(name)} dt").all_inner_texts() == ["m", "k", "v", "μ", "N"]
        assert "llustrative" in row["source"]
    cited = " ".join(row["source"] for row in ROWS.values())
    assert cited.count("doi:") >= 6


def test_the_fault_has_no_cure() -> None:
    """Nothing that a person can do changes its parameters."""
    assert "cures" not in ROWS["fault-block"]


def test_a_question_unfolds_its_answer(page: Page) -> None:
    """Six to eight short questions; each answer is hidden until its question is pressed."""
    rows = table("questions")["question"]
    assert 6 <= len(rows) <= 8
    for item, row in zip(page.locator("#questions details").all(), rows, strict=True):
        assert item.locator("summary").inner_text() == row["question"]
        assert not item.locator("p").is_visible()
        item.locator("summary").press("Enter")
        assert item.locator("p").is_visible()
        assert len(item.locator("p").inner_text().split()) < 120
