"""FMUs that take more than they should: time, memory, processes, room in the log."""

import gc
import mmap
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import pytest

from stickslip_verification import FmuError, Limits, verify
from stickslip_verification.drive import processes, workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.processes import Worker

from .foreign import building
from .records import named
from .test_workers import plain, short

linux = pytest.mark.skipif(sys.platform != "linux", reason="needs subreapers, which Linux has")


def lives(process: int) -> bool:
    """Whether a process is there, a zombie left out."""
    try:
        text = Path(f"/proc/{process}/stat").read_text(encoding="utf-8")
    except FileNotFoundError:
        return False
    return text.rpartition(")")[2].split()[0] != "Z"


@pytest.fixture
def forking(tmp_path: Path) -> tuple[Path, Path]:
    """Return an FMU that leaves a daemon at each third step, and the file with their numbers."""
    notes = tmp_path / "notes.txt"
    settings = {"WHAT": "'daemon'", "NOTES": repr(str(notes))}
    return building.build("misbehaving", tmp_path, "LeavesDaemon", settings), notes


@linux
def test_a_daemon_of_an_fmu_ends_with_the_pool(forking: tuple[Path, Path]) -> None:
    """A process that left its parent and its session lives as long as the pool, not longer."""
    fmu, notes = forking
    with workers.Pool(2, fmu=fmu) as pool:
        for answer in plain(pool, short(3), short(3)):
            assert answer.value is not None
        daemons = [int(line) for line in notes.read_text(encoding="utf-8").split()]
        assert len(daemons) == 2
        assert all(map(lives, daemons))
    assert not any(map(lives, daemons))


LEAVING = """\
import os, sys, time
from pathlib import Path
from stickslip_verification.drive import workers
from tests.verification.test_workers import plain, short

if __name__ == "__main__":
    with workers.Pool(1, fmu=Path(sys.argv[1])) as pool:
        plain(pool, short(3))
        os.kill(os.getpid(), 9)
"""


@linux
def test_a_daemon_ends_when_the_suite_is_killed(forking: tuple[Path, Path], tmp_path: Path) -> None:
    """Even a suite that had no chance to clear up leaves no process of the FMU."""
    fmu, notes = forking
    script = tmp_path / "leaving.py"
    script.write_text(LEAVING, encoding="utf-8")
    env = {**os.environ, "PYTHONPATH": str(Path.cwd()), "TMPDIR": str(tmp_path)}
    ended = subprocess.run([sys.executable, script, fmu], env=env, check=False, timeout=60)
    assert ended.returncode == -signal.SIGKILL
    (daemon,) = map(int, notes.read_text(encoding="utf-8").split())
    last = time.monotonic() + 10.0
    while lives(daemon) and time.monotonic() < last:
        time.sleep(0.05)
    assert not lives(daemon)


def test_an_fmu_that_hangs_everywhere_costs_its_budget(
    misbehaving: Callable[[str], Path],
) -> None:
    """The verdict comes soon after the budget, with the reason, and keeps what was finished."""
    cases = [named("one-step"), *(named(n) for n in ("default", "heavy", "reversals", "tuned"))]
    begun = time.monotonic()
    verdict = verify(misbehaving("hang"), cases, jobs=2, limits=Limits(budget=6.0), time_limit=60.0)
    assert time.monotonic() - begun < 40.0
    ends = {r.case: r for r in verdict.checks if r.check == "runs-to-the-end" and r.side == "fmu"}
    assert ends["one-step"].passed
    for case in cases[1:]:
        failure = ends[case.id].failure
        assert failure is not None
        assert failure.startswith("not finished: runs without a result took 6 s")
    assert not verdict.passed


