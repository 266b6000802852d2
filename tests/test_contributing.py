"""The section "Add an output" of CONTRIBUTING.md, done as it says in a copy of the project."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest

from tests.needs import needs
from tests.verification.test_contributing import blocks

ROOT = Path(__file__).parents[1]
pytestmark = pytest.mark.gate
FLOORS = ("fmu_src", "src", "verification", "workbench")


def applied(diff: str, root: Path) -> list[Path]:
    """Apply a diff without line numbers: what each hunk takes away must be there exactly once."""
    changed = []
    for part in diff.split("--- a/")[1:]:
        name, _, hunks = part.partition("\n+++ b/")
        file = root / name
        text = file.read_text(encoding="utf-8")
        for hunk in hunks.split("\n@@\n")[1:]:
            lines = hunk.rstrip("\n").split("\n")
            old = "\n".join(line[1:] for line in lines if line[:1] != "+")
            new = "\n".join(line[1:] for line in lines if line[:1] != "-")
            assert text.count(old) == 1, f"{name}: {old}"
            text = text.replace(old, new)
        file.write_text(text, encoding="utf-8")
        changed.append(file)
    return changed


def copied(names: Iterable[str], target: Path) -> None:
    for name in names:
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).is_dir():
            ignored = shutil.ignore_patterns("__pycache__")
            shutil.copytree(ROOT / name, target / name, ignore=ignored)
        else:
            shutil.copy(ROOT / name, target / name)


def walk(commands: str, folder: Path, **environment: str) -> str:
    """Run lines of the shell, all of which must succeed, in a folder; return what they print."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["/bin/sh", "-e", "-c", commands],
        cwd=folder,
        env={**os.environ, "PATH": path, **environment},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def changed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the project with the changes and the case of the section."""
    root = tmp_path_factory.mktemp("changed")
    copied(FLOORS, root)
    (diff,) = blocks("Add an output", "diff")
    assert len(applied(diff, root)) == 8
    (case,) = blocks("Add an output", "toml")
    (root / "z-dot.toml").write_text(case, encoding="utf-8")
    return root


def walk_in(root: Path, commands: str) -> None:
    """Run lines of the shell that end with a verdict, which must have held the new output."""
    search = os.pathsep.join(str(root / floor) for floor in FLOORS)
    walk(commands, root, PYTHONPATH=search, COLUMNS="120")
    report = (root / "report" / "report.json").read_text(encoding="utf-8")
    assert '"check": "z_dot-course"' in report


def test_an_output_is_added_as_contributing_says(changed: Path) -> None:
    (commands,) = blocks("Add an output", "bash")
    walk_in(changed, commands)


@needs("cc")
def test_the_native_fmu_has_the_added_output_too(changed: Path) -> None:
    (commands,) = blocks("Add an output", "bash")
    native = commands.replace("build --bare", "build --bare --native --this-machine")
    walk_in(changed, native.replace("StickSlip.fmu", "StickSlip_native.fmu"))
