"""The wheel: everything that a user installs is in it, and works without the source tree."""

import json
import os
import subprocess
import sys
import sysconfig
import zipfile
from dataclasses import dataclass
from importlib.metadata import Distribution, distribution, distributions, files
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from tests.needs import needs
from tests.python import python, run
from tests.sharing import made_once
from tests.test_architecture import FOLDERS

ROOT = Path(__file__).parents[1]
PACKAGES = sorted(FOLDERS)

# What may lead a Python to the source tree or to the environment of the tests.
LEADS = ("PYTHON", "VIRTUAL_ENV", "COVERAGE_")

LENT = Path(sysconfig.get_path("purelib"))
"""Where the environment of the tests has its packages; the source tree is there by a path file."""

WHERE = f"""
import importlib.util, json, sys
found = [importlib.util.find_spec(name).origin for name in {PACKAGES}]
print(json.dumps([found, sys.path]))
"""

pytestmark = pytest.mark.gate


@dataclass(frozen=True)
class Environment:
    root: Path
    folder: Path

    def run(self, program: str, *words: str) -> subprocess.CompletedProcess[str]:
        kept = {name: text for name, text in os.environ.items() if not name.startswith(LEADS)}
        return run(self.root / "bin" / program, *words, timeout=600, cwd=self.folder, env=kept)

    def pip(self, *words: str) -> subprocess.CompletedProcess[str]:
        return self.run("python", "-m", "pip", "--quiet", "--disable-pip-version-check", *words)

    def stickslip(self, *words: str) -> str:
        done = self.run("stickslip", *words)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout


@pytest.fixture(scope="module")
def wheel() -> Path:
    def build(folder: Path) -> None:
        # No isolated build: hatchling is among the tools that the tests are installed with.
        options = ["--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", str(folder)]
        python("-m", "pip", "wheel", *options, ROOT, timeout=300)

    (wheel,) = made_once("wheel", build).glob("*.whl")
    return wheel


@pytest.fixture(scope="module")
def names(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


@pytest.fixture(scope="module")
def installed(wheel: Path) -> Environment:
    def set_up(folder: Path) -> None:
        environment = Environment(folder / "venv", folder)
        subprocess.run([sys.executable, "-m", "venv", str(environment.root)], check=True)
        done = environment.pip("install", "--no-deps", "--no-index", str(wheel))
        assert done.returncode == 0, done.stderr
        (packages,) = environment.root.glob("lib/python*/site-packages")
        for name in asked_for(next(iter(distributions(name="stickslip", path=[str(packages)])))):
            for top in {file.parts[0] for file in files(name) or ()} - {".."}:
                if not (packages / top).exists():
                    (packages / top).symlink_to(LENT / top)

    folder = made_once("installed", set_up)
    return Environment(folder / "venv", folder)


def asked_for(of: Distribution, extra: str = "") -> set[str]:
    found: set[str] = set()
    for need in map(Requirement, of.requires or ()):
        if need.marker is None or need.marker.evaluate({"extra": extra}):
            for each in ("", *need.extras):
                found |= {need.name} | asked_for(distribution(need.name), each)
    return found


def test_nothing_leads_from_the_installed_wheel_to_the_source_tree(installed: Environment) -> None:
    found, path = json.loads(installed.run("python", "-c", WHERE).stdout)
    assert all(Path(origin).is_relative_to(installed.root) for origin in found)
    assert not any(Path(entry).is_relative_to(ROOT) for entry in path if entry)


def test_the_installed_command_builds_verifies_simulates_and_scores(installed: Environment) -> None:
    installed.stickslip("build", "--bare", "--output", "fmus")
    words = ("--fmu", "fmus/StickSlip.fmu", "--cases", "one-step", "--output", "report")
    installed.stickslip("verify", *words)
    told = json.loads((installed.folder / "report" / "report.json").read_text("utf-8"))
    assert told["summary"]["failed"] == 0 < told["summary"]["passed"]
    assert (installed.folder / "report" / "index.html").stat().st_size > 0
    installed.stickslip("simulate", "--stop-time", "3", "--output-file", "curve.csv")
    assert json.loads(installed.stickslip("score", "curve.csv", "--json"))["cause"] == "exact"
    installed.stickslip("page", "-o", "page.html")
    assert (installed.folder / "page.html").read_text("utf-8").rstrip().endswith("</html>")


@needs("cc")
def test_the_installed_command_builds_the_native_fmu(installed: Environment) -> None:
    installed.stickslip("build", "--native", "--this-machine", "--bare", "--output", "fmus")
    assert (installed.folder / "fmus" / "StickSlip_native.fmu").stat().st_size > 0


def test_every_file_that_a_package_reads_is_in_the_wheel(names: set[str]) -> None:
    kinds = {".py", ".toml", ".json", ".j2", ".html", ".css", ".js", ".txt", ".c", ".h", ".typed"}
    kinds |= {".xml", ".png"}
    floors = [ROOT / floor for floor in ("fmu_src", "src", "verification", "workbench")]
    data = {
        path.relative_to(floor).as_posix()
        for floor in floors
        for path in floor.rglob("*")
        # TypeScript's settings are for who changes the page.
        if path.suffix in kinds and path.name != "tsconfig.json"
    }
    assert {f"{package}/py.typed" for package in PACKAGES} <= data
    assert data <= names
