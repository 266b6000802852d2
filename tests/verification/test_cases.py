"""Facts about the case files and about what is refused in them."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification import CaseError, load_cases
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.judge.checks import extract, places
from stickslip_verification.model.formulas import FORMULAS
from stickslip_verification.model.quantities import GROUPS
from stickslip_verification.model.verdict import CaseGroup, Kind
from stickslip_verification.suite.cases import At, Case, Truth

from .records import exact_of

THEORY = Path(__file__).parents[2] / "docs" / "theory.md"
CASES = load_cases()

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


def read(folder: Path, text: str) -> Case:
    """Write a case file and load it."""
    (folder / "good.toml").write_text(text, encoding="utf-8")
    return load_cases(folder=folder)[0]


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("k = 500.0", "k = = 5", "line 10: Invalid value"),
        ("k = 500.0", "k = -1.0", "parameters.k: -1.0 is less than or equal to the minimum of 0"),
        ("k = 500.0", "kay = 5.0", "parameters: Additional properties.*'kay'"),
        ("k = 500.0", "k = 'much'", "parameters.k: 'much' is not of type 'number'"),
        ("k = 500.0", "k = inf", "parameters.k: inf is not a finite number"),
        ('title = "A case"', 'title = "A case"\ncolour = 1', "Additional properties.*'colour'"),
        ('id = "good"', 'id = "no good"', "id: 'no good' does not match"),
        ("stop_time = 1.0", "stop_time = 1.05", "the steps end at 1.0, not at stop_time 1.05"),
        ("{ fixed = 0.1 }", "{ fixed = 0.1, seed = 3 }", "experiment.steps"),
        ("{ fixed = 0.1 }", "{ list = [] }", "experiment.steps"),
        (
            "{ fixed = 0.1 }",
            "{ seed = 1, shortest = 0.2, longest = 0.1 }",
            "shortest: 0.2 is above longest 0.1",
        ),
        ("time = 0.3", "time = 0.35", "0.35 is not at a communication point"),
        ("time = 0.3", "time = 1.0", "1.0 is not before stop_time"),
        ("{ v = 0.0 }", "{ m = 2.0 }", "experiment.changes.0..set: Additional properties.*'m'"),
        ('"t_slip"\nformula', '"t_slop"\nformula', "quantity: 't_slop' is not a known quantity"),
        ('formula = "t_slip"', 'formula = "t_slop"', "'t_slop' is not a known formula"),
        ('formula = "t_slip"', 'formula = "spring_relief"', "is in 'm', t_slip in 's'"),
        ('"end"', '"now and then"', "at: 'now and then'"),
        ('"end"', "{ cycle = 0 }", "at.cycle: 0 is less than the minimum of 1"),
        ('"end"', '"every_point"', "relative makes no sense over all points"),
        ("fmu = 1e-12", "fmu = -1e-12", "tolerance.fmu: -1e-12 is less than the minimum"),
        ("fmu = 1e-12", "fmu = nan", "tolerance.fmu: nan is not a finite number"),
        (
            "1e-12, reference = 1e-9",
            "1e-12",
            "because.reference: a reason without a tolerance.reference",
        ),
        ('"rounding"', '" "', "because.fmu: ' ' does not match"),
        (', reference = "integration"', "", "tolerance.reference: it needs a reason: because"),
        ("because = { fmu", "cause = { fmu", "Additional properties.*'cause'"),
        (
            'formula = "t_slip"\nat = "end"\ntolerance = { measure = "relative", fmu = 1e-12, ',
            'at = "end"\ntolerance = { measure = "relative", ',
            "because.fmu: a reason without a tolerance.fmu",
        ),
        ('["x"]', '["x", "y"]', r"line 4, courses.1.: 'y' is not a known output or group: groups"),
        ('["x"]', '["state", "x"]', r"line 4, courses.1.: 'x' is named twice"),
        ('["x"]', '["x"]\ncourses_at = "start"', "line 5, courses_at: 'start' is not one of"),
        ('only = ["T"]', 'only = ["x"]', r"cycle.only.0.: 'x' has no formula in the undamped cyc"),
        ("{ cycle = 1 }", '"every_point"', "cycle.at: a cycle has no value at every point"),
        ("k = 500.0", "mu_k = 0.5", "line 5, cycle: without a gap and a pull there is no cycle"),
        ("k = 500.0", "v = 0.0", "line 5, cycle: without a gap and a pull there is no cycle"),
        ("k = 500.0", "load = -10.0", "parameters: load = -10.0 is outside load >= -m g"),
        ("{ v = 0.0 }", "{ load = -10.0 }", r"changes.0..set: load = -10.0 is outside"),
        ("slips = 1", "slips = -1", "line 6, motion.slips: -1 is less than the minimum"),
        ("slips = 1", 'slips = 1, zero = ["z"]', r"motion.zero.0.: 'z' is none of the courses: x"),
        ("slips = 1", "reversals = 1", "motion: 'slips' is a required property"),
        ("1e-11 }", "1e-9 }", "line 7, tolerances.fmu: 1e-09 is looser than the rules' 1e-10"),
        (
            "fmu = 1e-11 }",
            "conditioning = 2.6 }",
            "conditioning: 2.6 is above that of the narrowest",
        ),
        ("fmu = 1e-11 }", 'because = "so" }', "tolerances: 'fmu' is a dependency of 'because'"),
    ],
)
def test_a_broken_case_is_refused_by_file_field_and_reason(
    tmp_path: Path, old: str, new: str, told: str
) -> None:
    """A case file with a fault is refused with its name, the place and the reason, in one line."""
    assert old in GOOD
    with pytest.raises(CaseError, match=told) as caught:
        read(tmp_path, GOOD.replace(old, new))
    assert str(caught.value).startswith(str(tmp_path / "good.toml"))
    assert "\n" not in str(caught.value)


def test_a_discrete_quantity_has_no_tolerance(tmp_path: Path) -> None:
    """The number of slips is right or wrong, never nearly right."""
    text = GOOD.replace('"t_slip"\nformula = "t_slip"', '"n_slips"').replace("relative", "absolute")
    with pytest.raises(CaseError, match="tolerance: n_slips is discrete"):
        read(tmp_path, text)


def test_what_no_rule_gives_must_be_stated(tmp_path: Path) -> None:
    """A difference of two lengths has no tolerance by rule, nor has a measure of one's own."""
    check = GOOD[: GOOD.index("tolerance = { measure")]
    beyond = check.replace('"t_slip"\nformula = "t_slip"', '"slip_beyond_half_period"')
    told = r"tolerance: no rule gives slip_beyond_half_period a tolerance \(relative\): state fmu"
    with pytest.raises(CaseError, match=told):
        read(tmp_path, beyond)
    only_measure = check + 'tolerance = { measure = "absolute" }\n'
    with pytest.raises(CaseError, match=r"no rule gives t_slip a tolerance \(absolute\)"):
        read(tmp_path, only_measure)


