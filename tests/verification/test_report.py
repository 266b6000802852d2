"""The verdict, and its JSON and JUnit files: what a machine reads is what the verdict says."""

import hashlib
import json
import math
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from stickslip_verification import CheckResult, KillMatrix, Verdict, write_json
from stickslip_verification.drive.instance import FmuFile
from stickslip_verification.model.verdict import (
    ChosenContract,
    Detection,
    Kind,
    ObservedOrder,
    Table,
)
from stickslip_verification.report.files import as_junit
from stickslip_verification.run.verify import provenance

PASSED = CheckResult(
    case="default", check="t_slip-exact", quantity="t_slip", unit="s", truth=Kind.CLOSED_FORM,
    side="fmu", expected=0.1, got=0.1, error=0.0, tolerance=1e-12, because="rounding", passed=True,
)  # fmt: skip


def result(**values: Any) -> CheckResult:
    return replace(PASSED, **values)


RESULTS = [
    result(),
    result(side="reference", error=3e-3, passed=False),
    result(case="tuned", passed=False, decides=False, error=1.0, klass="contract"),
    result(case="tuned", passed=False, not_applicable="no slip", got=None, error=None),
    result(case="", check="units", passed=False),
]
CRASHED = result(got=math.nan, error=math.inf, passed=False, failure="FmuError: it refused")
PHYSICS = ChosenContract("physics", "--contract physics")


@pytest.mark.parametrize(
    ("checks", "passes"),
    [
        ([], False),
        ([result()], True),
        ([result(), result(passed=False)], False),
        ([result(), result(passed=False, decides=False)], True),
        ([result(), result(passed=False, not_applicable="no slip")], True),
        # Two programs that agree, the reference alone or the interface alone prove no motion.
        ([result(truth="cross_code", side="both")], False),
        ([result(side="reference")], False),
        ([result(case="")], False),
    ],
)
def test_a_verdict_passes_where_the_fmu_met_a_truth_and_nothing_failed(
    checks: list[CheckResult], passes: bool
) -> None:
    assert Verdict(checks).passed == passes


def refuse(constant: str) -> None:
    raise AssertionError(f"{constant} is not JSON")


def test_all_that_stands_behind_a_verdict_is_in_the_file(tmp_path: Path) -> None:
    order = ObservedOrder("default", "x", (1e-3, 1e-6), (1e-3, math.inf), (1.0,), 1.0)
    caught = Detection("late", "an event comes late", ("T-exact",), {"T-exact": 3}, caught=True)
    kills = KillMatrix(("T-exact", "idle"), (caught,), {"idle": "it guards the interface"})
    table = Table("Counts", "What was tried.", ("what", "c = 0"), [("load", 3), ("v", math.inf)])
    verdict = Verdict([*RESULTS, CRASHED], {"git": None}, (), [order], kills, PHYSICS, [table])
    file = tmp_path / "new" / "report.json"
    write_json(verdict, file)
    report = json.loads(file.read_text("utf-8"), parse_constant=refuse)
    counts = {"passed": 1, "failed": 3, "noted": 1, "not_applicable": 1}
    assert report["summary"] == report["by_kind"]["closed_form"] == counts
    assert report["passed"] is False
    row = report["checks"][4]
    assert (row["check"], row["class"], row["verdict"]) == ("units", "physics", "fail")
    assert {row[each] for each in ("expected", "got")} == {0.1}
    assert (row["error"], row["tolerance"], row["because"]) == (0.0, 1e-12, "rounding")
    assert report["checks"][5]["because"].startswith("FmuError: it refused")
    # What is not finite is null.
    assert (report["checks"][5]["got"], report["checks"][5]["error"]) == (None, None)
    assert report["orders"][0]["errors"] == [1e-3, None]
    assert report["tables"][0]["rows"] == [["load", 3], ["v", None]]
    assert report["kills"]["passed"] is True
    assert report["kills"]["rows"][0]["failing"] == {"T-exact": 3}
    assert report["contract"] == {"name": "physics", "why": "--contract physics"}


def test_the_provenance_names_the_bytes_that_were_judged(fmu_path: Path) -> None:
    of = provenance(FmuFile(fmu_path), "stickslip verify")
    assert of["fmu"]["file"] == fmu_path.name
    assert of["fmu"]["sha256"] == hashlib.sha256(fmu_path.read_bytes()).hexdigest()
    assert {"python", "stickslip", "numpy", "scipy", "mpmath", "fmpy"} <= set(of["versions"])
    assert of["command"] == "stickslip verify"
    json.dumps(of, allow_nan=False)


def test_each_result_is_a_test_case_of_junit_and_all_counts_agree() -> None:
    survivor = Detection("creep", "the mass creeps", ("x-course",), {}, caught=False)
    kills = KillMatrix((), (survivor,), {"idle": ""})
    root = ET.fromstring(as_junit(Verdict(RESULTS, contract=PHYSICS, kills=kills)))
    said = {each.get("name"): {child.tag for child in each} for each in root.iter("testcase")}
    assert said["planted fault creep"] == said["kills_nothing check idle"] == {"failure"}
    tags = [[child.tag for child in each] for each in root.iter("testcase")]
    assert tags[:5] == [[], ["failure"], ["system-out"], ["skipped"], ["failure"]]
    for group in (root, *root):
        counted = {tag: len(list(group.iter(tag))) for tag in ("testcase", "failure", "skipped")}
        counts = [int(group.get(name, "")) for name in ("tests", "failures", "skipped", "errors")]
        assert counts == [*counted.values(), 0]
    first, failure = next(root.iter("testcase")), next(root.iter("failure"))
    assert first.attrib == {"classname": "default", "name": "t_slip-exact (FMU)"}
    assert failure.get("message") == "error 0.003 is above 1e-12 s"
    assert "because: rounding" in str(failure.text)


def test_a_message_of_an_fmu_cannot_break_junit_nor_does_a_date_change_it() -> None:
    wild = result(passed=False, got=None, error=None, failure="a\x00b\x1b[31m <&\"'> \ud800 ]]>")
    text = as_junit(Verdict([wild]))
    failure = next(ET.fromstring(text.encode("utf-8")).iter("failure"))
    assert failure.get("message") == "a\ufffdb\ufffd[31m <&\"'> \ufffd ]]>"
    assert text == as_junit(Verdict([wild], {"created": "today"}))
