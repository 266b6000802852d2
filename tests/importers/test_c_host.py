"""The FMU in a simulator written in C, with libpython preloaded as the documentation says."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from stickslip_fmu.spec import TABLE
from tests.interrupting import HEARING
from tests.needs import needs

from . import replay
from .cases import CASES, Case
from .host_c import (
    OUTPUTS,
    Host,
    compile_host,
    get_outputs,
    interpreters,
    line,
    set_values,
    unpack,
    with_libpython,
    without_libpython,
)
from .judging import deviations
from .record import Call
from .running import Rows

TOLERANCE = 1e-9
"""What any importer may add to the block's own error; this one multiplies its step, which puts
the communication points within an ulp and the outputs within 1e-13."""

BEGIN = "setup 0\nenter\nexit\n"
INTERPRETERS = interpreters()

pytestmark = needs("cc", "libpython")


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory, fmu_path: Path) -> Path:
    """Give the folder of the unzipped FMU."""
    return unpack(fmu_path, tmp_path_factory.mktemp("unpacked") / "fmu")


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the compiled host; the compiler has nothing to say of it."""
    return compile_host(tmp_path_factory.mktemp("program"))


@pytest.fixture(scope="module")
def host(program: Path, unpacked: Path) -> Host:
    """Give the host with the libpython of the interpreter that runs the tests."""
    return with_libpython(program, unpacked)


def initialized(case: Case) -> str:
    """Return the lines that start a case and read its outputs."""
    return "setup 0\n" + set_values(case.start) + "enter\nexit\n" + get_outputs()


def stepped(case: Case) -> str:
    """Return the lines that step through a case and read its outputs."""
    return "".join(
        set_values(case.changes.get(number, {}))
        + line("step", number * case.step, case.step)
        + get_outputs()
        for number in range(case.steps)
    )


def rows(case: Case, shown: list[list[float]]) -> Rows:
    """Return what the host showed at the start and at the end of each step."""
    assert len(shown) == case.steps + 1
    times = tuple(number * case.step for number in range(case.steps + 1))
    columns = zip(*shown, strict=True)
    return Rows(times, {each.name: column for each, column in zip(OUTPUTS, columns, strict=True)})


@pytest.mark.parametrize("python", INTERPRETERS)
@pytest.mark.parametrize("case", [CASES["default"], CASES["inputs"]], ids=lambda case: case.name)
def test_a_host_in_c_is_exact(program: Path, unpacked: Path, case: Case, python: str) -> None:
    """With any libpython, every output at every communication point is exact within 1e-9."""
    host = with_libpython(program, unpacked, python)
    shown = rows(case, host.answers(initialized(case) + stepped(case) + "terminate\n"))
    assert max(deviations(case, shown).values()) < TOLERANCE


def test_a_run_after_reset_repeats_every_bit(host: Host) -> None:
    """A second run in the same instance is the first one again, and exact."""
    case = CASES["restart"]
    run = initialized(case) + stepped(case)
    shown = host.answers(run + "reset\n" + run)
    first, second = shown[: case.steps + 1], shown[case.steps + 1 :]
    assert list(map(replay.bits, first)) == list(map(replay.bits, second))
    assert max(deviations(case, rows(case, second)).values()) < TOLERANCE


def test_fmpy_shows_the_same_bits_for_the_same_calls(
    host: Host, fmu_path: Path, tmp_path: Path
) -> None:
    """What the host in C calls, called through FMPy, reads the same numbers."""
    case = CASES["inputs"]
    reals = [TABLE.by_name[each.name].number for each in OUTPUTS if each.kind == "Real"]
    calls = [Call("block", "make", ()), Call("block", "setup_experiment", (0.0, None, None))]
    calls += [_set(case.start)]
    calls += [Call("block", f"{each}_initialization_mode", ()) for each in ("enter", "exit")]
    for number in range(case.steps):
        if number in case.changes:
            calls.append(_set(case.changes[number]))
        calls.append(Call("block", "do_step", (number * case.step, case.step)))
        calls.append(Call("block", "get_real", (reals,)))
    assert replay.in_c(calls, host) == replay.by_fmpy(calls, fmu_path, tmp_path)


def _set(values: object) -> Call:
    assert isinstance(values, dict)
    references = [TABLE.by_name[name].number for name in values]
    return Call("block", "set_real", (references, list(values.values())))