def test_a_check_that_is_written_out_takes_what_it_leaves_open_from_the_rules(
    tmp_path: Path,
) -> None:
    """One side may have a tolerance of its own, and the other that of the rules."""
    own = GOOD.replace(", reference = 1e-9", "").replace(', reference = "integration"', "")
    by_rule = read(tmp_path, GOOD[: GOOD.index("tolerance = { measure")]).checks[-1]
    mixed = read(tmp_path, own).checks[-1]
    assert mixed.tolerance == {"fmu": 1e-12, "reference": by_rule.tolerance["reference"]}
    assert mixed.because == {"fmu": "rounding", "reference": by_rule.because["reference"]}
    assert (by_rule.unit, by_rule.truth, by_rule.measure) == (
        "s",
        Truth(Kind.CLOSED_FORM, 8, "t_slip"),
        "relative",
    )


BARE = """\
id = "good"
title = "A case"
about = "Parameters and an experiment."

[parameters]
k = 500.0

[experiment]
stop_time = 1.5
steps = { fixed = 0.1 }
"""


def test_an_experiment_is_enough(tmp_path: Path) -> None:
    """Without a word on checks every group of outputs is held against the exact motion."""
    case = read(tmp_path, BARE)
    names = [check.quantity for check in case.checks]
    assert names == [name for group in GROUPS.values() for name in group]
    assert all(check.at == At("every_point") for check in case.checks)


