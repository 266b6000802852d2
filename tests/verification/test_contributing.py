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
from pathlib import Path

import pytest

import stickslip_verification

TEXT = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text(encoding="utf-8")
COMMAND = Path(sys.executable).parent / "stickslip"


def blocks(section: str, language: str) -> list[str]:
    """Return the blocks of a section in a language, without their indentation."""
    text = TEXT[TEXT.index(f"## {section}\n") :].split("\n## ")[0]
    found = re.findall(rf"^( *)```{language}\n(.*?)^ *```$", text, re.DOTALL | re.MULTILINE)
    return [textwrap.dedent(block) for _, block in found]


class Suite:
    """A copy of the suite, on which the command works instead of the installed one."""

    def __init__(self, root: Path) -> None:
        package = Path(stickslip_verification.__file__).parent
        self.root = root
        self.folder = root / package.name
        shutil.copytree(package, self.folder, ignore=shutil.ignore_patterns("__pycache__"))
        self.cases = self.folder / "suite" / "cases"
        self.faults = self.folder / "suite" / "faults"

    def run(self, line: str) -> tuple[int, list[str]]:
        """Run a line of the shell that calls the command; give its exit code and what it says."""
        name, *arguments = shlex.split(line)
        assert name == "stickslip"
        done = subprocess.run(
            [str(COMMAND), *arguments],
            cwd=self.root,
            env={**os.environ, "PYTHONPATH": str(self.root), "COLUMNS": "100"},
            capture_output=True,
            text=True,
            timeout=600,
        )
        return done.returncode, (done.stdout + done.stderr).splitlines()


@pytest.fixture
def suite(tmp_path: Path) -> Suite:
    """Return a copy of the suite."""
    return Suite(tmp_path)


def test_a_case_is_added_as_contributing_says(suite: Suite, fmu_path: Path) -> None:
    """Its file, its commands and what it says of the linter lead to a case with second values."""
    (text,) = blocks("Add a case", "toml")
    (name,) = re.findall(r'^id = "(.*)"$', text, re.MULTILINE)
    file = suite.cases / f"{name}.toml"
    verify, lint = blocks("Add a case", "bash")[0].splitlines()
    assert f"--cases {name}" in verify

    file.write_text(text, encoding="utf-8")
    code, said = suite.run(f"{verify} --fmu {fmu_path} -o r.json")
    assert code == 0, said
    assert any(re.search(r"\b[1-9]\d* passed, 0 failed", line) for line in said)

    code, said = suite.run(lint)
    (missing,) = [line for line in said if "motion is missing" in line]
    line = missing.rpartition("write ")[2]
    assert line.startswith("motion = { slips = ")
    text = re.sub(r'(about = """.*?"""\n)', rf"\1{line}\n", text, flags=re.DOTALL)
    file.write_text(text, encoding="utf-8")
    code, said = suite.run(lint)
    then = re.compile(rf"{name} / .*: no accepted value; run stickslip verify --accept")
    assert len(said) > 1
    assert all(then.fullmatch(line) for line in said[:-1]), said

    # Second values are those of all cases: here of the new one alone, or it would take minutes.
    for other in suite.cases.glob("*.toml"):
        if other != file:
            other.unlink()
    code, said = suite.run(f"stickslip verify --accept --sequences 0 --fmu {fmu_path} -o r.json")
    assert code == 0, said
    accepted = suite.folder / "suite" / "second_values.json"
    assert "x-course" in json.loads(accepted.read_text(encoding="utf-8"))[name]

    file.unlink()
    assert suite.run(verify) == (2, [f"stickslip: {suite.cases}: no case matches '{name}'"])


def test_a_fault_is_planted_as_contributing_says(suite: Suite, fmu_path: Path) -> None:
    """Both of its faults are caught by its command, join the suite and leave it again."""
    (command,) = blocks("Plant a fault", "bash")
    texts = blocks("Plant a fault", "toml")
    names = [tomllib.loads(text)["id"] for text in texts]
    for name, text in zip(names, texts, strict=True):
        (suite.root / f"{name}.toml").write_text(text, encoding="utf-8")
    assert f"--fault {names[0]}.toml" in command
    for name in names:
        line = command.replace(names[0], name).replace(
            "\n", f" --fmu {fmu_path} --cases one-step -o r.json"
        )
        code, said = suite.run(line)
        assert code == 0, said
        assert "1 of 1 planted faults detected by a check named in advance" in said

    before = {file.name for file in suite.faults.iterdir()}
    for name in names:
        (suite.root / f"{name}.toml").rename(suite.faults / f"{name}.toml")
    assert suite.run("stickslip lint") == (0, ["0 findings"])
    for name in names:
        (suite.faults / f"{name}.toml").unlink()
    assert {file.name for file in suite.faults.iterdir()} == before
