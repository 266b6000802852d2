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
    """How far a study is: of `count` points are `done`, of these `failed` without a result.

    It takes `seconds` by now, without the points that an earlier run `kept`; a `note` says what the
    person should know, such as a cluster without workers.
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


def reason(error: BaseException) -> str:
    """Return what an exception says, in one line; an `OSError` of a file names it."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    text = " ".join(str(error).split())
    if isinstance(error, StudyError):
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
