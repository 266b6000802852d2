"""The wheel: everything that a user installs is in it."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Return the names of the files in the wheel of this source tree."""
    folder = tmp_path_factory.mktemp("wheel")
    # No isolated build: hatchling is among the tools that the tests are installed with.
    options = ["--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", str(folder)]
    done = subprocess.run(
        [sys.executable, "-m", "pip", "wheel", *options, str(ROOT)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


def test_the_four_packages_are_typed(names: set[str]) -> None:
    """Each package is in the wheel with its marker for type checkers."""
    packages = ("stickslip", "stickslip_fmu", "stickslip_ref", "stickslip_verification")
    assert {f"{package}/py.typed" for package in packages} <= names


def test_the_page_travels(names: set[str]) -> None:
    """Markup, style, model, view, theory and tables of the page are in the wheel."""
    folder = ROOT / "workbench" / "stickslip" / "page"
    kinds = (".j2", ".html", ".css", ".js", ".toml")
    sources = [path for path in folder.rglob("*") if path.suffix in kinds]
    assert {path.suffix for path in sources} == set(kinds)
    assert {path.relative_to(folder.parent.parent).as_posix() for path in sources} <= names


def test_the_data_travels(names: set[str]) -> None:
    """Cases, laws, faults, claims, schemas, templates and accepted values are in the wheel."""
    folder = ROOT / "verification" / "stickslip_verification"
    kinds = (".toml", ".json", ".j2", ".css", ".js", ".txt")
    data = [path for path in folder.rglob("*") if path.suffix in kinds]
    folders = {path.parent.relative_to(folder).as_posix() for path in data}
    assert {"cases", "laws", "mutants/faults", "claims", "report/templates"} <= folders
    assert folder / "judging" / "accepted.json" in data
    assert {path.relative_to(folder.parent).as_posix() for path in data} <= names
