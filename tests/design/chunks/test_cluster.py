"""Studies on a dask cluster: a real scheduler and its workers, on the loopback interface."""

import importlib
import json
import os
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from stickslip_design.chunks import Progress, StudyError, manifest, run
from tests.needs import ROOT, needs

from .toy import Toy, same, times_computed

pytestmark = needs("cluster")


class Dask:
    """A scheduler and its workers.

    Attributes
    ----------
    address
        That of the scheduler.
    scheduler, workers
        Their processes.
    """

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
        """Start a worker."""
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
        """Kill all of its processes."""
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
    """Give a scheduler with two workers."""
    with started(tmp_path_factory.mktemp("dask")) as dask:
        dask.add_worker()
        dask.add_worker()
        yield dask


@pytest.mark.usefixtures("_short_chunks")
def test_an_error_on_a_worker_ends_the_study_in_one_line(cluster: Dask) -> None:
    """The same line as on this machine."""
    with pytest.raises(
        StudyError,
        match=r"^points \d+ to \d+: ZeroDivisionError: of point 70, with a line more$",
    ):
        run(Toy(pace=1e-3, raises=70), cluster=cluster.address)


def test_a_worker_of_other_versions_is_named(
    cluster: Dask, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With both versions."""
    there = manifest.versions_here()["numpy"]
    ours = {**manifest.versions_here(), "numpy": "0.1"}
    monkeypatch.setattr(manifest, "versions_here", lambda: ours)
    with pytest.raises(
        StudyError,
        match=rf"the worker on .* \(process \d+\): has numpy {there}, and .* begun with 0\.1$",
    ):
        run(Toy(), cluster=cluster.address)


def test_a_worker_that_does_not_see_the_folder_is_told(cluster: Dask) -> None:
    """As that of an address in the memory of one process."""
    with pytest.raises(StudyError, match=r"the worker on .* does not see the study in memory://"):
        run(Toy(), "memory://unseen", cluster=cluster.address)


@pytest.mark.usefixtures("_short_chunks")
def test_a_killed_worker_leaves_the_results_as_they_are(
    cluster: Dask, tmp_path: Path, marks: Path
) -> None:
    """To the bit, as computed on one core undisturbed; only its open chunks are computed again."""
    workers = cluster.workers

    def disturb(progress: Progress) -> None:
        if progress.done > 1000:
            workers[0].kill()

    study = Toy(4000, pace=1e-3, marks=marks)
    results = run(study, str(tmp_path / "study"), cluster=cluster.address, progress=disturb)
    assert workers[0].wait() == -9
    assert same(results, run(Toy(4000), workers=1))
    again = [point for point, times in times_computed(marks).items() if times > 1]
    assert len(again) <= 2 * 50
    assert run(study, str(tmp_path / "study"), workers=1).count == 4000
    assert sum(times_computed(marks).values()) == 4000 + len(again)


def test_what_a_scheduler_lacks_is_told_and_its_end_too(tmp_path: Path) -> None:
    """Workers at all, workers of one thread; and what is computed is kept."""
    with started(tmp_path) as dask:
        told: list[str] = []

        def show(progress: Progress) -> None:
            if progress.note and progress.note not in told:
                told.append(progress.note)
                if len(told) == 1:
                    dask.add_worker(threads=2)
            if progress.done and len(told) == 2:
                dask.scheduler.kill()

        with pytest.raises(StudyError) as ended:
            run(Toy(pace=5e-3), str(tmp_path / "study"), cluster=dask.address, progress=show)
    assert "has no workers: waiting; dask worker tcp://127.0.0.1:" in told[0]
    assert "workers of several threads, which compute one chunk at a time" in told[1]
    assert str(ended.value) == (
        f"the scheduler {dask.address} has ended; what is computed is kept, and the study resumes"
    )
    assert list((tmp_path / "study").glob("*.chunk"))


@pytest.mark.parametrize(
    ("address", "told"),
    [
        ("tcp://127.0.0.1:1", "no dask scheduler answers at tcp://127.0.0.1:1: Connection refused"),
        ("tcp://no.invalid:8786", r"no dask scheduler answers at tcp://no\.invalid:8786: .+"),
        ("localhost", "'localhost' is no address of a scheduler, such as tcp://host:8786"),
        ("tcp://host:port", "'tcp://host:port' is no address of a scheduler"),
    ],
)
def test_an_unreachable_scheduler_is_told_soon(tmp_path: Path, address: str, told: str) -> None:
    """Within 10 s, and nothing is written."""
    begun = time.monotonic()
    with pytest.raises(StudyError, match=told):
        run(Toy(), str(tmp_path / "study"), cluster=address)
    assert time.monotonic() - begun < 10.0
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("greeting", "told"),
    [(b"", "nothing comes within 1 s"), (b"HTTP/1.1 400 Bad", "another kind of server does")],
)
def test_another_kind_of_server_is_told(
    monkeypatch: pytest.MonkeyPatch, greeting: bytes, told: str
) -> None:
    """One that says nothing by itself, and one that says something else."""
    crew = importlib.import_module("stickslip_design.chunks.crew")
    monkeypatch.setattr(crew, "_PATIENCE", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = "tcp://{}:{}".format(*server.getsockname())
        taken: list[socket.socket] = []

        def greet() -> None:
            connection, _ = server.accept()
            connection.sendall(greeting)
            taken.append(connection)

        thread = threading.Thread(target=greet)
        thread.start()
        try:
            with pytest.raises(StudyError, match=told):
                run(Toy(), cluster=address)
        finally:
            thread.join()
            taken[0].close()
