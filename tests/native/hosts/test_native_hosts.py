"""The native FMU runs everywhere, without Python, and gives the bits of the Python FMU."""

from __future__ import annotations

import shutil
import struct
import subprocess
from dataclasses import replace
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave

from tests.driver import Host as Process
from tests.importers.cases import CASES
from tests.importers.host_c import (
    Host,
    compile_host,
    unpack,
    with_libpython,
    without_libpython,
)
from tests.importers.judging import deviations
from tests.importers.running import IMPORTERS, Rows, ask, run
from tests.needs import each, needs

HERE = Path(__file__).parent

pytestmark = needs("cc")


@pytest.fixture(scope="module")
def host(native_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Host:
    """Compile the host in C and unpack the FMU for it; no libpython is preloaded."""
    folder = tmp_path_factory.mktemp("host")
    return without_libpython(compile_host(folder), unpack(native_path, folder / "fmu"))


def in_host(host: Host, name: str) -> Rows:
    """Run a case in the host in C."""
    return host.run(CASES[name])


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_an_importer_shows_the_bits_of_the_python_fmu(
    native_path: Path, fmu_path: Path, importer: str
) -> None:
    """The same case, run again in one process, gives the same bits with either FMU."""
    ours, theirs = (run(importer, fmu, "restart") for fmu in (native_path, fmu_path))
    assert ours == theirs
    assert ours.again == replace(ours, again=None)


@pytest.mark.parametrize("importer", each(["libcosimpy", "ecospy", "fmucontainer"]))
def test_two_connected_blocks_show_the_bits_of_the_python_fmu(
    native_path: Path, fmu_path: Path, importer: str
) -> None:
    """Two blocks in one simulation, in threads where the importer has them, are the same too."""
    how = "in_threads" if importer == "fmucontainer" else "pair"
    ours, theirs = (run(importer, fmu, "inputs", how) for fmu in (native_path, fmu_path))
    assert ours == theirs


@needs("proxyfmu")
def test_a_host_that_is_not_python_needs_no_preload(native_path: Path) -> None:
    """Proxyfmu loads the FMU as it is started by default."""
    process = Process(LD_PRELOAD="")
    done, _ = ask("proxyfmu", "inputs", native_path, process=process)
    process.end()
    assert done


@pytest.mark.parametrize("name", ["default", "inputs"])
def test_a_host_in_c_is_exact_without_libpython(host: Host, name: str) -> None:
    """Every output at every communication point keeps to the exact solution within 1e-12."""
    assert max(deviations(CASES[name], in_host(host, name)).values()) < 1e-12


def test_no_libpython_is_in_the_process(host: Host) -> None:
    """The loader's own list of files names the FMU's library, and no library of Python."""
    listening = replace(host, environment={**host.environment, "LD_DEBUG": "files"})
    loaded = listening("setup 0\nenter\nexit\nstep 0 1\n").stderr
    assert "StickSlip.so" in loaded
    assert "libpython" not in loaded


@needs("libpython")
def test_another_python_in_the_process_changes_nothing(host: Host) -> None:
    """With a libpython preloaded the host shows the same bits."""
    assert in_host(with_libpython(host.program, host.fmu), "inputs") == in_host(host, "inputs")


@pytest.mark.parametrize("name", ["(x86) a+b ü", "100% = [a]&b,c'd", "#1 $HOME ~ !"])
def test_any_folder_will_do(host: Host, tmp_path: Path, name: str) -> None:
    """The FMU runs from folders that the wrapper of the Python FMU does not survive."""
    moved = tmp_path / name / "fmu"
    shutil.copytree(host.fmu, moved)
    elsewhere = replace(host, fmu=moved)
    assert in_host(elsewhere, "restart") == in_host(host, "restart")


def compiled(program: str, folder: Path, *options: str) -> Path:
    """Compile a program of this folder, without a warning."""
    target = folder / program
    strict = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Werror")
    source = HERE / f"{program}.c"
    subprocess.run(["cc", *strict, "-o", target, source, "-ldl", *options], check=True)
    return target


def test_many_instances_in_many_threads_disturb_each_other_nowhere(
    native_path: Path, tmp_path: Path
) -> None:
    """10,000 instances in 8 threads, 50 alive in each, all show the bits of a lone one."""
    program = compiled("threads", tmp_path, "-pthread")
    guid = fmpy.read_model_description(str(native_path)).guid
    library = next(unpack(native_path, tmp_path / "fmu").glob("binaries/*/StickSlip.so"))
    done = subprocess.run(
        [program, library, guid, "8", "10000"], capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr, done.returncode) == ("0\n", "", 0)


def test_no_fused_multiply_add_is_in_the_library(native_path: Path, tmp_path: Path) -> None:
    """The disassembly has multiplications, and none that adds in the same instruction."""
    library = next(unpack(native_path, tmp_path).glob("binaries/*/StickSlip.so"))
    code = subprocess.run(
        ["objdump", "-d", "--no-show-raw-insn", library], capture_output=True, text=True, check=True
    ).stdout
    operations = {line.split("\t")[1].split()[0] for line in code.splitlines() if "\t" in line}
    assert any("mul" in each for each in operations)
    assert not [each for each in operations if "fma" in each or each.startswith(("fnm", "vfnm"))]


def test_two_versions_live_in_one_process(native_path: Path, tmp_path: Path) -> None:
    """A build in which gravity pulls half as much runs beside this one; each keeps to its own."""
    other = unpack(native_path, tmp_path / "other")
    (library,) = other.glob("binaries/*/StickSlip.so")
    # The start value of g stands once in the library, in its table.
    old, new = struct.pack("<d", 9.81), struct.pack("<d", 4.905)
    assert library.read_bytes().count(old) == 1
    library.write_bytes(library.read_bytes().replace(old, new))
    description = fmpy.read_model_description(str(native_path))
    slaves = []
    for folder in (unpack(native_path, tmp_path / "one"), other):
        slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier="StickSlip",
            instanceName=folder.name,
        )
        slave.instantiate()
        slave.setupExperiment()
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        slaves.append(slave)
    for number in range(100):
        for slave in slaves:
            slave.doStep(number * 0.01, 0.01)
    F_s = [each.valueReference for each in description.modelVariables if each.name == "F_s"]
    assert [slave.getReal(F_s) for slave in slaves] == [[4.905], [0.5 * 4.905]]
    for slave in slaves:
        slave.terminate()
        slave.freeInstance()
