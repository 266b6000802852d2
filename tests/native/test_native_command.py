"""`stickslip build --native`: what it writes, and what it answers where it cannot."""

import sys
import zipfile
from pathlib import Path

import pytest

from stickslip_native import compiler
from stickslip_verification.drive.fmu.digest import content_digest
from tests.laws import renamed
from tests.needs import needs
from tests.workbench.running import Answer, Command


@pytest.fixture
def command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Command:
    """Return what runs the command in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys, tmp_path / "none.fmu")


def names_in(fmu: str) -> set[str]:
    """Return the names of the files in an FMU of the working folder."""
    with zipfile.ZipFile(fmu) as archive:
        return set(archive.namelist())


@needs("cc")
def test_the_fmu_has_all_that_the_python_fmu_has(command: Command) -> None:
    """Documentation, page, icon, licences and evidence; its sources stay beside the evidence."""
    answer = command("build", "--native", "--this-machine", "-o", "all")
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.startswith("all/StickSlip_native.fmu  ")
    assert command("build", "-o", "all").code == 0
    native, python = names_in("all/StickSlip_native.fmu"), names_in("all/StickSlip.fmu")
    apart = ("binaries/", "resources/", "sources/")
    wrapper = {"licenses/pythonfmu.txt"}
    assert {name for name in python if not name.startswith(apart)} - wrapper == {
        name for name in native if not name.startswith(apart)
    }
    assert not any(name.startswith("resources/") for name in native)
    assert {"sources/block.c", "sources/fmi2.c", "sources/identity.h"} <= native
    bare = command("build", "--native", "--this-machine", "--bare", "-o", "bare.fmu")
    assert bare.code == 0
    assert names_in("bare.fmu") == {name for name in native if not name.startswith("extra/")}
    assert content_digest(Path("bare.fmu")) == content_digest(Path("all/StickSlip_native.fmu"))


@needs("cc")
def test_the_native_fmu_3_has_a_name_of_its_own(command: Command) -> None:
    """All four FMUs may lie in one folder."""
    answer = command("build", "--native", "--this-machine", "--fmi", "3", "--bare", "-o", "all")
    assert answer.out.startswith("all/StickSlip_native_fmi3.fmu  ")
    names = names_in("all/StickSlip_native_fmi3.fmu")
    assert {"sources/buildDescription.xml", "documentation/licenses/stickslip.txt"} <= names


@needs("cc")
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--this-machine"], "--this-machine is for --native"),
        (
            ["--native", "--this-machine", "--law", renamed.NAME],
            f"{renamed.NAME!r} has no native side; coulomb and stribeck have one",
        ),
    ],
)
def test_wrong_use_is_answered_in_one_line(command: Command, words: list[str], told: str) -> None:
    """Exit code 2 and one line; nothing is written."""
    refused(command("build", *words), told)


def test_without_ziglang_the_line_says_what_installs_it(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line with the extra, exit code 2, nothing is written."""
    monkeypatch.setattr(compiler, "find_spec", lambda name: None)
    refused(command("build", "--native"), "pip install 'stickslip[native]'")


def test_without_a_compiler_the_line_says_what_is_missing(
    command: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """One line with the name of the program, exit code 2, nothing is written."""
    monkeypatch.setenv("PATH", str(tmp_path))
    refused(command("build", "--native", "--this-machine"), "no C compiler: a program cc")


@needs("cc")
def test_a_machine_that_fmi_does_not_know_is_named(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line with the platforms there are, exit code 2, nothing is written."""
    monkeypatch.setattr(sys, "platform", "freebsd14")
    refused(command("build", "--native", "--this-machine"), "none of x86_64-linux, aarch64-linux,")


def refused(answer: Answer, told: str) -> None:
    """Check exit code 2, one line on standard error, and no FMU."""
    err = answer.err
    assert (answer.code, answer.out) == (2, "")
    assert err.startswith("stickslip: ")
    assert told in err
    assert err.count("\n") == 1
    assert not list(Path().rglob("*.fmu"))
