"""Studies on a dask cluster: a real scheduler and its workers, on the loopback interface."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from stickslip_design.chunks import Progress, StudyError, run
from tests.design.chunks.toy import Toy, same, times_computed
from tests.needs import ROOT, needs

pytestmark = [needs("cluster"), pytest.mark.gate]


class Dask:
    """The processes of a scheduler and its workers, and its address."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.workers: list[subprocess.Popen[bytes]] = []
        file = folder / "scheduler.json"
        self.scheduler = self._start(
            *("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file))
        )
        # The file is there before it is written.
        while not (file.exists() and file.read_text(encoding="utf-8").rstrip().endswith("}")):
            assert self.scheduler.poll() is None
            time.sleep(0.02)
        self.address: str = json.loads(file.read_text(encoding="utf-8"))["address"]

    def add_worker(self, threads: int = 1) -> None:
        options = ("--nthreads", str(threads), "--no-nanny", "--local-directory", str(self._folder))
        self.workers.append(self._start("worker", self.address, *options))

    def _start(self, what: str, *options: str) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{what}", *options, "--no-dashboard"],
            env={**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def end(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


@contextmanager
def started(folder: Path) -> Iterator[Dask]:
    """Give a scheduler; it and its workers end with the block."""
    dask = Dask(folder)
    try:
        yield dask
    finally:
        dask.end()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Dask]:
    with started(tmp_path_factory.mktemp("dask")) as dask:
        dask.add_worker()
        dask.add_worker()
        yield dask


def test_an_error_on_a_worker_ends_the_study_in_the_line_of_this_machine(cluster: Dask) -> None:
    words = r"^points \d+ to \d+: ZeroDivisionError: of point 70, with a line more$"
    with pytest.raises(StudyError, match=words):
        run(Toy(raises=70), cluster=cluster.address)


def test_a_killed_worker_leaves_the_results_as_they_are_and_costs_its_open_chunks(
    cluster: Dask, tmp_path: Path, marks: Path
) -> None:
    def disturb(progress: Progress) -> None:
        if progress.done > 1000:
            cluster.workers[0].kill()

    study = Toy(4000, pace=1e-3, marks=marks)
    results = run(study, str(tmp_path / "study"), cluster=cluster.address, progress=disturb)
    assert cluster.workers[0].wait() == -9
    assert same(results, run(Toy(4000), workers=1))
    times = times_computed(marks)
    assert len(times) == 4000
    # Two chunks of a second: one that it computed, one that waited.
    assert sum(times.values()) - 4000 <= 2 * 1000


def test_what_a_scheduler_lacks_is_noted_and_its_end_too(tmp_path: Path) -> None:
    with started(tmp_path) as dask:
        notes: list[str] = []

        def show(progress: Progress) -> None:
            if progress.note and progress.note not in notes:
                notes.append(progress.note)
                if len(notes) == 1:
                    dask.add_worker(threads=2)
            if progress.done and len(notes) == 2:
                dask.scheduler.kill()

        with pytest.raises(StudyError) as ended:
            run(Toy(pace=5e-3), str(tmp_path / "study"), cluster=dask.address, progress=show)
    assert "has no workers: waiting; dask worker tcp://127.0.0.1:" in notes[0]
    assert "workers of several threads, which compute one chunk at a time" in notes[1]
    assert str(ended.value) == (
        f"the scheduler {dask.address} has ended; what is computed is kept, and the study resumes"
    )
    assert list((tmp_path / "study").glob("*.chunk"))


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("tcp://127.0.0.1:1", "answers at tcp://127.0.0.1:1 in 4.5 s: "),
        ("localhost", "answers at localhost in 4.5 s: ValueError: missing port number"),
    ],
)
def test_an_unreachable_scheduler_is_named_and_nothing_written(
    tmp_path: Path, address: str, words: str
) -> None:
    with pytest.raises(StudyError, match=f"no dask scheduler {words}"):
        run(Toy(), str(tmp_path / "study"), cluster=address)
    assert not list(tmp_path.iterdir())
