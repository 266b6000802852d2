"""`stickslip verify` and `stickslip lint` as a person meets them."""

import hashlib
import json
import os
import re
import shutil
import signal
import sys
import tempfile
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from stickslip.commands.shared import pack_evidence
from stickslip.errors import CommandError
from stickslip_verification import load_cases, load_mutants
from stickslip_verification import verify as judge
from stickslip_verification.drive.fmu.digest import content_digest
from stickslip_verification.drive.planting import plant
from stickslip_verification.suite.cases import CASES_FOLDER
from stickslip_verification.suite.faults import FAULTS_FOLDER
from tests.interrupting import session, wait_for_work
from tests.python import python
from tests.verification.foreign import building

from .running import Command

NAMES = building.HERE / "slider_mm.toml"


@pytest.fixture(scope="module")
def slider(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an honest foreign FMU: its own names, millimetres."""
    return building.build("slider_mm", tmp_path_factory.mktemp("slider"))


@pytest.fixture
def scratch() -> Iterator[Path]:
    """Yield a folder with a short name: sockets of processes in it may have 107 characters."""
    with tempfile.TemporaryDirectory(prefix="s") as folder:
        yield Path(folder)


def report_in(folder: Path) -> dict[str, object]:
    """Read the report of a folder."""
    report: dict[str, object] = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    return report


def write_without_the_jump(fmu: Path, to: Path) -> None:
    """Write the FMU with its output delta_x under another name."""
    with zipfile.ZipFile(fmu) as good, zipfile.ZipFile(to, "w") as bad:
        for name in good.namelist():
            content = good.read(name)
            if name == "modelDescription.xml":
                content = content.replace(b'name="delta_x"', b'name="delta_y"')
            bad.writestr(name, content)


def test_verify_passes_on_our_fmu(command: Command, tmp_path: Path) -> None:
    """Exit code 0, a table, the whole report where it is said to be, and the FMU in build/."""
    answer = command.in_fresh_process("verify", "--jobs", "1", "--cases", "one-step")
    assert answer.code == 0, answer.err
    assert "FAIL" not in answer.out
    assert answer.out.splitlines()[-2:] == ["report/index.html", "report/report.json"]
    report = report_in(tmp_path / "report")
    summary, provenance = report["summary"], report["provenance"]
    assert isinstance(summary, dict)
    assert isinstance(provenance, dict)
    assert summary["failed"] == 0
    assert f"{summary['passed']} passed, 0 failed" in answer.out
    digest = hashlib.sha256((tmp_path / "build" / "StickSlip.fmu").read_bytes()).hexdigest()
    assert provenance["fmu"]["sha256"] == digest
    suites = ET.parse(tmp_path / "report" / "junit.xml").getroot()
    assert suites.get("failures") == "0"
    assert "http-equiv" not in (tmp_path / "report" / "index.html").read_text(encoding="utf-8")


def test_every_comparison_is_printed_on_demand(command: Command, fmu_path: Path) -> None:
    """--all names each check with what was expected and what came."""
    arguments = ("--fmu", fmu_path, "--cases", "one-step", "-o", "all.json")
    short, full = command.verify(*arguments), command.verify(*arguments, "--all")
    assert "x-course" not in short.out
    assert "x-course" in full.out
    assert "rollback-to-the-bit" in full.out


def test_a_failed_check_is_told_with_what_it_means(
    command: Command, tmp_path: Path, fmu_path: Path
) -> None:
    """Exit code 1: what failed, its consequence and the likeliest bug; JSON alone if asked for."""
    write_without_the_jump(fmu_path, Path("bad.fmu"))
    answer = command.verify("--fmu", "bad.fmu", "--cases", "default", "-o", "bad.json")
    assert answer.code == 1
    assert "FAIL default / delta_x-exact (fmu): no output delta_x" in answer.out
    said = " ".join(answer.out.split())
    assert "The jump of the mass is wrong, so" in said
    assert "(10). Likeliest bug: The relief of the spring" in said
    assert answer.err == ""
    report = json.loads((tmp_path / "bad.json").read_text(encoding="utf-8"))
    assert report["summary"]["failed"] > 0
    assert sorted(each.name for each in tmp_path.iterdir()) == ["bad.fmu", "bad.json"]


def test_verify_lists_its_cases(command: Command, tmp_path: Path) -> None:
    """--list names the cases of the pattern and runs nothing."""
    answer = command("verify", "--list", "--cases", "d*")
    assert answer.code == 0
    assert "default" in answer.out
    assert "reversed-pull" not in answer.out
    assert not list(tmp_path.iterdir())


def test_a_foreign_fmu_passes_by_its_names(command: Command, slider: Path) -> None:
    """With a names file a foreign FMU is judged on physics; what it lacks is counted."""
    answer = command.verify(
        "--fmu", slider, "--names", NAMES, "--cases", "one-step", "--time-limit", "30",
        "-o", "r.json",
    )  # fmt: skip
    assert answer.code == 0, answer.out
    assert "not applicable" in answer.out
    assert "noted (contract: it decides with --strict)" in answer.out


def test_the_contract_is_told_with_its_reason(
    command: Command, tmp_path: Path, fmu_path: Path
) -> None:
    """On the terminal and in all three files: the description names it, or --contract does."""
    arguments = ("--fmu", fmu_path, "--cases", "one-step")
    for more, name, why in (
        ((), "exact", "its description names stickslip-exact 1"),
        (("--contract", "physics"), "physics", "--contract physics"),
        (("--contract", "exact", "--all"), "exact", "--contract exact"),
    ):
        answer = command.verify(*arguments, *more)
        assert answer.code == 0, answer.out
        assert f"contract: {name} ({why})" in answer.out
        assert report_in(tmp_path / "report")["contract"] == {"name": name, "why": why}
        for file in ("index.html", "junit.xml"):
            assert why in (tmp_path / "report" / file).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("options", "told"), [((), "<body>"), (("--full",), '<body class="full">')]
)
def test_the_report_prints_every_comparison_on_demand(
    command: Command, fmu_path: Path, tmp_path: Path, options: tuple[str, ...], told: str
) -> None:
    """--full marks the page: its style prints what is else left out."""
    assert command.verify("--fmu", fmu_path, "--cases", "one-step", *options).code == 0
    assert told in (tmp_path / "report" / "index.html").read_text(encoding="utf-8")


def test_fitness_is_told_beside_the_verdict(
    command: Command, tmp_path: Path, fmu_path: Path
) -> None:
    """Of an FMU that integrates with 1 ms: yes or no for each quantity; the exit code stays 1."""
    bad = plant(fmu_path, load_mutants("fixed-step-1ms")[0], tmp_path / "bad.fmu")
    arguments = ("--fmu", bad, "--cases", "default")
    for within, share, word in (("2%", "2 %", "yes"), ("0.0002", "0.02 %", "no")):
        answer = command.verify(*arguments, "--within", within)
        assert answer.code == 1
        assert f"Fitness: within {share}?" in answer.out
        row = next(line for line in answer.out.splitlines() if "jump (" in line)
        assert word in row.split()
        tables = report_in(tmp_path / "report")["tables"]
        assert isinstance(tables, list)
        assert tables[0]["title"] == f"Fitness: within {share}?"
        assert f"within {share}?" in (tmp_path / "report" / "index.html").read_text("utf-8")
    assert "places are not within it; the report lists them" in answer.out


def test_a_names_file_is_begun(command: Command, tmp_path: Path, slider: Path) -> None:
    """To the terminal, or to a file that is never overwritten; verify takes it as it is."""
    shown = command("names", slider)
    assert (shown.code, shown.err) == (0, "")
    written = command("names", slider, "-o", "names.toml")
    assert (written.code, written.out) == (0, "names.toml\n")
    assert (tmp_path / "names.toml").read_text(encoding="utf-8") == shown.out
    again = command("names", slider, "-o", "names.toml")
    assert (again.code, again.out) == (2, "")
    assert again.err == "stickslip: -o names.toml: it is there already, and may have been edited\n"
    answer = command.verify(
        "--fmu", slider, "--names", "names.toml", "--cases", "one-step", "-o", "r.json"
    )
    assert answer.code == 0, answer.out
    for arguments, told in (
        (("names", "none.fmu"), "none.fmu: no such file"),
        (("names", slider, "-o", "none/names.toml"), "-o none/names.toml: "),
    ):
        refused = command(*arguments)
        assert (refused.code, refused.err.count("\n")) == (2, 1)
        assert told in refused.err


def test_own_cases_can_be_run(command: Command, fmu_path: Path, tmp_path: Path) -> None:
    """--cases takes a file, or a folder: a suite, which probes in fresh processes belong to."""
    mine = tmp_path / "mine"
    mine.mkdir()
    text = (CASES_FOLDER / "one-step.toml").read_text(encoding="utf-8")
    (mine / "mine.toml").write_text(text.replace('"one-step"', '"mine"', 1), encoding="utf-8")
    for where, suite in ((mine, True), (mine / "mine.toml", False)):
        answer = command.verify("--fmu", fmu_path, "--cases", where, "-o", "mine.json", "--all")
        assert answer.code == 0, answer.out
        assert " mine " in answer.out
        assert "declared-units" in answer.out
        assert ("memory-of-steps" in answer.out) == suite


@pytest.mark.parametrize(
    ("foretold", "code", "told"),
    [
        ("F_s-course", 0, "1 of 1 planted faults detected by a check named in advance"),
        ("stick-holds-x", 1, "SURVIVED mine (named: stick-holds-x): failing checks: "),
    ],
)
def test_own_faults_can_be_tried(
    command: Command, fmu_path: Path, tmp_path: Path, foretold: str, code: int, told: str
) -> None:
    """A fault of one's own; foretold wrongly it survives, and what sees it is told."""
    text = (FAULTS_FOLDER / "constant-g.toml").read_text(encoding="utf-8")
    text = text.replace('"constant-g"', '"mine"', 1)
    text = re.sub(r"detected_by = \[.*?\]", f'detected_by = ["{foretold}"]', text, flags=re.S)
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    answer = command.verify(
        "--fmu", fmu_path, "--cases", "default", "--fault", "mine.toml", "-o", "mine.json"
    )
    assert answer.code == code, answer.out
    assert told in answer.out


def test_a_baseline_shows_how_margins_moved(command: Command, fmu_path: Path) -> None:
    """Against its own earlier report nothing moved."""
    arguments = ("--fmu", fmu_path, "--cases", "one-step", "-o", "old.json")
    assert command.verify(*arguments).code == 0
    answer = command.verify(*arguments, "--baseline", "old.json")
    assert answer.code == 0
    assert "margins that grew more than 2 times: 0" in answer.out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--fmu", "none.fmu"], "--fmu none.fmu: no such file"),
        (["--fmu", "{text}"], "not an FMU"),
        (["--fmu", "{slider}"], "has no variable m, k, mu_s, mu_k, v, x; map them with --names"),
        (["--fmu", "{slider}", "--names", "none.toml"], "none.toml: no such file"),
        (["--fmu", "{slider}", "--names", "{unknown}"], "'springiness'"),
        (["--names", "{names}"], "--names goes with --fmu"),
        (["--cases", "nothing"], "no case matches 'nothing'"),
        (["--cases", "{broken}"], "broken.toml: line 1: "),
        (["--baseline", "none.json"], "none.json: no such file"),
        (["--baseline", "{text}"], "text.fmu: "),
        (["--fault", "nothing"], "--fault"),
        (["--fault", "none.toml"], "--fault none.toml: no such file"),
        (["--fault", "state-*", "--mutants"], "--fault does not go with --mutants"),
        (["--jobs", "0"], "--jobs"),
        (["--time-limit", "-1"], "--time-limit"),
        (["--budget", "0"], "--budget 0.0: must be above 0 s"),
        (["--memory", "nan"], "--memory nan: must be 0.1 GB at least"),
        (
            ["--accept", "--fmu", "{slider}", "--names", "{names}"],
            "only the exact block is accepted",
        ),
        (["--within", "1"], "--within 1: must be above 0 % and below 100 %, as 1% or as 0.01"),
        (["--within", "0"], "must be above 0 %"),
        (["--within", "nan"], "--within 'nan' is not a finite number"),
        (["--within", "1 mm"], "--within '1 mm' is a length"),
        (["--contract", "other"], "'other' is not one of 'exact', 'physics'"),
        (["--contract", "exact", "--strict"], "--strict does not go with --contract"),
        (["--contract", "exact", "--accept"], "--accept does not go with --contract"),
        (["--contract", "exact", "--pack"], "--pack does not go with --contract"),
        (["-o", "{text}/report"], "-o "),
    ],
)
def test_wrong_use_is_one_line(
    command: Command, slider: Path, tmp_path: Path, arguments: list[str], told: str
) -> None:
    """Exit code 2 and one line that names what is wrong, before anything runs."""
    texts = {
        "text": ("text.fmu", "no FMU"),
        "unknown": ("unknown.toml", 'springiness = "k"\n'),
        "broken": ("broken.toml", "id = = 1\n"),
    }
    files = {"slider": slider, "names": NAMES}
    for key, (name, text) in texts.items():
        files[key] = tmp_path / name
        files[key].write_text(text, encoding="utf-8")
    answer = command("verify", *(each.format(**files) for each in arguments))
    assert answer.code == 2
    assert told in answer.err
    assert answer.err.startswith("stickslip: ")
    assert answer.err.count("\n") == 1
    assert answer.out == ""


