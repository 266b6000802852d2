"""What comes back from a task that was done elsewhere: a value, or why there is none."""

from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True)
class Answer(Generic[T]):
    """What came of a task.

    ``failure`` is what went wrong, ``not_applicable`` what the FMU lacks for it; both None where
    there is a value. ``late`` tells that it failed for time alone.
    """

    value: T | None = None
    failure: str | None = None
    not_applicable: str | None = None
    late: bool = False
