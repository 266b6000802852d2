"""A friction law by its dotted name: built, verified, and refused where it is none."""

from pathlib import Path
from types import SimpleNamespace

import fmpy
import pytest

from stickslip_fmu.packer import build
from stickslip_verification import CaseError, load_cases
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.kept import FOLDER, kept
from stickslip_verification.model.verdict import ChosenContract
from stickslip_verification.run.verify import verify
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import load_invariants
from tests.laws.renamed import NAME

DELTAS = {"delta": 2.0}
NO_LAW = SimpleNamespace(block=f"{__name__}:DELTAS")
NAMESAKE = SimpleNamespace(block="stickslip_fmu.laws.coulomb.law:COULOMB")


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("renamed", "is no friction law: 'coulomb', 'stribeck', or a dotted name module:NAME"),
        ("nowhere:LAW", "was not found (No module named 'nowhere')"),
        ("tests.laws.renamed:LOW", "was not found (module 'tests.laws.renamed' has no attribute"),
        ("tests.laws.renamed:LAW", "has no attribute 'block' with the dotted name"),
        (f"{__name__}:NO_LAW", "is a dict; the block's side of a friction law has the"),
        (f"{__name__}:NAMESAKE", "needs a model name other than StickSlip"),
    ],
)
def test_a_law_that_is_none_is_refused(tmp_path: Path, name: str, reason: str) -> None:
    """What is wrong with a dotted name is said with an example."""
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the text is compared below
        build(tmp_path, law=name)
    assert reason in str(caught.value)


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


def _read(folder: Path, text: str = GOOD) -> Case:
    (folder / "good.toml").write_text(text, encoding="utf-8")
    return load_cases(folder=folder)[0]


def test_a_case_knows_its_law_and_the_parameters_of_it(tmp_path: Path) -> None:
    """Own parameters are values of the case like others, the start of the law where it has none."""
    case = _read(tmp_path)
    assert case.law == NAME
    assert (case.start["u_2"], case.start["delta"]) == (3.0, 2.0)
    plain = GOOD.replace(f'law = "{NAME}"', "")
    assert _read(tmp_path, plain[: plain.index("shape")] + plain[plain.index("[exp") :]).law == (
        "coulomb"
    )


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("u_2 = 3.0", "u_20 = 3.0", "u_20"),
        ("mu_2 = 0.0", "mu_2 = -1.0", "-1.0 is less than the minimum of 0"),
        ("set = { v = 0.03 }", "set = { u_20 = 0.5 }", "u_20"),
        ("set = { v = 0.03 }", "set = { u_2 = 2.0 }", "'u_2' was unexpected"),
        (f'law = "{NAME}"\n', "", "were unexpected"),
        (
            NAME,
            "tests.laws.no_such:LAW",
            "line 4, law: the friction law 'tests.laws.no_such:LAW' was not found (No module named "
            "'tests.laws.no_such'); expected module:NAME, such as 'my_laws.stribeck:STRIBECK'",
        ),
        (NAME, "renamed", "'renamed' is no friction law: "),
        (
            "motion =",
            "cycle = { at = { cycle = 1 } }\nmotion =",
            "line 5, cycle: the formulas are those of Coulomb's law",
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


def test_an_fmu_without_the_parameters_of_the_law_is_refused_with_one_line(
    tmp_path: Path, fmu_path: Path
) -> None:
    """Coulomb's FMU has no shape; it is told before anything runs."""
    told = f"has no variable shape, .*, mu_12, which the friction law {NAME} of the case"
    with pytest.raises(FmuError, match=told) as caught:
        verify(fmu_path, [_read(tmp_path)])
    assert "\n" not in str(caught.value)


def test_nothing_is_kept_of_a_law_whose_source_is_not_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Truth and reference of such a case are computed anew, and no file is written."""
    folder = tmp_path / "kept"
    folder.mkdir()
    monkeypatch.setenv(FOLDER, str(folder))
    case = _read(tmp_path)
    kept(lambda case: case.id, case)
    assert not list(folder.iterdir())


def test_the_fmu_of_the_law_keeps_the_exact_contract_on_its_case(tmp_path: Path) -> None:
    """It is called by the law's model; every check passes at the exact tolerances.

    What the equation of Coulomb's slip says is left out.
    """
    fmu = build(tmp_path, law=NAME)
    assert fmu.name == "RenamedFriction.fmu"
    description = fmpy.read_model_description(str(fmu))
    assert description.coSimulation.modelIdentifier == "RenamedFriction"
    verdict = verify(fmu, [_read(tmp_path)], jobs=1)
    assert verdict.contract == ChosenContract("exact", "its description names stickslip-exact 1")
    assert [r for r in verdict.checks if not r.passed] == []
    assert all(result.decides for result in verdict.checks)
    assert {each.side for each in verdict.checks if each.case} == {"fmu", "reference", "both"}
    names = {result.check for result in verdict.checks}
    assert {"x-course", "Q_friction-course", "time-scales-to-the-bit", "splitting"} <= names
    assert {"energy-balance", "stick-holds-x", "jump-is-v-T", "heat-never-falls"} <= names
    of_coulomb = {"slip-propagates", "heat-of-dry-friction", "phases-join", "declared-variables"}
    assert of_coulomb <= {each.id for each in load_invariants()}
    assert not of_coulomb & names
