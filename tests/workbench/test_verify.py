"""`stickslip verify` and `names`: one verdict, told on the terminal and in three files."""

import json
import shutil
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path
from typing import Any

import pytest

from stickslip.commands.shared import pack_evidence
from stickslip.errors import CommandError
from stickslip_verification import load_cases, load_mutants
from stickslip_verification import verify as judge
from stickslip_verification.drive.description import content_digest
from stickslip_verification.suite.cases import CASES_FOLDER
from stickslip_verification.suite.faults import plant
from tests.makers import SLIDER, altered, edited
from tests.python import python
from tests.workbench.running import Command


def report_in(folder: Path) -> dict[str, Any]:
    report: dict[str, Any] = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    return report


def write_without_the_jump(fmu: Path, to: Path) -> Path:
    return altered(fmu, to, edited(('name="delta_x"', 'name="delta_y"')))


def test_our_fmu_passes_and_all_files_say_so(
    command: Command, tmp_path: Path, fmu_path: Path
) -> None:
    arguments = ("--fmu", fmu_path, "--cases", "one-step")
    first = command.verify(*arguments, "--paper")
    assert first.code == 0, first.err
    assert first.out.splitlines()[-2:] == ["report/index.html", "report/report.json"]
    assert "x-course" not in first.out
    report = report_in(tmp_path / "report")
    assert report["summary"]["failed"] == 0 < report["summary"]["passed"]
    assert f"{report['summary']['passed']} passed, 0 failed" in first.out
    assert ET.parse(tmp_path / "report" / "junit.xml").getroot().get("failures") == "0"
    page = (tmp_path / "report" / "index.html").read_text(encoding="utf-8")
    assert '<body class="full">' in page
    again = command.verify(*arguments, "--all", "--contract", "exact")
    assert "x-course" in again.out
    assert "rollback-to-the-bit" in again.out


@pytest.mark.parametrize(
    ("options", "name", "why"),
    [
        ((), "exact", "its description names stickslip-exact 1"),
        (("--contract", "physics"), "physics", "--contract physics"),
    ],
)
def test_the_contract_is_told_with_its_reason(
    command: Command, tmp_path: Path, fmu_path: Path, options: tuple[str], name: str, why: str
) -> None:
    answer = command.verify("--fmu", fmu_path, "--cases", "one-step", *options)
    assert answer.code == 0, answer.out
    assert f"contract: {name} ({why})" in answer.out
    assert report_in(tmp_path / "report")["contract"] == {"name": name, "why": why}
    for file in ("index.html", "junit.xml"):
        assert why in (tmp_path / "report" / file).read_text(encoding="utf-8")


def test_a_failed_check_is_told_with_what_it_means(
    command: Command, tmp_path: Path, fmu_path: Path
) -> None:
    bad = write_without_the_jump(fmu_path, tmp_path / "bad.fmu")
    answer = command.verify("--fmu", bad, "--cases", "default", "-o", "bad.json")
    assert (answer.code, answer.err) == (1, "")
    assert "FAIL default / delta_x-exact (fmu): no output delta_x" in answer.out
    said = " ".join(answer.out.split())
    assert "The jump of the mass is wrong, so" in said
    assert "(10). Likeliest bug: The relief of the spring" in said
    assert json.loads(Path("bad.json").read_text("utf-8"))["summary"]["failed"] > 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["bad.fmu", "bad.json"]


def test_cases_are_listed_and_own_ones_run(
    command: Command, fmu_path: Path, tmp_path: Path
) -> None:
    listed = command.passes("verify", "--list", "--cases", "d*")
    assert "default" in listed
    assert "reversed-pull" not in listed
    assert not list(tmp_path.iterdir())
    text = (CASES_FOLDER / "one-step.toml").read_text(encoding="utf-8")
    mine = tmp_path / "mine.toml"
    mine.write_text(text.replace('"one-step"', '"mine"', 1), encoding="utf-8")
    answer = command.verify("--fmu", fmu_path, "--cases", mine, "-o", "mine.json", "--all")
    assert answer.code == 0, answer.out
    assert " mine " in answer.out
    assert "declared-units" in answer.out


def test_a_foreign_fmu_passes_by_the_names_that_are_proposed(
    command: Command, tmp_path: Path
) -> None:
    shown = command.passes("names", SLIDER.path)
    assert command.passes("names", SLIDER.path, "-o", "names.toml") == "written: names.toml\n"
    assert (tmp_path / "names.toml").read_text(encoding="utf-8") == shown
    answer = command.verify(
        "--fmu", SLIDER.path, "--names", "names.toml", "--cases", "one-step", "-o", "r.json"
    )
    assert answer.code == 0, answer.out
    assert "not applicable" in answer.out
    assert "noted (contract: it decides with --strict)" in answer.out


@pytest.mark.parametrize(
    ("within", "code", "word"), [("2%", 0, "; within the 2"), ("0.0002", 1, "not within the 0.02")]
)
def test_what_is_asked_for_decides_of_a_numerical_solution(
    command: Command, tmp_path: Path, fmu_path: Path, within: str, code: int, word: str
) -> None:
    bad = plant(fmu_path, load_mutants("fixed-step-1ms")[0], tmp_path / "bad.fmu")
    asked = ("--fmu", bad, "--cases", "default", "--contract", "physics", "--within", within)
    answer = command.verify(*asked)
    assert answer.code == code, answer.out
    assert f"{word} % asked for" in " ".join(answer.out.split())
    assert report_in(tmp_path / "report")["tables"][0]["title"] == "Accuracy"


@pytest.mark.gate
def test_the_verdict_is_packed_into_our_fmu_alone(
    command: Command, tmp_path: Path, fmu_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = Path(shutil.copy(fmu_path, tmp_path / "own.fmu"))
    some = load_cases("one-step")
    monkeypatch.setattr("stickslip_verification.load_cases", lambda *_, **__: some)
    assert command.verify("--fmu", own, "--pack", "--sequences", "4").code == 0
    digest = content_digest(fmu_path)
    assert content_digest(own) == digest
    with zipfile.ZipFile(own) as archive:
        report = archive.read("extra/org.fmi-standard.fmi-ls-ref/report.html").decode()
    assert digest in report
    assert "one-step" in report
    # An FMU that changed after it was judged gets no evidence.
    verdict = judge(own, some, long_probes=False)
    write_without_the_jump(fmu_path, own)
    before = own.read_bytes()
    with pytest.raises(CommandError, match="it changed while it was judged"):
        pack_evidence(own, verdict, "--fmu")
    assert own.read_bytes() == before


@pytest.mark.gate
def test_a_verify_without_a_file_judges_what_is_built(command: Command, tmp_path: Path) -> None:
    judged = "from stickslip.commands.shared import current_fmu; print(current_fmu())"
    assert command.in_fresh_process("build", "--bare").code == 0
    fmu = tmp_path / "build" / "StickSlip.fmu"
    before = content_digest(fmu)
    for damage in (False, True):
        if damage:
            fmu.write_bytes(b"no FMU")
        assert python("-c", judged).stdout.strip() == "build/StickSlip.fmu"
        assert content_digest(fmu) == before
