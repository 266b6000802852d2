"""Second values: a drift above rounding is told, and only what passed is accepted."""

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_verification.judge.checks import EXACT_CONTRACT, judge, resolution_of
from stickslip_verification.judge.second_values import Accepted, AcceptError, accept, load_accepted
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import (
    CheckResult,
    ChosenContract,
    Measured,
    Second,
    Verdict,
)
from stickslip_verification.suite.cases import load_cases

from .records import Draft, exact_of, named, planted
from .test_report import result as plain


def result(check: str = "t_slip-exact", mean: float = 0.125, side: str = "fmu") -> CheckResult:
    """Return a check that passed, with what a second value is made of."""
    measured = Measured(mean, 0.25, 1e-14)
    return plain(check=check, side=side, expected=0.125, got=mean, measured=measured)


KEY = ("default", "t_slip-exact", "fmu")


@pytest.mark.parametrize(
    ("moved", "verdict"),
    [(0.0, "pass"), (0.9e-14, "pass"), (-0.9e-14, "pass"), (1.2e-14, "drift"), (-1e-9, "drift")],
)
def test_what_moves_by_more_than_rounding_has_drifted(moved: float, verdict: str) -> None:
    """A mean that is off its accepted value by more than the resolution of its scale is a drift."""
    (seen,) = Accepted({KEY: 0.125 - 0.25 * moved}).attach([result()])
    assert seen.verdict == verdict
    assert seen.second is not None
    assert seen.second.drift == pytest.approx(abs(moved), abs=1e-16)
    assert seen.failed == (verdict == "drift")


@pytest.mark.parametrize(
    ("case", "column", "resolution"),
    [
        ("default", "reference", 1e-12),
        ("load-pulses", "reference", 1e-12),
        ("curve-swings", "reference", 1e-12),
        ("curve-inputs", "fmu", 1e-14),
        ("curve-inputs", "reference", 0.5e-8),
    ],
)
def test_a_reference_that_starts_anew_hides_small_drifts(
    case: str, column: str, resolution: float
) -> None:
    """Where friction depends on the speed and inputs change; the FMU is as sharp there."""
    (found,) = (each for each in load_cases() if each.id == case)
    assert resolution_of(found, column, 1e-8) == resolution


def test_a_drift_fails_the_verdict() -> None:
    """A check within its tolerance that has drifted counts as failed."""
    drifted = Accepted({KEY: 0.12501}).attach([result(), result("other")])
    verdict = Verdict(checks=drifted)
    assert verdict.summary == {"passed": 1, "failed": 1, "noted": 0, "not_applicable": 0}
    assert not verdict.passed


def test_a_check_without_an_accepted_value_has_no_second() -> None:
    """New checks, and checks that gave nothing, are judged by the truth alone."""
    new = result("new")
    nothing = replace(result(), measured=None)
    assert [r.second for r in Accepted({KEY: 1.0}).attach([new, nothing])] == [None, None]


def test_the_accepted_value_is_that_of_the_same_side() -> None:
    """The reference is held to what the reference gave."""
    (seen,) = Accepted({(*KEY[:2], "reference"): 0.1, KEY: 0.125}).attach(
        [result(side="reference")]
    )
    assert seen.second == Second(0.1, 0.125, (0.125 - 0.1) / 0.25, 1e-14)


def test_a_foreign_fmu_has_no_second_values() -> None:
    """Of a foreign FMU nothing was accepted; the reference beside it is held to its own."""
    values = {(*KEY[:2], side): 1.0 for side in ("fmu", "reference", "both")}
    results = [result(side=side) for side in ("fmu", "reference", "both")]
    seconds = [r.second is not None for r in Accepted(values).attach(results, fmu=False)]
    assert seconds == [False, True, False]


def test_a_quantity_that_has_become_zero_has_drifted() -> None:
    """Where the truth is zero by now and was not when accepted, that is a drift and no crash."""
    zero = replace(result(), measured=Measured(0.0, 0.0, 1e-14))
    (seen,) = Accepted({KEY: 1.0}).attach([zero])
    assert seen.verdict == "drift"
    (same,) = Accepted({KEY: 0.0}).attach([zero])
    assert same.verdict == "pass"


def test_a_result_that_is_no_number_has_drifted() -> None:
    """A mean that is NaN is not the accepted one."""
    (seen,) = Accepted({KEY: 0.125}).attach([result(mean=math.nan)])
    assert seen.verdict == "drift"


AWKWARD = (0.1 + 0.2, 5e-324, -1.7976931348623157e308, 1.0 / 3.0, -0.0, 0.3 * 9.81)


