"""The contract of an FMU: what its description names, what a person says, what follows."""

import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from stickslip_fmu import interface
from stickslip_verification import FmuError, NameMap, load_mutants, verify
from stickslip_verification.drive import FmuFile
from stickslip_verification.drive import description as stated
from stickslip_verification.drive.description import StatedContract, Target, stated_contract
from stickslip_verification.drive.masters import setting_of
from stickslip_verification.judge.checks import CONTRACTS, chosen_contract
from stickslip_verification.model.verdict import ChosenContract
from stickslip_verification.suite.faults import plant
from tests.conftest import built
from tests.makers import SLIDER, altered, edited
from tests.verification.records import named

EXACT = "its description names stickslip-exact 1"
NONE = "its description names no contract of this suite"
RENAMED = NameMap({"x": Target("x")})
NOTE = '<Contract name="stickslip-exact" version="1" />'
HEAD, TOOL = "<VendorAnnotations>", '<Tool name="org.stickslip.contract">'


@pytest.fixture
def silent(fmu_path: Path, tmp_path: Path) -> Path:
    nothing = edited(("<VendorAnnotations>.*</VendorAnnotations>", ""))
    return altered(fmu_path, tmp_path / "silent.fmu", nothing)


def test_the_block_and_the_suite_mean_the_same_contract() -> None:
    assert interface.CONTRACT == (
        stated.ANNOTATION,
        "Contract",
        {"name": stated.NAME, "version": stated.VERSION},
    )
    file = FmuFile(built("python-2"))
    assert (file.stated, file.own_starts) == (StatedContract(True, EXACT), True)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('version="1"', 'version="2"', "its description names stickslip-exact 2; this suite knows"),
        ('version="1"', 'version=" 1"', "its description names stickslip-exact 1; this suite"),
        ("stickslip-exact", "&#10;other&#10;one", "its description names other one 1; this suite"),
        (' version="1"', "", "is malformed: expected one element <Contract name="),
        (NOTE, f"{NOTE}{NOTE}", "is malformed"),
        (NOTE, "stickslip-exact 1", "is malformed"),
        ("org.stickslip.contract", "org.example.other", NONE),
        (HEAD, f"{HEAD}{TOOL}{NOTE}</Tool>", "its description has 2 annotations org.stickslip.con"),
    ],
)
def test_what_names_no_known_contract_is_told(
    fmu_path: Path, old: str, new: str, told: str
) -> None:
    with zipfile.ZipFile(fmu_path) as archive:
        text = archive.read("modelDescription.xml").decode()
    text = text.replace("/>", " />").replace("  />", " />")
    before, tag, after = text.partition("<VendorAnnotations>")
    assert old in tag + after
    found = stated_contract(ElementTree.fromstring(before + (tag + after).replace(old, new, 1)))
    assert not found.exact
    assert told in found.told


@pytest.mark.parametrize(
    ("names_it", "names", "said", "chosen"),
    [
        (True, None, {"strict": True}, ("exact", EXACT)),
        (True, None, {"wanted": "physics"}, ("physics", "--contract physics")),
        (True, RENAMED, {}, ("physics", "a names file is given")),
        (True, RENAMED, {"wanted": "exact"}, ("exact", "--contract exact")),
        (False, None, {}, ("physics", NONE)),
        (False, None, {"strict": True}, ("strict", "--strict")),
        (False, None, {"wanted": "exact"}, ("exact", "--contract exact")),
    ],
)
def test_a_person_chooses_before_the_names_file_and_that_before_the_description(
    fmu_path: Path,
    silent: Path,
    names_it: bool,
    names: NameMap | None,
    said: dict[str, Any],
    chosen: tuple[str, str],
) -> None:
    found = chosen_contract(FmuFile(fmu_path if names_it else silent, names), **said)
    assert found == ChosenContract(*chosen)
    assert found.name in CONTRACTS


def test_tolerances_and_what_decides_follow_from_the_contract(fmu_path: Path, silent: Path) -> None:
    case = [named("one-step")]
    verdicts = [
        verify(path, case, contract=contract, long_probes=False, jobs=1)  # type: ignore[arg-type]
        for path, contract in ((fmu_path, None), (silent, None), (silent, "exact"))
    ]
    assert [verdict.contract.name for verdict in verdicts] == ["exact", "physics", "exact"]
    assert all(verdict.passed for verdict in verdicts)
    of_exact, of_physics, of_forced = (
        [r.tolerance for r in verdict.checks if r.side == "fmu"] for verdict in verdicts
    )
    assert of_forced == of_exact
    assert sum(of_physics) > sum(of_exact)


def test_start_values_are_promised_by_the_exact_contract_alone(
    fmu_path: Path, silent: Path, tmp_path: Path
) -> None:
    case = named("one-step")
    assert setting_of(FmuFile(silent), case).parameters.keys() > case.parameters.keys()
    assert not FmuFile(fmu_path, RENAMED).own_starts
    forced = FmuFile(silent, own_starts=True)
    assert setting_of(forced, case).parameters == case.parameters
    # An FMU that starts at another g fails where its start values are tried, and only there.
    (gravity,) = load_mutants("constant-standard-gravity")
    planted = plant(fmu_path, gravity, tmp_path)
    for contract, passes in ((None, False), ("physics", True)):
        verdict = verify(planted, [case], contract=contract, long_probes=False, jobs=1)  # type: ignore[arg-type]
        assert verdict.passed is passes


@pytest.mark.gate
def test_faults_are_planted_where_the_source_is(silent: Path) -> None:
    faults, case = load_mutants("constant-g"), [named("default")]
    verdict = verify(silent, case, mutants=faults, contract="exact", long_probes=False, jobs=1)
    assert verdict.kills is not None
    assert verdict.kills.rows[0].caught
    with pytest.raises(FmuError, match="which this FMU does not carry; faults in the calls can"):
        verify(SLIDER.path, case, names=SLIDER.names, mutants=faults, contract="exact", jobs=1)
