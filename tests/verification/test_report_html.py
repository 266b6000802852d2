"""The report as a page: what it says, and that it asks for nothing outside itself."""

import itertools
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_verification import (
    CheckResult,
    KillMatrix,
    Meaning,
    Verdict,
    compare,
    read_earlier_report,
    render,
    write_json,
    write_report,
)
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import (
    CaseGroup,
    ChosenContract,
    Detection,
    Motion,
    ObservedOrder,
    Second,
    Table,
)
from tests.verification.test_report import result

VOID = {"meta", "input", "br", "hr", "link", "img"}
FMU = {"file": "StickSlip.fmu", "sha256": "ab12", "names": "their.toml", "problems": ["no GUID"]}
PROVENANCE = {"created": "today", "fmu": FMU}
DRAWN = dict.fromkeys(("default", "tuned"), '<svg role="img" aria-label="drawn before"></svg>')
MEANINGS = {"x-course": Meaning("The mass is elsewhere.", "the arcs")}
BAD: dict[str, Any] = {"passed": False, "error": 1.0}


class Page(HTMLParser):
    """A page that was read: its elements, and the text that a reader sees, with single blanks."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.words: list[str] = []
        self.feed(html)
        self.close()
        assert not self.open
        self.text = " ".join(" ".join(self.words).split())
        self.ids = [attrs["id"] for _, attrs in self.elements if "id" in attrs]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert len({name for name, _ in attrs}) == len(attrs), f"twice the same in {tag}"
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not {"style", "script"} & set(self.open):
            self.words.append(data)

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attrs for name, attrs in self.elements if name == tag]


def motion(case: str) -> Motion:
    """Make a mass that rests while the other end of its spring goes away."""
    t, zero = np.linspace(0.1, 1.0, 10), np.zeros(10)
    outputs = {
        **dict.fromkeys(("x", "x_dot", "mode"), zero),
        **dict.fromkeys(("x_pull", "z", "F"), t),
    }
    outputs["F_s"] = zero + 2.0
    record = Run(t, outputs, dict.fromkeys(outputs, 0.0) | {"F_s": 2.0})
    group = CaseGroup.DEFAULT if case == "default" else CaseGroup.SETTINGS
    title = f"The title of {case}"
    return Motion(case, title, "What it is about.", record, (), {"fmu": record}, group)


def verdict_of(*checks: CheckResult, **more: Any) -> Verdict:
    return Verdict(checks, PROVENANCE, **more)


def full_verdict(**origin: Any) -> Verdict:
    """Make a verdict with some of everything."""
    drifted = Second(1.0, 2.0, drift=1.0, tolerance=1e-9)
    checks = [
        result(tolerance=2e-12, error=1e-12, because="rounding & <friends>"),
        result(side="reference", because="integration"),
        result(case="tuned", check="x-course", **BAD, because="integration"),
        result(case="tuned", check="energy", truth="invariant", **BAD, not_applicable="no slip"),
        result(case="tuned", check="agree", truth="cross_code", side="both"),
        result(case="", check="units", klass="contract", decides=False, **BAD),
        result(case="heat", check="Q-course", second=drifted),
    ]
    rows = (
        Detection("late", "an event comes late", ("t_slip-exact",), {"t_slip-exact": 3}, True),
        Detection("creep", "the mass creeps", ("x-course",), {"energy": 2}, caught=False),
        Detection("deaf", "it does not start", ("units",), {}, False, broken="ImportError"),
    )
    names = ("t_slip-exact", "x-course", "energy", "units")
    order = ObservedOrder("default", "x", (1e-3, 1e-6), (2e-3, 2e-6), (1.0,), 1.0)
    return Verdict(
        checks,
        PROVENANCE | origin,
        [motion("default"), motion("tuned")],
        [order],
        KillMatrix(names, rows, {"units": "it guards"}),
        ChosenContract("physics", "--contract physics"),
    )


@pytest.fixture(scope="module")
def page() -> Page:
    return Page(render(full_verdict(), meanings=MEANINGS))


FIRST = """\
StickSlip.fmu fail
Fails in 2 of 3 cases. A planted fault survived
Likeliest cause: the arcs x-course fails in 1 case: The mass is elsewhere.
Contract: physics (--contract physics). Physics checks decide.
7 comparisons: 3 passed, 2 failed, 1 noted, 1 not applicable
tuned: the line is the exact motion"""


def test_the_first_screen_says_what_failed_why_and_by_which_contract(page: Page) -> None:
    first = page.text[: page.text.index("Failures x-course")]
    assert [words for words in FIRST.splitlines() if words not in first] == []


WORDS = """\
ab12
their.toml maps the variables
no GUID
It is not validation.
both may be wrong alike, so it alone gives no pass.
0 held, 1 drifted
What it means: The mass is elsewhere. Likeliest bug: the arcs
1 of 3 detected, 1 survived, 1 could not be judged
t_slip-exact (3)
units it guards
rounding & <friends>
no slip
Default parameters default
Other settings: 0 of 2 passed tuned
The FMU itself the FMU itself"""


def test_what_was_judged_and_what_it_is_worth_is_on_the_page(page: Page) -> None:
    assert [words for words in WORDS.splitlines() if words not in page.text] == []


def course(case: str, error: float, **values: Any) -> CheckResult:
    """Make a passed comparison with the exact motion, in parts of the scale."""
    return result(case=case, error=error, measure="of_scale", **values)


NA = {"not_applicable": "no slip"}
ITSELF = "what the FMU declares, refuses and promises."
NEAR = [course("default", 2e-15), course("heat", 5e-15), course("sequence-001", 1e-15)]
# Neither another side, nor another truth, nor what does not apply has that distance.
FAR = [course("a", 9e-9, side="reference"), course("a", 9e-8, truth="invariant")]
FAR.append(course("b", 1e-7, passed=False, **NA))
HALF = [course(f"{c}{n}", 1.0, passed=n > 1) for c in ("case", "sequence-") for n in (1, 2)]
BROKEN = course("", 1.0, passed=False)
AGREED = result(truth="cross_code", side="both")


@pytest.mark.parametrize(
    ("checks", "words"),
    [
        (NEAR, "Within 5e-15 of the exact motion in 2 cases and 1 random sequence."),
        ([course("a", 0.0)], "Equal to the last bit to the exact motion in 1 case."),
        ([course("a", 1e-15), *FAR], "Within 1e-15 of the exact motion in 1 of 2 cases."),
        ([*HALF, BROKEN], f"Fails in 1 of 2 cases, 1 of 2 random sequences and in {ITSELF}"),
        ([course("default", 0.0), BROKEN], f"Fails in {ITSELF}"),
        ([result(truth="invariant")], "No output was compared with the exact motion."),
        ([AGREED], "No comparison of the FMU with a closed form or an invariant passed."),
        ([result()], "StickSlip.fmu pass"),
    ],
)
def test_one_sentence_says_how_near_the_exact_motion_it_is_or_where_it_fails(
    checks: list[CheckResult], words: str
) -> None:
    text = Page(render(verdict_of(*checks))).text
    assert words in text
    assert ("Failures" in text) == words.startswith("Fails")


def test_the_likeliest_cause_fails_in_most_cases() -> None:
    # Equally often, an invariant goes first; then another program, then the reference alone.
    named: list[tuple[str, str, dict[str, Any]]] = [
        ("abcdef", "of-the-reference", {"side": "reference"}),
        ("abcde", "agree", {"truth": "cross_code", "side": "both"}),
        ("aaa", "once", {}),
        ("ab", "course", {}),
        ("ab", "balance", {"truth": "invariant"}),
        ("abc", "heat", {}),
    ]
    checks = [
        result(case=c, check=name, **BAD, **values) for cases, name, values in named for c in cases
    ]
    text = Page(render(verdict_of(*checks))).text
    first, _, failures = text.partition("3 more checks")
    assert "heat fails in 3 cases balance fails in 2 cases course fails in 2 cases" in first
    order = ("heat", "balance", "course", "once", "agree", "of-the-reference")
    places = [failures.index(f"{name} ") for name in order]
    assert places == sorted(places)


def test_every_comparison_is_a_row_with_the_reason_and_a_curve_is_there_once() -> None:
    html = render(full_verdict(), drawn=DRAWN)
    rows = re.findall(r'<tr class="([\w-]+) \w+".*<td>(.*)</td></tr>', html)
    outcomes = ["pass", "pass", "fail", "not-applicable", "pass", "drift", "noted"]
    reasons = ["rounding &amp; &lt;friends&gt;", *["integration"] * 2, *["rounding"] * 4]
    assert rows == list(zip(outcomes, reasons, strict=True))
    # Its case shows the curve of the first screen by a reference.
    assert html.count('<use href="#curve"/>') == 1
    assert html.index('<svg id="curve"') < html.index("</header>")


def test_a_failed_case_is_open_and_comes_before_those_that_passed(page: Page) -> None:
    cases = [attrs for attrs in page.all("details") if "case" in (attrs.get("class") or "")]
    failed = ["failed" in (attrs["class"] or "") for attrs in cases]
    assert failed == ["open" in attrs for attrs in cases] == [False, True, True, False]


def test_of_the_random_sequences_those_that_failed_are_shown_and_all_are_counted() -> None:
    fine = [result(case=f"sequence-{n:03}", check=f"fine-{n}", error=9e-13) for n in range(30)]
    bad = result(case="sequence-030", check="bad", **BAD)
    html = render(verdict_of(*fine, bad, result()))
    page = Page(html)
    assert "Random sequences: 30 of 31 passed" in page.text
    shown = re.findall(r'<tr class="\w+ closed_form"[^>]*><th scope="row">([\w-]+)', html)
    assert shown == ["t_slip-exact", "bad"]
    # The nearest to the tolerance are named, without a link that leads nowhere.
    assert "sequence-000 / fine-0 (FMU)" in page.text
    assert {attrs["href"] for attrs in page.all("a") if "#r" in (attrs["href"] or "")} == {"#r30"}


def test_the_page_is_whole_and_asks_for_nothing_outside_itself(page: Page) -> None:
    assert len(page.ids) == len(set(page.ids))
    links = [attrs.get("href") or "" for tag in ("a", "use") for attrs in page.all(tag)]
    assert links
    assert set(links) <= {f"#{id_}" for id_ in page.ids}
    html = render(full_verdict())
    assert not re.search(r"https?:|\bsrc=|@import|<link|url\((?!#)", html)


def test_the_page_can_be_read_without_its_looks(page: Page) -> None:
    assert page.all("html") == [{"lang": "en"}]
    assert (len(page.all("title")), len(page.all("h1"))) == (1, 1)
    assert all(attrs.get("scope") for attrs in page.all("th"))
    assert all(attrs.get("role") and attrs.get("aria-label") for attrs in page.all("svg"))
    levels = [int(tag[1]) for tag, _ in page.elements if re.fullmatch(r"h\d", tag)]
    assert all(after <= before + 1 for before, after in itertools.pairwise(levels))


def test_only_the_dated_block_knows_where_when_and_what_was_earlier(tmp_path: Path) -> None:
    here = render(full_verdict(created="today", platform="here"))
    there = render(full_verdict(created="tomorrow", platform="there", command="stickslip verify"))
    cut = re.compile(r"<!-- dated: begin -->.*<!-- dated: end -->", re.DOTALL)
    assert here != there
    assert cut.sub("", here) == cut.sub("", there)
    assert "stickslip verify" in Page(there).text
    earlier = tmp_path / "earlier.json"
    write_json(verdict_of(result(error=1e-14)), earlier)
    now = verdict_of(result(error=9e-13))
    html = render(now, margins=compare(read_earlier_report(earlier), now))
    assert "Margins that grew by more than a factor 2: 1;" in Page(html).text
    assert ("earlier.json" in html, "earlier.json" in cut.sub("", html)) == (True, False)


def test_markup_in_a_message_of_an_fmu_is_shown_and_not_obeyed() -> None:
    text = render(verdict_of(result(failure="<script>alert(1)</script>", passed=False)))
    assert "<script>alert" not in text
    assert "<script>alert(1)</script>" in Page(text).text


def test_a_table_of_the_verdict_is_a_section() -> None:
    rows: list[tuple[str, str | int]] = [
        ("load in stick", 12),
        ("load at v = 0", "no stick <ends>"),
    ]
    table = Table("Coverage", "Where things changed.", ("change", "c = 0"), rows, "Seed 1.")
    page = Page(render(verdict_of(result(), tables=[table])))
    assert {"href": "#table-0"} in page.all("a")
    words = "change c = 0 load in stick 12 load at v = 0 no stick <ends> Seed 1."
    assert f"Coverage Where things changed. {words}" in page.text
    # Numbers are aligned, and each cell knows its heading.
    assert {"class": "n", "data-is": "c = 0"} in page.all("td")


def test_the_files_are_written_together_or_not_at_all(tmp_path: Path) -> None:
    write_report(full_verdict(), tmp_path, drawn=DRAWN)
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    assert set(before) == {"index.html", "junit.xml", "report.json"}
    with pytest.raises(TypeError):
        write_report(full_verdict(versions={"a": {1, 2}}), tmp_path, drawn=DRAWN)
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before
