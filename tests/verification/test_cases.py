"""Facts about the case files and about what is refused in them."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification import CaseError, load_cases
from stickslip_verification.cases import Case
from stickslip_verification.formulas import FORMULAS
from stickslip_verification.judging.checks import extract, places

from .standing_in import exact_of

THEORY = Path(__file__).parents[2] / "docs" / "theory.md"
CASES = load_cases()

GOOD = """\
id = "good"
title = "A case"
about = "It is enough to be read."

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
unit = "s"
truth = { kind = "closed_form", source = 8, formula = "t_slip" }
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
        ("k = 500.0", "k = = 5", "line 6: Invalid value"),
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
        ('"t_slip"\nunit', '"t_slop"\nunit', "quantity: 't_slop' is not a known quantity"),
        ('unit = "s"', 'unit = "ms"', "unit: t_slip is in 's', not 'ms'"),
        ("closed_form", "hearsay", "truth.kind: 'hearsay' is not one of"),
        ("source = 8", "source = 9", r"truth.source: t_slip is equation \(8\), not \(9\)"),
        ('formula = "t_slip"', 'formula = "t_slop"', "'t_slop' is not a known formula"),
        ('8, formula = "t_slip"', '7, formula = "spring_relief"', "is in 'm', t_slip in 's'"),
        ('"end"', '"now and then"', "at: 'now and then'"),
        ('"end"', "{ cycle = 0 }", "at.cycle: 0 is less than the minimum of 1"),
        ('"end"', '"every_point"', "relative makes no sense over all points"),
        ("fmu = 1e-12", "fmu = -1e-12", "tolerance.fmu: -1e-12 is less than the minimum"),
        ("fmu = 1e-12", "fmu = nan", "tolerance.fmu: nan is not a finite number"),
        (", reference = 1e-9", "", "tolerance: 'reference' is a required property"),
        ('"rounding"', '" "', "because.fmu: ' ' does not match"),
        (', reference = "integration"', "", "because: 'reference' is a required property"),
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
    text = GOOD.replace('"t_slip"\nunit = "s"', '"n_slips"\nunit = "1"')
    text = text.replace('8, formula = "t_slip"', "16").replace("relative", "absolute")
    with pytest.raises(CaseError, match="tolerance: n_slips is discrete"):
        read(tmp_path, text)


def test_ids_are_unique(tmp_path: Path) -> None:
    """Neither two cases nor two checks of a case share an id."""
    check = GOOD[GOOD.index("[[checks]]") :]
    with pytest.raises(CaseError, match=r"checks\[1\].id: 'slip' is taken"):
        read(tmp_path, GOOD + check)
    read(tmp_path, GOOD)
    (tmp_path / "zwei.toml").write_text(GOOD, encoding="utf-8")
    with pytest.raises(CaseError, match=r"zwei.toml: id: 'good' is taken by good.toml"):
        load_cases(folder=tmp_path)


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
    (check,) = case.checks
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
