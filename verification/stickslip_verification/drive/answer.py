"""The result of a task in another process: a value, or the reason why there is none."""

from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True)
class Answer(Generic[T]):
    """The result of a task.

    Attributes
    ----------
    value
        Its value; None if there is none.
    failure
        The error on one line; None if there was none.
    not_applicable
        What the FMU lacks for the task; None if it lacks nothing.
    late
        Whether the task failed by its time limit.
    """

    value: T | None = None
    failure: str | None = None
    not_applicable: str | None = None
    late: bool = False
