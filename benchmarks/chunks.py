"""What a chunk of a study costs beyond its points."""

import json
import os
import pickle
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from pathlib import Path

from benchmarks.settings import Busy
from stickslip_design.chunks.run import cluster_of, processes
from stickslip_design.chunks.store import Chunk, Done, Store, begun, compute, manifest_of, work
from stickslip_design.datasets import digest_of

CHUNKS = 1000
AHEAD = 8
"""Chunks that wait: the time of a chunk is then that of the slowest part, and no round trip."""
ROOT = Path(__file__).parents[1]


def measure_chunks() -> tuple[float, float, float]:
    """Return the time of a chunk without work [s]: here, in a worker process, in a dask worker."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        study = Busy(CHUNKS)
        store, manifest = Store(str(folder / "study")), manifest_of(study)
        of = store.address, digest_of(manifest)
        chunks = [Chunk(start, start + 1) for start in range(CHUNKS)]
        with begun(store, manifest, fresh=False):
            store.write("study.pickle", pickle.dumps(study))
            begin = time.perf_counter()
            for chunk in chunks:
                compute(store, study, digest_of(manifest), chunk)
            here = (time.perf_counter() - begin) / CHUNKS
            with processes(1)[0]() as workers:
                process = _time_of_a_chunk(workers, of, chunks, 1)
            with _dask(folder) as address, cluster_of(address) as (make, _), make() as workers:
                dask = _time_of_a_chunk(workers, of, chunks, AHEAD)
        return here, process, dask


def _time_of_a_chunk(
    workers: Executor, of: tuple[str, str], chunks: list[Chunk], ahead: int
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