def test_what_a_case_does_not_state_of_its_motion_is_found(tmp_path: Path) -> None:
    """The exact motion is followed at the loading, and the tolerances are those of its slips."""
    facts = exact_motion(read(tmp_path, BARE)).facts
    assert (facts.slips, facts.reversals) == (2, 0)
    assert "T" not in facts.zero
    stated = read(tmp_path, BARE.replace("\n\n[par", "\nmotion = { slips = 2 }\n\n[par", 1))
    assert read(tmp_path, BARE).checks == stated.checks
    once = read(tmp_path, BARE.replace("stop_time = 1.5", "stop_time = 0.7")).checks
    assert next(check for check in once if check.quantity == "T").measure == "absolute"


def test_a_case_that_checks_nothing_is_refused(tmp_path: Path) -> None:
    """An empty list of courses leaves a case without a check."""
    with pytest.raises(CaseError, match="it checks nothing: no courses, no cycle, no checks"):
        read(tmp_path, BARE.replace("\n\n[par", "\ncourses = []\n\n[par", 1))


def test_a_looser_tolerance_needs_its_reason_and_a_tighter_one_does_not(tmp_path: Path) -> None:
    """The bound for changing inputs is 1e-10: 1e-11 is told as tighter, 1e-9 with its reason."""
    (check, *_) = [each for each in read(tmp_path, GOOD).checks if each.id == "x-course"]
    assert check.tolerance["fmu"] == 1e-11
    assert check.because["fmu"].startswith("held to 1e-11, tighter than the rule's 1e-10: ")
    loose = GOOD.replace("fmu = 1e-11 }", 'fmu = 1e-9, because = "it is rough" }')
    (check, *_) = [each for each in read(tmp_path, loose).checks if each.id == "x-course"]
    assert (check.tolerance["fmu"], check.because["fmu"]) == (1e-9, "it is rough")


def test_ids_are_unique(tmp_path: Path) -> None:
    """Neither two cases nor two checks of a case share an id."""
    check = GOOD[GOOD.index("[[checks]]") :]
    with pytest.raises(CaseError, match=r"checks\[1\].id: 'slip' is taken"):
        read(tmp_path, GOOD + check)
    with pytest.raises(CaseError, match=r"checks\[0\].id: 'x-course' is taken"):
        read(tmp_path, GOOD.replace('id = "slip"', 'id = "x-course"'))
    read(tmp_path, GOOD)
    (tmp_path / "zwei.toml").write_text(GOOD, encoding="utf-8")
    with pytest.raises(CaseError, match=r"zwei.toml: id: 'good' is taken by good.toml"):
        load_cases(folder=tmp_path)


def test_a_case_is_grouped_by_what_it_sets() -> None:
    """The group follows from the file, and every group has cases."""
    groups = {case.id: case.group for case in load_cases()}
    assert set(groups.values()) == {*CaseGroup}
    assert {case for case, group in groups.items() if group == CaseGroup.DEFAULT} == {
        "default",
        "crumbs",
        "long-run",
        "one-step",
    }
    assert groups["clamp-tuned"] == CaseGroup.CONVENTIONS
    assert groups["overdamped-turn"] == CaseGroup.CHANGES
    assert groups["reversals-damped"] == CaseGroup.STARTS
    assert groups["damped-cycle"] == CaseGroup.DAMPING
    assert groups["stiff"] == CaseGroup.SETTINGS