@pytest.mark.parametrize("python", INTERPRETERS)
def test_the_default_experiment_needs_no_script(program: Path, unpacked: Path, python: str) -> None:
    """Without a script the host writes the default experiment as CSV and ends in silence."""
    done = with_libpython(program, unpacked, python)()
    assert (done.returncode, done.stderr) == (0, "")
    head, *lines = done.stdout.splitlines()
    assert head == ",".join(["time", *(each.name for each in OUTPUTS)])
    last = dict(zip(head.split(","), map(float, lines[-1].split(",")), strict=True))
    assert (len(lines), last["time"], last["n_slips"]) == (1001, 10.0, 31.0)


def test_without_libpython_a_symbol_is_missing(program: Path, unpacked: Path) -> None:
    """A host that starts as usual cannot load the FMU, and the help quotes what it says."""
    done = without_libpython(program, unpacked)(BEGIN)
    assert (done.returncode, done.stdout) == (1, "")
    assert "undefined symbol: _Py_NoneStruct" in done.stderr
    help_ = _stickslip("host", "--help").stdout
    assert "undefined symbol: _Py_NoneStruct" in " ".join(help_.split())


def test_the_launcher_starts_the_host(host: Host) -> None:
    """`stickslip host -- ./host FOLDER` writes what the host writes with libpython preloaded."""
    launched = _stickslip("host", "--", str(host.program), str(host.fmu))
    assert (launched.returncode, launched.stderr) == (0, "")
    assert launched.stdout == host().stdout


def _stickslip(*arguments: str) -> subprocess.CompletedProcess[str]:
    program = "from stickslip.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False
    )


def test_two_instances_keep_apart(host: Host) -> None:
    """Stepped in turn, two instances show what each shows alone."""
    slow = [f"use slow\n{BEGIN}", *(f"use slow\nstep {i} 1\nget x F n_slips\n" for i in range(9))]
    fast = [
        f"use fast\nset v 0.05\n{BEGIN}",
        *(f"use fast\nstep {i} 1\nget x F n_slips\n" for i in range(9)),
    ]
    together = host.answers("".join(s + f for s, f in zip(slow, fast, strict=True)))
    assert together[0::2] == host.answers("".join(slow))
    assert together[1::2] == host.answers("".join(fast))
    assert together[0::2] != together[1::2]


def test_a_failure_leaves_the_host_alive(host: Host) -> None:
    """A thousand failures are a fatal status each, told once in full, and reset recovers."""
    done = host((BEGIN + "try set k -1\ntry step 0 1\ntry get x\nreset\n") * 1000
                + BEGIN + "step 0 1\nget x_pull\n")  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout == "fatal\n" * 3000 + "0.02\n"
    told = "StickSlip: k = -1.0 N/m is out of range: it must be finite and above 0"
    assert done.stderr.count(told) == 1000


def test_a_failure_that_is_not_met_ends_the_run(host: Host) -> None:
    """The exit code is 1, and what failed, where and why stands on standard error."""
    done = host(BEGIN + "set k -1\nget x\n")
    assert (done.returncode, done.stdout) == (1, "")
    assert "host: line 4: set: fatal" in done.stderr
    assert "k = -1.0 N/m is out of range" in done.stderr


def test_a_warning_reaches_the_logger(host: Host) -> None:
    """The clamp of mu_k comes through the log with its status, and fails nothing."""
    done = host("setup 0\nset mu_k 0.6\nenter\nexit\nget mu_k_used\n")
    assert (done.returncode, done.stdout) == (0, "0.48999999999999999\n")
    assert "block: warning: mu_k = 0.6 is above mu_s = 0.5" in done.stderr


def test_a_rollback_repeats_every_bit(host: Host) -> None:
    """From a state kept in mid-slip the same steps give the same outputs."""
    steps = "".join(line("step", 0.57 + 0.01 * i, 0.01) + get_outputs() for i in range(40))
    shown = host.answers(f"{BEGIN}step 0 0.57\nget mode\nsave\n{steps}restore\n{steps}")
    assert shown[0] == [1.0]
    assert list(map(replay.bits, shown[1:41])) == list(map(replay.bits, shown[41:]))
    assert shown[1] != shown[2]


def test_a_library_loaded_again_runs_again(host: Host) -> None:
    """A simulator that unloads the FMU after each run gets the same from each."""
    run = f"{BEGIN}step 0 1\nsave\nget x x_pull n_slips\nuse other\n{BEGIN}reload\n"
    shown = host.answers(run * 20)
    assert shown == [shown[0]] * 20
    assert shown[0][1:] == [0.02, 3.0]


