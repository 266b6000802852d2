"""The native FMU runs everywhere, without Python, and gives the bits of the Python FMU."""

from dataclasses import replace
from pathlib import Path

import pytest

from tests.conftest import built
from tests.driver import Fmu
from tests.importers.cases import CASES
from tests.importers.host_c import BEGIN, compile_host, unpack, without_libpython
from tests.importers.judging import deviations
from tests.importers.running import IMPORTERS, PAIRING, run
from tests.native.compiling import run as output_of
from tests.needs import each, needs

pytestmark = needs("cc")

HOW = dict.fromkeys(PAIRING, "pair") | {"fmucontainer": "in_threads"}


@pytest.mark.parametrize("importer", each(IMPORTERS))
def test_an_importer_shows_the_bits_of_the_python_fmu(importer: str) -> None:
    native, python = (
        run(importer, built(kind), "inputs", HOW.get(importer, "run"))
        for kind in ("native-2", "python-2")
    )
    assert native == python


def test_a_host_in_c_is_exact_without_libpython(tmp_path: Path) -> None:
    fmu = unpack(built("native-2"), tmp_path / "fmu")
    simulator = without_libpython(compile_host(tmp_path), fmu)
    # The block itself is within 1e-13; a few roundings of times come on top.
    assert max(deviations(CASES["inputs"], simulator.run(CASES["inputs"])).values()) < 1e-12
    listening = replace(simulator, environment={**simulator.environment, "LD_DEBUG": "files"})
    loaded = listening(f"{BEGIN}step 0 1\n").stderr
    assert "StickSlip.so" in loaded
    assert "libpython" not in loaded


def test_many_instances_in_many_threads_show_the_bits_of_a_lone_one(tmp_path: Path) -> None:
    program = tmp_path / "threads"
    source = Path(__file__).with_name("threads.c")
    output_of("cc", "-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-o", program, source, "-ldl",
              "-pthread")  # fmt: skip
    fmu = Fmu(built("native-2"))
    assert output_of(program, fmu.binary, fmu.token.decode(), 8, 2_000) == "0\n"