def test_a_description_that_takes_too_long_is_refused(
    slider_mm: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A description of variables that break rules, which takes FMPy minutes, ends by the limit."""
    variable = (
        '<ScalarVariable name="q" valueReference="1" causality="foo"><Real/></ScalarVariable>'
    )
    path = building.altered(
        slider_mm,
        tmp_path / "long.fmu",
        lambda text: text.replace("</ModelVariables>", f"{50_000 * variable}</ModelVariables>"),
    )
    monkeypatch.setattr(workers, "TIME_LIMIT", 5.0)
    begun = time.monotonic()
    with pytest.raises(FmuError, match="its description cannot be read: no answer within 5 s"):
        verify(path, [named("one-step")], jobs=1, time_limit=5.0)
    assert time.monotonic() - begun < 40.0


def test_a_slow_fmu_that_finishes_has_time(misbehaving: Callable[[str], Path]) -> None:
    """Only runs without a result spend the budget; one that takes longer than it may finish."""
    limits = Limits(budget=2.0)
    with workers.Pool(1, fmu=misbehaving("raise"), limits=limits) as pool:
        for _ in range(3):
            (answer,) = pool.each(slow, [(1.0,)])
            assert answer == Answer(1.0)
        (late,) = pool.each(slow, [(30.0,)])
    assert late.late


def slow(seconds: float) -> Answer[float]:
    """Take a while."""
    time.sleep(seconds)
    return Answer(seconds)


@pytest.mark.skipif(sys.platform != "linux", reason="no other system keeps the limit")
def test_memory_beyond_the_limit_is_refused(misbehaving: Callable[[str], Path]) -> None:
    """An FMU that takes a gigabyte fails that run where it may have half of one, and not else."""
    fmu = misbehaving("eat")
    with workers.Pool(1, fmu=fmu, limits=Limits(memory=0.5)) as pool:
        eaten, after = plain(pool, short(3), short(2))
    assert eaten.failure is not None
    assert "fmi2DoStep(t = 0.02, h = 0.01) failed" in eaten.failure
    assert after.value is not None
    with workers.Pool(1, fmu=fmu) as pool:
        (enough,) = plain(pool, short(3))
    assert enough.value is not None


def eat_in_children() -> Answer[None]:
    """Take a quarter of a gigabyte in each of five processes, then wait."""
    for _ in range(4):
        if os.fork() == 0:
            break
    eaten = b"a" * 250_000_000
    time.sleep(60.0)
    return Answer(None, not_applicable=f"{len(eaten)}")


def eat_shared() -> Answer[None]:
    """Take shared memory bit by bit."""
    shared = mmap.mmap(-1, 2_000_000_000)
    for _ in range(2000):
        shared.write(b"a" * 1_000_000)
        time.sleep(0.005)
    return Answer(None)


@linux
@pytest.mark.parametrize("task", [eat_in_children, eat_shared])
def test_the_memory_of_all_its_processes_counts(
    misbehaving: Callable[[str], Path], task: Callable[[], Answer[None]]
) -> None:
    """Children and shared memory count as well, and the next task gets a new process."""
    with workers.Pool(1, fmu=misbehaving("eat"), limits=Limits(memory=0.8)) as pool:
        (eaten,) = pool.each(task, [()])
        (after,) = plain(pool, short(2))
    assert eaten.failure == "the process was ended: the FMU had more memory than --memory gives"
    assert after.value is not None


def test_an_fmu_may_print_and_log_a_lot(misbehaving: Callable[[str], Path]) -> None:
    """Twenty megabytes of prints cost nothing; of a hundred in the log few are kept."""
    with workers.Pool(1, fmu=misbehaving("print")) as pool:
        (printed,) = plain(pool, short(3))
    assert printed.value is not None
    with workers.Pool(1, fmu=misbehaving("log")) as pool:
        (logged,) = plain(pool, short(3))
    assert logged.value is not None
    assert len(logged.value.messages) == 1000
    assert set(logged.value.messages) == {200 * "moving on "}


def test_a_thousand_jobs_are_no_thousand_processes(
    fmu_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """There are no more processes than tasks, and than four for each processor."""
    monkeypatch.setattr(workers, "jobs_here", lambda: 1)
    started = []

    def start(*arguments: Any) -> Worker:
        started.append(Worker(*arguments))
        return started[-1]

    monkeypatch.setattr(workers, "Worker", start)
    for tasks, most in ((3, 3), (20, 4)):
        started.clear()
        with workers.Pool(1000, fmu=fmu_path) as pool:
            assert all(answer.value is not None for answer in plain(pool, *[short(2)] * tasks))
        assert len(started) == most


def close_everything() -> Answer[None]:
    """Close all that this process has open, and go on."""
    os.closerange(0, 1000)
    return Answer(None)


def answer_with_anything() -> Answer[None]:
    """Give an answer of another kind."""
    return "everything passed"  # type: ignore[return-value]


def answer_by_half() -> Answer[None]:
    """Begin an answer, and go no further."""
    for each in gc.get_objects():
        if isinstance(each, Connection):
            os.write(each.fileno(), b"\0\0\xff\xff half")
    time.sleep(60.0)
    return Answer(None)


def leave_in_the_background() -> Answer[int]:
    """Leave a process with all that was open here, and end."""
    if os.fork() == 0:
        os.setsid()
        time.sleep(300.0)
    os.kill(os.getpid(), signal.SIGABRT)
    return Answer(0)


@linux
@pytest.mark.parametrize(
    ("task", "told"),
    [
        (close_everything, "the process ended by itself with exit code 1"),
        (answer_with_anything, "no readable answer"),
        (answer_by_half, "the process gave half an answer and was ended"),
        (leave_in_the_background, "the process crashed (SIGABRT)"),
    ],
)
def test_a_worker_that_breaks_its_connection_costs_its_task(
    misbehaving: Callable[[str], Path],
    monkeypatch: pytest.MonkeyPatch,
    task: Callable[[], Answer[None]],
    told: str,
) -> None:
    """The task fails with its reason within seconds, and the next one gets its answer."""
    monkeypatch.setattr(processes, "LONGEST_SILENCE", 1)
    begun = time.monotonic()
    with workers.Pool(1, fmu=misbehaving("raise")) as pool:
        (broken,) = pool.each(task, [()])
        (after,) = plain(pool, short(2))
    assert broken.failure == told
    assert after.value is not None
    assert time.monotonic() - begun < 20.0


LONG = """\
from stickslip_verification.drive import workers
from tests.verification.records import named

if __name__ == "__main__":
    with workers.Pool(2) as pool:
        answers = list(pool.each(workers.reference, [(named("one-step"),)] * 2))
    print([answer.failure for answer in answers])
"""


def in_folder(folder: Path, script: Path) -> subprocess.CompletedProcess[str]:
    """Run a script with another folder for temporary files."""
    env = {**os.environ, "PYTHONPATH": str(Path.cwd()), "TMPDIR": str(folder)}
    return subprocess.run(
        [sys.executable, script], env=env, capture_output=True, text=True, check=False, timeout=60
    )


def test_the_folder_for_temporary_files_may_have_a_long_name(tmp_path: Path) -> None:
    """The sockets of the processes go elsewhere, and nothing is left."""
    script = tmp_path / "long.py"
    script.write_text(LONG, encoding="utf-8")
    folder = tmp_path / ("ü" * 100) / ("b" * 200)
    folder.mkdir(parents=True)
    run = in_folder(folder, script)
    assert (run.stdout, run.stderr, run.returncode) == ("[None, None]\n", "", 0)
    assert not list(folder.iterdir())


def test_without_a_folder_for_sockets_the_reason_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no folder has a short name, one line says what to set."""
    monkeypatch.setattr(processes, "SHORT_FOLDERS", (str(tmp_path / "none"),))
    monkeypatch.setattr(tempfile, "tempdir", f"{tmp_path}/{100 * 'a'}")
    monkeypatch.setitem(multiprocessing.current_process()._config, "tempdir", None)  # type: ignore[attr-defined]
    with pytest.raises(FmuError, match="too long for sockets, which take 70 bytes; set TMPDIR"):
        processes.choose_folder_of_sockets()
    assert tempfile.gettempdir().endswith("aaa")
