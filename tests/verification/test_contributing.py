"""CONTRIBUTING.md done as it says: a case, an invariant and faults added to a copy of the suite."""

import re
import shutil
from functools import partial
from pathlib import Path

import pytest

import stickslip_verification
from tests.contributing import blocks, walk

PACKAGE = Path(stickslip_verification.__file__).parent

pytestmark = pytest.mark.gate


@pytest.fixture
def suite(tmp_path: Path) -> Path:
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


def test_an_invariant_is_added_as_it_says(suite: Path, tmp_path: Path, fmu_path: Path) -> None:
    run = partial(walk, folder=tmp_path, PYTHONPATH=str(tmp_path), COLUMNS="100")
    (metric,), (invariant, fault) = (
        blocks("Add an invariant", each) for each in ("python", "toml")
    )
    metrics = suite.parent / "judge" / "metrics.py"
    head, table, tail = metrics.read_text("utf-8").partition("Metric]] = {\n")
    metrics.write_text(head + table + metric + tail, "utf-8")
    for name, text in (("invariants/outputs", invariant), ("faults/meter", fault)):
        with (suite / f"{name}.toml").open("a", encoding="utf-8") as file:
            file.write(f"\n{text}")
    (commands,) = blocks("Add an invariant", "bash")
    _, verify, faults, lint = commands.replace("build/StickSlip.fmu", str(fmu_path)).splitlines()
    assert "passed, 0 failed" in run(f"{verify} -o r.json")
    assert "1 of 1 planted faults detected by" in run(f"{faults} --cases default")
    assert not re.search("slips.(are-)?counted", run(f"{lint} --cases no-cases || true"))


def test_a_fault_is_planted_as_it_says(suite: Path, tmp_path: Path, fmu_path: Path) -> None:
    run = partial(walk, folder=tmp_path, PYTHONPATH=str(tmp_path), COLUMNS="100")
    _, command = blocks("Plant a fault", "bash")[0].splitlines()
    (text,) = blocks("Plant a fault", "toml")
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    said = run(f"{command.replace('build/StickSlip.fmu', str(fmu_path))} --cases one-step")
    assert "1 of 1 planted faults detected by a check named in advance" in said
    (tmp_path / "mine.toml").rename(suite / "faults" / "mine.toml")
    assert "strong-friction" not in run("python -m stickslip_verification lint || true")
