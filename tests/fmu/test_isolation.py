"""Instances and versions in one process keep to themselves."""

import shutil
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from pythonfmu.builder import FmuBuilder

import stickslip_fmu
from tests.conftest import built
from tests.driver import Host
from tests.fmu.acts import left_loaded, modules, of_versions
from tests.python import python

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
_BUILD = (
    "import sys; sys.path.insert(0, sys.argv[1])\n"
    "from pathlib import Path; from stickslip_fmu.packer import build\n"
    "build(Path(sys.argv[2]))"
)


@pytest.fixture(scope="module")
def other_version(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("other")
    shutil.copytree(Path(stickslip_fmu.__file__).parent, folder / "stickslip_fmu")
    settings = folder / "stickslip_fmu" / "settings.py"
    text = settings.read_text("utf-8")
    assert text.count("weight = self.m * self.g") == 1
    settings.write_text(text.replace("weight = self.m * self.g", "weight = 1.1 * self.m * self.g"))
    python("-I", "-c", _BUILD, folder, folder / "Other.fmu")
    return folder / "Other.fmu"


@pytest.fixture(scope="module")
def foreign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("foreign")
    (folder / "ramp.py").write_text(_FOREIGN, encoding="utf-8")
    FmuBuilder.build_FMU(folder / "ramp.py", folder / "raw.fmu", needsExecutionTool="false")
    target = folder / "Ramp.fmu"
    with zipfile.ZipFile(folder / "raw.fmu") as raw, zipfile.ZipFile(target, "w") as archive:
        for name in raw.namelist():
            older = name.endswith("pythonfmu/_version.py")
            archive.writestr(name, b'__version__ = "0.6.2"\n' if older else raw.read(name))
    return target


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 0, 2)])
def test_every_fmu_in_a_process_runs_its_own_code(
    other_version: Path, foreign: Path, order: tuple[int, ...], fresh_host: Host
) -> None:
    fmus = [built("python-2"), other_version, foreign]
    paths = [fmus[n] for n in order]
    # Alone is in a process of its own.
    alone = []
    for path in paths:
        alone += fresh_host.call(of_versions, [path])
        fresh_host.end()
    assert fresh_host.call(of_versions, paths) == alone
    assert len({str(shown) for shown in alone}) == 3


def test_the_identity_of_an_fmu_tells_its_content(other_version: Path) -> None:
    names = (built("python-2"), other_version)
    assert len({fmpy.read_model_description(str(name)).guid for name in names}) == 2


def test_the_standard_library_is_enough(fresh_host: Host) -> None:
    roots, entries = fresh_host.call(modules, built("python-2"))
    own = {name for name in roots if name.startswith("stickslip_fmu_")}
    assert len(own) == 2
    assert set(roots) - own - {"pythonfmu"} <= set(sys.stdlib_module_names)
    assert entries == 1


def test_a_process_ends_well_though_the_folder_of_a_loaded_fmu_is_gone() -> None:
    host = Host(PYTHONDEVMODE="1", MALLOC_PERTURB_="165")
    host.call(left_loaded, built("python-2"))
    assert host.end() == 0, host.errors()
