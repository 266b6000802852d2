"""FMUs that are judged through model exchange: ours, and others as people write them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_verification import FmuError, Verdict, load_cases, load_mutants, starter, verify
from stickslip_verification.drive.exchange import HOW, OPENED, RTOL
from stickslip_verification.drive.masters import run_case
from stickslip_verification.suite import sequences as drawing
from stickslip_verification.truth.parameters import CHANGEABLE, START_VALUES
from tests.conftest import Sized, built
from tests.makers import solved
from tests.needs import needs

pytestmark = needs("cc")

FEW = "default,damped-cycle,fast-pull,grazing,heavy,load-pulses,pull-reverses,reversals,tuned"
MARCHED = "curve-flat,hyperbolic-tuned,stribeck-exponential"


def judged(fmu: Path, cases: str = FEW, **how: Any) -> Verdict:
    return verify(fmu, load_cases(cases), interface="me", long_probes=False, **how)


@pytest.mark.parametrize(
    ("kind", "law", "cases", "drawn"),
    [
        ("native-3", "coulomb", FEW, 32),
        ("native-2me", "coulomb", FEW, 8),
        ("native-3", "stribeck", MARCHED, 4),
        ("foreign", "coulomb", FEW, 32),
    ],
)
def test_a_right_block_is_right_and_accurate_when_it_is_solved(
    kind: str, law: str, cases: str, drawn: int
) -> None:
    fmu = solved() if kind == "foreign" else built(kind, law)
    verdict = judged(fmu, cases, sequences=drawn)
    assert verdict.passed, [each for each in verdict.checks if each.failed]
    assert (verdict.contract.name, verdict.contract.why) == ("physics", HOW)


@pytest.mark.parametrize(
    ("macro", "value", "good", "said"),
    [
        ("NOMINAL", 1e3, True, "state smaller nominal values, or --within"),
        ("NOMINAL", 1e5, True, "state smaller nominal values, or --within"),
        ("FRICTION", 1.00001, False, "mu_k acts as if it were 0.001 % larger"),
        ("CREEP", 1e-5, False, "the mass moves in stick"),
        ("STEPS", 1, False, "It is too far off to tell a wrong model from a rough solver"),
        ("BLINDLY", 1, False, "events are found late or never"),
        ("STATUS", 3, False, "failed: without a message (status error)"),
        ("AGAIN", 1, False, "updates its discrete states without an end at t = 0.0"),
        ("SILENT", 1, False, "changes its continuous states and does not say so"),
        ("BEHIND", 1, False, "has events without an end at t = 0.0"),
    ],
)
def test_a_rough_block_is_right_and_a_wrong_one_is_not(
    macro: str, value: float, good: bool, said: str
) -> None:
    verdict = judged(solved(**{macro: value}), sequences=8)
    right, *_ = verdict.questions
    assert (right.good, verdict.passed) == (good, False), right
    texts = [each.answer for each in verdict.questions]
    assert said in " ".join([*texts, *(each.failure or "" for each in verdict.checks)])


@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
def test_solved_and_stepped_a_random_motion_is_the_same(law: str, sized: Sized) -> None:
    stepping, solving = (kind(built("native-3", law), own_starts=False) for kind in OPENED.values())
    every = drawing.Scope(frozenset(START_VALUES), frozenset(CHANGEABLE))
    cases = [each.case for each in drawing.draw_sequences(1, sized(320), every)]
    others = drawing.with_dwell(cases, 1) if law == "coulomb" else ()
    for case in (*cases, *others) if others else drawing.under_law(cases, law, 1):
        got, expected = (run_case(file, case).outputs for file in (solving, stepping))
        assert got["n_slips"].tolist() == expected["n_slips"].tolist(), case.id
        scale = max(np.abs(expected[name]).max() for name in ("x", "z", "x_pull"))
        assert np.abs(got["x"] - expected["x"]).max() <= 300.0 * RTOL * scale, case.id


def test_a_planted_fault_is_found() -> None:
    kills = judged(built("native-3"), mutants=load_mutants("heat-one-percent")).kills
    assert kills is not None
    assert kills.rows[0].caught


def test_a_block_that_is_only_solved_has_a_names_file() -> None:
    names = starter(solved(), "me")
    assert all(f'\n{name} = "{name}"' in names for name in ("m", "mu_s", "v", "x", "F"))


def test_where_fmpy_has_no_solver_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stickslip_verification.drive.exchange.CVodeSolver", object)
    with pytest.raises(FmuError, match="FMPy has no solver for "):
        OPENED["me"](solved()).instantiate()
