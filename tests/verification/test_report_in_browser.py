"""The report in a real browser: nothing is cut on a screen, and it prints on a few pages."""

import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from stickslip_verification.model.verdict import (
    CaseGroup,
    CheckResult,
    ObservedOrder,
    Table,
    Verdict,
)
from stickslip_verification.report.html import render
from stickslip_verification.report.words import ClaimSection
from stickslip_verification.suite.catalogue import Meaning
from tests.verification.test_report import result
from tests.verification.test_report_html import PROVENANCE, motion

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    Shown = Callable[..., Page]

CASES = ["default", *(f"lifted-and-set-down-{n}" for n in range(43))]
SEQUENCES = [f"sequence-{n:03}" for n in range(200)]
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


def like(numbers: dict[str, Any]) -> CheckResult:
    """Make a result whose texts are as long as those of the suite are."""
    usual = {
        "check": "simplified-jump-leaves-out",
        "quantity": "jump_beyond_simplified",
        "unit": "m/s",
        "expected": -0.00630536174,
        "got": -0.00630536174,
        "error": 1.2e-16,
        "tolerance": 2.5e-12,
        "because": REASON,
        "measure": "of_scale",
    }
    return result(**{**usual, **numbers})


def suite_like(*failing: str) -> Verdict:
    """Make a verdict as large as that of the suite, in which these cases fail."""
    checks = [
        like(
            {
                "case": case,
                "check": f"simplified-stick-too-long-by-{n}",
                "side": ("fmu", "reference")[n % 2],
                "truth": ("closed_form", "invariant")[n // 60],
                "passed": n != 7 or case not in failing,
                "error": 1e-13 * n,
            }
        )
        for case in CASES
        for n in range(108)
    ]
    checks += [
        like({"case": case, "check": "sequence-holds", "passed": case not in failing})
        for case in SEQUENCES
    ]
    levels = tuple(10.0**-n for n in range(3, 12))
    order = ObservedOrder("damped-cycle", "x_dot", levels, levels, (1.0,) * 8, 1.0)
    rows = [
        (f"load and F_ext together, in stick {n}", 12, 30, "no stick at v = 0") for n in range(24)
    ]
    head = ("what changes", "c below critical", "c at critical", "c above critical")
    coverage = Table("Random sequences", "What changed, and where.", head, rows, "Seed 1.")
    return Verdict(
        checks,
        PROVENANCE,
        [motion(case) for case in ("default", *failing)],
        [order] * 16,
        tables=[coverage, coverage],
    )


def page_of(verdict: Verdict, *, full: bool = False) -> str:
    """Render a verdict with as many claims as there are."""
    picture = '<svg viewBox="0 0 480 412" role="img" aria-label="drawn"></svg>'
    drawn = {each.case: picture for each in verdict.motions}
    sentence = "Half a period is the standard for a slip: it is too short at slow pull. " * 5
    claims = [ClaimSection("The slip time", sentence, "holds to 5 % for v < 0.3", picture)] * 6
    meant = Meaning(REASON, REASON)
    meanings = {f"simplified-stick-too-long-by-{n}": meant for n in range(108)}
    return render(verdict, claims=claims, meanings=meanings, drawn=drawn, full=full)


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


def printed(page: "Page") -> int:
    """Count the pages on paper."""
    return len(re.findall(rb"/Type\s*/Page\b", page.pdf(prefer_css_page_size=True)))


@pytest.mark.parametrize("width", [1440, 1024, 400])
def test_no_column_is_cut(shown: "Shown", width: int) -> None:
    """With every case open, nothing reaches beyond its box or the window, and no number breaks."""
    page = shown(page_of(suite_like("default", "sequence-017")), width)
    page.evaluate("document.querySelectorAll('details').forEach(each => each.open = true)")
    assert page.evaluate(CUT) == []
    assert page.evaluate(SPLIT) == []


@pytest.mark.parametrize("width", [1440, 400])
def test_the_first_screen_has_the_verdict_and_its_cause(shown: "Shown", width: int) -> None:
    """Verdict, sentence and likeliest cause lie within the window as it opens."""
    page = shown(page_of(suite_like("default")), width)
    for part in ("h1", ".lead", ".cause p"):
        box = page.locator(part).first.bounding_box()
        assert box is not None
        assert box["y"] + box["height"] < 900
    # Beside them on a wide screen, below them on a narrow one.
    curve = page.locator("#curve").bounding_box()
    assert curve is not None
    assert width < 1000 or curve["y"] + curve["height"] < 900


def test_the_reason_of_a_tolerance_is_seen_in_an_open_case(shown: "Shown") -> None:
    """Nothing but the case has to be opened."""
    page = shown(page_of(suite_like()))
    page.locator("details.case summary").first.click()
    assert page.locator("details.case[open] td:last-child").first.is_visible()
    assert page.locator("details.case[open] td:last-child").first.inner_text() == REASON


def test_a_report_without_failures_prints_on_a_few_pages(shown: "Shown") -> None:
    """Each case is a line there; --full prints every comparison."""
    page = shown(page_of(suite_like()))
    assert printed(page) <= MOST_PAGES
    full = shown(page_of(suite_like(), full=True))
    assert printed(full) > 10 * MOST_PAGES


def test_a_failed_case_is_printed_with_every_comparison(shown: "Shown") -> None:
    """What passed in it is printed too; what passed elsewhere is not."""
    page = shown(page_of(suite_like("default")))
    page.emulate_media(media="print")
    rows = page.locator("table.rows tr.pass:visible")
    assert rows.count() == 107
    assert page.locator("details.case summary:visible").count() == 44


def test_the_filter_hides_groups_without_a_hit(shown: "Shown") -> None:
    """Only what did not pass: one case, one row, and no empty heading."""
    page = shown(page_of(suite_like("default")))
    page.locator("input[name=failed]").check()
    page.wait_for_function("document.querySelector('output').textContent !== ''")
    assert page.locator("output").inner_text() == "1 of 4752 shown"
    assert page.locator("section.group:visible h3").all_inner_texts() == [CaseGroup.DEFAULT]