def test_the_host_is_clean_in_memory(tmp_path: Path, unpacked: Path) -> None:
    """No invalid access, no undefined behaviour, and no memory of its own that it forgets."""
    program = compile_host(tmp_path, "-std=c99", "-g", "-fsanitize=address,undefined",
                           "-fno-sanitize-recover=all")  # fmt: skip
    host = with_libpython(program, unpacked)
    # CPython leaves memory behind at its end: what was asked for inside it is not counted.
    python = tmp_path / "python.txt"
    python.write_text("leak:libpython\n", encoding="utf-8")
    # The runtime of the sanitizer asks to be the first library.
    runtime = subprocess.run(
        ["cc", "-print-file-name=libasan.so"], capture_output=True, text=True, check=True
    ).stdout.strip()
    checked = {
        **host.environment,
        "LD_PRELOAD": f"{runtime}:{host.environment['LD_PRELOAD']}",
        "LSAN_OPTIONS": f"suppressions={python}:print_suppressions=0",
    }
    script = (
        f"{BEGIN}step 0 1\nsave\nget x mode\nrestore\nuse b\n{BEGIN}save\nreload\n"
        f"{BEGIN}save\ntry set k -1\n"
    )
    done = Host(program, unpacked, checked)(script)
    assert done.returncode == 0, done.stderr[-3000:]
    assert "Sanitizer" not in done.stderr


def test_ctrl_c_ends_the_host(host: Host, tmp_path: Path) -> None:
    """The Python in the FMU takes SIGINT for itself, and the host takes it back."""
    script = tmp_path / "long.txt"
    script.write_text(BEGIN + "get x\n" + "step 0 1e-3\n" * 2_000_000, encoding="utf-8")
    with subprocess.Popen(
        [*HEARING, host.program, host.fmu, script], env=host.environment, stdout=subprocess.PIPE
    ) as running:
        assert running.stdout is not None
        running.stdout.readline()
        running.send_signal(signal.SIGINT)
        try:
            assert running.wait(60.0) == -signal.SIGINT
        finally:
            running.kill()


@pytest.mark.parametrize("folder", ["with space", "a+b", "(1)"])
def test_the_fmu_may_lie_where_file_managers_put_it(
    host: Host, fmu_path: Path, tmp_path: Path, folder: str
) -> None:
    """Spaces and what browsers add to a name do no harm to the URI of the resources."""
    there = Host(host.program, unpack(fmu_path, tmp_path / folder), host.environment)
    assert there.answers(BEGIN + "step 0 1\nget x_pull\n") == [[0.02]]


@pytest.mark.parametrize("folder", ["100%", "#1", "Jürgen"])
def test_a_folder_that_the_wrapper_cannot_find_ends_the_process(
    host: Host, fmu_path: Path, tmp_path: Path, folder: str
) -> None:
    """Of the URI pythonfmu's wrapper decodes spaces alone, and runs on without what it misses."""
    there = Host(host.program, unpack(fmu_path, tmp_path / folder), host.environment)
    assert there(BEGIN).returncode == -signal.SIGSEGV


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("get nonsense\n", "nonsense is no variable of this FMU"),
        ("setup 0\nset v fast\n", "fast is no number"),
        ("set v\n", "wrong number of words"),
        ("jump 1\n", "jump is no call of this host"),
        ("step 0\n", "step is no call of this host, or has a wrong number of words"),
        ("step 0 1\n", "doStep is not allowed here"),
        ("restore\n", "nothing is saved"),
    ],
)
def test_a_wrong_script_is_told(host: Host, script: str, said: str) -> None:
    """A call that is none, or comes at the wrong time, ends the run with its line and a reason."""
    done = host(script)
    assert done.returncode == 1
    assert said in done.stderr
    assert f"host: line {len(script.splitlines())}: " in done.stderr


def test_a_folder_that_is_no_fmu_is_told(host: Host, tmp_path: Path) -> None:
    """Exit codes 2 for a folder that is not there, 1 for one that is no FMU 2.0, with its name."""
    missing = Host(host.program, tmp_path / "none", host.environment)()
    assert (missing.returncode, missing.stderr.count(str(tmp_path / "none"))) == (2, 1)
    (tmp_path / "modelDescription.xml").write_text('<fmiModelDescription fmiVersion="3.0">')
    other = Host(host.program, tmp_path, host.environment)()
    assert other.returncode == 1
    assert "no FMU 2.0 for co-simulation" in other.stderr
