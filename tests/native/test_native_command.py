"""`stickslip build --native`: what it writes, and what it answers where it cannot."""

import sys
import zipfile
from pathlib import Path

import pytest

from stickslip_native import compiler
from tests.laws import renamed
from tests.needs import needs
from tests.workbench.running import Command

HERE = ("build", "--native", "--this-machine")


@pytest.fixture
def command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Command:
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys, tmp_path / "none.fmu")


def names_in(fmu: str) -> set[str]:
    with zipfile.ZipFile(fmu) as archive:
        return set(archive.namelist())


@needs("cc")
def test_the_fmu_has_all_that_the_python_fmu_has_but_what_is_of_python(command: Command) -> None:
    told = command.passes(*HERE, "--bare", "-o", "all")
    assert told.startswith("all/StickSlip_native.fmu  ")
    command.passes("build", "--bare", "-o", "all")
    native, python = names_in("all/StickSlip_native.fmu"), names_in("all/StickSlip.fmu")
    apart = ("binaries/", "resources/", "sources/")
    common = {name for name in python if not name.startswith(apart)} - {"licenses/pythonfmu.txt"}
    assert common == {name for name in native if not name.startswith(apart)}
    assert not any(name.startswith("resources/") for name in native)
    assert {"sources/block.c", "sources/fmi2.c", "sources/identity.h"} <= native
    told = command.passes(*HERE, "--fmi", "3", "--bare", "-o", "all")
    assert told.startswith("all/StickSlip_native_fmi3.fmu  ")
    names = names_in("all/StickSlip_native_fmi3.fmu")
    assert {"sources/buildDescription.xml", "documentation/licenses/stickslip.txt"} <= names


@pytest.mark.parametrize(
    ("words", "compiler_path", "system", "answer"),
    [
        ("--this-machine", "cc", "linux", "--this-machine is for --native"),
        (
            f"--native --this-machine --law {renamed.NAME}", "cc", "linux",
            f"{renamed.NAME!r} has no native side; coulomb, lugre, rate_state, stribeck have one",
        ),
        ("--native", "cc", "linux", "pip install ziglang=="),
        ("--native --this-machine", None, "linux", "there is no C compiler: a program cc"),
        ("--native --this-machine", "cc", "freebsd14", "none of x86_64-linux, aarch64-linux,"),
    ],
)  # fmt: skip
def test_what_cannot_be_built_is_answered_in_one_line(
    command: Command, words: str, compiler_path: str | None, system: str, answer: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr(compiler, "find_spec", lambda name: None)
    monkeypatch.setattr("shutil.which", lambda name: compiler_path)
    monkeypatch.setattr(sys, "platform", system)
    assert answer in command.refuses("build", *words.split())
