"""Case files: what is read from them, what is refused in them, and those of the suite."""

import math
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification import Case, CaseError, load_cases, load_invariants, meanings
from stickslip_verification.judge.checks import extract, places
from stickslip_verification.model.quantities import GROUPS, QUANTITIES
from stickslip_verification.suite.cases import At, Meaning

from .records import exact_of

CASES = load_cases()
# Where friction depends on speed, the exact motion takes seconds.
QUICK = [case for case in CASES if case.law == "coulomb" and case.id != "long-run"]

GOOD = """\
id = "good"
title = "A case"
about = "It is enough to be read."
courses = ["x"]
cycle = { at = { cycle = 1 }, only = ["T"] }
motion = { slips = 1 }
tolerances = { fmu = 1e-11 }

[parameters]
k = 500.0

[experiment]
stop_time = 1.0
steps = { fixed = 0.1 }

[[experiment.changes]]
time = 0.3
set = { v = 0.0 }

[[checks]]
id = "slip"
quantity = "t_slip"
formula = "t_slip"
at = "end"
tolerance = { measure = "relative", fmu = 1e-12, reference = 1e-9 }
because = { fmu = "rounding", reference = "integration" }
"""
BARE = GOOD[: GOOD.index("courses")] + GOOD[GOOD.index("[par") : GOOD.index("[[experiment.")]
STATED = GOOD[GOOD.index("tolerance = {") :]

LENGTH = GOOD[GOOD.index('"t_slip"') :]
BEYOND = '[[checks]]\nid = "beyond"\nquantity = "slip_beyond_half_period"\nat = "end"'
NOTHING = "courses = []\n\n" + BARE[BARE.index("[par") :]


def read(folder: Path, text: str) -> Case:
    (folder / "good.toml").write_text(text, encoding="utf-8")
    return load_cases(folder=folder)[0]


# What stands in GOOD, what stands there instead, and the words of the refusal.
REFUSED = [
    ("k = 500.0", "k = = 5", "line 10"),
    ("k = 500.0", "k = -1.0", "line 10, parameters.k: k = -1.0 is outside k > 0"),
    ("k = 500.0", "mu_k = 0.5", "line 5, cycle: without a gap and a pull there is no cycle"),
    ("k = 500.0", "load = -10.0", "parameters: load = -10.0 is outside load >= -m g"),
    ("k = 500.0", "tau_s = 0.1", "Coulomb's law with constant coefficients"),
    ('id = "good"', 'id = "no good"', "line 1, id: 'no good' should match pattern"),
    ("stop_time = 1.0", "stop_time = 1.05", "the steps end at 1.0, not at stop_time 1.05"),
    ("{ fixed = 0.1 }", "{ seed = 1, shortest = 0.2, longest = 0.1 }", "0.2 is above longest 0.1"),
    ("time = 0.3", "time = 0.35", "0.35 is not at a communication point"),
    ('"t_slip"\nformula', '"t_slop"\nformula', "quantity: 't_slop' is not a known quantity"),
    ('formula = "t_slip"', 'formula = "t_slop"', "'t_slop' is not a known formula"),
    ('formula = "t_slip"', 'formula = "spring_relief"', "is in 'm', t_slip in 's'"),
    (
        LENGTH,
        LENGTH.replace('"t_slip"\nformula = "t_slip"', '"n_slips"').replace("relative", "absolute"),
        "tolerance: n_slips is discrete",
    ),
    ('"end"', '"every_point"', "relative makes no sense over all points"),
    ("1e-12, reference = 1e-9", "1e-12", "line 25, .*tolerance.reference: is missing"),
    (
        ', reference = "integration"',
        "",
        "line 26, .*because: has the keys fmu, and not",
    ),
    ('["x"]', '["x", "y"]', r"line 4, courses.1.: 'y' is not a known output or group"),
    ('only = ["T"]', 'only = ["x"]', r"cycle.only.0.: 'x' has no formula"),
    ("{ cycle = 1 }", '"every_point"', "cycle.at: a cycle has no value at every point"),
    ("slips = 1", 'slips = 1, zero = ["z"]', r"motion.zero: 'z' is none of the courses"),
    ("1e-11 }", "1e-9 }", "line 7, tolerances.fmu: 1e-09 is looser than the rules' 1e-10"),
    ("fmu = 1e-11 }", "conditioning = 2.6 }", "2.6 is above that of the narrowest"),
    ('id = "slip"', 'id = "x-course"', r"checks\[0\].id: 'x-course' is taken"),
    (GOOD[GOOD.index("because") :], "", r"checks\[0\].tolerance: needs because"),
    (GOOD[GOOD.index("courses") :], NOTHING, "it checks nothing"),
    (STATED, BEYOND, "no rule gives slip_beyond_half_period a tolerance"),
]


