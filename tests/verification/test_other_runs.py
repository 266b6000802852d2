"""Other runs of an FMU: the same motion from ours, and what a foreign one lacks is told."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import NOT_THERE, NameMap, Target
from stickslip_verification.drive.nearby import nearby_motions
from stickslip_verification.drive.other_runs import RUNS
from stickslip_verification.drive.planting import plant
from stickslip_verification.drive.stepping import NotApplicableError, Setting, run, run_case
from stickslip_verification.judge.band import numerical
from stickslip_verification.judge.checks import EXACT_CONTRACT, PHYSICS_CONTRACT, Contract
from stickslip_verification.judge.run_checks import judge_run
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.model.symmetries import HEAVIER, MIRROR, QUICKER, Symmetry
from stickslip_verification.model.verdict import CheckResult
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.experiment import CommunicationStep
from stickslip_verification.suite.faults import load_mutants
from stickslip_verification.suite.invariants import RunInvariant, load_invariants
from stickslip_verification.truth.parameters import complete

from .records import Draft, exact_of, named, planted, without

INVARIANTS = {invariant.id: invariant for invariant in load_invariants().runs}

CASES = (
    "clamp-tuned",
    "crumbs",
    "damped-cycle",
    "default",
    "force-pulses",
    "grazing",
    "lifted-and-set-down",
    "moving-start",
    "one-step",
    "overdamped-turn",
    "pull-reverses",
    "reversals",
    "start-beyond",
    "tuned",
)
"""Cases that between them have every sort of transition, damping, change and start."""


@pytest.fixture(scope="module")
def ours(fmu_path: Path) -> Iterator[FmuFile]:
    """Return our FMU, opened."""
    file = FmuFile(fmu_path)
    yield file
    file.close()


@pytest.fixture(scope="module")
def plain(ours: FmuFile) -> Callable[[str], Run]:
    """Return what gives our FMU's plain run of a case."""
    return cache(lambda name: run_case(ours, named(name)))


def differing(one: Run, other: Run) -> set[str]:
    """Return the outputs in which two records differ in a bit, at the start or later."""
    return {
        name
        for name in OUTPUT_NAMES
        if not np.array_equal(one.outputs[name], other.outputs[name])
        or one.initial[name] != other.initial[name]
    }


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("run", [run for run in RUNS if run != "splitting"])
def test_our_block_repeats_every_bit(
    ours: FmuFile, plain: Callable[[str], Run], run: str, name: str
) -> None:
    """Mirrored, scaled, set back, moved, reset or not alone: no digit of our block changes."""
    assert differing(plain(name), RUNS[run](ours, named(name))) == set()


@pytest.mark.parametrize("name", CASES)
def test_our_block_does_not_care_how_steps_are_cut(
    ours: FmuFile, plain: Callable[[str], Run], name: str
) -> None:
    """Cut in three, the steps end at the same motion within the rounding of their lengths."""
    cut = RUNS["splitting"](ours, named(name))
    assert [len(samples) for samples in cut.outputs.values()] == [len(named(name).steps)] * 22
    result = judge_run(
        INVARIANTS["splitting"],
        named(name),
        EXACT_CONTRACT,
        exact_of(name),
        plain(name),
        Answer(cut),
    )
    assert result.passed, result


@pytest.mark.parametrize("name", ["reversals-damped", "load-pulses", "tuned", "moving-start"])
@pytest.mark.parametrize("symmetry", [MIRROR, HEAVIER, QUICKER], ids=lambda s: s.name[:6])
def test_a_symmetry_is_one_of_the_exact_motion(symmetry: Symmetry, name: str) -> None:
    """The exact motion itself has the symmetry, in every output and to the bit."""
    case = named(name)
    steps = tuple(
        CommunicationStep(step.h * symmetry.pace, symmetry.scaled(step.changes))
        for step in case.steps
    )
    values = symmetry.scaled(complete(case.parameters))
    scaled = exact_motion(replace(case, parameters=values, steps=steps)).record
    back = symmetry.outputs
    outputs = {n: samples / back.get(n, 1.0) for n, samples in scaled.outputs.items()}
    initial = {n: value / back.get(n, 1.0) for n, value in scaled.initial.items()}
    assert differing(exact_of(name).record, Run(scaled.times, outputs, initial)) == set()


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
def test_a_run_shows_the_fault_it_is_there_for(fmu_path: Path, tmp_path: Path, mutant: str) -> None:
    """A block that forgets, rounds, shares or prefers is not the same in the run that tries it."""
    (fault,) = load_mutants(mutant)
    file = FmuFile(plant(fmu_path, fault, tmp_path), hooks=fault.hooks)
    run, invariant = MUTANTS[mutant]
    results = [
        judge_run(
            INVARIANTS[invariant],
            named(name),
            EXACT_CONTRACT,
            exact_of(name),
            run_case(file, named(name)),
            answer(file, run, name),
        )
        for name in ("tuned", "pull-reverses")
    ]
    file.close()
    assert not all(result.passed for result in results)
    assert all(result.failure is None for result in results)


