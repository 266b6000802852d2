"""The report as a page: what it says, what it asks for, and that it says the same each time."""

import itertools
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import (
    ChosenContract,
    Detection,
    KillMatrix,
    Motion,
    ObservedOrder,
    Second,
    Table,
    Verdict,
)
from stickslip_verification.report.earlier import compare, read_earlier_report
from stickslip_verification.report.html import render, write_report
from stickslip_verification.report.json_file import write_json
from stickslip_verification.report.words import ClaimSection
from stickslip_verification.suite.catalogue import Meaning
from tests.verification.test_report import result

VOID = {"meta", "input", "br", "hr", "link", "img"}
FMU = {"file": "StickSlip.fmu", "sha256": "ab12", "names": "their.toml", "problems": ["no GUID"]}
PROVENANCE = {"created": "today", "fmu": FMU}


class Page(HTMLParser):
    """A page that was read: its elements, its text, and what was open at each of them."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.words: list[str] = []
        self.feed(html)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Open an element."""
        assert len({name for name, _ in attrs}) == len(attrs), f"twice the same in {tag}"
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take an element without content."""
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        """Close the element that was opened last."""
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        """Take text that a reader sees."""
        if not {"style", "script"} & set(self.open):
            self.words.append(data)

    @property
    def text(self) -> str:
        """What a reader sees, with single blanks."""
        return " ".join(" ".join(self.words).split())

    def all(self, tag: str) -> list[dict[str, str | None]]:
        """Return the attributes of all elements of a kind."""
        return [attrs for name, attrs in self.elements if name == tag]


def motion(case: str) -> Motion:
    """Make a mass that rests while the other end of its spring goes away."""
    t = np.linspace(0.1, 1.0, 10)
    zero = np.zeros(10)
    outputs = {"x": zero, "x_dot": zero, "x_pull": t, "z": t, "F": t, "F_s": zero + 2.0,
               "mode": zero}  # fmt: skip
    record = Run(t, outputs, dict.fromkeys(outputs, 0.0) | {"F_s": 2.0})
    return Motion(case, f"The title of {case}", "What it is about.", record, (), {"fmu": record})


def full_verdict(**provenance: Any) -> Verdict:
    """Make a verdict with some of everything."""
    checks = [
        result(tolerance=2e-12, error=1e-12, because="rounding & <friends>"),
        result(side="reference", because="integration"),
        result(case="tuned", check="x-course", error=3.0, passed=False, because="integration"),
        result(case="tuned", check="energy", truth="invariant", not_applicable="no slip here",
               passed=False, got=None, error=None),
        result(case="tuned", check="agree", truth="cross_code", side="both"),
        result(case="", check="units", klass="contract", decides=False, passed=False, error=1.0,
               unit="1"),
        result(case="heat", check="Q-course", second=Second(1.0, 2.0, drift=1.0, tolerance=1e-9)),
    ]  # fmt: skip
    rows = (
        Detection("late", "an event comes late", ("t_slip-exact",), {"t_slip-exact": 3}, True),
        Detection("creep", "the mass creeps", ("x-course",), {"energy": 2}, caught=False),
        Detection("deaf", "it does not start", ("units",), {}, False, broken="ImportError"),
    )
    return Verdict(
        checks,
        PROVENANCE | provenance,
        [motion("default"), motion("tuned")],
        [ObservedOrder("default", "x", (1e-3, 1e-6), (2e-3, 2e-6), (1.0,), 1.0)],
        KillMatrix(("t_slip-exact", "x-course", "energy", "units"), rows, {"units": "it guards"}),
        contract=ChosenContract("physics", "--contract physics"),
    )


CLAIM = ClaimSection(
    "A jump", "It jumps.", "holds", '<svg viewBox="0 0 1 1"><g id="a" fill="url(#a)"></g></svg>'
)
DRAWN = dict.fromkeys(("default", "tuned"), '<svg role="img" aria-label="drawn before"></svg>')
MEANINGS = {"x-course": Meaning("The mass is elsewhere.", "the arcs")}


@pytest.fixture(scope="module")
def page() -> Page:
    """Return the page of a verdict with some of everything."""
    return Page(render(full_verdict(), claims=[CLAIM, CLAIM], meanings=MEANINGS))


def test_page_one_has_the_verdict_and_its_scope(page: Page) -> None:
    """The verdict in words, the FMU, the counts, the kinds and their worth come before all else."""
    first = page.text[: page.text.index("Nearest to the tolerance The passed")]
    assert "StickSlip.fmu fail" in first
    assert "ab12" in first
    assert "their.toml" in first
    assert "no GUID" in first
    assert "7 comparisons in 3 cases: 3 passed, 2 failed, 1 noted, 1 not applicable" in first
    assert "It is not validation." in first
    assert "ASME V&V 10" in first
    assert "The weaker kind: both may be wrong alike, so it alone gives no pass." in first
    assert "Contract checks" in first
    assert "0 held, 1 drifted" in first
    assert "What it means: The mass is elsewhere. Likeliest bug: the arcs" in first
    assert "A planted fault survived" in first


def test_a_verdict_that_passes_says_so() -> None:
    """Nothing failed, so the page says pass, and there is no list of failures."""
    passing = Page(render(Verdict([result()], PROVENANCE)))
    assert "StickSlip.fmu pass" in passing.text
    assert "Failures" not in passing.text
    assert "not the exact block" not in passing.text


def test_agreement_of_two_programs_alone_is_not_green() -> None:
    """With nothing but cross-code the verdict is a fail, and the page says why."""
    weak = Page(render(Verdict([result(truth="cross_code", side="both")], PROVENANCE)))
    assert "StickSlip.fmu fail" in weak.text
    assert "No comparison of the FMU with a closed form or an invariant passed." in weak.text


def test_every_comparison_is_a_row_that_leads_to_its_reason(page: Page) -> None:
    """A row has its verdict in words and links to the note with the reason of its tolerance."""
    html = render(full_verdict(), drawn=DRAWN)
    rows = re.findall(r'<tr class="([\w-]+) (\w+)"', html)
    assert len(rows) == 7
    assert {word for word, _ in rows} == {"pass", "fail", "not-applicable", "noted", "drift"}
    assert "rounding & <friends>" in page.text
    # The same reason is written once a case, and each row has the number of its own.
    notes = re.findall(r'<li id="case-(\w+)-n(\d)">(\w+)', html)
    assert notes == [
        ("tuned", "1", "integration"),
        ("tuned", "2", "rounding"),
        ("heat", "1", "rounding"),
        ("default", "1", "rounding"),
        ("default", "2", "integration"),
        ("fmu", "1", "rounding"),
    ]
    assert "no slip here" in page.text
    assert html.count("drawn before") == 2


def test_cases_with_failures_come_first_and_are_open(page: Page) -> None:
    """Who opens the report sees what failed without a click."""
    cases = [attrs for attrs in page.all("details") if attrs.get("class") == "case"]
    assert ["open" in attrs for attrs in cases] == [True, True, False, False]


def test_every_link_has_its_target_and_every_id_is_unique(page: Page) -> None:
    """No link leads nowhere or outside, and the same picture twice gets ids of its own."""
    ids = [attrs["id"] for _, attrs in page.elements if "id" in attrs]
    assert len(ids) == len(set(ids))
    links = [attrs.get("href") or "" for tag in ("a", "use") for attrs in page.all(tag)]
    assert links
    assert {link.removeprefix("#") for link in links} <= set(ids)
    assert all(link.startswith("#") for link in links)


def test_the_page_asks_for_nothing_outside_itself() -> None:
    """No address, no source and no import is in the file."""
    html = render(full_verdict(), claims=[CLAIM])
    assert not re.search(r"https?:|\bsrc=|@import|<link|url\((?!#)", html)


def test_the_page_can_be_read_without_its_looks(page: Page) -> None:
    """It has a language, a title, one first heading, scopes on headers and names on pictures."""
    assert page.all("html") == [{"lang": "en"}]
    assert len(page.all("h1")) == 1
    assert page.all("title")
    assert all(attrs.get("scope") for attrs in page.all("th"))
    assert all(attrs.get("role") and attrs.get("aria-label") for attrs in page.all("svg"))
    levels = [int(tag[1]) for tag, _ in page.elements if re.fullmatch(r"h\d", tag)]
    assert all(after <= before + 1 for before, after in itertools.pairwise(levels))
    assert page.all("form") == [{"id": "filter", "role": "search", "hidden": None}]


def test_the_planted_faults_are_judged_in_words(page: Page) -> None:
    """Caught, survived and not judged are words, and a foretold 0 is in the matrix."""
    assert "1 of 3 detected, 1 survived, 1 could not be judged" in page.text
    assert "t_slip-exact (3)" in page.text
    cells = [attrs.get("class") for attrs in page.all("td")]
    assert cells.count("wanted") == 2
    assert cells.count("h3 wanted") == 1
    assert "units it guards" in page.text


def test_only_the_last_block_knows_where_and_when() -> None:
    """Another day, another machine and another baseline: the same page but for the dated block."""
    here = render(full_verdict(created="today", platform="here"))
    there = render(full_verdict(created="tomorrow", platform="there", command="stickslip verify"))
    assert here != there
    cut = re.compile(r"<!-- dated: begin -->.*<!-- dated: end -->", re.DOTALL)
    assert cut.sub("", here) == cut.sub("", there)
    assert "stickslip verify" in Page(there).text


def test_the_compact_form_keeps_what_failed_and_says_what_it_is() -> None:
    """Paper gets all that failed and the nearest of each quantity, and says that it does."""
    many = [result(check=f"c{n}", error=n * 1e-14) for n in range(50)]
    failing = [replace(result(check="bad"), passed=False, error=1.0)]
    text = render(Verdict(many + failing, PROVENANCE), compact=True)
    assert "This is the compact form." in text
    shown = re.findall(r'<tr class="\w+ closed_form"[^>]*><th scope="row">(\w+)', text)
    assert "bad" in shown
    # Ten are named among the nearest; the worst of the quantity is the failed one.
    assert len(shown) == 11
    assert "11 of 51 comparisons" in Page(text).text


def test_a_wild_message_stays_text() -> None:
    """Markup in what an FMU says is shown, not obeyed."""
    text = render(Verdict([result(failure="<script>alert(1)</script>", passed=False)], PROVENANCE))
    assert "<script>alert" not in text
    assert "<script>alert(1)</script>" in Page(text).text


def test_moved_margins_are_shown(tmp_path: Path) -> None:
    """With an earlier report the page shows what grew, and names that report at its end only."""
    earlier = tmp_path / "earlier.json"
    write_json(Verdict([result(error=1e-14)], PROVENANCE), earlier)
    now = Verdict([result(error=9e-13)], PROVENANCE)
    html = render(now, margins=compare(read_earlier_report(earlier), now))
    assert "Margins that grew by more than a factor 2: 1;" in Page(html).text
    before, _, after = html.partition("<!-- dated: begin -->")
    assert "earlier.json" not in before
    assert "earlier.json" in after


def test_a_table_of_the_verdict_is_a_section() -> None:
    """Heading, sentence, cells under their headings, note, and a link in the list of sections."""
    table = Table(
        "Coverage", "Where things changed.", ("change", "c = 0", "c > 0"),
        [("load in stick", 12, 1e-15), ("load at v = 0", "no stick <ends>", 3)], "Seed 1.",
    )  # fmt: skip
    html = render(Verdict([result()], PROVENANCE, tables=[table]))
    page = Page(html)
    said = (
        "Coverage Where things changed. change c = 0 c > 0 load in stick 12 1e-15 "
        "load at v = 0 no stick <ends> 3 Seed 1."
    )
    assert said in " ".join(page.text.split())
    assert {"href": "#table-0"} in page.all("a")
    # Numbers are aligned where the whole column has them, and each cell knows its heading.
    cells = [attrs for attrs in page.all("td") if (attrs.get("data-is") or "").startswith("c ")]
    assert cells == 2 * [{"data-is": "c = 0"}, {"class": "n", "data-is": "c > 0"}]


def test_the_files_are_written_together_or_not_at_all(tmp_path: Path) -> None:
    """A report is three files; what cannot be written as JSON leaves no half of it."""
    write_report(full_verdict(), tmp_path / "report", drawn=DRAWN)
    assert {file.name for file in (tmp_path / "report").iterdir()} == {
        "index.html",
        "junit.xml",
        "report.json",
    }
    with pytest.raises(TypeError):
        write_report(full_verdict(versions={"a": {1, 2}}), tmp_path / "other", drawn=DRAWN)
    assert not (tmp_path / "other").exists()


def test_thousands_of_comparisons_stay_small() -> None:
    """Six thousand rows take less than three megabytes: a reason is written once a case."""
    because = "a reason that is said again and again, and would swell the file " * 3
    checks = [
        result(case=f"case-{n % 45}", check=f"check-number-{n}", because=because, error=1e-13)
        for n in range(6000)
    ]
    assert len(render(Verdict(checks, PROVENANCE)).encode()) < 3e6
