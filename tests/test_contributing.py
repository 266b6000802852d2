"""The section "Add an output" of CONTRIBUTING.md, done as it says in a copy of the project."""

import os
from pathlib import Path

import pytest

from tests.contributing import applied, blocks, copied, walk
from tests.needs import needs

pytestmark = pytest.mark.gate
FLOORS = ("fmu_src", "src", "verification", "workbench")


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