def answer(file: FmuFile, run: str, name: str) -> Answer[Run]:
    """Return what a run of a case comes to."""
    return Answer(RUNS[run](file, named(name)))


def test_what_a_slider_without_state_lacks_is_told(
    slider_mm: Path, slider_mm_names: NameMap
) -> None:
    """An FMU that cannot keep its state is out of the runs that need it, and is told why."""
    file = FmuFile(slider_mm, slider_mm_names)
    with pytest.raises(NotApplicableError, match="cannot get and set its state, by its descr"):
        RUNS["rollback"](file, named("default"))
    with pytest.raises(NotApplicableError, match="cannot serialize its state, by its descr"):
        RUNS["serialized"](file, named("default"))


@pytest.mark.parametrize("run", sorted(RUNS))
def test_a_case_with_what_a_slider_lacks_is_not_applicable(
    slider_si: Path, slider_si_names: NameMap, run: str
) -> None:
    """An undamped FMU is not tried on a damped case, in no run, and the variable is named."""
    file = FmuFile(slider_si, slider_si_names)
    with pytest.raises(NotApplicableError, match=r"^it has no variable c$"):
        RUNS[run](file, named("damped-cycle"))
    with pytest.raises(NotApplicableError, match=r"^it has no variable F_ext$"):
        RUNS[run](file, named("force-pulses"))


def test_what_cannot_change_on_the_way_is_named(slider_si: Path, slider_si_names: NameMap) -> None:
    """A case that changes what an FMU holds fixed is not applicable to it."""
    file = FmuFile(slider_si, slider_si_names)
    case = named("default")
    changed = replace(case.steps[1], changes={"mu_s": 0.4})
    with pytest.raises(NotApplicableError, match=r"^it cannot change mu_s on the way$"):
        run_case(file, replace(case, steps=(case.steps[0], changed)))


def shortened(name: str, steps: int) -> Case:
    """Return the first steps of a case."""
    return replace(named(name), steps=named(name).steps[:steps])


@pytest.mark.parametrize("run", sorted(RUNS))
def test_an_honest_slider_is_the_same_in_every_run(
    slider_si: Path, slider_si_names: NameMap, run: str
) -> None:
    """A foreign solution keeps its motion as a numerical one must, with the variables it has."""
    file = FmuFile(slider_si, slider_si_names)
    case = shortened("default", 150)
    invariant = next(invariant for invariant in INVARIANTS.values() if invariant.run == run)
    other, exact = Answer(RUNS[run](file, case)), exact_motion(case)
    band = numerical(exact, nearby_motions(case))
    result = judge_run(invariant, case, PHYSICS_CONTRACT, exact, run_case(file, case), other, band)
    assert result.passed, result


def test_a_scaled_run_sets_only_what_is_there(ours: FmuFile) -> None:
    """Without gravity among its variables an FMU is scaled where g stays, and else left out."""
    poor = FmuFile(ours.path, NameMap({"g": Target(NOT_THERE)}))
    case = shortened("default", 40)
    whole = run_case(poor, case)
    for other in ("mirror", "forces"):
        assert differing(whole, RUNS[other](poor, case)) == set()
    with pytest.raises(NotApplicableError, match=r"^it has no variable g$"):
        RUNS["time"](poor, case)


