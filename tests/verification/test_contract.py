"""The contract of an FMU: what its description names, what a person says, what follows."""

import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree

import numpy as np
import pytest

from stickslip_fmu import interface
from stickslip_fmu.packer import build
from stickslip_verification import FmuError, Mutant, NameMap, Verdict, load_mutants, verify
from stickslip_verification.drive.fmu import stated
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import Target
from stickslip_verification.drive.fmu.stated import StatedContract, stated_contract
from stickslip_verification.drive.planting import plant
from stickslip_verification.drive.stepping import run_case, setting_of
from stickslip_verification.model.verdict import ChosenContract
from stickslip_verification.run.contract import CONTRACTS, Wanted, chosen_contract

from .foreign import building
from .records import named

EXACT = "its description names stickslip-exact 1"
NONE = "its description names no contract of this suite"
RENAMED = NameMap({"x": Target("x")})


@pytest.fixture(scope="module")
def changed(fmu_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Return what copies our FMU with the one match of a pattern in its description replaced."""
    folder = tmp_path_factory.mktemp("changed")

    def copy(pattern: str, new: str) -> Path:
        def description(text: str) -> str:
            text, count = re.subn(pattern, new, text, flags=re.DOTALL)
            assert count == 1
            return text

        return building.altered(fmu_path, folder / f"{abs(hash((pattern, new)))}.fmu", description)

    return copy


@pytest.fixture(scope="module")
def silent(changed: Callable[..., Path]) -> Path:
    """Return our FMU with a description that names no contract."""
    return changed("<VendorAnnotations>.*</VendorAnnotations>", "")


def test_the_block_and_the_suite_mean_the_same_contract() -> None:
    """Neither side takes the name from the other, and they are equal."""
    assert interface.CONTRACT == (
        stated.ANNOTATION,
        "Contract",
        {"name": stated.NAME, "version": stated.VERSION},
    )


@pytest.mark.parametrize("face", [2, 3])
def test_our_descriptions_name_the_exact_contract(tmp_path: Path, face: Literal[2, 3]) -> None:
    """In FMI 2.0 and in FMI 3.0."""
    file = FmuFile(build(tmp_path, face=face))
    assert file.stated == StatedContract(True, EXACT)
    assert file.own_starts


NOTE = '<Contract name="stickslip-exact" version="1" />'


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('version="1"', 'version="2"', "its description names stickslip-exact 2; this suite knows"),
        ('version="1"', 'version=" 1"', "its description names stickslip-exact 1; this suite"),
        ("stickslip-exact", "&#10;other&#10;one", "its description names other one 1; this suite"),
        ("stickslip-exact", 50 * "long", f"its description names {9 * 'long'}l... 1; this suite"),
        ("stickslip-exact", "other", "its description names other 1; this suite knows"),
        (' version="1"', "", "is malformed: expected one element <Contract name="),
        (NOTE, "", "is malformed"),
        (NOTE, f"{NOTE}{NOTE}", "is malformed"),
        (NOTE, "stickslip-exact 1", "is malformed"),
        ("<Contract ", "<contract ", "is malformed"),
        ("org.stickslip.contract", "org.example.other", NONE),
        (
            "<VendorAnnotations>",
            f'<VendorAnnotations><Tool name="org.stickslip.contract">{NOTE}</Tool>',
            "its description has 2 annotations org.stickslip.contract",
        ),
    ],
)
def test_what_names_no_known_contract_is_told(
    fmu_path: Path, old: str, new: str, told: str
) -> None:
    """Another version, another name or a malformed annotation is not the exact contract."""
    with zipfile.ZipFile(fmu_path) as archive:
        text = archive.read("modelDescription.xml").decode()
    text = text.replace("/>", " />").replace("  />", " />")
    assert text.count(old) >= 1
    at = text.index("<VendorAnnotations>")
    text = text[:at] + text[at:].replace(old, new, 1)
    found = stated_contract(ElementTree.fromstring(text))
    assert not found.exact
    assert told in found.told


@pytest.mark.parametrize(
    ("fmu", "names", "said", "chosen"),
    [
        ("fmu_path", None, {}, ("exact", EXACT)),
        ("fmu_path", None, {"strict": True}, ("exact", EXACT)),
        ("fmu_path", None, {"wanted": "physics"}, ("physics", "--contract physics")),
        ("fmu_path", RENAMED, {}, ("physics", "a names file is given")),
        ("fmu_path", RENAMED, {"strict": True}, ("strict", "--strict")),
        ("fmu_path", RENAMED, {"wanted": "exact"}, ("exact", "--contract exact")),
        ("silent", None, {}, ("physics", NONE)),
        ("silent", None, {"strict": True}, ("strict", "--strict")),
        ("silent", None, {"wanted": "exact"}, ("exact", "--contract exact")),
    ],
)
def test_a_person_chooses_before_the_names_file_and_that_before_the_description(
    request: pytest.FixtureRequest,
    fmu: str,
    names: NameMap | None,
    said: dict[str, Any],
    chosen: tuple[str, str],
) -> None:
    """The reason says who chose."""
    file = FmuFile(request.getfixturevalue(fmu), names)
    found = chosen_contract(file, **said)
    assert found == ChosenContract(*chosen)
    assert found.name in CONTRACTS


def test_the_verdict_keeps_to_the_chosen_contract(fmu_path: Path, silent: Path) -> None:
    """The identifier does not choose it; tolerances, decisions and the reason follow from it."""
    case = [named("one-step")]
    exact = verify(fmu_path, case, fresh_processes=False, jobs=1)
    physics = verify(silent, case, fresh_processes=False, jobs=1)
    forced = verify(silent, case, contract="exact", fresh_processes=False, jobs=1)
    assert exact.contract == ChosenContract("exact", EXACT)
    assert physics.contract == ChosenContract("physics", NONE)
    assert (exact.exact, physics.exact, forced.exact) == (True, False, True)
    assert exact.contract_decides
    assert not physics.contract_decides

    def tolerances(verdict: Any) -> list[float]:
        return [r.tolerance for r in verdict.checks if r.side == "fmu"]

    assert tolerances(forced) == tolerances(exact)
    assert sum(tolerances(physics)) > sum(tolerances(exact))
    assert exact.passed
    assert physics.passed
    assert forced.passed
    # What was accepted is the block's, and not that of any FMU that is held to its contract.
    assert any(r.second for r in exact.checks if r.side == "fmu")
    assert not any(r.second for r in forced.checks if r.side == "fmu")


def test_start_values_are_promised_by_the_exact_contract_alone(
    fmu_path: Path, silent: Path
) -> None:
    """A case sets what it names there, and every value elsewhere, with the same motion here."""
    case = named("one-step")
    assert setting_of(FmuFile(silent), case).parameters.keys() > case.parameters.keys()
    assert not FmuFile(fmu_path, RENAMED).own_starts
    forced = FmuFile(silent, own_starts=True)
    assert setting_of(forced, case).parameters == case.parameters
    own, all_set = (run_case(file, case).outputs["x"] for file in (forced, FmuFile(silent)))
    assert np.array_equal(own, all_set)


def test_the_chosen_contract_reaches_the_processes(fmu_path: Path, tmp_path: Path) -> None:
    """An FMU that starts at another g fails where its start values are tried, and only there."""
    (gravity,) = load_mutants("constant-standard-gravity")
    planted = plant(fmu_path, gravity, tmp_path)
    case = [named("default")]

    def judged(fmu: Path, contract: Wanted | None, *mutants: Mutant) -> Verdict:
        return verify(fmu, case, contract=contract, mutants=mutants, fresh_processes=False, jobs=1)

    assert not judged(planted, None).passed
    assert judged(planted, "physics").passed
    kills = judged(fmu_path, "physics", gravity).kills
    assert kills is not None
    assert not kills.rows[0].caught


def test_faults_are_planted_where_the_source_is(
    silent: Path, slider_mm: Path, slider_mm_names: NameMap
) -> None:
    """Whatever the contract, an FMU with the block's source takes them; another one is refused."""
    faults = load_mutants("constant-g")
    verdict = verify(
        silent,
        [named("default")],
        fresh_processes=False,
        mutants=faults,
        whole_matrix=False,
        jobs=1,
    )
    assert verdict.kills is not None
    assert verdict.kills.rows[0].caught
    with pytest.raises(FmuError, match="which this FMU does not carry; faults in the calls can"):
        verify(
            slider_mm,
            [named("default")],
            names=slider_mm_names,
            mutants=faults,
            contract="exact",
            jobs=1,
        )
