"""FMUs that are judged through model exchange: ours, and others as people write them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stickslip_ref import Parameters, critical_velocity
from stickslip_verification import Verdict, load_cases, load_mutants, starter, verify
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.exchange import HOW, RTOL, SolvedFile
from stickslip_verification.drive.masters import run_case
from stickslip_verification.suite.cases import load_case
from tests.conftest import Sized, built
from tests.makers import solved
from tests.needs import needs

pytestmark = needs("cc")

FEW = "default,damped-cycle,fast-pull,grazing,heavy,load-pulses,pull-reverses,reversals,tuned"
MARCHED = "curve-flat,hyperbolic-tuned,stribeck-exponential"


def judged(fmu: Path, cases: str = FEW, **how: Any) -> Verdict:
    return verify(fmu, load_cases(cases), interface="me", long_probes=False, **how)


@pytest.mark.parametrize(("law", "cases"), [("coulomb", FEW), ("stribeck", MARCHED)])
def test_our_fmu_is_right_and_accurate_when_it_is_solved(
    law: str, cases: str, sized: Sized
) -> None:
    verdict = judged(built("native-3", law), cases, sequences=sized(320) if law == "coulomb" else 4)
    assert verdict.passed, [each for each in verdict.checks if each.failed]
    assert (verdict.contract.name, verdict.contract.why) == ("physics", HOW)


@pytest.mark.parametrize("nominal", [1.0, 1e5])
def test_a_rough_block_is_right_and_not_as_accurate(nominal: float) -> None:
    right, accurate = judged(solved(NOMINAL=nominal), sequences=16).questions
    assert right.good, right.answer
    assert not accurate.good
    assert "state smaller nominal values, or --within" in accurate.answer


@pytest.mark.parametrize(
    ("macros", "said"),
    [
        ({"FRICTION": 1.00001}, "mu_k acts as if it were 0.001 % larger"),
        ({"CREEP": 1e-5}, "the mass moves in stick"),
        ({"STEPS": 1}, "It is too far off to tell a wrong model from a rough solver"),
        ({"BLINDLY": 1}, "events are found late or never"),
        ({"STATUS": 3}, "failed: without a message (status error)"),
        ({"AGAIN": 1}, "updates its discrete states without an end at t = 0.0"),
        ({"BEHIND": 1}, "has events without an end at t = 0.0"),
    ],
)
def test_a_wrong_block_is_not_right(macros: dict[str, float], said: str) -> None:
    verdict = judged(solved(**macros))
    right, *_ = verdict.questions
    assert not right.good
    assert said in " ".join([right.answer, *(each.failure or "" for each in verdict.checks)])


def test_a_planted_fault_is_found() -> None:
    kills = judged(built("native-3"), mutants=load_mutants("heat-one-percent")).kills
    assert kills is not None
    assert kills.rows[0].caught


NEAR = """title = "Near the critical velocity"
about = "A slip hardly comes to rest."
parameters = {{ c = 4.0, v = {} }}
experiment = {{ stop_time = 3.0, steps = {{ fixed = 0.05 }} }}
"""


@pytest.mark.parametrize("below", [1e-3, 1e-6, 1e-9, -1e-9, -1e-3])
def test_no_slip_is_lost_near_the_critical_velocity(tmp_path: Path, below: float) -> None:
    (cycle,) = critical_velocity(Parameters(c=4.0)).cycle
    file = tmp_path / "near.toml"
    file.write_text(NEAR.format(cycle.high * (1.0 - below)), encoding="utf-8")
    exact = exact_motion(case := load_case(file)).record.outputs
    got = run_case(SolvedFile(built("native-3")), case).outputs
    assert (exact["n_slips"][-1] > 10) == (below > 0.0)
    assert got["n_slips"].tolist() == exact["n_slips"].tolist()
    assert np.abs(got["x"] - exact["x"]).max() <= 100.0 * RTOL * exact["x"].max()


def test_a_block_that_is_only_solved_has_a_names_file() -> None:
    names = starter(solved(), "me")
    assert all(f'\n{name} = "{name}"' in names for name in ("m", "mu_s", "v", "x", "F"))


def test_the_exact_contract_is_not_asked() -> None:
    with pytest.raises(ValueError, match="meets the physics contract"):
        judged(built("native-3"), contract="exact")
