"""A whole verdict: on our FMU, on others, and when something is wrong."""

from collections import Counter
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from stickslip_verification import (
    CheckResult,
    Verdict,
    load_cases,
    load_invariants,
    load_mutants,
    verify,
)
from stickslip_verification.model.verdict import ChosenContract, Kind
from stickslip_verification.suite.sequences import COUNT
from tests import makers
from tests.conftest import built
from tests.makers import FEW, RENAMED, RUNGE_KUTTA, SLIDER, SLIDER_3, Foreign, misbehaving
from tests.verification.records import named

TRIED = [named(name) for name in ("one-step", "tuned", "reversals", "damped-cycle", "slow-pull")]
"""A few cases that try everything once: a cycle, changes, reversals, damping."""


@cache
def on_ours() -> Verdict:
    return verify(built("python-2"), TRIED, sequences=12, long_probes=False, jobs=1)


def judged(fmu: Foreign, *cases: str, **more: Any) -> Verdict:
    tried, usual = list(map(named, cases)), {"long_probes": False, "jobs": 1}
    return verify(fmu.path, tried, names=fmu.names, **{**usual, **more})


def wrong(verdict: Verdict) -> list[CheckResult]:
    return [result for result in verdict.checks if result.failed]


def test_our_fmu_and_the_reference_hold_in_every_kind_of_truth() -> None:
    assert wrong(on_ours()) == []
    assert on_ours().passed
    assert on_ours().summary["not_applicable"] == on_ours().summary["noted"] == 0
    assert set(on_ours().by_kind) == set(Kind)


def test_every_check_of_a_case_is_made_on_both_sides_and_every_invariant_tried() -> None:
    counted = Counter((r.case, r.check, r.side) for r in on_ours().checks)
    assert set(counted.values()) == {1}
    for case in TRIED:
        for check in case.checks:
            assert {(case.id, check.id, side) for side in ("fmu", "reference")} <= counted.keys()
    invariants = load_invariants()
    ids = {invariant.id for invariant in invariants} - {order.id for order in invariants.orders}
    fresh = {each.id for each in invariants.probes if is_left_out(each.id)}
    fresh |= {each.id for each in invariants.runs if each.numerical}
    # A break-away beyond the threshold needs a change that lets the mass go.
    assert ids - {r.check for r in on_ours().checks} <= {"onset-beyond-break-away"} | fresh


def is_left_out(probe: str) -> bool:
    fresh = ("memory-of", "state-in-a-fresh-process", "environment")
    return probe.startswith(fresh) or probe == "keeps-its-cycle"


def test_a_probe_in_a_fresh_process_is_left_out_unless_a_fault_foretells_it(fmu_path: Path) -> None:
    leak = load_mutants("memory-of-instances")
    options: dict[str, Any] = {"mutants": leak, "whole_matrix": False}
    verdict = verify(fmu_path, TRIED[:1], long_probes=False, jobs=1, **options)
    left_out = {each.id for each in load_invariants().probes} - {r.check for r in verdict.checks}
    assert len(left_out) == len(list(filter(is_left_out, left_out))) == 8
    assert verdict.kills is not None
    assert verdict.kills.rows[0].failing == {"memory-of-instances": 1}


def test_two_processes_give_the_same_as_one_and_tell_their_progress(fmu_path: Path) -> None:
    told: list[tuple[str, int, int]] = []
    options: dict[str, Any] = {"sequences": 12, "long_probes": False, "jobs": 2}
    two = verify(fmu_path, TRIED, lambda *each: told.append(each), **options)
    assert two.checks == on_ours().checks
    assert {what.rpartition(": ")[2] for what, _, _ in told} >= {case.id for case in TRIED}
    assert all(done <= total for _, done, total in told)


def test_what_an_honest_foreign_fmu_lacks_is_counted_and_not_passed() -> None:
    verdict = judged(SLIDER, "default", "heavy", "damped-cycle")
    assert wrong(verdict) == []
    assert verdict.passed
    assert verdict.contract == ChosenContract("physics", "a names file is given")
    reasons = {r.not_applicable for r in verdict.checks if r.not_applicable is not None}
    assert "it has no variable c" in reasons
    assert any("cannot get and set its state" in reason for reason in reasons)
    strict = judged(SLIDER, "one-step", strict=True)
    noted = {r.check for r in verdict.checks if r.verdict == "noted" and r.case == ""}
    assert "declared-units" in noted <= {result.check for result in wrong(strict)}


