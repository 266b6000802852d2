"""Other runs of an FMU: which faults they show, and what a foreign FMU lacks for them."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification import CheckResult, NameMap, load_invariants, load_mutants
from stickslip_verification.drive import CommunicationStep, FmuFile, Setting, run
from stickslip_verification.drive.description import Target
from stickslip_verification.drive.masters import NotApplicableError, run_case
from stickslip_verification.drive.other_runs import RUNS
from stickslip_verification.drive.processes import Answer
from stickslip_verification.judge.checks import (
    EXACT_CONTRACT,
    PHYSICS_CONTRACT,
    judge_run,
    of_invariant,
    same_run,
)
from stickslip_verification.judge.course import Band
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.verdict import Run
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.faults import plant
from tests.conftest import built
from tests.makers import SLIDER, SLIDER_3, plain
from tests.verification.records import exact_of, named

INVARIANTS = {invariant.id: invariant for invariant in load_invariants().runs}


@cache
def ours() -> FmuFile:
    return FmuFile(built("python-2"))


def differing(one: Run, other: Run) -> set[str]:
    return {
        name
        for name in OUTPUT_NAMES
        if not np.array_equal(one.outputs[name], other.outputs[name])
        or one.initial[name] != other.initial[name]
    }


MUTANTS = {
    "state-forgets-meter": ("rollback", "rollback-to-the-bit"),
    "state-rounded-on-paper": ("serialized", "serialized-state-to-the-bit"),
    "reset-keeps-inputs": ("reset", "reset-to-the-bit"),
    "instances-share-pull": ("two_instances", "two-instances-to-the-bit"),
    "fixed-step-1ms": ("splitting", "splitting"),
    "direction-always-forward": ("mirror", "mirror"),
    "meter-nanosecond-clock": ("time", "time-scales-to-the-bit"),
}


@pytest.mark.parametrize("mutant", MUTANTS)
def test_a_run_shows_the_fault_it_is_there_for(mutant: str, tmp_path: Path) -> None:
    (fault,) = load_mutants(mutant)
    file = FmuFile(plant(ours().path, fault, tmp_path), hooks=fault.hooks)
    other, invariant = MUTANTS[mutant]
    results = []
    for case in map(named, ("tuned", "pull-reverses")):
        given = (case, EXACT_CONTRACT, exact_of(case.id), run_case(file, case))
        answer = Answer(RUNS[other](file, case))
        results.append(judge_run(INVARIANTS[invariant], *given, answer))
    file.close()
    assert not all(result.passed for result in results)
    assert all(result.failure is None for result in results)


@pytest.mark.parametrize(
    ("fault", "other"),
    [
        ("", ""),
        ("push weak in stick", "shifted"),
        ("damping of the start", "continued"),
        ("begins at rest", "continued"),
    ],
)
def test_a_slider_goes_on_alike_from_another_start_if_it_is_right(fault: str, other: str) -> None:
    file = plain("Anew" + "".join(fault.title().split()), step=1e-3, fault=fault).opened()
    tuned, band = named("tuned"), Band(exact_of("tuned"))
    numerical = [each for each in INVARIANTS.values() if each.numerical]
    for of in numerical:
        empty = of_invariant(of, tuned, PHYSICS_CONTRACT)
        row = same_run(empty, run_case(file, tuned), RUNS[of.run](file, tuned), band)
        assert row.passed is (of.run != other), row
    assert len(numerical) == 2


def without_gravity() -> FmuFile:
    return FmuFile(ours().path, NameMap({"g": Target("")}))


def changing_mu_s(case: Case) -> Case:
    return replace(case, steps=(case.steps[0], replace(case.steps[1], changes={"mu_s": 0.4})))


DEFAULT = replace(named("default"), steps=named("default").steps[:60])
NOT_APPLICABLE: list[tuple[Callable[[], FmuFile], str, Case, str]] = [
    (SLIDER.opened, "rollback", DEFAULT, "it cannot get and set its state, by its description"),
    (SLIDER.opened, "serialized", DEFAULT, "it cannot serialize its state, by its description"),
    (without_gravity, "time", DEFAULT, "it has no variable g"),
    (SLIDER_3.opened, "reset", changing_mu_s(DEFAULT), "it cannot change mu_s on the way"),
    (ours, "continued", named("overdamped"), "there the mass is never faster than the pull"),
    *((SLIDER_3.opened, run, named("damped-cycle"), "it has no variable c") for run in RUNS),
]


@pytest.mark.parametrize(("opened", "other", "case", "told"), NOT_APPLICABLE)
def test_what_an_fmu_lacks_for_a_run_is_told(
    opened: Callable[[], FmuFile], other: str, case: Case, told: str
) -> None:
    with pytest.raises(NotApplicableError) as caught:
        RUNS[other](opened(), case)
    assert str(caught.value).startswith(told)


def test_a_scaled_run_sets_only_what_is_there() -> None:
    poor = without_gravity()
    for other in ("mirror", "forces"):
        assert differing(run_case(poor, DEFAULT), RUNS[other](poor, DEFAULT)) == set()


SMALL = exact_of("grazing").record


def judged(invariant: str, other: Answer[Run]) -> CheckResult:
    exact, case = exact_of("grazing"), named("grazing")
    return judge_run(INVARIANTS[invariant], case, EXACT_CONTRACT, exact, exact.record, other)


def changed(name: str, by: float) -> Answer[Run]:
    samples = np.array(SMALL.outputs[name])
    samples[-1] += by
    return Answer(replace(SMALL, outputs={**SMALL.outputs, name: samples}))


LAST_BIT = float(np.spacing(SMALL.outputs["z"][-1]))
START = Answer(replace(SMALL, initial={**SMALL.initial, "F_s": 1.0}))
SHORT = {**SMALL.outputs, "T": SMALL.outputs["T"][:-1]}
LESS = {name: samples for name, samples in SMALL.outputs.items() if name != "T"}


@pytest.mark.parametrize(
    ("invariant", "other", "passed", "quantity"),
    [
        ("reset-to-the-bit", Answer(SMALL), True, "values that differ"),
        ("reset-to-the-bit", changed("z", LAST_BIT), False, ", z first"),
        ("reset-to-the-bit", START, False, ""),
        ("mirror", changed("t_slip", 1e-9), False, "t_slip"),
        *(
            (name, other, False, "")
            for name in ("reset-to-the-bit", "mirror")
            for other in (
                # A count is right or wrong; what is lost is a failure, and none raises.
                changed("n_slips", 1.0),
                changed("T", np.nan),
                Answer(replace(SMALL, outputs=SHORT)),
                Answer(replace(SMALL, outputs=LESS)),
            )
        ),
    ],
)
def test_a_difference_is_seen_and_named_where_it_is_worst(
    invariant: str, other: Answer[Run], passed: bool, quantity: str
) -> None:
    result = judged(invariant, other)
    assert result.passed is passed
    assert quantity in result.quantity
    assert passed or result.failure or result.error


def test_an_error_is_part_of_its_scale_and_why_there_is_no_other_run_is_kept() -> None:
    result = judged("mirror", changed("t_slip", 1e-9))
    assert result.error == pytest.approx(1e-9 / named("grazing").stop_time, rel=1e-6)  # rounding
    failed = judged("mirror", Answer(failure="it broke"))
    lacking = judged("mirror", Answer(not_applicable="it cannot"))
    assert (failed.verdict, failed.failure) == ("fail", "it broke")
    assert (lacking.verdict, lacking.not_applicable) == ("not applicable", "it cannot")


def test_steps_begin_at_the_rounded_sums_of_those_before() -> None:
    setting = Setting({}, [CommunicationStep(0.1, {})] * 10)
    assert (setting.points[0], setting.points[9], setting.points[-1]) == (0.0, 0.9, 1.0)
    record = run(ours(), Setting(DEFAULT.parameters, DEFAULT.steps))
    assert differing(record, run_case(ours(), DEFAULT)) == set()
