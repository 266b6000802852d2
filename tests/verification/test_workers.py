"""Processes that hold an FMU: what crashes, hangs or prints there stays there."""

import multiprocessing.util
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stickslip_verification.drive import workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.fmu.names import NameMap, load_names
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.invariants import load_invariants

from .foreign import building
from .records import exact_of, named

INVARIANTS = {invariant.id: invariant for invariant in load_invariants()}


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the temporary folder that this process uses."""
    # Its sockets stay elsewhere: the path of one may have 107 characters.
    multiprocessing.util.get_temp_dir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def left_in(folder: Path) -> list[str]:
    """Return what lies in a folder."""
    return [entry.name for entry in folder.iterdir()]


def short(steps: int) -> Case:
    """Return the first steps of a case."""
    return replace(named("default"), steps=named("default").steps[:steps])


def plain(pool: workers.Pool, *cases: Case) -> list[Answer[Run]]:
    """Return the answers to plain runs of cases."""
    return list(pool.each(workers.plain_run, [(case,) for case in cases]))


def test_a_crash_is_an_answer_and_the_next_task_gets_one(
    misbehaving: Callable[[str], Path], temporary: Path
) -> None:
    """A process that an FMU crashes takes its task with it, and is replaced."""
    with workers.Pool(1, fmu=misbehaving("crash")) as pool:
        before, crashed, after = plain(pool, short(2), short(3), short(2))
        assert left_in(temporary)
    assert crashed == Answer(failure="the process crashed (SIGSEGV)")
    for answer in (before, after):
        assert answer.value is not None
        assert answer.value.outputs["x"].tolist() == [0.0, 0.0]
    assert left_in(temporary) == []


def test_a_hang_is_an_answer_and_the_next_task_gets_one(
    misbehaving: Callable[[str], Path], temporary: Path
) -> None:
    """A task that takes too long is ended with its process, and is told as late."""
    with workers.Pool(1, time_limit=5.0, fmu=misbehaving("hang")) as pool:
        hung, after = plain(pool, short(3), short(2))
    assert hung == Answer(failure="no answer within 5 s; the process was ended", late=True)
    assert after.value is not None
    assert left_in(temporary) == []


@pytest.mark.parametrize("what", ["discard", "raise"])
def test_a_refused_step_is_an_answer_in_one_line(
    misbehaving: Callable[[str], Path], temporary: Path, what: str
) -> None:
    """What an FMU refuses is a failure with its reason, and the process lives on."""
    with workers.Pool(1, fmu=misbehaving(what)) as pool:
        refused, after = plain(pool, short(3), short(2))
    assert refused.failure is not None
    assert refused.failure.startswith(f"FmuError: Does{what.capitalize()}.fmu: ")
    assert "\n" not in refused.failure
    assert not refused.late
    assert after.value is not None


def test_answers_come_in_the_order_of_the_questions(fmu_path: Path) -> None:
    """Two processes at once give each task its own answer, long ones and short ones."""
    names = ["reversals", "one-step", "default", "grazing", "tuned", "fast-pull"]
    with workers.Pool(2, fmu=fmu_path) as pool:
        answers = plain(pool, *map(named, names))
        runs = list(pool.each(workers.other_run, [(named(n), "splitting") for n in names]))
        probes = list(
            pool.each(
                workers.probe, [(INVARIANTS["declared-units"],), (INVARIANTS["refuses-k-zero"],)]
            )
        )
    for name, answer, other in zip(names, answers, runs, strict=True):
        for given in (answer.value, other.value):
            assert given is not None
            exact = exact_of(name).record.outputs["x"]
            assert np.max(np.abs(given.outputs["x"] - exact)) <= 1e-10 * np.max(np.abs(exact))
    assert probes == [Answer([]), Answer([])]


def test_the_truth_and_the_reference_need_no_fmu() -> None:
    """A pool without an FMU gives exact motions and the reference's runs."""
    with workers.Pool(1) as pool:
        (exact,) = pool.each(workers.exact, [(named("grazing"),)])
        (reference,) = pool.each(workers.reference, [(named("grazing"),)])
    assert exact.value is not None
    assert (
        exact.value.record.outputs["x"].tolist() == exact_of("grazing").record.outputs["x"].tolist()
    )
    assert reference.value is not None
    assert (
        reference.value.outputs["n_slips"].tolist()
        == exact_of("grazing").record.outputs["n_slips"].tolist()
    )


def test_a_foreign_fmu_is_known_by_its_names(slider_mm: Path) -> None:
    """The map of names reaches the processes, and what the FMU lacks comes back as an answer."""
    names: NameMap = load_names(building.HERE / "slider_mm.toml")
    with workers.Pool(1, fmu=slider_mm, names=names) as pool:
        given, lacking = plain(pool, named("one-step"), named("damped-cycle"))
    assert given.value is not None
    assert given.value.outputs["n_slips"].tolist() == [31.0]
    assert lacking == Answer(not_applicable="it has no variable c")


def test_what_is_no_fmu_is_an_answer(tmp_path: Path) -> None:
    """A file that cannot be opened fails each task and no process."""
    file = tmp_path / "text.fmu"
    file.write_text("not an FMU", encoding="utf-8")
    with workers.Pool(1, fmu=file) as pool:
        answers = plain(pool, short(1), short(2))
    assert [answer.failure for answer in answers] == [
        f"FmuError: {file}: not an FMU (not a zip archive)"
    ] * 2


def leave(code: int) -> Answer[int]:
    """End the process without a word."""
    os._exit(code)


def test_a_process_that_ends_is_told_by_its_exit_code() -> None:
    """A process that ends by itself is no crash, and its code is told."""
    with workers.Pool(1) as pool:
        (left,) = pool.each(leave, [(3,)])
    assert left == Answer(failure="the process ended by itself with exit code 3")


@contextmanager
def pool_left_at_once(fmu: Path) -> Iterator[None]:
    """Leave a pool while its task still runs."""
    with workers.Pool(1, time_limit=60.0, fmu=fmu) as pool:
        answers = pool.each(workers.plain_run, [(short(2),), (short(3),)])
        next(answers)
        yield


def test_leaving_a_pool_ends_what_still_runs(
    misbehaving: Callable[[str], Path], temporary: Path
) -> None:
    """An FMU that hangs does not keep the suite waiting once it is no longer wanted."""
    with pytest.raises(KeyboardInterrupt), pool_left_at_once(misbehaving("hang")):
        raise KeyboardInterrupt
    assert left_in(temporary) == []


TALKING = """\
import sys
from pathlib import Path
from stickslip_verification.drive import workers
from stickslip_verification.suite.invariants import load_invariants

if __name__ == "__main__":
    invariant = next(each for each in load_invariants().probes if each.id == "warns-of-clamp")
    with workers.Pool(1, fmu=Path(sys.argv[1])) as pool:
        (answer,) = pool.each(workers.probe, [(invariant,)])
    print(answer.value)
"""


def test_what_an_fmu_prints_does_not_reach_the_terminal(fmu_path: Path, tmp_path: Path) -> None:
    """Our FMU warns on standard error; in a worker nobody sees it, and the log still has it."""
    script = tmp_path / "talking.py"
    script.write_text(TALKING, encoding="utf-8")
    run = subprocess.run(
        [sys.executable, script, fmu_path], capture_output=True, text=True, check=False, timeout=60
    )
    assert (run.stdout, run.stderr, run.returncode) == ("[]\n", "", 0)
