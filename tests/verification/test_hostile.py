"""What an FMU does to its process stays there: crashes, hangs, prints, memory, what it starts."""

import gc
import multiprocessing.util
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import pytest

from stickslip_verification import Case, FmuError, Limits, verify
from stickslip_verification.drive import FmuFile, processes
from stickslip_verification.drive.masters import run_case
from stickslip_verification.model.verdict import Run
from tests.makers import SLIDER, altered, edited, misbehaving
from tests.python import run
from tests.verification.records import named

linux = pytest.mark.skipif(sys.platform != "linux", reason="needs subreapers, which Linux has")
USUAL = Limits()


def short(steps: int) -> Case:
    return replace(named("default"), steps=named("default").steps[:steps])


def plain(pool: processes.Pool, *cases: Case) -> list[processes.Answer[Run]]:
    return list(pool.each(run_case, [(case,) for case in cases]))


def use(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have temporary files in a folder, but sockets elsewhere: their paths have 107 characters."""
    multiprocessing.util.get_temp_dir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))


MISDEEDS: dict[str, tuple[Limits, str | None]] = {
    "crash": (USUAL, r"the process crashed \(SIGSEGV\)"),
    "hang": (USUAL, r"no answer within 5 s \(--time-limit\); the process was ended"),
    "discard": (USUAL, r"FmuError: DoesDiscard\.fmu: [^\n]*discarded[^\n]*"),
    "raise": (USUAL, r"FmuError: DoesRaise\.fmu: [^\n]*had enough[^\n]*"),
    "eat": (Limits(memory=0.5), r"FmuError: DoesEat\.fmu: fmi2DoStep[^\n]* failed[^\n]*"),
    "print": (USUAL, None),
    "log": (USUAL, None),
}


@linux
@pytest.mark.parametrize("what", MISDEEDS)
def test_a_misdeed_of_an_fmu_is_an_answer_and_the_next_task_gets_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    limits, words = MISDEEDS[what]
    fmu, seconds = misbehaving(what).path, 5.0 if what == "hang" else 60.0
    use(tmp_path, monkeypatch)
    with processes.Pool(1, seconds, partial(FmuFile, fmu), limits=limits) as p:
        before, during, after = plain(p, short(2), short(3), short(2))
    for answer in (before, after):
        assert answer.value is not None
        assert answer.value.outputs["x"].tolist() == [0.0, 0.0]
    if during.value is None:
        assert re.fullmatch(words or "no failure", during.failure or "")
        assert during.late is (what == "hang")
    else:
        assert words is None
        # Of a hundred megabytes in the log few are kept.
        kept = 1000 * [200 * "moving on "] if what == "log" else []
        assert list(during.value.messages) == kept
    assert not list(tmp_path.iterdir())


def leave(_: object) -> None:
    os._exit(3)


def answer_with_anything(_: object, *begin: bytes) -> None:
    for each in gc.get_objects():
        if isinstance(each, Connection):
            for half in begin:
                os.write(each.fileno(), half)
            if not begin:
                each.send("everything passed")
    time.sleep(60.0)


def answer_by_half(fmu: object) -> None:
    answer_with_anything(fmu, b"\0\0\xff\xff half")


def leave_a_child_with_all_that_was_open(_: object) -> None:
    if os.fork() == 0:
        os.setsid()
        time.sleep(300.0)
    os.kill(os.getpid(), signal.SIGABRT)


def eat_in_children(_: object) -> None:
    for _ in range(4):
        if os.fork() == 0:
            break
    eaten = b"a" * 250_000_000
    time.sleep(60.0 + len(eaten) % 2)


@linux
@pytest.mark.parametrize(
    ("task", "told"),
    [
        (leave, "the process ended by itself with exit code 3"),
        (answer_with_anything, "the process gave no readable answer"),
        (answer_by_half, "the process gave half an answer and was ended"),
        (leave_a_child_with_all_that_was_open, "the process crashed (SIGABRT)"),
        (eat_in_children, "the process was ended: the FMU had more memory than --memory gives"),
    ],
)
def test_a_process_that_is_lost_costs_its_task(
    monkeypatch: pytest.MonkeyPatch, task: Callable[[object], None], told: str
) -> None:
    monkeypatch.setattr(processes, "LONGEST_SILENCE", 1)
    limits = Limits(memory=0.8)
    with processes.Pool(1, fmu=partial(FmuFile, misbehaving("raise").path), limits=limits) as pool:
        (lost,) = pool.each(task, [()])
        (after,) = plain(pool, short(2))
    assert lost.failure == told
    assert after.value is not None


def lives(process: int) -> bool:
    try:
        text = Path(f"/proc/{process}/stat").read_text(encoding="utf-8")
    except FileNotFoundError:
        return False
    return text.rpartition(")")[2].split()[0] != "Z"


@linux
def test_a_daemon_of_an_fmu_ends_with_the_pool(tmp_path: Path) -> None:
    notes = tmp_path / "notes.txt"
    with processes.Pool(2, fmu=partial(FmuFile, misbehaving(f"daemon {notes}").path)) as pool:
        assert all(answer.value is not None for answer in plain(pool, short(3), short(3)))
        daemons = [int(line) for line in notes.read_text(encoding="utf-8").split()]
        assert list(map(lives, daemons)) == [True, True]
    assert not any(map(lives, daemons))


SUITE = """\
import os, sys
from pathlib import Path
from tests.verification.test_hostile import FmuFile, partial, plain, processes, short

if __name__ == "__main__":
    with processes.Pool(1, fmu=partial(FmuFile, Path(sys.argv[1]))) as pool:
        print(plain(pool, short(3))[0].failure, flush=True)
        if sys.argv[2:]:
            os.kill(os.getpid(), 9)
"""


def suite(folder: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    script = folder.parent / f"{folder.name}.py"
    script.write_text(SUITE, encoding="utf-8")
    env = {**os.environ, "PYTHONPATH": str(Path.cwd()), "TMPDIR": str(folder)}
    return run(sys.executable, script, *arguments, env=env, timeout=120)


@linux
def test_a_daemon_ends_when_the_suite_is_killed(tmp_path: Path) -> None:
    notes = tmp_path / "notes.txt"
    ended = suite(tmp_path, misbehaving(f"daemon {notes}").path, "killed")
    assert ended.returncode == -signal.SIGKILL
    (daemon,) = map(int, notes.read_text(encoding="utf-8").split())
    last = time.monotonic() + 30.0
    while lives(daemon) and time.monotonic() < last:
        time.sleep(0.05)
    assert not lives(daemon)


def test_an_fmu_that_hangs_everywhere_costs_its_budget_and_keeps_what_was_finished() -> None:
    cases = [named(name) for name in ("one-step", "default", "heavy", "reversals", "tuned")]
    limits = Limits(budget=6.0)
    options: dict[str, Any] = {"jobs": 2, "limits": limits, "long_probes": False}
    verdict = verify(misbehaving("hang").path, cases, contract="exact", **options)
    ends = {r.case: r for r in verdict.checks if r.check == "runs-to-the-end" and r.side == "fmu"}
    assert ends["one-step"].passed
    for case in cases[1:]:
        failure = ends[case.id].failure or ""
        assert failure.startswith("not finished: runs without a result took 6 s")
    assert not verdict.passed


def slow(_: object, seconds: float) -> float:
    time.sleep(seconds)
    return seconds


def test_only_runs_without_a_result_spend_the_budget() -> None:
    opened = partial(FmuFile, misbehaving("raise").path)
    with processes.Pool(1, fmu=opened, limits=Limits(budget=8.0)) as pool:
        for _ in range(3):
            (answer,) = pool.each(slow, [(3.0,)])
            assert answer == processes.Answer(3.0)
        (late,) = pool.each(slow, [(60.0,)])
    assert late.late


def test_a_description_that_takes_too_long_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = '<ScalarVariable name="q" valueReference="1" causality="foo"><Real/></ScalarVariable>'
    many = edited(("</ModelVariables>", f"{50_000 * wrong}</ModelVariables>"))
    path = altered(SLIDER.path, tmp_path / "long.fmu", many)
    monkeypatch.setattr(processes, "TIME_LIMIT", 2.0)
    with pytest.raises(FmuError, match="its description cannot be read: no answer within 2 s"):
        verify(path, [named("one-step")], jobs=1, time_limit=2.0)


def test_a_pool_that_is_left_ends_what_still_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fmu = misbehaving("hang").path
    use(tmp_path, monkeypatch)

    def interrupted() -> None:
        with processes.Pool(1, fmu=partial(FmuFile, fmu)) as pool:
            next(pool.each(run_case, [(short(2),), (short(3),)]))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert not list(tmp_path.iterdir())


def test_prints_stay_in_the_process_and_folders_may_have_long_names(tmp_path: Path) -> None:
    folder = tmp_path / ("ü" * 100) / ("b" * 200)
    folder.mkdir(parents=True)
    run = suite(folder, misbehaving("print").path)
    assert (run.stdout, run.stderr, run.returncode) == ("None\n", "", 0)
    assert not list(folder.iterdir())