def test_what_fails_is_not_accepted(command: Command, fmu_path: Path) -> None:
    """--accept refuses an FMU that misses a truth, and writes nothing."""
    write_without_the_jump(fmu_path, Path("bad.fmu"))
    answer = command.verify("--fmu", "bad.fmu", "--cases", "one-step", "--accept", "-o", "r.json")
    assert answer.code == 2
    assert "checks fail against their truth" in answer.err


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT cannot be sent to one process there")
def test_ctrl_c_ends_the_run_and_its_processes(
    tmp_path: Path, fmu_path: Path, scratch: Path
) -> None:
    """Exit code 130, one line, and neither files nor processes are left."""
    command = ("verify", "--fmu", str(fmu_path), "-o", "r.json")
    with session(*command, folder=tmp_path, scratch=scratch) as running:
        # To load takes less than two, the run a minute.
        wait_for_work(running, 4.0)
        os.killpg(running.pid, signal.SIGINT)
        out, err = running.communicate(timeout=60)
    assert (running.returncode, out, err) == (130, "", "stickslip: interrupted\n")
    assert not list(tmp_path.iterdir())
    assert not list(scratch.glob("stickslip*"))


def test_the_suite_is_sound(command: Command) -> None:
    """The linter finds nothing in the suite as it is shipped."""
    answer = command("lint")
    assert (answer.code, answer.out) == (0, "0 findings\n")


