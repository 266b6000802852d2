"""The report in a real browser: nothing is cut on a screen, and it prints on a few pages."""

import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from stickslip_verification import Meaning, Verdict, render
from stickslip_verification.model.verdict import CaseGroup, ObservedOrder, Table
from tests.verification.test_report import result
from tests.verification.test_report_html import PROVENANCE, motion

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    Shown = Callable[..., Page]

CASES = ["default", *(f"lifted-and-set-down-{n}" for n in range(43))]
REASON = "rounding, 1e-12, times the conditioning mu_s/(mu_s - mu_k) = 2.5, times 31 slips"
MOST_PAGES = 8

CUT = """() => [...document.querySelectorAll("body *")].filter(each => {
  if (!each.getClientRects().length || each.closest("svg, .matrix, thead")) return false;
  const {left, right} = each.getBoundingClientRect();
  const wide = getComputedStyle(each).display !== "inline" && each.clientWidth > 0;
  return left < -0.5 || right > innerWidth + 0.5
    || (wide && each.scrollWidth > each.clientWidth + 1);
}).map(each => `${each.tagName} ${each.className}: ${each.textContent.slice(0, 60)}`)"""
"""What reaches beyond the window, or holds more than it shows."""

SPLIT = """() => [...document.querySelectorAll(".rows td:nth-child(n+5):nth-child(-n+7)")]
  .filter(cell => {
    const text = document.createRange();
    text.selectNodeContents(cell);
    return text.getClientRects().length > 1;
  }).map(cell => cell.textContent)"""
"""Numbers that are broken into several lines."""


def suite_like(*failing: str, full: bool = False) -> str:
    """Render a verdict as large as that of the suite, its texts as long, these cases failing."""
    checks = [
        result(
            case=case,
            check=f"simplified-stick-too-long-by-{n}",
            side=("fmu", "reference")[n % 2],
            truth=("closed_form", "invariant")[n // 60],
            quantity="jump_beyond_simplified",
            unit="m/s",
            expected=-0.00630536174,
            got=-0.00630536174,
            error=1e-13 * n,
            tolerance=2.5e-12,
            because=REASON,
            measure="of_scale",
            passed=n != 7 or case not in failing,
        )
        for case in CASES
        for n in range(108)
    ]
    checks += [
        result(case=name, check="sequence-holds", because=REASON, passed=name not in failing)
        for name in (f"sequence-{n:03}" for n in range(200))
    ]
    levels = tuple(10.0**-n for n in range(3, 12))
    order = ObservedOrder("damped-cycle", "x_dot", levels, levels, (1.0,) * 8, 1.0)
    rows = [
        (f"load and F_ext together, in stick {n}", 12, 30, "no stick at v = 0") for n in range(24)
    ]
    head = ("what changes", "c below critical", "c at critical", "c above critical")
    coverage = Table("Random sequences", "What changed, and where.", head, rows, "Seed 1.")
    motions = [motion(case) for case in ("default", *failing)]
    verdict = Verdict(checks, PROVENANCE, motions, [order] * 16, tables=[coverage, coverage])
    picture = '<svg viewBox="0 0 480 412" role="img" aria-label="drawn"></svg>'
    names = ["sequence-holds", *(f"simplified-stick-too-long-by-{n}" for n in range(108))]
    meanings = dict.fromkeys(names, Meaning(REASON, REASON))
    drawn = {each.case: picture for each in motions}
    return render(verdict, meanings=meanings, drawn=drawn, full=full)


@pytest.fixture
def shown(browser: "Browser", tmp_path: Path) -> Iterator["Shown"]:
    """Give what opens a page in a window of some width [px], until the end of the test."""
    file = tmp_path / "index.html"
    with ExitStack() as windows:

        def show(html: str, width: int = 1440) -> "Page":
            file.write_text(html, encoding="utf-8")
            window = browser.new_page(viewport={"width": width, "height": 900})
            page = windows.enter_context(window)
            page.goto(file.as_uri())
            return page

        yield show


@pytest.mark.parametrize("width", [1440, 1024, 400])
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
    assert page.evaluate(SPLIT) == []


def test_an_open_case_shows_the_reasons_of_tolerances_and_the_filter_what_did_not_pass(
    shown: "Shown",
) -> None:
    page = shown(suite_like("default"))
    page.locator("details.case:not([open]) summary").first.click()
    reason = page.locator("details.case[open] td:last-child").last
    assert reason.is_visible()
    assert reason.inner_text() == REASON
    page.locator("input[name=failed]").check()
    page.wait_for_function("document.querySelector('output').textContent !== ''")
    assert page.locator("output").inner_text() == "1 of 4752 shown"
    assert page.locator("section.group:visible h3").all_inner_texts() == [CaseGroup.DEFAULT]


def test_the_report_prints_on_a_few_pages_and_what_failed_with_every_comparison(
    shown: "Shown",
) -> None:
    sheets = shown(suite_like()).pdf(prefer_css_page_size=True)
    assert len(re.findall(rb"/Type\s*/Page\b", sheets)) <= MOST_PAGES
    # A sheet of A4 is 794 px wide, less its margins.
    page = shown(suite_like("default"), 700)
    page.emulate_media(media="print")
    assert page.locator("table.rows tr.pass:visible").count() == 107
    assert page.locator("details.case summary:visible").count() == len(CASES)
    assert page.locator("form:visible, script:visible").count() == 0
    assert page.evaluate(SPLIT) == []
    every = shown(suite_like(full=True))
    every.emulate_media(media="print")
    assert every.locator("details.case:first-of-type tr.pass:visible").first.is_visible()
