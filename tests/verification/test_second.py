"""Second values: a drift above rounding is seen, and only what passed is accepted."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_verification import AcceptError, CheckResult, Verdict, accept
from stickslip_verification.judge.checks import resolution_of
from stickslip_verification.judge.second_values import Accepted, load_accepted
from stickslip_verification.model.verdict import ChosenContract, Measured, Second

from .records import named
from .test_report import result as plain

KEY = ("default", "t_slip-exact", "fmu")


def result(check: str = "t_slip-exact", mean: float = 0.125, **values: object) -> CheckResult:
    return plain(check=check, got=mean, **{"measured": Measured(mean, 0.25, 1e-14), **values})


@pytest.mark.parametrize(
    ("accepted", "mean", "scale", "verdict"),
    [
        # Drifts are parts of the scale, and rounding moves a mean by 1e-14 of it.
        (0.125 - 0.25 * 0.9e-14, 0.125, 0.25, "pass"),
        (0.125 - 0.25 * 1.2e-14, 0.125, 0.25, "drift"),
        (0.125, math.nan, 0.25, "drift"),
        (1.0, 0.0, 0.0, "drift"),
    ],
)
def test_what_moves_by_more_than_rounding_has_drifted(
    accepted: float, mean: float, scale: float, verdict: str
) -> None:
    now = result(measured=Measured(mean, scale, 1e-14))
    (seen,) = Accepted({KEY: accepted}).attach([now])
    assert seen.verdict == verdict
    assert Verdict([seen, result("other")]).passed == (verdict == "pass")


def test_a_side_is_held_to_what_it_gave_itself() -> None:
    sides = [result(side=side) for side in ("fmu", "reference", "both")]
    accepted = Accepted({(*KEY[:2], "reference"): 0.1, KEY: 0.125})
    second = Second(0.1, 0.125, (0.125 - 0.1) / 0.25, 1e-14)
    ours = [r.second for r in accepted.attach(sides)]
    assert ours == [Second(0.125, 0.125, 0.0, 1e-14), second, None]
    # Of a foreign FMU nothing was accepted; the reference beside it is ours.
    assert [r.second for r in accepted.attach(sides, fmu=False)] == [None, second, None]


@pytest.mark.parametrize(
    ("case", "column", "resolution"),
    [
        ("default", "fmu", 1e-14),
        ("load-pulses", "reference", 1e-12),
        ("curve-inputs", "fmu", 1e-14),
        # It integrates anew after each change: half of its tolerance.
        ("curve-inputs", "reference", 0.5e-8),
    ],
)
def test_the_least_drift_that_is_seen(case: str, column: str, resolution: float) -> None:
    assert resolution_of(named(case), column, 1e-8) == resolution


AWKWARD = (0.1 + 0.2, 5e-324, -1.7976931348623157e308, 1.0 / 3.0, -0.0, 0.3 * 9.81)


def test_accepted_values_come_back_to_the_last_digit_and_replace_those_of_their_cases(
    tmp_path: Path,
) -> None:
    file = tmp_path / "accepted.json"
    assert load_accepted(file).values == {}
    accept(Verdict([result("old"), result(case="heavy"), result(case="gone")]), file)
    results = [result(f"c{n}", value) for n, value in enumerate(AWKWARD)]
    results += [result("c0", 0.5, side="reference"), result("n", math.nan)]
    drifted = Accepted({("default", "c0", "fmu"): 1.0}).attach(results)
    assert drifted[0].verdict == "drift"
    lacking = result(passed=False, not_applicable="it has no output x", measured=None)
    assert accept(Verdict([*drifted, lacking]), file) == len(AWKWARD) + 1
    values = dict(load_accepted(file).values)
    assert values.pop(("heavy", "t_slip-exact", "fmu")) == 0.125
    assert values.pop(("default", "c0", "reference")) == 0.5
    assert [value.hex() for value in values.values()] == [value.hex() for value in AWKWARD]


PHYSICS = ChosenContract("physics", "asked")
MISSES = [replace(result("a"), passed=False, decides=False), replace(result("b"), passed=False)]


@pytest.mark.parametrize(
    ("verdict", "words"),
    [
        (Verdict([result(), *MISSES]), r"^2 checks fail .* first default / a \(fmu\)$"),
        (Verdict([result()], contract=PHYSICS), "only the exact block"),
    ],
)
def test_what_fails_or_is_another_fmu_is_not_accepted(
    tmp_path: Path, verdict: Verdict, words: str
) -> None:
    with pytest.raises(AcceptError, match=words):
        accept(verdict, tmp_path / "accepted.json")
    assert not list(tmp_path.iterdir())
