"""The report as a page: what it says, what it asks for, and that it says the same each time."""

import itertools
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import (
    CaseGroup,
    CheckResult,
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
from stickslip_verification.report.first_screen import sentence
from stickslip_verification.report.html import render, write_report
from stickslip_verification.report.json_file import write_json
from stickslip_verification.report.view import failed_checks
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
    group = CaseGroup.DEFAULT if case == "default" else CaseGroup.SETTINGS
    return Motion(
        case, f"The title of {case}", "What it is about.", record, (), {"fmu": record}, group
    )


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


def test_the_first_screen_says_what_failed_and_why(page: Page) -> None:
    """Verdict, one sentence, the likeliest cause and the contract come before all else."""
    first = page.text[: page.text.index("Failures x-course")]
    assert "StickSlip.fmu fail" in first
    assert "Fails in 2 of 3 cases. A planted fault survived" in first
    assert "Likeliest cause: the arcs x-course fails in 1 case: The mass is elsewhere." in first
    assert (
        "Contract: physics (--contract physics). Physics checks decide. Contract checks," in first
    )
    assert "7 comparisons: 3 passed, 2 failed, 1 noted, 1 not applicable" in first
    assert "tuned: the line is the exact motion" in first


def test_what_was_judged_and_what_it_is_worth_is_told(page: Page) -> None:
    """The FMU, its names, the kinds of truth with their worth, and the scope."""
    for told in (
        "ab12",
        "their.toml maps the variables",
        "no GUID",
        "It is not validation.",
        "ASME V&V 10",
        "The weaker kind: both may be wrong alike, so it alone gives no pass.",
        "0 held, 1 drifted",
        "What it means: The mass is elsewhere. Likeliest bug: the arcs",
    ):
        assert told in page.text


def course(case: str, error: float, **values: Any) -> CheckResult:
    """Make a passed comparison with the exact motion, in parts of the scale."""
    return result(case=case, error=error, measure="of_scale", **values)


@pytest.mark.parametrize(
    ("checks", "said"),
    [
        (
            [course("default", 2e-15), course("heat", 5e-15), course("sequence-001", 1e-15)],
            "Within 5e-15 of the exact motion in 2 cases and 1 random sequence.",
        ),
        ([course("default", 0.0)], "Equal to the last bit to the exact motion in 1 case."),
        # Neither another side, nor another truth, nor what does not apply tells of the distance.
        (
            [
                course("default", 1e-15),
                course("default", 1e-9, side="reference"),
                course("default", 1e-8, truth="invariant"),
                course("heat", 1e-7, passed=False, not_applicable="no slip"),
            ],
            "Within 1e-15 of the exact motion in 1 of 2 cases.",
        ),
        (
            [
                course("default", 1.0, passed=False),
                course("heat", 0.0),
                course("sequence-001", 1.0, passed=False),
                course("sequence-002", 0.0),
                course("", 1.0, passed=False),
            ],
            "Fails in 1 of 2 cases, 1 of 2 random sequences and in what the FMU declares, "
            "refuses and promises.",
        ),
        (
            [course("default", 0.0), course("", 1.0, passed=False)],
            "Fails in what the FMU declares, refuses and promises.",
        ),
        ([result(truth="invariant")], "No output was compared with the exact motion."),
    ],
)
def test_one_sentence_says_what_came_out(checks: list[CheckResult], said: str) -> None:
    """How near the exact motion over how many cases and sequences, or where it fails."""
    assert sentence(Verdict(checks)) == said


def test_the_likeliest_cause_fails_in_most_cases() -> None:
    """Equally often, an invariant goes first; then another program, then the reference alone."""
    bad: dict[str, Any] = {"passed": False, "error": 1.0}
    checks = [
        *(result(case=c, check="of-the-reference", side="reference", **bad) for c in "abcdef"),
        *(result(case=c, check="agree", truth="cross_code", side="both", **bad) for c in "abcde"),
        # Thrice in one case is one case.
        *(result(case="a", check="once", **bad) for _ in range(3)),
        *(result(case=case, check="course", **bad) for case in ("a", "sequence-001")),
        *(result(case=case, check="balance", truth="invariant", **bad) for case in "ab"),
        *(result(case=case, check="heat", **bad) for case in "abc"),
    ]
    order = ["heat", "balance", "course", "once", "agree", "of-the-reference"]
    assert [each.check for each in failed_checks(Verdict(checks), {})] == order
    text = Page(render(Verdict(checks, PROVENANCE))).text
    said = (
        "heat fails in 3 cases balance fails in 2 cases "
        "course fails in 1 case and 1 random sequence 3 more checks"
    )
    assert said in text


def test_the_contract_is_told_with_why_it_was_chosen() -> None:
    """One line on the first screen; the packed report says it too."""
    chosen = ChosenContract("physics", "--contract physics")
    text = Page(render(Verdict([result()], PROVENANCE, contract=chosen))).text
    assert "Contract: physics (--contract physics). Physics checks decide." in text


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


def test_every_comparison_is_a_row_with_the_reason_of_its_tolerance(page: Page) -> None:
    """A row has its verdict in words, and its last cell says where the tolerance comes from."""
    html = render(full_verdict(), drawn=DRAWN)
    rows = re.findall(r'<tr class="([\w-]+) \w+".*<td>(.*)</td></tr>', html)
    assert rows == [
        ("pass", "rounding &amp; &lt;friends&gt;"),
        ("pass", "integration"),
        ("fail", "integration"),
        ("not-applicable", "rounding"),
        ("pass", "rounding"),
        ("drift", "rounding"),
        ("noted", "rounding"),
    ]
    assert "rounding & <friends>" in page.text
    assert "no slip here" in page.text


def test_the_curve_of_the_first_screen_is_in_the_file_once() -> None:
    """Its case shows it again by a reference."""
    html = render(full_verdict(), drawn=DRAWN)
    assert html.count("drawn before") == 3
    assert html.count('<use href="#curve"/>') == 1
    (first,) = re.findall(r'<svg id="curve".*?</svg>', html)
    assert html.index(first) < html.index("</header>")


def test_the_cases_stand_in_groups_the_default_one_first(page: Page) -> None:
    """A case that failed is open, and in its group it comes before those that passed."""
    cases = [attrs for attrs in page.all("details") if "case" in (attrs.get("class") or "")]
    assert [attrs["class"] for attrs in cases] == [
        "case", "case failed whole", "case failed whole", "case",
    ]  # fmt: skip
    assert ["open" in attrs for attrs in cases] == [False, True, True, False]
    headings = [
        "Default parameters default",
        "Other settings: 0 of 2 passed tuned",
        "The FMU itself the FMU itself",
    ]
    places = [page.text.index(heading) for heading in headings]
    assert places == sorted(places)


def test_random_sequences_that_passed_are_counted_alone() -> None:
    """The page holds the comparisons of those that failed."""
    fine = [result(case=f"sequence-{n:03}", check=f"fine-{n}", error=9e-13) for n in range(30)]
    bad = result(case="sequence-030", check="bad", passed=False, error=1.0)
    html = render(Verdict([*fine, bad, result()], PROVENANCE))
    text = Page(html).text
    assert "Random sequences: 30 of 31 passed Those that passed are not shown" in text
    assert re.findall(r'<tr class="\w+ closed_form"[^>]*><th scope="row">([\w-]+)', html) == [
        "t_slip-exact",
        "bad",
    ]
    # The nearest to the tolerance are named, without a link that leads nowhere.
    assert "sequence-000 / fine-0 (FMU)" in text
    assert {attrs["href"] for attrs in Page(html).all("a") if "#r" in (attrs["href"] or "")} == {
        "#r30"
    }


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


def test_the_compact_form_has_what_is_printed_and_no_more() -> None:
    """The first five failed cases are there with all that they hold; every other is one line."""
    fine = [result(case="fine", check=f"fine-{n}") for n in range(5)]
    failing = [
        result(case=f"bad-{n}", check=check, passed=check != "bad", error=1.0)
        for n in range(7)
        for check in ("bad", "good")
    ]
    text = render(Verdict(fine + failing, PROVENANCE), compact=True)
    shown = re.findall(r'<tr class="\w+ closed_form"[^>]*><th scope="row">([\w-]+)', text)
    assert shown == 5 * ["bad", "good"]
    assert "bad-6 fail 1 passed, 1 failed" in Page(text).text
    assert "fine pass 5 passed, 0 failed" in Page(text).text
    assert "<script" not in text
    # No link leads to what was left out.
    ids = {attrs["id"] for _, attrs in Page(text).elements if "id" in attrs}
    assert {(attrs["href"] or "").removeprefix("#") for attrs in Page(text).all("a")} <= ids


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
    # Numbers are aligned, and each cell knows its heading.
    cells = [attrs for attrs in page.all("td") if (attrs.get("data-is") or "").startswith("c ")]
    number = {"class": "n"}
    assert cells == [
        number | {"data-is": "c = 0"},
        number | {"data-is": "c > 0"},
        {"data-is": "c = 0"},
        number | {"data-is": "c > 0"},
    ]


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
