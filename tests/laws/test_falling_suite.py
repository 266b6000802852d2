"""Cases of the falling friction law in the suite: read, followed, refused where they cannot run."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from stickslip_fmu.packer import build
from stickslip_verification import CaseError, load_cases
from stickslip_verification.drive.exact import exact_motion
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.kept import FOLDER, kept
from stickslip_verification.drive.stepping import setting_of
from stickslip_verification.model.symmetries import HEAVIER, MIRROR, QUICKER
from stickslip_verification.model.verdict import ChosenContract
from stickslip_verification.run.baseline import compute
from stickslip_verification.run.verify import verify
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import load_invariants

CASES = Path(__file__).parent / "falling" / "cases"

GOOD = """\
id = "good"
title = "A case"
about = "It is enough to be read."
law = "tests.laws.falling:FALLING"
courses = ["x"]
motion = { slips = 1 }

[parameters]
slope = 0.25

[experiment]
stop_time = 1.0
steps = { fixed = 0.1 }

[[experiment.changes]]
time = 0.3
set = { slope = 0.5 }
"""


def _read(folder: Path, text: str) -> Case:
    (folder / "good.toml").write_text(text, encoding="utf-8")
    return load_cases(folder=folder)[0]


def test_a_case_knows_its_law_and_the_parameters_of_it(tmp_path: Path) -> None:
    """Own parameters are values of the case like others, the start of the law where it has none."""
    case = _read(tmp_path, GOOD)
    assert case.law == "tests.laws.falling:FALLING"
    assert [each.name for each in case.own] == ["slope"]
    assert case.start["slope"] == 0.25
    assert replace(case, parameters={}).start["slope"] == 0.1
    assert (
        _read(
            tmp_path,
            GOOD.replace('law = "tests.laws.falling:FALLING"\n', "")
            .replace("slope = 0.25", "mu_k = 0.25")
            .replace("slope = 0.5", "mu_k = 0.1"),
        ).law
        == "coulomb"
    )


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("slope = 0.25", "slop = 0.25", "slop"),
        ("slope = 0.25", "slope = -1.0", "-1.0 is less than the minimum of 0"),
        ("set = { slope = 0.5 }", "set = { slop = 0.5 }", "slop"),
        ("set = { slope = 0.5 }", "set = { m = 2.0 }", "'m' was unexpected"),
        ('law = "tests.laws.falling:FALLING"\n', "", "'slope' was unexpected"),
        (
            "tests.laws.falling:FALLING",
            "tests.laws.no_such:LAW",
            "line 4, law: the friction law 'tests.laws.no_such:LAW' was not found (No module named "
            "'tests.laws.no_such'); expected module:NAME, such as 'my_laws.stribeck:STRIBECK'",
        ),
        ("tests.laws.falling:FALLING", "falling", "'falling' is no friction law: 'coulomb', or"),
        (
            "motion =",
            "cycle = { at = { cycle = 1 } }\nmotion =",
            "line 6, cycle: the formulas are those of Coulomb's law; without one the exact motion",
        ),
        (
            "[parameters]",
            '[[checks]]\nid = "T"\nquantity = "T"\nat = "end"\nformula = "T"\n\n[parameters]',
            "the formulas are those of Coulomb's law",
        ),
    ],
)
def test_what_is_wrong_with_a_case_of_a_law_is_told(
    tmp_path: Path, old: str, new: str, told: str
) -> None:
    """One line says the file, the place and the reason."""
    assert GOOD.count(old) == 1
    with pytest.raises(CaseError) as caught:
        _read(tmp_path, GOOD.replace(old, new))
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_fmu_without_the_parameters_of_the_law_is_refused_with_one_line(fmu_path: Path) -> None:
    """Coulomb's FMU has no slope; it is told before anything runs, and by the drive itself."""
    cases = load_cases(folder=CASES)
    told = "has no variable slope, which the friction law tests.laws.falling:FALLING of the case"
    with pytest.raises(FmuError, match=told) as caught:
        verify(fmu_path, cases)
    assert "\n" not in str(caught.value)
    with pytest.raises(FmuError, match=told):
        setting_of(FmuFile(fmu_path), cases[0])


def test_invariants_of_coulombs_slip_are_not_tried_on_another_law() -> None:
    """What holds for every law is judged; what the equation of Coulomb's slip says is left out."""
    (baseline, *_) = compute(load_cases("falling", CASES), load_invariants(), 1)
    names = {each.id for each in baseline.invariants}
    assert {"energy-balance", "stick-holds-x", "jump-is-v-T", "heat-never-falls"} <= names
    assert not {"slip-propagates", "heat-of-dry-friction", "phases-join"} & names
    # A law may add outputs to the interface.
    assert "declared-variables" not in {
        each.id for each in load_invariants().of_laws([baseline.case.law])
    }
    left = load_invariants().of_laws(["tests.laws.falling:FALLING"])
    assert {each.id for each in load_invariants()} > {each.id for each in left}
    assert load_invariants().of_laws(["coulomb"]).only({"slip-friction"}).residuals


def test_own_parameters_follow_the_symmetries_by_their_unit() -> None:
    """A slope in s/m halves where everything is twice as fast, and has no sign to turn."""
    (case, *_) = load_cases("falling-changes", CASES)
    assert QUICKER.scaled(case.start, case.own)["slope"] == case.start["slope"] / 2
    assert HEAVIER.scaled(case.start, case.own)["slope"] == case.start["slope"]
    assert MIRROR.scaled(case.start, case.own)["slope"] == case.start["slope"]


def test_nothing_is_kept_of_a_law_whose_source_is_not_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The exact motion of such a case is computed anew, and no file is written."""
    monkeypatch.setenv(FOLDER, str(tmp_path))
    kept(exact_motion, load_cases("falling", CASES)[0])
    assert not list(tmp_path.iterdir())


@pytest.fixture(scope="module")
def falling_fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an FMU of the falling friction law."""
    return build(tmp_path_factory.mktemp("falling"), law="tests.laws.falling:FALLING")


def test_the_fmu_of_the_law_keeps_the_exact_contract_on_its_cases(
    falling_fmu: Path,
) -> None:
    """Its description names it, and every check of both cases passes at the exact tolerances."""
    verdict = verify(falling_fmu, load_cases(folder=CASES), jobs=1)
    assert verdict.contract == ChosenContract("exact", "its description names stickslip-exact 1")
    assert [r for r in verdict.checks if not r.passed] == []
    assert all(result.decides for result in verdict.checks)
    sides = {(result.case, result.side) for result in verdict.checks if result.case}
    assert sides == {
        (case, side)
        for case in ("falling", "falling-changes")
        for side in ("fmu", "reference", "both")
    }
    names = {result.check for result in verdict.checks}
    assert {"x-course", "Q_friction-course", "time-scales-to-the-bit", "splitting"} <= names


def test_the_fmu_of_the_law_fails_as_an_fmu_of_coulombs(falling_fmu: Path, tmp_path: Path) -> None:
    """Its slope of 0.1 s/m changes the period by 2 %, which a case of Coulomb's law tells."""
    text = (CASES / "falling.toml").read_text(encoding="utf-8")
    case = _read(tmp_path, text.replace('law = "tests.laws.falling:FALLING"\n', ""))
    verdict = verify(falling_fmu, [case], fresh_processes=False, jobs=1)
    failed = {(result.check, result.side) for result in verdict.checks if not result.passed}
    assert {("T-course", "fmu"), ("slip-propagates", "fmu"), ("agree-on-x", "both")} <= failed
    assert not any(side == "reference" for _, side in failed)