def test_cases_are_chosen_by_pattern(tmp_path: Path) -> None:
    """A shell pattern chooses cases; one that matches nothing is an error, not an empty run."""
    assert [case.id for case in load_cases("slow-*")] == ["slow-pull"]
    with pytest.raises(CaseError, match="no case matches 'nothing'"):
        load_cases("nothing")
    with pytest.raises(CaseError, match="no such folder"):
        load_cases(folder=tmp_path / "nowhere")


def test_a_good_case_is_read(tmp_path: Path) -> None:
    """Steps, changes and checks come out as they were written."""
    case = read(tmp_path, GOOD)
    assert case.parameters == {"k": 500.0}
    assert [step.h for step in case.steps] == [0.1] * 10
    assert [n for n, step in enumerate(case.steps) if step.changes] == [3]
    assert case.steps[3].changes == {"v": 0.0}
    assert case.stop_time == 1.0
    assert [check.id for check in case.checks] == ["T-exact", "x-course", "slip"]
    check = case.checks[-1]
    assert check.tolerance == {"fmu": 1e-12, "reference": 1e-9}
    assert check.because == {"fmu": "rounding", "reference": "integration"}


def test_uneven_steps_are_named_by_their_seed(tmp_path: Path) -> None:
    """A seed draws the same steps each time, within their range, and meets the change exactly."""
    text = GOOD.replace("{ fixed = 0.1 }", "{ seed = 5, shortest = 1e-4, longest = 0.2 }")
    first, again = read(tmp_path, text), read(tmp_path, text)
    assert first.steps == again.steps
    assert max(step.h for step in first.steps) <= 0.2
    changed = next(n for n, step in enumerate(first.steps) if step.changes)
    assert first.times[changed - 1] == pytest.approx(0.3, abs=1e-15)
    assert math.fsum(step.h for step in first.steps) == first.stop_time


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.id)
def test_every_case_is_sound(case: Case) -> None:
    """A case bears the name of its file, and each of its checks has a place and a scale."""
    assert case.file.stem == case.id
    exact = exact_of(case.id)
    for check in case.checks:
        chosen = places(check.at, exact)
        samples = extract(check.quantity, exact.record, exact.start)
        assert np.all(np.isfinite(samples[chosen])), check.id
        if check.measure == "of_scale":
            assert np.any(samples != 0.0), f"{check.id}: the scale is zero"


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.id)
def test_no_sample_hangs_on_rounding(case: Case) -> None:
    """Between a communication point and an event lie 10 ns, or the event is a change's own."""
    points = np.array((0.0, *case.times))
    changes = [t for t, step in zip(points, case.steps, strict=False) if step.changes]
    for event in exact_of(case.id).event_times:
        caused = any(abs(event - time) <= 4.0 * math.ulp(time) for time in (0.0, *changes))
        assert caused or np.min(np.abs(points - event)) > 1e-8


def test_every_truth_has_its_equation() -> None:
    """Each source of a case and each formula is an equation of docs/theory.md."""
    numbers = {int(n) for n in re.findall(r"\\tag\{(\d+)\}", THEORY.read_text(encoding="utf-8"))}
    cited = {check.truth.source for case in CASES for check in case.checks}
    assert cited <= numbers
    assert {formula.equation for formula in FORMULAS.values()} <= numbers


def test_every_formula_is_used() -> None:
    """No named formula stands in the library without a case that tries it."""
    used = {check.truth.formula for case in CASES for check in case.checks}
    assert set(FORMULAS) - used - {"half_period"} == set()


def test_the_exact_motion_and_the_formulas_agree() -> None:
    """The motion followed event by event meets each closed form that is exact."""
    first_order = {"slow_slip_excess", "fast_slip_deficit"}
    for case in CASES:
        exact = exact_of(case.id)
        for check in case.checks:
            if check.truth.formula is None or check.truth.formula in first_order:
                continue
            value = float(FORMULAS[check.truth.formula].evaluate(exact.start))
            got = extract(check.quantity, exact.record, exact.start)
            slack = check.tolerance["fmu"] * (abs(value) if check.measure == "relative" else 1.0)
            assert abs(got[places(check.at, exact)[0]] - value) <= slack, (case.id, check.id)
