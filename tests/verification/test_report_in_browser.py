"""The report in a real browser: nothing is cut on a screen, and it prints on a few pages."""

import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from stickslip_verification import Meaning, Verdict, render
from stickslip_verification.model.verdict import Table
from tests.verification.test_report import result
from tests.verification.test_report_html import PROVENANCE, motion

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    Shown = Callable[..., Page]

CASES = ["default", *(f"lifted-and-set-down-{n}" for n in range(43))]
NAMES = [f"simplified-stick-too-long-by-{n}" for n in range(108)]
REASON = "rounding, 1e-12, times the conditioning mu_s/(mu_s - mu_k) = 2.5, times 31 slips"
CUT = """() => [...document.querySelectorAll("body *")].filter(each => {
  if (!each.getClientRects().length || each.closest("svg, .matrix, thead")) return false;
  const {left, right} = each.getBoundingClientRect();
  const wide = getComputedStyle(each).display !== "inline" && each.clientWidth > 0;
  return left < -0.5 || right > innerWidth + 0.5
    || (wide && each.scrollWidth > each.clientWidth + 1);
}).map(each => `${each.tagName} ${each.className}: ${each.textContent.slice(0, 60)}`)"""
"""What reaches beyond the window, or holds more than it shows."""


def suite_like(*failing: str) -> str:
    usual: dict[str, Any] = {
        "quantity": "jump_beyond_simplified", "unit": "m/s", "got": -0.00630536174, "error": 1e-12,
        "tolerance": 2.5e-12, "because": REASON, "measure": "of_scale",
    }  # fmt: skip
    checks = [
        result(case=case, check=name, passed=n != 7 or case not in failing, **usual)
        for case in CASES
        for n, name in enumerate(NAMES)
    ]
    for case in (f"sequence-{n:03}" for n in range(200)):
        checks.append(result(case=case, check=NAMES[0], passed=case not in failing, **usual))
    rows = [(f"load and F_ext together, in stick {n}", 12, "no stick at v = 0") for n in range(24)]
    head = ("what changes", "c below critical", "c above critical")
    coverage = Table("Random sequences", "What changed, and where.", head, rows, "Seed 1.")
    motions = [motion(case) for case in ("default", *failing)]
    verdict = Verdict(checks, PROVENANCE, motions, tables=[coverage, coverage])
    meanings = dict.fromkeys(NAMES, Meaning(REASON, REASON))
    return render(verdict, meanings=meanings)


@pytest.fixture
def shown(browser: "Browser", tmp_path: Path) -> Iterator["Shown"]:
    file = tmp_path / "index.html"
    with ExitStack() as windows:

        def show(html: str, width: int = 1440) -> "Page":
            file.write_text(html, encoding="utf-8")
            window = browser.new_page(viewport={"width": width, "height": 900})
            page = windows.enter_context(window)
            page.goto(file.as_uri())
            return page

        yield show


@pytest.mark.parametrize("width", [1440, 400])
def test_the_first_screen_has_the_verdict_and_its_cause_and_nothing_is_cut(
    shown: "Shown", width: int
) -> None:
    page = shown(suite_like("default", "sequence-017"), width)
    # On a narrower screen the curve lies below.
    for part in ("h1", ".lead", ".cause p", *(["#curve"] if width > 1200 else [])):
        box = page.locator(part).first.bounding_box()
        assert box is not None
        assert box["y"] + box["height"] < 900
    page.evaluate("document.querySelectorAll('details').forEach(each => each.open = true)")
    assert page.evaluate(CUT) == []


def test_an_open_case_shows_the_reasons_of_tolerances_and_the_filter_what_did_not_pass(
    shown: "Shown",
) -> None:
    page = shown(suite_like("default"))
    page.locator("details.case:not([open]) summary").first.click()
    assert page.locator("details.case[open] td:last-child").last.inner_text() == REASON
    page.locator("input[name=failed]").check()
    page.wait_for_function("document.querySelector('output').textContent.startsWith('1 of')")


def test_the_report_prints_on_a_few_pages_and_what_failed_with_every_comparison(
    shown: "Shown",
) -> None:
    sheets = shown(suite_like()).pdf(prefer_css_page_size=True)
    assert len(re.findall(rb"/Type\s*/Page\b", sheets)) <= 8
    # A sheet of A4 is 794 px wide, less its margins.
    page = shown(suite_like("default"), 700)
    page.emulate_media(media="print")
    assert page.locator("table.rows tr.pass:visible").count() == 107
    assert page.locator("details.case summary:visible").count() == len(CASES)