def test_the_linter_names_what_is_wrong(command: Command, tmp_path: Path) -> None:
    """A reason that says nothing and an id that is not the file's are findings, and exit 1."""
    text = (CASES_FOLDER / "long-run.toml").read_text(encoding="utf-8")
    reason = text[text.index('because = "') :].split("\n")[0]
    (tmp_path / "other.toml").write_text(text.replace(reason, 'because = "seems fine"'), "utf-8")
    answer = command("lint", "--cases", tmp_path)
    assert answer.code == 1
    assert "other.toml: its id is 'long-run'" in answer.out
    assert "'seems' is no reason" in answer.out


def test_the_fmi_3_face_is_judged_as_ours(command: Command, tmp_path: Path) -> None:
    """It meets the same truths at the same tolerances, and keeps its own contract."""
    assert command.in_fresh_process("build", "--bare", "--fmi", "3", "-o", ".").code == 0
    fmu = tmp_path / "StickSlip_fmi3.fmu"
    answer = command.verify("--fmu", fmu, "--cases", "start-beyond", "--all", "-o", "a.json")
    assert answer.code == 0, answer.out
    assert "noted" not in answer.out


def test_the_verdict_is_packed_into_our_fmu(
    command: Command, tmp_path: Path, fmu_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """--pack leaves the content as it was and adds the evidence of what was judged."""
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
    assert digest in (tmp_path / "report" / "index.html").read_text(encoding="utf-8")


def test_what_is_no_evidence_of_ours_is_not_packed(
    command: Command, tmp_path: Path, fmu_path: Path, slider: Path
) -> None:
    """A foreign FMU, some of the cases, a missing or read-only folder: refused before the run."""
    before = slider.read_bytes()
    own = Path(shutil.copy(fmu_path, tmp_path / "own.fmu"))
    for arguments, reason in (
        (("--fmu", slider), "is not the exact block"),
        (("--fmu", slider, "--names", NAMES), "--pack does not go with --names"),
        (("--fmu", own, "--cases", "one-step"), "--pack does not go with --cases"),
        (("--fmu", tmp_path / "none.fmu"), "no such file"),
    ):
        answer = command.verify(*arguments, "--pack")
        assert (answer.code, reason in answer.err) == (2, True), answer.err
        assert not (tmp_path / "report").exists()
    assert slider.read_bytes() == before
    assert own.read_bytes() == fmu_path.read_bytes()


def test_a_verdict_on_another_content_is_not_packed(tmp_path: Path, fmu_path: Path) -> None:
    """Where the FMU changed after it was judged, it stays without evidence."""
    own = Path(shutil.copy(fmu_path, tmp_path / "own.fmu"))
    verdict = judge(own, load_cases("one-step"), fresh_processes=False)
    write_without_the_jump(fmu_path, own)
    before = own.read_bytes()
    with pytest.raises(CommandError, match="it changed while it was judged"):
        pack_evidence(own, verdict, "--fmu")
    assert own.read_bytes() == before


def test_a_later_run_leaves_the_evidence_in_the_fmu(command: Command, tmp_path: Path) -> None:
    """`verify` without a file judges the one that `build` left, where that is still the same."""
    assert command.in_fresh_process("build").code == 0
    fmu = tmp_path / "build" / "StickSlip.fmu"
    before = fmu.read_bytes()
    judged = "from stickslip.commands.shared import current_fmu; print(current_fmu())"

    def found() -> str:
        return python("-c", judged).stdout.strip()

    assert found() == "build/StickSlip.fmu"
    assert fmu.read_bytes() == before
    fmu.write_bytes(b"no FMU")
    assert found() == "build/StickSlip.fmu"
    assert content_digest(fmu)
