"""The FMU in a simulator written in C, with libpython preloaded as the documentation says."""

import signal
import subprocess
from pathlib import Path

import pytest

from tests import driver
from tests.conftest import built
from tests.importers.cases import CASES
from tests.importers.host_c import (
    BEGIN,
    OUTPUTS,
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
    folder = tmp_path_factory.mktemp("host")
    return with_libpython(compile_host(folder), unpack(built("python-2"), folder / "fmu"))


def test_a_host_in_c_is_exact(simulator: Host) -> None:
    rows = simulator.run(CASES["inputs"])
    # It multiplies its step: times within an ulp, and as near as in any importer.
    assert max(deviations(CASES["inputs"], rows).values()) < 1e-12


def test_a_run_in_c_after_a_reset_shows_the_bits_of_one_in_python(
    simulator: Host, host: driver.Host
) -> None:
    case = CASES["restart"]
    in_c = simulator.answers(f"{script_of(case)}reset\n{script_of(case)}")[-case.steps :]
    calls: list[list[object]] = [["start", dict(case.start)]]
    for number in range(case.steps):
        calls += [["set", dict(case.changes.get(number, {}))], ["step", case.step]]
        calls.append(["get", *OUTPUTS])
    in_python = host.call(driver.play, built("python-2"), calls)[3::3]
    # One multiplies its steps, the other adds them up, and that dates events.
    same = [number for number, name in enumerate(OUTPUTS) if name != "t_event"]
    for here, there in zip(in_c, in_python, strict=True):
        assert [here[each] for each in same] == [there[each] for each in same]


def test_without_libpython_a_symbol_is_missing(simulator: Host) -> None:
    done = without_libpython(simulator.program, simulator.fmu)(BEGIN)
    assert (done.returncode, done.stdout) == (1, "")
    assert "undefined symbol: _Py_NoneStruct" in done.stderr


def test_failures_leave_the_host_alive_and_a_reset_recovers(simulator: Host) -> None:
    failing = f"{BEGIN}try set k -1\ntry step 0 1\ntry get x\nreset\n"
    done = simulator(f"{failing * 300}{BEGIN}step 0 1\nget x_pull\n")
    assert (done.returncode, done.stdout) == (0, "fatal\n" * 900 + "0.02\n")
    told = "StickSlip: k = -1.0 N/m is out of range: it must be finite and above 0"
    assert done.stderr.count(told) == 300


def test_a_library_loaded_again_runs_again(simulator: Host) -> None:
    run = f"{BEGIN}step 0 1\nsave\nget x x_pull n_slips\nuse other\n{BEGIN}reload\n"
    shown = simulator.answers(run * 10)
    assert shown == [shown[0]] * 10
    assert shown[0][1:] == [0.02, 3.0]


def test_a_folder_may_be_called_as_file_managers_call_it(simulator: Host, tmp_path: Path) -> None:
    folder = unpack(built("python-2"), tmp_path / "a+b copy (1)")
    there = Host(simulator.program, folder, simulator.environment)
    assert there.answers(f"{BEGIN}step 0 1\nget x_pull\n") == [[0.02]]


def test_ctrl_c_ends_the_host_although_python_takes_the_signal(
    simulator: Host, tmp_path: Path
) -> None:
    script = tmp_path / "long.txt"
    script.write_text(f"{BEGIN}get x\n" + "step 0 1e-3\n" * 2_000_000, encoding="utf-8")
    with subprocess.Popen(
        [*HEARING, simulator.program, simulator.fmu, script],
        env=simulator.environment,
        stdout=subprocess.PIPE,
    ) as running:
        assert running.stdout is not None
        running.stdout.readline()
        running.send_signal(signal.SIGINT)
        try:
            assert running.wait(60.0) == -signal.SIGINT
        finally:
            running.kill()


@needs("sanitizers")
def test_the_host_is_clean_in_memory(simulator: Host, tmp_path: Path) -> None:
    program = compile_host(
        tmp_path, "-std=c99", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"
    )
    # CPython leaves memory behind at its end: what was asked for inside it is not counted.
    python = tmp_path / "python.txt"
    python.write_text("leak:libpython\n", encoding="utf-8")
    # The runtime of the sanitizer asks to be the first library.
    runtime = subprocess.run(
        ["cc", "-print-file-name=libasan.so"], capture_output=True, text=True, check=True
    ).stdout.strip()
    checked = {
        **simulator.environment,
        "LD_PRELOAD": f"{runtime}:{simulator.environment['LD_PRELOAD']}",
        "LSAN_OPTIONS": f"suppressions={python}:print_suppressions=0",
    }
    script = (
        f"{BEGIN}step 0 1\nsave\nget x mode\nrestore\nuse b\n{BEGIN}save\nreload\n"
        f"{BEGIN}save\ntry set k -1\n"
    )
    done = Host(program, simulator.fmu, checked)(script)
    assert done.returncode == 0, done.stderr[-3000:]
    assert "Sanitizer" not in done.stderr


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("get nonsense", "nonsense is no variable of this FMU"),
        ("setup 0\nset v fast", "fast is no number"),
        ("set v", "wrong number of words"),
        ("jump 1", "jump is no call of this host"),
        ("step 0", "step is no call of this host, or has a wrong number of words"),
        ("step 0 1", "doStep is not allowed here"),
        ("restore", "nothing is saved"),
        (f"{BEGIN}set k -1", "k = -1.0 N/m is out of range"),
    ],
)
def test_a_failure_that_is_not_met_ends_the_run_with_its_line(
    simulator: Host, script: str, words: str
) -> None:
    done = simulator(f"{script}\nget x\n")
    assert (done.returncode, done.stdout) == (1, "")
    assert words in done.stderr
    assert f"host: line {len(script.splitlines())}: " in done.stderr


def test_a_folder_that_holds_no_fmu_is_refused_by_name(simulator: Host, tmp_path: Path) -> None:
    done = Host(simulator.program, tmp_path / "none", simulator.environment)(BEGIN)
    assert done.returncode == 2
    assert str(tmp_path / "none") in done.stderr
