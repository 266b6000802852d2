"""The page's script by TypeScript's compiler: types are those that the comments declare."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.needs import ROOT, TSC, needs

SOURCES = ROOT / "workbench" / "stickslip" / "page"
pytestmark = needs("typescript")


def findings(project: Path) -> list[str]:
    """Return what the compiler finds in a folder with a tsconfig.json, a line each."""
    done = subprocess.run(
        [*TSC, "--project", "."], cwd=project, capture_output=True, text=True, check=False
    )
    lines = done.stdout.splitlines()
    assert bool(lines) == (done.returncode != 0), done.stderr
    return lines


def test_the_script_has_no_type_errors() -> None:
    """Every name and argument of model and view is of the declared type."""
    assert findings(SOURCES) == []


def test_the_model_declares_every_type() -> None:
    """With the compiler's strict rules, and without a browser's names, the model has no error."""
    assert findings(SOURCES / "model") == []


WRONG = {
    "model": [
        ("cycle.js", "steadyCycle(1);", "'number' is not assignable to parameter"),
        ("root.js", "const double = (a) => 2 * a;", "implicitly has an 'any' type"),
        ("root.js", "const title = document.title;", "Cannot find name 'document'"),
    ],
    ".": [
        ("model/root.js", 'risingZero("x", 0, 1, 0);', "'string' is not assignable"),
        ("view/units.js", "shortest('20');", "'string' is not assignable to parameter"),
    ],
}
"""Folder to modules, a wrong line for the end of each, and what is said of it."""


@pytest.mark.parametrize("folder", WRONG)
def test_each_wrong_line_is_found(tmp_path: Path, folder: str) -> None:
    """A parameter without a type, a browser's name in the model, and a wrong argument are told."""
    copy = shutil.copytree(SOURCES, tmp_path / "page")
    for module, line, _ in WRONG[folder]:
        with (copy / folder / module).open("a", encoding="utf-8") as file:
            file.write(f"{line}\n")
    found = sorted(findings(copy / folder))
    for finding, (module, _, told) in zip(found, WRONG[folder], strict=True):
        assert finding.startswith(f"{module}(")
        assert told in finding
