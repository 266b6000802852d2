"""CONTRIBUTING.md, "Add a case", done as it says, in a copy of the suite."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

import stickslip_verification

SECTION = re.search(
    r"## Add a case\n(.*?)\n## ",
    (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text(encoding="utf-8"),
    re.DOTALL,
)
COMMAND = Path(sys.executable).parent / "stickslip"


def block(language: str) -> str:
    """Give the one block of the section in a language, without its indentation."""
    assert SECTION is not None
    (text,) = re.findall(rf" *```{language}\n(.*?) *```", SECTION[1], re.DOTALL)
    return textwrap.dedent(text)


class Suite:
    """A copy of the suite, on which the command works instead of the installed one."""

    def __init__(self, root: Path) -> None:
        package = Path(stickslip_verification.__file__).parent
        self.root = root
        self.folder = root / package.name
        shutil.copytree(package, self.folder, ignore=shutil.ignore_patterns("__pycache__"))
        self.cases = self.folder / "cases"

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


def test_a_case_is_added_as_contributing_says(suite: Suite) -> None:
    """Its file, its commands and what it says of the linter lead to a case with second values."""
    text = block("toml")
    (name,) = re.findall(r'^id = "(.*)"$', text, re.MULTILINE)
    file = suite.cases / f"{name}.toml"
    verify, lint = block("bash").splitlines()
    assert f"--cases {name}" in verify
    assert suite.run(verify) == (2, [f"stickslip: {suite.cases}: no case matches '{name}'"])

    file.write_text(text, encoding="utf-8")
    code, said = suite.run(verify)
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
    code, said = suite.run("stickslip verify --accept")
    assert code == 0, said
    accepted = suite.folder / "judging" / "accepted.json"
    assert "x-course" in json.loads(accepted.read_text(encoding="utf-8"))[name]
