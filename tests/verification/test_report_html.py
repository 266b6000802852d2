"""The report as a page: what it says, and that it asks for nothing outside itself."""

import re
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_verification import (
    CheckResult,
    KillMatrix,
    Meaning,
    Verdict,
    render,
    write_report,
)
from stickslip_verification.model.verdict import (
    CaseGroup,
    ChosenContract,
    Detection,
    Motion,
    ObservedOrder,
    Run,
    Table,
)
from tests.verification.test_report import result

FMU = {"file": "StickSlip.fmu", "sha256": "ab12", "names": "their.toml", "problems": ["no GUID"]}
PROVENANCE = {"created": "today", "fmu": FMU}
MEANINGS = {"x-course": Meaning("The mass is elsewhere.", "the arcs")}
BAD: dict[str, Any] = {"passed": False, "error": 1.0}


def text_of(page: str) -> str:
    seen = re.sub(r"<(style|script).*?</\1>|<[^>]+>", " ", page, flags=re.DOTALL)
    return " ".join(unescape(seen).split())


def motion(case: str) -> Motion:
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


def full_verdict(**origin: Any) -> Verdict:
    checks = [
        result(tolerance=2e-12, error=1e-12, because="rounding & <friends>"),
        result(side="reference", because="integration"),
        result(case="tuned", check="x-course", **BAD, because="integration"),
        result(case="tuned", check="energy", truth="invariant", **BAD, not_applicable="no slip"),
        result(case="tuned", check="agree", truth="cross_code", side="both"),
        result(case="", check="units", klass="contract", decides=False, **BAD),
        result(case="heat", check="Q-course", passed=False),
    ]
    rows = (
        Detection("late", "an event comes late", ("t_slip-exact",), {"t_slip-exact": 3}, True),
        Detection("creep", "the mass creeps", ("x-course",), {"energy": 2}, caught=False),
        Detection("deaf", "it does not start", ("units",), {}, False, broken="ImportError"),
    )
    names = ("t_slip-exact", "x-course", "energy", "units")
    order = ObservedOrder("default", "x", (1e-3, 1e-6), (2e-3, 2e-6), (1.0,), 1.0)
    table = Table(
        "Coverage", "What was tried.", ("what", "c = 0"), [("load <ends>", 12)], "Seed 1."
    )
    return Verdict(
        checks,
        PROVENANCE | origin,
        [motion("default"), motion("tuned")],
        [order],
        KillMatrix(names, rows, {"units": "it guards"}),
        ChosenContract("physics", "--contract physics"),
        [table],
    )


WORDS = """\
StickSlip.fmu fail
Fails in 2 of 3 cases. A planted fault survived
Likeliest cause: the arcs x-course fails in 1 case: The mass is elsewhere.
Contract: physics (--contract physics). Physics checks decide.
7 comparisons: 3 passed, 2 failed, 1 noted, 1 not applicable
file with the names of its variables their.toml
1 of 3 detected, 1 survived, 1 could not be judged
t_slip-exact (3)
units it guards
rounding & <friends>
Other settings: 0 of 2 passed tuned
Coverage What was tried. what c = 0 load <ends> 12 Seed 1."""


def test_what_was_judged_failed_and_why_and_what_it_is_worth_is_on_the_page() -> None:
    page = render(full_verdict(), meanings=MEANINGS)
    text = text_of(page)
    assert [words for words in WORDS.splitlines() if words not in text] == []
    # What failed is open and comes before what passed.
    cases = re.findall(r'<details class="case[^>]*>', page)
    assert ["open" in each for each in cases] == ["failed" in each for each in cases]
    # It is whole and asks for nothing outside itself.
    ids = re.findall(r'\sid="([^"]+)"', page)
    links = re.findall(r'<(?:a|use)\s[^>]*href="#([^"]+)"', page)
    assert len(ids) == len(set(ids))
    assert links
    assert set(links) <= set(ids)
    assert not re.search(r'https?:|\bsrc=|@import|<link|url\((?!#)|href="(?!#)', page)


def course(case: str, error: float, **values: Any) -> CheckResult:
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
# What fails in most cases; equally often, an invariant goes first; last the reference alone.
CAUSES: list[tuple[str, str, dict[str, Any]]] = [
    ("abcdef", "of-the-reference", {"side": "reference"}),
    ("abcde", "agree", {"truth": "cross_code", "side": "both"}),
    ("ab", "course", {}),
    ("ab", "balance", {"truth": "invariant"}),
    ("abc", "heat", {}),
]
BY_CAUSE = [result(case=c, check=n, **BAD, **more) for cases, n, more in CAUSES for c in cases]
MARKUP = "<script>alert(1)</script>"


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
        ([result(failure=MARKUP, passed=False)], MARKUP),
        (BY_CAUSE, "heat fails in 3 cases balance fails in 2 cases course fails in 2 cases"),
    ],
)
def test_a_sentence_says_how_near_the_exact_motion_it_is_or_where_it_fails_and_why(
    checks: list[CheckResult], words: str
) -> None:
    page = render(Verdict(checks, PROVENANCE))
    assert words in text_of(page)
    assert MARKUP not in page


def test_only_the_dated_block_knows_where_and_when() -> None:
    here = render(full_verdict(created="today", platform="here"))
    there = render(full_verdict(created="tomorrow", platform="there", command="stickslip verify"))
    cut = re.compile(r"<!-- dated: begin -->.*<!-- dated: end -->", re.DOTALL)
    assert here != there
    assert cut.sub("", here) == cut.sub("", there)
    assert "stickslip verify" in text_of(there)


def test_of_the_random_sequences_those_that_failed_are_shown_and_all_are_counted() -> None:
    fine = [result(case=f"sequence-{n:03}", check="fine") for n in range(30)]
    bad = result(case="sequence-030", check="bad", **BAD)
    page = render(Verdict([*fine, bad, result()], PROVENANCE))
    assert "Random sequences: 30 of 31 passed" in text_of(page)
    # A link leads to what is shown.
    assert set(re.findall('href="(#r[^"]*)"', page)) == {"#r30"}


def test_the_files_are_written_together_or_not_at_all(tmp_path: Path) -> None:
    write_report(full_verdict(), tmp_path)
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    assert set(before) == {"index.html", "junit.xml", "report.json"}
    with pytest.raises(ValueError, match="serialize"):
        write_report(full_verdict(versions={"a": [object()]}), tmp_path)
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before
