"""A study that can be slow, end its worker, hang, raise, or find the disk full."""

import os
import resource
import signal
import threading
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from multiprocessing import parent_process
from pathlib import Path
from typing import Any

import numpy as np

from stickslip_design.chunks import Columns, Results

_ALONE = threading.Lock()


@dataclass(frozen=True)
class Toy:
    """A study of `count` points, which refuses chunks off its quantum and a second thread.

    `marks` gets a file for each chunk. In workers `kills` chunks end theirs, one `hangs`.
    """

    count: int = 1000
    quantum: int = 4
    seed: int = 1
    pace: float = 0.0
    pace_of_workers: float = 0.0
    marks: Path | None = None
    kills: int = 0
    hangs: bool = False
    raises: int | None = None
    largest: int | None = None

    @property
    def identity(self) -> Mapping[str, Any]:
        return {"toy": {"seed": self.seed, "over": [*range(1, 100), self.count]}}

    def compute(self, start: int, stop: int) -> Columns:
        assert start % self.quantum == 0
        assert stop % self.quantum == 0 or stop == self.count
        assert _ALONE.acquire(blocking=False)
        try:
            return self._computed(start, stop)
        finally:
            _ALONE.release()

    def _computed(self, start: int, stop: int) -> Columns:
        if self.raises is not None and start <= self.raises < stop:
            raise ZeroDivisionError(f"of point {self.raises},\nwith a line more")
        if parent_process() is not None:
            self._go_wrong()
        time.sleep(
            (self.pace if parent_process() is None else self.pace_of_workers) * (stop - start)
        )
        if self.marks is not None:
            (self.marks / f"{start}-{stop}-{os.getpid()}-{time.monotonic_ns()}").touch()
        points = np.arange(start, stop)
        return {
            "x": np.sin(1.7 * points + self.seed),
            "n": points % 5,
            "failure": np.array([failure(point) for point in range(start, stop)]),
        }

    def _go_wrong(self) -> None:
        if self.hangs and self.marks is not None:
            (self.marks / "hangs").touch()
            time.sleep(300.0)
        if self.largest is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (self.largest, resource.RLIM_INFINITY))
        if self.marks is not None and len(list(self.marks.glob("killed*"))) < self.kills:
            (self.marks / f"killed {os.getpid()}").touch()
            os.kill(os.getpid(), signal.SIGKILL)


def failure(point: int) -> str:
    """Return why a point has no result: every hundredth, in a text as long as the point is late."""
    return "" if point % 100 else "failed" + "!" * (point // 100)


def times_computed(marks: Path) -> Counter[int]:
    ranges = [file.name.split("-")[:2] for file in marks.glob("*-*-*")]
    return Counter(point for start, stop in ranges for point in range(int(start), int(stop)))


def processes(marks: Path) -> set[int]:
    return {int(file.name.split("-")[2]) for file in marks.glob("*-*-*")}


def same(results: Results, others: Results) -> bool:
    """Tell whether two studies have the same results, to the bit."""
    mine, theirs = results.read(), others.read()
    return list(mine) == list(theirs) and all(
        mine[name].dtype == theirs[name].dtype and mine[name].tobytes() == theirs[name].tobytes()
        for name in mine
    )