@pytest.mark.parametrize(("old", "new", "words"), REFUSED)
def test_a_broken_case_is_refused_by_file_field_and_reason_in_one_line(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    assert old in GOOD
    with pytest.raises(CaseError, match=words) as refused:
        read(tmp_path, GOOD.replace(old, new))
    assert str(refused.value).startswith(str(tmp_path / "good.toml"))
    assert "\n" not in str(refused.value)


def test_all_that_is_wrong_is_said_at_once(tmp_path: Path) -> None:
    wrong = GOOD.replace("= 1.0", "= true").replace("fixed = 0.1", "fixed = -1, seed = 1")
    wrong = wrong.replace('title = "A case"', "").replace("slips = 1", "slip = 1")
    with pytest.raises(CaseError) as refused:
        read(tmp_path, wrong)
    assert [line.partition("good.toml: ")[2] for line in str(refused.value).splitlines()] == [
        "title: is missing",
        "line 13, experiment.stop_time: True should be a valid number",
        "line 14, experiment.steps.fixed: -1 should be greater than 0",
        "line 14, experiment.steps.fixed: does not go with seed",
        "line 14, experiment.steps.seed: needs shortest",
        "line 14, experiment.steps.seed: needs longest",
        "line 6, motion.slips: is missing",
        "line 6, motion.slip: is no field; there are slips, reversals, zero",
    ]


def test_cases_are_chosen_by_pattern_from_a_folder_of_unique_ids(tmp_path: Path) -> None:
    assert [case.id for case in load_cases("slow-*")] == ["slow-pull"]
    with pytest.raises(CaseError, match="no case matches 'nothing'"):
        load_cases("nothing")
    with pytest.raises(CaseError, match="no such folder"):
        load_cases(folder=tmp_path / "nowhere")
    read(tmp_path, GOOD)
    (tmp_path / "zwei.toml").write_text(GOOD, encoding="utf-8")
    with pytest.raises(CaseError, match=r"zwei.toml: id: 'good' is taken by good.toml"):
        load_cases(folder=tmp_path)


def test_a_case_is_read_as_it_was_written(tmp_path: Path) -> None:
    case = read(tmp_path, GOOD)
    assert case.parameters == {"k": 500.0}
    assert [step.h for step in case.steps] == [0.1] * 10
    assert [step.changes for step in case.steps] == [{}] * 3 + [{"v": 0.0}] + [{}] * 6
    assert [check.id for check in case.checks] == ["T-exact", "x-course", "slip"]
    _, course, slip = case.checks
    assert (course.tolerance["fmu"], slip.tolerance) == (1e-11, {"fmu": 1e-12, "reference": 1e-9})
    assert slip.because == {"fmu": "rounding", "reference": "integration"}
    assert (slip.source, slip.formula) == (8, "t_slip")
    loose = GOOD.replace("fmu = 1e-11 }", 'fmu = 1e-9, because = "it is rough" }')
    assert read(tmp_path, loose).checks[1].because["fmu"] == "it is rough"


def test_an_experiment_is_enough_and_every_output_is_held_against_the_exact_motion(
    tmp_path: Path,
) -> None:
    bare = BARE.replace("stop_time = 1.0", "stop_time = 1.5")
    case = read(tmp_path, bare)
    outputs = {name for group in GROUPS.values() for name in group}
    assert {(check.quantity, check.at) for check in case.checks} == {
        (name, At("every_point")) for name in outputs
    }
    # What it does not state of its motion is found.
    stated = bare.replace("[par", "motion = { slips = 2 }\n\n[par")
    assert case.checks == read(tmp_path, stated).checks


def test_uneven_steps_are_those_of_their_seed_and_meet_a_change_exactly(tmp_path: Path) -> None:
    text = GOOD.replace("{ fixed = 0.1 }", "{ seed = 5, shortest = 1e-4, longest = 0.2 }")
    case = read(tmp_path, text)
    assert case.steps == read(tmp_path, text).steps
    assert max(step.h for step in case.steps) <= 0.2
    assert math.fsum(step.h for step in case.steps) == case.stop_time
    begins = dict(zip((0.0, *case.times), case.steps, strict=False))
    # A sum of some steps is rounded once each.
    assert [t for t, step in begins.items() if step.changes] == pytest.approx([0.3], abs=1e-15)


@pytest.mark.parametrize("case", QUICK, ids=lambda case: case.id)
def test_no_communication_point_hangs_on_rounding_and_every_scale_is_some(case: Case) -> None:
    exact = exact_of(case.id)
    points = np.array((0.0, *case.times))
    changes = [t for t, step in zip(points, case.steps, strict=False) if step.changes]
    for event in exact.event_times:
        caused = any(abs(event - time) <= 4.0 * math.ulp(time) for time in (0.0, *changes))
        # The reference's events are right to less than 10 ns.
        assert caused or np.min(np.abs(points - event)) > 1e-8
    for check in case.checks:
        samples = extract(check.quantity, exact.record, exact.start)
        assert np.all(np.isfinite(samples[places(check.at, exact)])), check.id
        assert check.measure != "of_scale" or np.any(samples != 0.0), check.id


def test_every_check_of_a_verdict_has_a_meaning_and_one_of_its_quantity() -> None:
    invariants = load_invariants()
    known = {name: Meaning(of.means, of.look) for name, of in QUANTITIES.items()}
    expected = {each.id: Meaning(each.means, each.look) for each in invariants}
    for check in (check for case in CASES for check in case.checks):
        # Two checks of one name are about one quantity, or one would hide the other.
        assert expected.setdefault(check.id, known[check.quantity]) == known[check.quantity]
    found = meanings(CASES, invariants)
    for order in invariants.orders:
        assert found.pop(f"{order.id}-asymptotic").means
    assert found == expected
