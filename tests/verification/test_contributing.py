"""CONTRIBUTING.md done as it says: a case and two faults added to a copy of the suite."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import textwrap
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

import stickslip_verification

TEXT = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text(encoding="utf-8")
PACKAGE = Path(stickslip_verification.__file__).parent

pytestmark = pytest.mark.gate


def blocks(section: str, language: str) -> list[str]:
    """Return the blocks of a section in a language, without their indentation."""
    text = TEXT[TEXT.index(f"## {section}\n") :].split("\n## ")[0]
    found = re.findall(rf"^( *)```{language}\n(.*?)^ *```$", text, re.DOTALL | re.MULTILINE)
    return [textwrap.dedent(block) for _, block in found]


@pytest.fixture
def suite(tmp_path: Path) -> Path:
    """Return the suite's folder in a copy of its package, without cases of costly truth."""
    ignored = shutil.ignore_patterns("__pycache__", "stribeck-*", "hyperbolic-*", "curve-*")
    return Path(shutil.copytree(PACKAGE, tmp_path / PACKAGE.name, ignore=ignored)) / "suite"


@pytest.fixture
def run(tmp_path: Path) -> Callable[[str], tuple[int, str]]:
    """Give what runs a line of the shell on that copy: its exit code and what it says."""

    def command(line: str) -> tuple[int, str]:
        name, *arguments = shlex.split(line)
        done = subprocess.run(
            [str(Path(sys.executable).with_name(name)), *arguments],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(tmp_path), "COLUMNS": "100"},
            capture_output=True,
            text=True,
            timeout=600,
        )
        return done.returncode, done.stdout + done.stderr

    return command


def test_a_case_is_added_as_it_says(
    suite: Path, run: Callable[[str], tuple[int, str]], fmu_path: Path
) -> None:
    (text,) = blocks("Add a case", "toml")
    name = tomllib.loads(text)["id"]
    file = suite / "cases" / f"{name}.toml"
    verify, lint = blocks("Add a case", "bash")[0].splitlines()
    assert f"--cases {name}" in verify
    file.write_text(text, encoding="utf-8")
    code, said = run(f"{verify} --fmu {fmu_path} -o r.json")
    assert (code, "passed, 0 failed" in said) == (0, True), said

    # Second values are those of all cases: here of the new one alone, or it would take minutes.
    for other in set((suite / "cases").glob("*.toml")) - {file}:
        other.unlink()
    # The linter prints the line that is to be added below `about`.
    (line,) = re.findall(r"motion is missing.*write (motion = .*)", run(lint)[1])
    text = re.sub(r'(about = """.*?"""\n)', rf"\1{line}\n", text, flags=re.DOTALL)
    file.write_text(text, encoding="utf-8")
    left = {each.partition(": ")[2] for each in run(lint)[1].splitlines() if name in each}
    assert left == {"no accepted value; run stickslip verify --accept"}
    code, said = run(f"stickslip verify --accept --sequences 0 --fmu {fmu_path} -o r.json")
    assert code == 0, said
    accepted = json.loads((suite / "second_values.json").read_text(encoding="utf-8"))
    assert "x-course" in accepted[name]


def test_a_fault_is_planted_as_it_says(
    suite: Path, run: Callable[[str], tuple[int, str]], fmu_path: Path, tmp_path: Path
) -> None:
    (command,) = blocks("Plant a fault", "bash")
    faults = {tomllib.loads(text)["id"]: text for text in blocks("Plant a fault", "toml")}
    first = next(iter(faults))
    assert f"--fault {first}.toml" in command
    for name, text in faults.items():
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
        line = command.strip().replace(first, name)
        code, said = run(f"{line} --fmu {fmu_path} --cases one-step -o r.json")
        assert code == 0, said
        assert "1 of 1 planted faults detected by a check named in advance" in said
        (tmp_path / f"{name}.toml").rename(suite / "faults" / f"{name}.toml")
    findings = run("stickslip lint")[1].splitlines()
    assert [each for each in findings if any(name in each for name in faults)] == []
