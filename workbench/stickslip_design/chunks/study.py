"""What a study of many points is, for those who compute it and those who write one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

Columns: TypeAlias = dict[str, NDArray[np.generic]]
"""Results by name: arrays of one number, or text, a point."""


class StudyError(ValueError):
    """A study cannot be computed, or not to its end; the message is one line that says why."""


class Study(Protocol):
    """A study of many points; it is pickled to the workers.

    Each point is computed from the study and its number alone, so that the result does not depend
    on chunks, workers or order.
    """

    @property
    def count(self) -> int:
        """How many points there are; their numbers are 0 to count - 1."""

    @property
    def quantum(self) -> int:
        """A chunk is a multiple of so many points, but for the last one."""

    @property
    def identity(self) -> Mapping[str, Any]:
        """All that the results depend on, but for versions: JSON. Digests stand for files."""

    def compute(self, start: int, stop: int) -> Columns:
        """Return the results of the points from `start` up to but not including `stop`.

        A column `failure`, where there is one, is a text: the reason why a point has no result,
        empty where it has one.
        """


@dataclass(frozen=True)
class Progress:
    """How far a study is.

    Attributes
    ----------
    done, count
        Points that have been computed, of how many.
    failed
        Points without a result.
    seconds
        Time since this run began [s].
    kept
        Points that an earlier run had computed; they are done.
    note
        What the person should know, such as a cluster without workers; empty as a rule.
    """

    done: int
    count: int
    failed: int
    seconds: float
    kept: int = 0
    note: str = ""


class Chunk(NamedTuple):
    """The points from `start` up to but not including `stop`."""

    start: int
    stop: int

    @property
    def points(self) -> int:
        """How many they are."""
        return self.stop - self.start

    def __str__(self) -> str:
        return f"points {self.start} to {self.stop - 1}"
