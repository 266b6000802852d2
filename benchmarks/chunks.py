"""What a chunk of a study costs beyond its points, and how well two workers share the work."""

import json
import os
import pickle
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Iterator, Mapping
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stickslip_design.chunks import Columns, run
from stickslip_design.chunks.chunk import packed
from stickslip_design.chunks.executors import Workers, cluster, processes
from stickslip_design.chunks.manifest import STUDY, begun, manifest_of
from stickslip_design.chunks.store import store_of
from stickslip_design.chunks.study import Chunk
from stickslip_design.chunks.work import Done, compute, work

CHUNKS = 1000
AHEAD = 8
"""Chunks that wait: the time of a chunk is then that of the slowest part, and no round trip."""
POINTS = 4000
ROOT = Path(__file__).parents[1]


@dataclass(frozen=True)
class Busy:
    """A study whose points keep a core busy.

    Attributes
    ----------
    count
        Number of points.
    work
        Sines of 1000 numbers that a point takes; 4 us each.
    """

    count: int
    work: int = 0
    quantum: int = 1

    @property
    def identity(self) -> Mapping[str, Any]:
        """The results depend on the work alone."""
        return {"work": self.work}

    def compute(self, start: int, stop: int) -> Columns:
        """Return a number a point."""
        x = np.linspace(0.0, 1.0, 1000)
        sums = np.zeros(stop - start)
        for index in range(stop - start):
            for _ in range(self.work):
                sums[index] += np.sin(x * (start + index)).sum()
        return {"x": sums}


@dataclass(frozen=True)
class Overhead:
    """Seconds of a chunk without work, by who computes it; bytes of its file without data."""

    here: float
    process: float
    dask: float
    file: int


def measure_overhead() -> Overhead:
    """Measure what a chunk costs: here, in one worker process, and in one dask worker."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        study = Busy(CHUNKS)
        store, manifest = store_of(str(folder / "study")), manifest_of(study)
        store.write(STUDY, pickle.dumps(study))
        of = store.address, manifest.key
        chunks = [Chunk(start, start + 1) for start in range(CHUNKS)]
        with begun(store, manifest, fresh=False):
            begin = time.perf_counter()
            for chunk in chunks:
                compute(store, study, manifest.key, chunk)
            here = (time.perf_counter() - begin) / CHUNKS
            with processes(1) as workers:
                process = _time_of_a_chunk(workers, of, chunks, 1)
            with _dask(folder) as address, cluster(address) as workers:
                dask = _time_of_a_chunk(workers, of, chunks, AHEAD)
        size = len(packed(chunks[0], manifest.key, study.compute(0, 1))) - np.float64().nbytes
        return Overhead(here, process, dask, size)


def _time_of_a_chunk(
    workers: Workers, of: tuple[str, str], chunks: list[Chunk], ahead: int
) -> float:
    """Return the time of a chunk [s] while up to `ahead` are given, without the first ones."""
    first, *others = chunks
    workers.submit(work, *of, first).result()
    given = deque[Future[Done]]()
    begin = time.perf_counter()
    for chunk in others:
        if len(given) == ahead:
            given.popleft().result()
        given.append(workers.submit(work, *of, chunk))
    for future in given:
        future.result()
    return (time.perf_counter() - begin) / len(others)


@contextmanager
def _dask(folder: Path) -> Iterator[str]:
    """Start a dask scheduler and a worker of one thread; give the address."""
    file = folder / "scheduler.json"
    module = "distributed.cli.dask_"
    options = ("--no-dashboard", "--scheduler-file", str(file))
    started: list[subprocess.Popen[bytes]] = []
    try:
        for what, more in (
            ("scheduler", ("--host", "127.0.0.1", "--port", "0")),
            ("worker", ("--nthreads", "1", "--local-directory", str(folder))),
        ):
            started.append(
                subprocess.Popen(
                    [sys.executable, "-m", f"{module}{what}", *options, *more],
                    env={**os.environ, "PYTHONPATH": str(ROOT)},
                    stderr=subprocess.DEVNULL,
                )
            )
            while not file.exists():
                time.sleep(0.05)
        yield json.loads(file.read_text(encoding="utf-8"))["address"]
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait()


def measure_sharing() -> tuple[float, float]:
    """Return the time of a study of some 30 s [s], in this process and by two workers.

    Its chunks take a second; the start of the workers is in the time.
    """
    study = Busy(POINTS, work=1000)
    times = []
    for workers in (1, 2):
        begin = time.perf_counter()
        run(study, workers=workers)
        times.append(time.perf_counter() - begin)
    return times[0], times[1]