def test_a_value_comes_back_to_the_last_digit(tmp_path: Path) -> None:
    """What is written is read as the same doubles, by case, check and side."""
    file = tmp_path / "accepted.json"
    results = [result(f"c{n}", value) for n, value in enumerate(AWKWARD)]
    assert accept(Verdict(checks=results), file) == len(AWKWARD)
    read = load_accepted(file).values
    assert [read["default", f"c{n}", "fmu"].hex() for n in range(len(AWKWARD))] == [
        value.hex() for value in AWKWARD
    ]


def test_a_check_is_one_line(tmp_path: Path) -> None:
    """Each check stands on a line of its own with its sides, in order, in a text that is JSON."""
    file = tmp_path / "accepted.json"
    checks = [
        result("b"),
        result("a", side="reference"),
        result("a"),
        replace(result("p"), case=""),
    ]
    accept(Verdict(checks=checks), file)
    assert file.read_text(encoding="utf-8") == (
        "{\n"
        ' "": {\n'
        '  "p": {"fmu": 0.125}\n'
        " },\n"
        ' "default": {\n'
        '  "a": {"fmu": 0.125, "reference": 0.125},\n'
        '  "b": {"fmu": 0.125}\n'
        " }\n"
        "}\n"
    )
    assert json.loads(file.read_text(encoding="utf-8"))["default"]["b"] == {"fmu": 0.125}


def test_values_of_other_cases_stay(tmp_path: Path) -> None:
    """Accepting some cases replaces all of theirs, and touches nothing of the others."""
    file = tmp_path / "accepted.json"
    accept(Verdict(checks=[result("old"), replace(result(), case="heavy", got=2.0)]), file)
    accept(Verdict(checks=[result("new")]), file)
    assert set(load_accepted(file).values) == {
        ("default", "new", "fmu"),
        ("heavy", "t_slip-exact", "fmu"),
    }


def test_what_gave_nothing_is_not_accepted(tmp_path: Path) -> None:
    """A check that does not apply, or whose mean is no number, has no line."""
    file = tmp_path / "accepted.json"
    lacking = replace(result("x"), passed=False, measured=None, not_applicable="it has no output x")
    assert accept(Verdict(checks=[lacking, result("n", math.nan), result()]), file) == 1
    assert set(load_accepted(file).values) == {KEY}


def test_a_verdict_that_fails_is_not_accepted(tmp_path: Path) -> None:
    """One failed check, and nothing is written; the error tells how many and the first."""
    file = tmp_path / "accepted.json"
    wrong = replace(result("wrong"), passed=False, error=1.0)
    noted = replace(wrong, check="noted", decides=False)
    with pytest.raises(AcceptError, match=r"^2 checks fail .* first default / wrong \(fmu\)$"):
        accept(Verdict(checks=[result(), wrong, noted]), file)
    assert not file.exists()


def test_a_drift_is_what_accepting_is_for(tmp_path: Path) -> None:
    """A drifted value that keeps its truth is accepted, and has not drifted afterwards."""
    file = tmp_path / "accepted.json"
    accept(Verdict(checks=[result(mean=0.1249)]), file)
    drifted = load_accepted(file).attach([result()])
    assert drifted[0].verdict == "drift"
    accept(Verdict(checks=drifted), file)
    assert load_accepted(file).attach([result()])[0].verdict == "pass"


def test_a_foreign_verdict_is_not_accepted(tmp_path: Path) -> None:
    """Second values are those of an FMU held to the exact contract."""
    file = tmp_path / "accepted.json"
    with pytest.raises(AcceptError, match="only the exact block"):
        accept(Verdict([result()], contract=ChosenContract("physics", "said")), file)
    assert not file.exists()


def test_there_may_be_no_accepted_values_yet(tmp_path: Path) -> None:
    """Without a file nothing was accepted."""
    assert load_accepted(tmp_path / "none.json").values == {}


def moved(by: float) -> Run:
    """Return the exact motion of a case with its slip times moved by a part of them."""

    def fault(draft: Draft) -> None:
        draft.scale("t_slip", 1.0 + by)

    return planted(exact_of("default").record, fault)


def test_a_drift_shows_far_below_the_tolerance() -> None:
    """A slip time that moves by a tenth of its tolerance passes its check, and has drifted."""
    case = named("default")
    (check,) = (check for check in case.checks if check.id == "t_slip-exact")
    exact = exact_of("default")
    before, after = (judge(case, check, EXACT_CONTRACT, exact, moved(by)) for by in (0.0, 1e-13))
    assert before.measured is not None
    key = (case.id, check.id, "fmu")
    (seen,) = Accepted({key: before.measured.mean}).attach([after])
    assert (seen.passed, seen.verdict) == (True, "drift")
    (same,) = Accepted({key: before.measured.mean}).attach([before])
    assert same.verdict == "pass"