def test_fmi_3_is_driven_as_2_is_its_state_too() -> None:
    verdict = judged(SLIDER_3, "default", "tuned")
    assert wrong(verdict) == []
    rollbacks = {r.verdict for r in verdict.checks if r.check == "rollback"}
    assert "pass" in rollbacks


def test_where_nothing_applies_nothing_passes() -> None:
    verdict = judged(makers.POOR, "damped-cycle")
    assert wrong(verdict) == []
    on_fmu = {r.verdict for r in verdict.checks if r.case}
    assert on_fmu == {"not applicable"}
    assert not verdict.passed


def test_an_fmu_that_fails_in_every_run_is_judged() -> None:
    verdict = judged(misbehaving("raise"), "default", sequences=2)
    assert not verdict.passed
    assert not verdict.questions[0].good
    assert "the slider has had enough" in str([result.failure for result in verdict.checks])


def test_an_fmu_that_fails_takes_only_its_case_with_it() -> None:
    verdict = judged(misbehaving("crash"), "one-step", "heavy", contract="exact")
    ends = {r.case: r for r in verdict.checks if r.check == "runs-to-the-end" and r.side == "fmu"}
    assert "the process crashed (SIG" in (ends["heavy"].failure or "")
    assert ends["one-step"].passed
    others = {r.verdict for r in verdict.checks if r.case == "heavy" and r.check == "z-course"}
    assert others == {"not applicable", "pass"}
    assert not verdict.passed


@pytest.mark.gate
def test_a_numerical_solution_that_crashes_fails_where_it_did() -> None:
    verdict = judged(misbehaving("crash"), "grazing", "heavy")
    ends = {r.case: r.failure or "" for r in verdict.checks if r.check == "any-sequence"}
    assert all("the process crashed (SIG" in ends[case] for case in ("grazing", "heavy"))
    assert not verdict.passed


OF_CONVENTION = (
    "clamp-tuned", "default", "frictionless", "gap-whole", "lifted-and-set-down", "moving-start",
    "no-gap", "no-pull", "reversals", "start-beyond",
)  # fmt: skip
"""Cases with starts beyond rest, in motion and off zero, clamps, reversals, stops that only touch
zero and equal forces: where conventions and rounding might decide."""

OTHERS = {fmu.name: fmu for fmu in (RENAMED, FEW, RUNGE_KUTTA)}
MARKS = {"RungeKutta": pytest.mark.soak, **dict.fromkeys(("Few", "Renamed"), pytest.mark.gate)}


@pytest.mark.parametrize("name", [pytest.param(each, marks=MARKS.get(each, ())) for each in OTHERS])
def test_other_conventions_names_units_signs_and_methods_fail_no_check(
    name: str, pytestconfig: pytest.Config
) -> None:
    fmu, whole = OTHERS[name], pytestconfig.getoption("soak")
    cases = [case.id for case in load_cases()] if whole else OF_CONVENTION
    verdict = judged(fmu, *cases, sequences=COUNT if whole else 8)
    assert [(each.case, each.check, each.failure) for each in wrong(verdict)] == []
    assert verdict.passed


@pytest.mark.parametrize(
    ("fault", "healthy"),
    [
        pytest.param("undamped back", RENAMED, marks=pytest.mark.gate),
        pytest.param("clamp when set", RENAMED, marks=pytest.mark.gate),
        pytest.param("moves when read", FEW, marks=pytest.mark.gate),
        pytest.param("state loses pending", RUNGE_KUTTA, marks=pytest.mark.soak),
    ],
)
def test_a_fault_where_inputs_phases_and_calls_meet_is_found_by_random_sequences(
    fault: str, healthy: Foreign
) -> None:
    fmu = replace(healthy, name=f"{healthy.name}Faulty", fault=fault, order=0, step=0.0)
    verdict = judged(fmu, "one-step", sequences=24, time_limit=60.0)
    # What takes too long has a failure in words, and no error.
    found = {each.case for each in wrong(verdict) if each.error is not None}
    assert found - {"one-step", ""}
    assert not verdict.passed
