"""A friction law by its dotted name: built, verified, and refused where it is none."""

from pathlib import Path

import pytest

from stickslip_fmu.packer import build
from stickslip_verification import CaseError, load_cases
from stickslip_verification.drive.description import FmuError
from stickslip_verification.drive.exact import FOLDER, kept
from stickslip_verification.run.verify import verify
from stickslip_verification.suite.cases import Case
from tests.laws.renamed import NAME

GOOD = f"""\
id = "good"
title = "Friction falls straight with speed"
about = "The effective damping is negative; the slope is 0.1 s/m up to 3 m/s."
law = "{NAME}"
motion = {{ slips = 2 }}

[parameters]
shape = 3
n_points = 2
mu_1 = 0.3
u_2 = 3.0
mu_2 = 0.0

[experiment]
stop_time = 1.0
steps = {{ fixed = 0.1 }}

[[experiment.changes]]
time = 0.3
set = {{ v = 0.03 }}
"""


def read(folder: Path, text: str = GOOD) -> Case:
    (folder / "good.toml").write_text(text, encoding="utf-8")
    return load_cases(folder=folder)[0]


def test_a_law_with_the_model_name_of_another_is_not_built(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="needs a model name other than StickSlip"):
        build(tmp_path, law="tests.laws.test_own_law:NAMESAKE")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("u_2 = 3.0", "u_20 = 3.0", "u_20"),
        ("mu_2 = 0.0", "mu_2 = -1.0", "mu_2 = -1.0 is outside mu_2 >= 0"),
        ("set = { v = 0.03 }", "set = { u_20 = 0.5 }", "u_20"),
        ("set = { v = 0.03 }", "set = { u_2 = 2.0 }", "u_2"),
        (f'law = "{NAME}"\n', "", "shape"),
        (NAME, "tests.laws.no_such:LAW", "line 4, law: .* 'tests.laws.no_such:LAW' was not found"),
        (NAME, "renamed", "'renamed' is no friction law: "),
        ("motion =", "cycle = { at = { cycle = 1 } }\nmotion =", "line 5, cycle: .* Coulomb's law"),
        (
            "[parameters]",
            '[[checks]]\nid = "T"\nquantity = "T"\nat = "end"\nformula = "t_slip"\n\n[parameters]',
            "the formulas are those of Coulomb's law",
        ),
    ],
)
def test_what_is_wrong_with_a_case_of_a_law_is_said_in_one_line(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    assert GOOD.count(old) == 1
    with pytest.raises(CaseError, match=words) as caught:
        read(tmp_path, GOOD.replace(old, new))
    assert "\n" not in str(caught.value)


def test_an_fmu_without_the_parameters_of_the_law_is_refused(
    tmp_path: Path, fmu_path: Path
) -> None:
    with pytest.raises(FmuError, match=f"no variable shape, .*, which the friction law {NAME}"):
        verify(fmu_path, [read(tmp_path)])


def test_no_baseline_is_kept_of_a_law_whose_source_is_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "kept"
    folder.mkdir()
    monkeypatch.setenv(FOLDER, str(folder))
    kept(lambda case: case.id, read(tmp_path))
    assert not list(folder.iterdir())


@pytest.mark.gate
def test_the_fmu_of_the_law_keeps_the_exact_contract_on_its_case(tmp_path: Path) -> None:
    fmu = build(tmp_path, law=NAME)
    assert fmu.name == "RenamedFriction.fmu"
    verdict = verify(fmu, [read(tmp_path)], jobs=1)
    assert verdict.contract is not None
    assert verdict.contract.name == "exact"
    assert [result for result in verdict.checks if not result.passed] == []
    names = {result.check for result in verdict.checks}
    assert {"x-course", "time-scales-to-the-bit", "splitting", "energy-balance"} <= names
    # What the equation of Coulomb's slip says is left out.
    assert not {"slip-propagates", "heat-of-dry-friction", "phases-join"} & names
