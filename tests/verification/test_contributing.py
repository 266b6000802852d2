"""CONTRIBUTING.md done as it says: a case and two faults added to a copy of the suite."""

import re
import shutil
import tomllib
from functools import partial
from pathlib import Path

import pytest

import stickslip_verification
from tests.contributing import blocks, walk

PACKAGE = Path(stickslip_verification.__file__).parent

pytestmark = pytest.mark.gate


@pytest.fixture
def suite(tmp_path: Path) -> Path:
    """Return the suite's folder in a copy of its package, without cases of costly truth."""
    ignored = shutil.ignore_patterns("__pycache__", "stribeck-*", "hyperbolic-*", "curve-*")
    return Path(shutil.copytree(PACKAGE, tmp_path / PACKAGE.name, ignore=ignored)) / "suite"


def test_a_case_is_added_as_it_says(suite: Path, tmp_path: Path, fmu_path: Path) -> None:
    run = partial(walk, folder=tmp_path, PYTHONPATH=str(tmp_path), COLUMNS="100")
    (text,) = blocks("Add a case", "toml")
    verify, lint = blocks("Add a case", "bash")[0].splitlines()
    (name,) = re.findall(r"--cases (\S+)", verify)
    file = suite / "cases" / f"{name}.toml"
    file.write_text(text, encoding="utf-8")
    assert "passed, 0 failed" in run(f"{verify} --fmu {fmu_path} -o r.json")

    # The linter follows the exact motion of each case: of all it would take minutes.
    for other in set((suite / "cases").glob("*.toml")) - {file}:
        other.unlink()
    # The linter prints the line that is to be added below `about`.
    (line,) = re.findall(r"motion is missing.*write (motion = .*)", run(f"{lint} || true"))
    text = re.sub(r'(about = ".*"\n)', rf"\1{line}\n", text)
    file.write_text(text, encoding="utf-8")
    found = run(f"{lint} || true").splitlines()
    assert [each for each in found if name in each] == []


def test_a_fault_is_planted_as_it_says(suite: Path, tmp_path: Path, fmu_path: Path) -> None:
    run = partial(walk, folder=tmp_path, PYTHONPATH=str(tmp_path), COLUMNS="100")
    (command,) = blocks("Plant a fault", "bash")
    text = "\n".join(blocks("Plant a fault", "toml"))
    faults = tomllib.loads(text)
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    said = run(f"{command.strip().replace('build/StickSlip.fmu', str(fmu_path))} --cases one-step")
    assert "2 of 2 planted faults detected by a check named in advance" in said
    (tmp_path / "mine.toml").rename(suite / "faults" / "mine.toml")
    findings = run("python -m stickslip_verification lint || true").splitlines()
    assert [each for each in findings if any(name in each for name in faults)] == []
