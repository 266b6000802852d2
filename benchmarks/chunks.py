"""What a chunk of a study costs beyond its points."""

import json
import os
import pickle
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path

from benchmarks.settings import Busy
from stickslip_design.chunks.crew import Crew, cluster, processes
from stickslip_design.chunks.manifest import STUDY, manifest_of, settle
from stickslip_design.chunks.store import store_of
from stickslip_design.chunks.study import Chunk
from stickslip_design.chunks.work import Done, Job, compute

CHUNKS = 1000
AHEAD = 8
"""Chunks that wait: the time of a chunk is then that of the slowest part, and no round trip."""
ROOT = Path(__file__).parents[1]


def measure_chunks() -> tuple[float, float, float]:
    """Return the time of a chunk without work [s]: here, in a worker process, in a dask worker."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        study = Busy(CHUNKS)
        store = store_of(str(folder / "study"))
        (folder / "study").mkdir()
        manifest = manifest_of(study)
        settle(store, manifest, fresh=False)
        content = pickle.dumps(study)
        store.write(STUDY, content)
        job = Job(store.address, manifest.key, sha256(content).hexdigest())
        chunks = [Chunk(start, start + 1) for start in range(CHUNKS)]
        begin = time.perf_counter()
        for chunk in chunks:
            compute(store, study, job.key, chunk)
        here = (time.perf_counter() - begin) / CHUNKS
        with processes(1) as crew:
            process = _time_of_a_chunk(crew, job, chunks, 1)
        with _dask(folder) as address, cluster(address) as crew:
            dask = _time_of_a_chunk(crew, job, chunks, AHEAD)
        return here, process, dask


def _time_of_a_chunk(crew: Crew, job: Job, chunks: list[Chunk], ahead: int) -> float:
    """Return the time of a chunk [s] while up to `ahead` are given, without the first ones."""
    crew.give(job, chunks[0])
    while not crew.answers(1.0):
        pass
    given = done = 1
    begin = time.perf_counter()
    while done < len(chunks):
        while given < min(done + ahead, len(chunks)):
            crew.give(job, chunks[given])
            given += 1
        for answer in crew.answers(1.0):
            assert isinstance(answer, Done), answer
            done += 1
    return (time.perf_counter() - begin) / (len(chunks) - 1)


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