TO_THE_BIT = INVARIANTS["reset-to-the-bit"]
NEARLY = INVARIANTS["mirror"]


SMALL = exact_of("grazing").record


def judged(
    invariant: RunInvariant, other: Answer[Run], contract: Contract = EXACT_CONTRACT
) -> CheckResult:
    """Return the result of a small case whose other run came to `other`."""
    exact = exact_of("grazing")
    band = numerical(exact, nearby_motions(named("grazing"))) if contract.banded else None
    return judge_run(invariant, named("grazing"), contract, exact, exact.record, other, band)


def changed(name: str, by: float) -> Answer[Run]:
    """Return the small case's record with the last value of an output moved."""

    def fault(draft: Draft) -> None:
        draft.outputs[name][-1] += by

    return Answer(planted(SMALL, fault))


def test_one_bit_is_seen_and_named() -> None:
    """An invariant to the bit counts the values that differ and names the first output."""
    result = judged(TO_THE_BIT, changed("z", float(np.spacing(SMALL.outputs["z"][-1]))))
    assert (result.passed, result.got, result.error) == (False, 1.0, 1.0)
    assert result.quantity == "values that differ, z first"
    same = judged(TO_THE_BIT, Answer(SMALL))
    assert (same.passed, same.got, same.quantity) == (True, 0.0, "values that differ")


def test_a_start_that_differs_is_seen() -> None:
    """What is shown after initialization belongs to the motion that a run must repeat."""
    other = replace(SMALL, initial={**SMALL.initial, "F_s": 1.0})
    assert not judged(TO_THE_BIT, Answer(other)).passed


def test_a_motion_that_differs_is_seen_where_it_differs_most() -> None:
    """An invariant with a tolerance shows the worst output, in its unit and over its scale."""
    result = judged(NEARLY, changed("t_slip", 1e-9))
    assert (result.passed, result.quantity, result.unit) == (False, "t_slip", "s")
    assert result.error == pytest.approx(1e-9 / named("grazing").stop_time, rel=1e-6)
    assert judged(NEARLY, changed("t_slip", 1e-11), PHYSICS_CONTRACT).passed
    assert not judged(NEARLY, changed("t_slip", 1e-3), PHYSICS_CONTRACT).passed


@pytest.mark.parametrize("invariant", [TO_THE_BIT, NEARLY], ids=lambda invariant: invariant.id)
def test_a_count_is_right_or_wrong(invariant: RunInvariant) -> None:
    """One slip more is a failure whatever the number of slips."""
    result = judged(invariant, changed("n_slips", 1.0), PHYSICS_CONTRACT)
    assert (result.passed, result.error) == (False, 1.0)


def test_what_is_lost_in_the_other_run_is_a_failure() -> None:
    """An output that vanishes, a sample that is lost, a NaN: each fails, none raises."""

    def short(draft: Draft) -> None:
        draft.outputs["T"] = draft.outputs["T"][:-1]

    for invariant in (TO_THE_BIT, NEARLY):
        for other in (
            Answer(planted(SMALL, without("T"))),
            Answer(planted(SMALL, short)),
            changed("T", np.nan),
        ):
            result = judged(invariant, other)
            assert not result.passed
            assert result.failure or result.error


def test_why_there_is_no_other_run_is_kept() -> None:
    """A run that failed fails the invariant with its reason; one that is lacking does not count."""
    failed = judged(TO_THE_BIT, Answer(failure="it broke"))
    lacking = judged(TO_THE_BIT, Answer(not_applicable="it cannot"))
    assert (failed.verdict, failed.failure) == ("fail", "it broke")
    assert (lacking.verdict, lacking.not_applicable) == ("not applicable", "it cannot")


def test_a_setting_begins_its_steps_where_the_last_ended(ours: FmuFile) -> None:
    """Communication points are the correctly rounded sums of the steps, and begin at 0."""
    setting = Setting({}, [CommunicationStep(0.1, {})] * 10)
    assert setting.points[0] == 0.0
    assert (setting.points[9], setting.points[-1]) == (0.9, 1.0)
    case = shortened("default", 10)
    record = run(ours, Setting(case.parameters, case.steps))
    assert differing(record, run_case(ours, case)) == set()
