"""How margins moved since an earlier report."""

import io
import json
import math
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from stickslip.show.earlier_table import earlier_table
from stickslip_verification import Verdict, write_json
from stickslip_verification.report.earlier import (
    FLOOR,
    EarlierReportError,
    Moves,
    compare,
    read_earlier_report,
)
from tests.verification.test_report import result

PROVENANCE = {"created": "2026-01-02T03:04:05+00:00", "fmu": {"file": "a.fmu", "sha256": "ab"}}


def moves(folder: Path, before: list[Any], now: list[Any]) -> Moves:
    """Compare a verdict with a report of another one, through its file."""
    write_json(Verdict(before, PROVENANCE), folder / "old.json")
    return compare(read_earlier_report(folder / "old.json"), Verdict(now))


def test_the_same_verdict_has_not_moved(tmp_path: Path) -> None:
    """What a report says of itself comes back: no margin, no verdict, no check differs."""
    results = [result(error=5e-13), result(side="reference", got=None, error=None, passed=False)]
    same = moves(tmp_path, results, results)
    assert same.compared == 2
    assert not (*same.grew, *same.shrank, *same.changed, *same.new, *same.gone)
    assert same.baseline.created == PROVENANCE["created"]
    assert same.baseline.sha256 == "ab"


def test_a_margin_that_doubled_has_moved(tmp_path: Path) -> None:
    """More than a factor 2 either way is a move, less is none, and the furthest comes first."""
    before = [result(check=name, error=1e-13) for name in "abcde"]
    now = [
        result(check=name, error=factor * 1e-13)
        for name, factor in zip("abcde", (1.9, 2.1, 8.0, 0.55, 0.45), strict=True)
    ]
    found = moves(tmp_path, before, now)
    assert [move.check for move in found.grew] == ["c", "b"]
    assert [move.check for move in found.shrank] == ["e"]
    assert found.grew[0].factor == pytest.approx(8.0)


def test_rounding_is_no_move(tmp_path: Path) -> None:
    """From nothing to a thousandth of the tolerance is rounding; from there on it counts."""
    before = [result(check="a", error=0.0), result(check="b", error=1e-30)]
    now = [result(check="a", error=1.9 * FLOOR * 1e-12), result(check="b", error=1e-14)]
    assert [move.check for move in moves(tmp_path, before, now).grew] == ["b"]


def test_a_wider_tolerance_shows_as_a_smaller_margin(tmp_path: Path) -> None:
    """A margin is error over tolerance, so it tells when someone made room."""
    found = moves(tmp_path, [result(error=9e-13)], [result(error=9e-13, tolerance=1e-9)])
    assert [(move.before.tolerance, move.now.tolerance) for move in found.shrank] == [(1e-12, 1e-9)]


def test_new_gone_and_changed_checks_are_told(tmp_path: Path) -> None:
    """A check in one report only is new or gone; a verdict that changed is told by both words."""
    before = [result(check="gone"), result(check="a"), result(check="b", error=1e-13)]
    skipped = result(check="b", got=None, error=None, passed=False, not_applicable="no slip")
    crashed = result(check="a", got=None, error=None, passed=False, failure="it refused")
    found = moves(tmp_path, before, [result(check="new"), crashed, skipped])
    assert found.new == [("default", "new", "fmu")]
    assert found.gone == [("default", "gone", "fmu")]
    told = [(move.check, move.before.verdict, move.now.verdict) for move in found.changed]
    assert told == [("a", "pass", "fail"), ("b", "pass", "not applicable")]
    assert [move.check for move in found.grew] == ["a"]
    assert math.isinf(found.grew[0].now.margin)


def test_a_report_from_before_there_were_verdicts_can_be_read(tmp_path: Path) -> None:
    """The first layout told only whether a check passed; that is enough."""
    row = {"case": "default", "check": "T", "side": "fmu", "error": 2e-13, "tolerance": 1e-12,
           "passed": True}  # fmt: skip
    (tmp_path / "old.json").write_text(json.dumps({"checks": [row]}), encoding="utf-8")
    entry = read_earlier_report(tmp_path / "old.json").entries["default", "T", "fmu"]
    assert entry.margin == pytest.approx(0.2)
    assert entry.verdict == "pass"


@pytest.mark.parametrize(
    "content",
    [
        None,
        b"",
        b"\xff\xfe",
        b"[1, 2]",
        b'{"checks": 3}',
        b'{"checks": [3]}',
        b'{"checks": [{"case": "a"}]}',
        b'{"checks": [{"case": [], "check": "", "side": "", "error": 0, "tolerance": 1,'
        b' "passed": true}]}',
        b'{"checks": [{"case": "", "check": "", "side": "", "error": "much", "tolerance": 1,'
        b' "passed": true}]}',
        b"[" * 100_000,
    ],
)
def test_what_is_no_report_is_told_in_one_line(tmp_path: Path, content: bytes | None) -> None:
    """A missing file, a file that is not JSON and other JSON are named with the reason."""
    file = tmp_path / "old.json"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(EarlierReportError) as told:
        read_earlier_report(file)
    assert "\n" not in str(told.value)
    assert str(told.value).startswith(f"{file}: ")


@pytest.mark.parametrize("width", [60, 140])
def test_the_table_names_what_moved(tmp_path: Path, width: int) -> None:
    """Each check that moved stands in the table once, with its margins, at any width."""
    before = [result(check="grew", error=1e-13), result(check="left", error=1e-13)]
    crashed = result(check="left", got=None, error=None, passed=False, failure="it refused")
    found = moves(tmp_path, before, [result(check="grew", error=9e-13), crashed, result()])
    console = Console(file=io.StringIO(), width=width)
    console.print(earlier_table(found))
    text = console.file.getvalue()  # type: ignore[attr-defined]
    assert text.count("grew") == 2
    assert "0.9" in text
    assert "pass → fail" in text
    assert "1 new: default / t_slip-exact (fmu)" in text
    assert "2 compared; margins that grew more than 2 times: 2" in " ".join(text.split())
    assert max(len(line) for line in text.splitlines()) <= width
