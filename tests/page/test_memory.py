"""What the page remembers: presets, the address with its complaints, and the browser's Back."""

from __future__ import annotations

from random import Random

import pytest

from stickslip_fmu.spec import TABLE
from tests.page.settings import CORNERS, PRESETS, START, block, table
from tests.page.window import Window


def address(window: Window) -> str:
    window.until("location.hash.startsWith('#k=' + stickslip.setting.k)")
    return str(window.js("location.hash.slice(1)"))


def go_to(window: Window, fragment: str, ready: str) -> None:
    window.js("fragment => { location.hash = fragment; }", fragment)
    window.until(ready)
    window.drawn()


def test_a_preset_is_a_complete_setting_with_its_source(window: Window) -> None:
    assert {name: TABLE.by_name[name].start for name in START} == START
    for row in table("applications", "application"):
        window.preset(row["id"])
        assert window.setting == PRESETS[row["id"]]
        assert window.pressed("preset") == [row["id"]]
        assert row["source"].split("{")[0] in window.page.inner_text(f"#application-{row['id']}")
    window.press("k", "ArrowRight")
    assert window.pressed("preset") == []
    window.set(**PRESETS["violin-bow"])
    assert window.pressed("preset") == ["violin-bow"]


def test_the_address_restores_setting_picture_and_results(window: Window) -> None:
    draw = Random("address")
    # A 0 that is no start value is lost where an address leaves zeros out.
    for values in (block(draw), block(draw), CORNERS["kinetic friction 0"]):
        window.set(**values)
        fragment = address(window)
        window.page.click("#zoom-auto")
        before = window.setting, window.paths(), window.text(".results"), window.view
        window.open(fragment)
        assert window.text("#address-said") == ""
        assert before == (window.setting, window.paths(), window.text(".results"), window.view)


@pytest.mark.parametrize(
    ("fragment", "taken", "named"),
    [
        (
            "k=2000&v=abc&stiffness=5&m=2&mu_s=-1&g=1e99&c=",
            {"k": 2000.0, "m": 2.0},
            ["v=abc", "stiffness", "mu_s", "g:", "c="],
        ),
        ("curve=0.5,0.02", {}, ["curve=0.5,0.02 is no number"]),
        # Its first load-up takes more than 1e9 of its cycles.
        ("k=42.5&v=8.25e-8&mu_s=0.259&mu_k=0.259&m=41824&g=3.26e11", {}, ["1e9 cycles"]),
    ],
)
def test_a_bad_part_of_an_address_is_named_and_costs_no_good_part(
    window: Window, fragment: str, taken: dict[str, float], named: list[str]
) -> None:
    window.open(fragment)
    assert [part for part in named if part not in window.text("#address-said")] == []
    assert window.setting == {**START, **taken}
    # The complaint ends with something good.
    window.press("mu_s", "ArrowRight")
    assert window.text("#address-said") == ""


def test_the_browser_leads_back_over_links_and_presses(window: Window) -> None:
    window.look(3.0, 4.0)
    go_to(window, "k=2000&v=0.05", "stickslip.setting.k === 2000")
    shown = window.paths(), window.view
    address(window)
    go_to(window, "k=3000", "stickslip.setting.k === 3000")
    # A link means the same in a fresh window and in a used one.
    assert window.setting == {**START, "k": 3000.0}
    address(window)
    window.page.go_back()
    window.until("stickslip.setting.k === 2000")
    assert (window.paths(), window.view) == shown
    assert window.setting["v"] == 0.05


def test_a_jump_within_the_page_is_no_setting(window: Window) -> None:
    window.type("k", "2345")
    address(window)
    window.page.click("#results a[href='#theory-cycle']")
    window.until("scrollY > 0")
    assert window.text("#address-said") == ""
    assert "k=2345" in address(window)
