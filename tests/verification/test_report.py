"""The verdict's JSON: its layout, its numbers, and how it is written."""

import hashlib
import json
import math
from pathlib import Path
from typing import Any

import pytest

from stickslip_verification import CheckResult, Verdict, write_json
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.model.verdict import (
    ChosenContract,
    Detection,
    KillMatrix,
    ObservedOrder,
    Second,
    Table,
)
from stickslip_verification.report import provenance

LAYOUT = [
    "case",
    "check",
    "quantity",
    "unit",
    "truth",
    "class",
    "side",
    "measure",
    "expected",
    "got",
    "error",
    "tolerance",
    "because",
    "passed",
    "decides",
    "verdict",
    "failure",
    "not_applicable",
    "second",
]


def result(**values: Any) -> CheckResult:
    """Make a passed result, but for `values`."""
    usual: dict[str, Any] = {
        "case": "default",
        "check": "t_slip-exact",
        "quantity": "t_slip",
        "unit": "s",
        "truth": "closed_form",
        "side": "fmu",
        "expected": 0.1,
        "got": 0.1,
        "error": 0.0,
        "tolerance": 1e-12,
        "because": "rounding",
        "passed": True,
    }
    return CheckResult(**{**usual, **values})


def refuse(constant: str) -> None:
    """Fail on the names that Python's reader takes for numbers and JSON does not."""
    raise AssertionError(f"{constant} is not JSON")


def test_the_report_has_the_agreed_layout(tmp_path: Path) -> None:
    """The file holds the agreed parts, and each check exactly the agreed keys."""
    file = tmp_path / "new" / "report.json"
    verdict = Verdict([result(), result(side="reference", passed=False)], {"git": None})
    write_json(verdict, file)
    report = json.loads(file.read_text(encoding="utf-8"), parse_constant=refuse)
    assert list(report) == [
        "summary",
        "passed",
        "by_kind",
        "checks",
        "orders",
        "kills",
        "contract",
        "tables",
        "provenance",
    ]
    counts = {"passed": 1, "failed": 1, "noted": 0, "not_applicable": 0}
    assert report["summary"] == counts
    assert report["by_kind"] == {"closed_form": counts}
    assert report["kills"] is None
    assert all(list(row) == LAYOUT for row in report["checks"])
    assert report["provenance"] == {"git": None}
    assert [path.name for path in file.parent.iterdir()] == ["report.json"]


def test_what_is_not_a_number_is_null(tmp_path: Path) -> None:
    """No NaN and no infinity reaches the file, and a failure without numbers tells its reason."""
    file = tmp_path / "report.json"
    broken = result(got=math.nan, error=math.inf, passed=False)
    crashed = result(got=None, error=None, passed=False, failure="FmuError: it refused")
    write_json(Verdict([broken, crashed]), file)
    rows = json.loads(file.read_text(encoding="utf-8"), parse_constant=refuse)["checks"]
    assert [(row["got"], row["error"]) for row in rows] == [(None, None), (None, None)]
    assert rows[1]["because"] == "FmuError: it refused (the tolerance: rounding)"


def test_what_stands_behind_a_verdict_is_in_the_file(tmp_path: Path) -> None:
    """Second values, orders and planted faults are written in plain numbers."""
    file = tmp_path / "report.json"
    drifted = result(second=Second(0.1, 0.2, drift=1.0, tolerance=1e-9))
    order = ObservedOrder("default", "x", (1e-3, 1e-6), (1e-3, math.inf), (1.0,), 1.0)
    caught = Detection("late", "an event comes late", ("T-exact",), {"T-exact": 3}, caught=True)
    kills = KillMatrix(
        ("T-exact", "kills_nothing"), (caught,), {"kills_nothing": "it guards the interface"}
    )
    write_json(Verdict([drifted], orders=[order], kills=kills), file)
    report = json.loads(file.read_text(encoding="utf-8"), parse_constant=refuse)
    row = report["checks"][0]
    assert row["verdict"] == "drift"
    assert row["second"] == {"accepted": 0.1, "got": 0.2, "drift": 1.0, "tolerance": 1e-9}
    assert report["orders"][0]["errors"] == [1e-3, None]
    assert report["kills"]["passed"] is True
    assert report["kills"]["rows"][0]["failing"] == {"T-exact": 3}
    assert report["passed"] is False


def test_tables_and_the_contract_are_in_the_file(tmp_path: Path) -> None:
    """A table keeps its numbers as numbers, and a number that is not finite is null."""
    file = tmp_path / "report.json"
    table = Table("Counts", "What was tried.", ("what", "c = 0"), [("load", 3), ("v", math.inf)])
    chosen = ChosenContract("physics", "--contract physics")
    write_json(Verdict([result()], contract=chosen, tables=[table]), file)
    report = json.loads(file.read_text(encoding="utf-8"), parse_constant=refuse)
    assert report["contract"] == {"name": "physics", "why": "--contract physics"}
    assert report["tables"] == [
        {
            "title": "Counts",
            "about": "What was tried.",
            "head": ["what", "c = 0"],
            "rows": [["load", 3], ["v", None]],
            "note": "",
        }
    ]


def test_a_table_whose_rows_do_not_fit_its_head_is_refused() -> None:
    """The message names the table and the row."""
    with pytest.raises(ValueError, match=r"table 'Counts': row \['load'\] has 1 cells, the head 2"):
        Table("Counts", "", ("what", "c = 0"), [["load"]])


def test_random_sequences_are_counted_apart_from_cases() -> None:
    """The FMU as a whole is neither a case nor a sequence."""
    verdict = Verdict(
        [result(), result(case="sequence-017"), result(case=""), result(), result(case="heat")]
    )
    assert verdict.cases == ["default", "heat"]
    assert verdict.sequences == ["sequence-017"]


def test_a_failed_write_leaves_the_old_report(tmp_path: Path) -> None:
    """A report that cannot be written whole does not touch what was there."""
    file = tmp_path / "report.json"
    file.write_text("old", encoding="utf-8")
    with pytest.raises(TypeError):
        write_json(Verdict([result()], {"versions": {1, 2}}), file)
    assert file.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [file]


def test_a_verdict_without_checks_does_not_pass() -> None:
    """Nothing checked is nothing proven."""
    assert not Verdict([]).passed
    assert Verdict([result()]).passed
    assert not Verdict([result(), result(passed=False)]).passed


def test_the_provenance_names_the_bytes_that_were_judged(foreign_fmu: Path) -> None:
    """The SHA-256 is that of the FMU file, and every version is told."""
    told = provenance.collect(FmuFile(foreign_fmu), "stickslip verify")
    assert told["fmu"]["file"] == foreign_fmu.name
    assert told["fmu"]["sha256"] == hashlib.sha256(foreign_fmu.read_bytes()).hexdigest()
    assert {"python", "stickslip", "numpy", "scipy", "mpmath", "fmpy"} <= set(told["versions"])
    assert told["command"] == "stickslip verify"
    assert "can rewrite what that code reports" in told["trust"]
    assert told["platform"]
    json.dumps(told, allow_nan=False)


def test_the_revision_is_that_of_our_own_source(tmp_path: Path) -> None:
    """A package outside our working copy, in another one or in none, has no revision."""
    assert provenance._git(tmp_path / "stickslip_verification") is None
