"""The presets and the address bar: settings by name, and settings in a link."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

from stickslip_fmu.spec import TABLE
from stickslip_ref import Parameters
from tests.page.browser import opened
from tests.page.settings import block, corner, presets, table
from tests.page.using import drawn, press, set_values, setting, shown, type_in

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

START = presets()["default"]
"""The start values of the FMU, SI; `test_the_default_is_the_start_of_the_fmu`."""


def pressed(page: Page) -> list[str]:
    """Give the ids of the presets that are shown as chosen."""
    found: list[str] = page.eval_on_selector_all(
        "[data-preset][aria-pressed=true]", "all => all.map(each => each.dataset.preset)"
    )
    return found


def address(page: Page) -> str:
    """Wait until the address has been still for a moment, and give what stands after #."""
    wanted = "#k=" + page.evaluate("String(window.stickslip.setting.k)")
    page.wait_for_function("wanted => location.hash.startsWith(wanted)", arg=wanted)
    return str(page.evaluate("location.hash.slice(1)"))


def test_the_default_is_the_start_of_the_fmu() -> None:
    """The first preset is the start values of the variable table, and those of the reference."""
    assert {name: TABLE.by_name[name].start for name in START} == START
    assert {name: getattr(Parameters(), name) for name in START} == START


def test_a_preset_is_a_complete_setting_with_its_source(page: Page) -> None:
    """Each sets all values, and its entry says what it shows and where its numbers are from."""
    for row, values in zip(table("applications")["application"], presets().values(), strict=True):
        page.click(f"[data-preset={row['id']}]")
        drawn(page)
        assert setting(page) == values
        assert pressed(page) == [row["id"]]
        entry = page.inner_text(f"#application-{row['id']}")
        assert row["about"].split("{")[0] in entry
        assert row["source"].split("{")[0] in entry
        assert "NaN" not in page.inner_text("body")
        assert all("NaN" not in str(path) for path in shown(page).values())


def test_a_moved_slider_releases_the_preset(page: Page) -> None:
    """What is no longer the preset's setting is not shown as one; its values back, it is again."""
    page.click("[data-preset=violin-bow]")
    drawn(page)
    press(page, "k", "ArrowRight")
    drawn(page)
    assert pressed(page) == []
    set_values(page, **presets()["violin-bow"])
    assert pressed(page) == ["violin-bow"]


def test_the_start_values_restore_all(page: Page) -> None:
    """One press leads back to the start values of the FMU and to their six cycles."""
    start = page.evaluate("window.stickslip.view")
    page.click("[data-preset=fault-block]")
    type_in(page, "mu_k", "0.59")
    page.click("[data-preset=default]")
    drawn(page)
    assert setting(page) == START
    assert page.evaluate("window.stickslip.view") == start


def test_the_address_holds_the_setting(browser: Browser, page_file: Path, page: Page) -> None:
    """A page opened with the address of another has the same setting, bit for bit."""
    draw = Random("address")
    # A 0 that is no start value is lost where an address leaves zeros out.
    for values in (block(draw), block(draw), corner("kinetic friction 0")):
        set_values(page, **values)
        with opened(browser, page_file, fragment=address(page)) as other:
            assert setting(other) == setting(page)
            assert other.inner_text("#address-said") == ""
            assert other.inner_text(".results") == page.inner_text(".results")


def test_an_address_with_nonsense_says_so(page_file: Path, page: Page) -> None:
    """A link that asks for what cannot be is told so, by name, and the start values stay."""
    for fragment in ("k=abc", "k=-5&v=0.02", "k=", "stiffness=5", "k=1e999"):
        page.goto("about:blank")
        page.goto(f"{page_file.as_uri()}#{fragment}")
        page.wait_for_function("window.stickslip !== undefined")
        assert fragment.partition("=")[0] in page.inner_text("#address-said")
        assert page.is_visible("#address-said")
        assert setting(page) == START


def test_another_address_is_another_setting(page: Page) -> None:
    """A bookmark opened in the same window restores its setting, and Back the one before."""
    page.evaluate("location.hash = '#k=2000&v=0.05'")
    page.wait_for_function("window.stickslip.setting.k === 2000")
    address(page)
    page.evaluate("location.hash = '#k=3000'")
    page.wait_for_function("window.stickslip.setting.k === 3000")
    # A link means the same in a fresh window and in a used one.
    assert setting(page) == {**START, "k": 3000.0}
    address(page)
    page.evaluate("history.back()")
    page.wait_for_function("window.stickslip.setting.k === 2000")
    assert setting(page)["v"] == 0.05


def test_a_jump_within_the_page_is_no_setting(page: Page) -> None:
    """The links to the results and to the theory complain of nothing and lose no setting."""
    type_in(page, "k", "2345")
    address(page)
    page.click("a[href='#theory-cycle']")
    page.wait_for_function(
        """() => {
          const covered = document.querySelector("#stage").getBoundingClientRect().bottom;
          const { top } = document.querySelector("#theory-cycle").getBoundingClientRect();
          return top >= covered && top < covered + 99;
        }"""
    )
    assert page.inner_text("#address-said") == ""
    assert "k=2345" in address(page)
    assert setting(page)["k"] == 2345.0
