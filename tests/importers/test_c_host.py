"""The FMU in a simulator written in C, with libpython preloaded as the documentation says."""

import signal
import subprocess
from pathlib import Path

import pytest

from tests.conftest import built
from tests.importers.cases import CASES
from tests.importers.host_c import (
    BEGIN,
    Host,
    compile_host,
    script_of,
    unpack,
    with_libpython,
    without_libpython,
)
from tests.importers.judging import deviations
from tests.interrupting import HEARING
from tests.needs import needs

pytestmark = needs("cc", "libpython")


@pytest.fixture(scope="module")
def simulator(tmp_path_factory: pytest.TempPathFactory) -> Host:
    # Called as file managers call a copy.
    folder = tmp_path_factory.mktemp("host") / "a+b copy (1)"
    fmu = unpack(built("python-2"), folder)
    return with_libpython(compile_host(folder), fmu)


def test_a_host_in_c_is_exact(simulator: Host) -> None:
    rows = simulator.run(CASES["inputs"])
    # It multiplies its step: times within an ulp, and as near as in any importer.
    assert max(deviations(CASES["inputs"], rows).values()) < 1e-12


def test_a_run_after_a_reset_or_in_a_library_loaded_again_shows_the_same_bits(
    simulator: Host,
) -> None:
    script = script_of(CASES["restart"])
    shown = simulator.answers(f"{script}reset\n{script}use other\n{script}reload\n" * 2)
    assert shown == shown[: len(shown) // 6] * 6


def test_without_libpython_a_symbol_is_missing(simulator: Host) -> None:
    done = without_libpython(simulator.program, simulator.fmu)(BEGIN)
    assert (done.returncode, done.stdout) == (1, "")
    assert "undefined symbol: _Py_NoneStruct" in done.stderr


def test_failures_leave_the_host_alive_and_a_reset_recovers(simulator: Host) -> None:
    failing = f"{BEGIN}try set k -1\ntry step 0 1\ntry get x\nreset\n"
    done = simulator(f"{failing * 100}{BEGIN}step 0 1\nget x_pull\n")
    assert (done.returncode, done.stdout) == (0, "fatal\n" * 300 + "0.02\n")
    told = "StickSlip: k = -1.0 N/m is out of range: it must be finite and above 0"
    assert done.stderr.count(told) == 100


def test_ctrl_c_ends_the_host_although_python_takes_the_signal(simulator: Host) -> None:
    with subprocess.Popen(
        [*HEARING, simulator.program, simulator.fmu, "-"],
        env=simulator.environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as running:
        assert running.stdin is not None
        assert running.stdout is not None
        # Its input stays open: it waits for more.
        running.stdin.write(f"{BEGIN}get x\n".encode())
        running.stdin.flush()
        running.stdout.readline()
        running.send_signal(signal.SIGINT)
        try:
            assert running.wait(60.0) == -signal.SIGINT
        finally:
            running.kill()


@needs("sanitizers")
def test_the_host_is_clean_in_memory(tmp_path: Path) -> None:
    # With the native FMU: CPython leaves memory behind at its end.
    sanitized = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    checked = without_libpython(compile_host(tmp_path, *sanitized), tmp_path / "fmu")
    unpack(built("native-2"), checked.fmu)
    again = f"use b\n{BEGIN}save\nreload\n{BEGIN}save\ntry set k -1\n"
    done = checked(f"{BEGIN}step 0 1\nsave\nget x mode\nrestore\n{again}")
    assert done.returncode == 0, done.stderr[-3000:]
    assert "Sanitizer" not in done.stderr
