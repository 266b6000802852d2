"""A study that can be slow, end its worker, raise, or find the disk full."""

from __future__ import annotations

import os
import signal
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stickslip_design.chunks import Columns, Results


@dataclass(frozen=True)
class Toy:
    """A study of `count` points that depend on the seed.

    Attributes
    ----------
    pace
        Time of a point [s].
    marks
        Folder with a file for each chunk that was computed.
    kills
        A point that ends its process by SIGKILL; only once, where `marks` is given.
    raises
        A point that raises an error.
    largest
        Bytes that a file may have in the process of a chunk; None: no limit.
    """

    count: int = 1000
    quantum: int = 4
    seed: int = 1
    pace: float = 0.0
    marks: Path | None = None
    kills: int | None = None
    raises: int | None = None
    largest: int | None = None

    @property
    def identity(self) -> Mapping[str, Any]:
        """The seed, which the results depend on."""
        return {"toy": {"seed": self.seed, "over": [1, self.count]}}

    def compute(self, start: int, stop: int) -> Columns:
        """Return a number, an integer and the failures of points."""
        if self.largest is not None:
            import resource

            resource.setrlimit(resource.RLIMIT_FSIZE, (self.largest, resource.RLIM_INFINITY))
        if self.kills is not None and start <= self.kills < stop and self._first_time():
            os.kill(os.getpid(), signal.SIGKILL)
        if self.raises is not None and start <= self.raises < stop:
            raise ZeroDivisionError(f"of point {self.raises},\nwith a line more")
        time.sleep(self.pace * (stop - start))
        if self.marks is not None:
            (self.marks / f"{start}-{stop}-{time.monotonic_ns()}").touch()
        points = np.arange(start, stop)
        return {
            "x": np.sin(1.7 * points + self.seed),
            "n": points % 5,
            "failure": np.array([failure(point) for point in range(start, stop)]),
        }

    def _first_time(self) -> bool:
        if self.marks is None:
            return True
        mark = self.marks / "killed"
        here = mark.exists()
        mark.touch()
        return not here


def failure(point: int) -> str:
    """Return why a point has no result: every hundredth, in a text as long as the point is late."""
    return "" if point % 100 else "failed" + "!" * (point // 100)


def times_computed(marks: Path) -> Counter[int]:
    """Return how often each point was computed."""
    ranges = [file.name.split("-") for file in marks.glob("*-*-*")]
    return Counter(point for each in ranges for point in range(int(each[0]), int(each[1])))


def same(results: Results, others: Results) -> bool:
    """Tell whether two studies have the same results, to the bit."""
    mine, theirs = results.read(), others.read()
    return list(mine) == list(theirs) and all(
        mine[name].dtype == theirs[name].dtype and mine[name].tobytes() == theirs[name].tobytes()
        for name in mine
    )
