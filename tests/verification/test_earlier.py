"""How margins moved since an earlier report."""

import io
import json
import math
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from stickslip.show.earlier_table import earlier_table
from stickslip_verification import (
    EarlierReportError,
    Verdict,
    compare,
    read_earlier_report,
    write_json,
)
from stickslip_verification.report.earlier import FLOOR, Moves
from tests.verification.test_report import result

PROVENANCE = {"created": "2026-01-02T03:04:05+00:00", "fmu": {"file": "a.fmu", "sha256": "ab"}}
FAILED: dict[str, Any] = {"got": None, "error": None, "passed": False}
DOWN: dict[str, Any] = {"error": 1e-13}


def moves(folder: Path, before: list[Any], now: list[Any]) -> Moves:
    write_json(Verdict(before, PROVENANCE), folder / "old.json")
    return compare(read_earlier_report(folder / "old.json"), Verdict(now))


def test_the_same_verdict_has_not_moved(tmp_path: Path) -> None:
    results = [result(error=5e-13), result(side="reference", **FAILED)]
    same = moves(tmp_path, results, results)
    assert same.compared == 2
    assert not (*same.grew, *same.shrank, *same.changed, *same.new, *same.gone)
    assert (same.baseline.created, same.baseline.sha256) == (PROVENANCE["created"], "ab")


@pytest.mark.parametrize(
    ("before", "now", "factor"),
    [
        # More than a factor 2 either way is a move.
        (1e-13, 1.9e-13, None),
        (1e-13, 2.1e-13, 2.1),
        (1e-13, 0.55e-13, None),
        (1e-13, 0.45e-13, 0.45),
        # From nothing to a thousandth of the tolerance is rounding.
        (0.0, 1.9 * FLOOR * 1e-12, None),
        (1e-30, 1e-14, 0.01 / FLOOR),
    ],
)
def test_a_margin_that_doubled_or_halved_beyond_rounding_has_moved(
    tmp_path: Path, before: float, now: float, factor: float | None
) -> None:
    found = moves(tmp_path, [result(error=before)], [result(error=now)])
    moved = [*found.grew, *found.shrank]
    assert [move.factor for move in moved] == (
        [] if factor is None else [pytest.approx(factor, rel=1e-9)]  # decimals in the file
    )
    assert len(found.grew) == (factor is not None and factor > 1.0)


def test_new_gone_and_changed_checks_are_told_the_furthest_first(tmp_path: Path) -> None:
    before = [*(result(check=n) for n in ("gone", "a")), *(result(check=n, **DOWN) for n in "bc")]
    skipped = result(check="b", **FAILED, not_applicable="no slip")
    crashed = result(check="a", **FAILED, failure="it refused")
    now = [result(check="new"), crashed, skipped, result(check="c", error=9e-13)]
    found = moves(tmp_path, before, now)
    assert found.new == [("default", "new", "fmu")]
    assert found.gone == [("default", "gone", "fmu")]
    told = [(move.check, move.before.verdict, move.now.verdict) for move in found.changed]
    assert told == [("a", "pass", "fail"), ("b", "pass", "not applicable")]
    assert [move.check for move in found.grew] == ["a", "c"]
    assert math.isinf(found.grew[0].now.margin)
    console = Console(file=io.StringIO(), width=140)
    console.print(earlier_table(found))
    text = console.file.getvalue()  # type: ignore[attr-defined]
    for words in ("pass → fail", "1 new: default / new (fmu)", "grew more than 2 times: 2"):
        assert words in text


def test_a_report_that_tells_only_what_passed_can_be_read(tmp_path: Path) -> None:
    row = {"case": "default", "check": "T", "side": "fmu", "error": 2e-13, "tolerance": 1e-12}
    text = json.dumps({"checks": [{**row, "passed": True}]})
    (tmp_path / "old.json").write_text(text, encoding="utf-8")
    entry = read_earlier_report(tmp_path / "old.json").entries["default", "T", "fmu"]
    assert entry.margin == pytest.approx(0.2)  # decimals in the file
    assert entry.verdict == "pass"


ROW = (
    b'{"checks": [{"case": %s, "check": "", "side": "", "error": %s, "tolerance": 1,'
    b'"passed": true}]}'
)


@pytest.mark.parametrize(
    "content",
    [
        *(None, b"", b"\xff\xfe", b"[1, 2]", b'{"checks": 3}', b'{"checks": [3]}', b"[" * 100_000),
        *(b'{"checks": [{"case": "a"}]}', ROW % (b"[]", b"0"), ROW % (b'""', b'"much"')),
    ],
)
def test_what_is_no_report_is_told_in_one_line(tmp_path: Path, content: bytes | None) -> None:
    file = tmp_path / "old.json"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(EarlierReportError) as told:
        read_earlier_report(file)
    assert "\n" not in str(told.value)
    assert str(told.value).startswith(f"{file}: ")
