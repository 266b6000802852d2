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


@pytest.mark.parametrize("native", [False, pytest.param(True, marks=needs("cc"))])
def test_an_output_is_added_as_contributing_says_to_the_native_fmu_too(
    changed: Path, native: bool
) -> None:
    (commands,) = blocks("Add an output", "bash")
    if native:
        commands = commands.replace("build --bare", "build --bare --native --this-machine")
        commands = commands.replace("StickSlip.fmu", "StickSlip_native.fmu")
    search = os.pathsep.join(str(changed / floor) for floor in FLOORS)
    walk(commands, changed, PYTHONPATH=search, COLUMNS="120")
    # The verdict must have held the new output.
    report = (changed / "report" / "report.json").read_text(encoding="utf-8")
    assert '"check": "z_dot-course"' in report
