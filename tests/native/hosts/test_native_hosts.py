"""The native FMU runs everywhere, without Python, and gives the bits of the Python FMU."""

import shutil
import struct
from dataclasses import replace
from pathlib import Path

import pytest

from tests.conftest import built
from tests.driver import Fmu
from tests.importers.cases import CASES
from tests.importers.host_c import BEGIN, Host, compile_host, unpack, without_libpython
from tests.importers.judging import deviations
from tests.importers.running import IMPORTERS, PAIRING, run
from tests.native.compiling import run as output_of
from tests.native.compiling import with_library
from tests.needs import each, needs

pytestmark = needs("cc")

HOW = dict.fromkeys(PAIRING, "pair") | {"fmucontainer": "in_threads"}


@pytest.fixture(scope="module")
def simulator(tmp_path_factory: pytest.TempPathFactory) -> Host:
    folder = tmp_path_factory.mktemp("host")
    return without_libpython(compile_host(folder), unpack(built("native-2"), folder / "fmu"))


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_an_importer_shows_the_bits_of_the_python_fmu(importer: str) -> None:
    native, python = (
        run(importer, built(kind), "inputs", HOW.get(importer, "run"))
        for kind in ("native-2", "python-2")
    )
    assert native == python


def test_a_host_in_c_is_exact_without_libpython(simulator: Host) -> None:
    # The block itself is within 1e-13; a few roundings of times come on top.
    assert max(deviations(CASES["inputs"], simulator.run(CASES["inputs"])).values()) < 1e-12
    listening = replace(simulator, environment={**simulator.environment, "LD_DEBUG": "files"})
    loaded = listening(f"{BEGIN}step 0 1\n").stderr
    assert "StickSlip.so" in loaded
    assert "libpython" not in loaded


@pytest.mark.parametrize("name", ["(x86) a+b ü", "100% = [a]&b,c'd", "#1 $HOME ~ !"])
def test_any_folder_will_do(simulator: Host, tmp_path: Path, name: str) -> None:
    moved = tmp_path / name / "fmu"
    shutil.copytree(simulator.fmu, moved)
    case = CASES["restart"]
    assert replace(simulator, fmu=moved).run(case) == simulator.run(case)


def test_many_instances_in_many_threads_show_the_bits_of_a_lone_one(tmp_path: Path) -> None:
    program = tmp_path / "threads"
    source = Path(__file__).with_name("threads.c")
    output_of("cc", "-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-o", program, source, "-ldl",
              "-pthread")  # fmt: skip
    fmu = Fmu(built("native-2"))
    assert output_of(program, fmu.binary, fmu.token.decode(), 8, 10_000) == "0\n"


def test_two_builds_live_in_one_process_each_with_its_own_values(tmp_path: Path) -> None:
    content = Fmu(built("native-2")).binary.read_bytes()
    # The start value of g stands once in the library, in its table.
    old, new = struct.pack("<d", 9.81), struct.pack("<d", 4.905)
    assert content.count(old) == 1
    library = tmp_path / "StickSlip.so"
    library.write_bytes(content.replace(old, new))
    other = with_library(built("native-2"), library, tmp_path / "moon.fmu")
    instances = [Fmu(path).started() for path in (built("native-2"), other)]
    for _ in range(100):
        for instance in instances:
            instance.step(0.01)
    assert [instance.get("F_s") for instance in instances] == [[4.905], [0.5 * 4.905]]
