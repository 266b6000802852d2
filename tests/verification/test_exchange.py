"""FMUs that are judged through model exchange: ours, and others as people write them."""

from pathlib import Path
from typing import Any

import pytest

from stickslip_verification import Verdict, load_cases, load_mutants, starter, verify
from stickslip_verification.drive.exchange import HOW
from tests.conftest import built
from tests.makers import solved
from tests.needs import needs

pytestmark = needs("cc")

FEW = "default,damped-cycle,fast-pull,grazing,heavy,load-pulses,pull-reverses,reversals,tuned"
MARCHED = "curve-flat,hyperbolic-tuned,stribeck-exponential"


def judged(fmu: Path, cases: str = FEW, **how: Any) -> Verdict:
    return verify(fmu, load_cases(cases), interface="me", long_probes=False, **how)


@pytest.mark.parametrize(
    ("law", "cases", "drawn"), [("coulomb", FEW, 32), ("stribeck", MARCHED, 4)]
)
def test_our_fmu_is_right_and_accurate_when_it_is_solved(law: str, cases: str, drawn: int) -> None:
    verdict = judged(built("native-3", law), cases, sequences=drawn)
    assert verdict.passed, [each for each in verdict.checks if each.failed]
    assert (verdict.contract.name, verdict.contract.why) == ("physics", HOW)


@pytest.mark.parametrize("nominal", [1.0, 1e5])
def test_a_rough_block_is_right_and_not_as_accurate(nominal: float) -> None:
    right, accurate = judged(solved(NOMINAL=nominal), sequences=16).questions
    assert right.good, right.answer
    assert not accurate.good
    assert "state smaller nominal values, or --within" in accurate.answer


@pytest.mark.parametrize(
    ("macro", "value", "said"),
    [
        ("FRICTION", 1.00001, "mu_k acts as if it were 0.001 % larger"),
        ("CREEP", 1e-5, "the mass moves in stick"),
        ("STEPS", 1, "It is too far off to tell a wrong model from a rough solver"),
        ("BLINDLY", 1, "events are found late or never"),
        ("STATUS", 3, "failed: without a message (status error)"),
        ("AGAIN", 1, "updates its discrete states without an end at t = 0.0"),
        ("BEHIND", 1, "has events without an end at t = 0.0"),
    ],
)
def test_a_wrong_block_is_not_right(macro: str, value: float, said: str) -> None:
    verdict = judged(solved(**{macro: value}))
    right, *_ = verdict.questions
    assert not right.good
    assert said in " ".join([right.answer, *(each.failure or "" for each in verdict.checks)])


def test_a_planted_fault_is_found() -> None:
    kills = judged(built("native-3"), mutants=load_mutants("heat-one-percent")).kills
    assert kills is not None
    assert kills.rows[0].caught


def test_a_block_that_is_only_solved_has_a_names_file() -> None:
    names = starter(solved(), "me")
    assert all(f'\n{name} = "{name}"' in names for name in ("m", "mu_s", "v", "x", "F"))
