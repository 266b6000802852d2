"""Instances, versions and threads in one process keep to themselves."""

import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest
from pythonfmu.builder import FmuBuilder

import stickslip_fmu
from tests.fmu.running import inside

_FOREIGN = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Ramp(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.x = 0.0
        self.register_variable(Real("x", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.x += 3.0 * step_size
        return True
"""


@pytest.fixture(scope="module")
def other_version(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the FMU of a changed source tree, where the mass weighs more."""
    folder = tmp_path_factory.mktemp("other")
    package = folder / "stickslip_fmu"
    shutil.copytree(Path(stickslip_fmu.__file__).parent, package)
    settings = package / "settings.py"
    text = settings.read_text("utf-8")
    assert text.count("weight = self.m * self.g") == 1
    settings.write_text(text.replace("weight = self.m * self.g", "weight = 1.1 * self.m * self.g"))
    program = (
        f"import sys; sys.path.insert(0, {str(folder)!r})\n"
        "from pathlib import Path; from stickslip_fmu.packer import build\n"
        f"build(Path({str(folder / 'Other.fmu')!r}))"
    )
    subprocess.run([sys.executable, "-I", "-c", program], check=True, timeout=60)
    return folder / "Other.fmu"


@pytest.fixture(scope="module")
def foreign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an FMU of somebody else, with another version of pythonfmu inside."""
    folder = tmp_path_factory.mktemp("foreign")
    slave = folder / "ramp.py"
    slave.write_text(_FOREIGN, encoding="utf-8")
    FmuBuilder.build_FMU(slave, folder / "raw.fmu", needsExecutionTool="false")
    with (
        zipfile.ZipFile(folder / "raw.fmu") as raw,
        zipfile.ZipFile(folder / "Ramp.fmu", "w") as target,
    ):
        for name in raw.namelist():
            content = raw.read(name)
            if name.endswith("pythonfmu/_version.py"):
                content = b'__version__ = "0.6.2"\n'
            target.writestr(name, content)
    return folder / "Ramp.fmu"


def alone(fmu: Path, folder: Path) -> Any:
    """Return what an FMU gives in a process of its own."""
    (found,), (again,) = inside(fmu, "isolation", "versions", [], folder)
    return found, again


@pytest.mark.parametrize("order", ["ours first", "ours last", "ours between"])
def test_every_fmu_in_a_process_runs_its_own_code(
    fmu_path: Path, other_version: Path, foreign: Path, tmp_path: Path, order: str
) -> None:
    """Two versions of ours and a stranger of another pythonfmu, in any order, each as alone."""
    fmus = {
        "ours first": [fmu_path, other_version, foreign],
        "ours last": [foreign, other_version, fmu_path],
        "ours between": [other_version, fmu_path, foreign],
    }[order]
    first, *others = fmus
    found, again = inside(first, "isolation", "versions", [str(each) for each in others], tmp_path)
    expected = [alone(each, tmp_path) for each in fmus]
    assert list(zip(found, again, strict=True)) == expected
    assert all(a[0] != b[0] for n, a in enumerate(expected) for b in expected[:n])


def test_versions_of_one_name_would_run_one_code(
    fmu_path: Path, other_version: Path, tmp_path: Path
) -> None:
    """Were both versions packed by one name, the second would run the first one's code."""
    own, other = _package(fmu_path), _package(other_version)
    assert own != other
    named_alike = tmp_path / "alike.fmu"
    with zipfile.ZipFile(other_version) as source, zipfile.ZipFile(named_alike, "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if name.startswith("resources/"):
                content = content.replace(other.encode(), own.encode())
            target.writestr(name.replace(other, own), content)
    found, _ = inside(fmu_path, "isolation", "versions", [str(named_alike)], tmp_path)
    assert found[0] == found[1] != alone(named_alike, tmp_path)[0]


def _package(fmu: Path) -> str:
    """Return the name of the package inside."""
    with zipfile.ZipFile(fmu) as archive:
        return archive.read("resources/slavemodule.txt").decode().strip().removesuffix("_slave")


def test_instances_are_independent(fmu_path: Path, tmp_path: Path) -> None:
    """Two hundred instances stepped in random order show what each shows alone, bit for bit."""
    same, different, entries = inside(fmu_path, "isolation", "together", 200, tmp_path)
    assert same == different == 200
    assert entries <= 1


def test_threads_are_independent(fmu_path: Path, tmp_path: Path) -> None:
    """Four threads that make, step, roll back and free instances give what one alone gives."""
    same, lives = inside(fmu_path, "isolation", "in_threads", 4, tmp_path)
    assert same == lives == 80
