"""The section "Add an output" of CONTRIBUTING.md, done as it says in a copy of the project."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from tests.verification.test_contributing import blocks

ROOT = Path(__file__).parents[1]
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


def test_an_output_is_added_as_contributing_says(tmp_path: Path) -> None:
    """Its changes and its case lead to an FMU whose new output is held against the truth."""
    for floor in FLOORS:
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / floor, tmp_path / floor, ignore=ignored)
    (diff,) = blocks("Add an output", "diff")
    assert len(applied(diff, tmp_path)) == 7
    (case,) = blocks("Add an output", "toml")
    (tmp_path / "z-dot.toml").write_text(case, encoding="utf-8")
    (commands,) = blocks("Add an output", "bash")
    search = os.pathsep.join(str(tmp_path / floor) for floor in FLOORS)
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["/bin/sh", "-e", "-c", commands],
        cwd=tmp_path,
        env={**os.environ, "PATH": path, "PYTHONPATH": search, "COLUMNS": "120"},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    report = (tmp_path / "report" / "report.json").read_text(encoding="utf-8")
    assert '"check": "z_dot-course"' in report
