"""The result of a task in another process: a value, or the reason why there is none."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from stickslip_verification.drive.fmu.errors import NotApplicableError

T = TypeVar("T")


@dataclass(frozen=True)
class Answer(Generic[T]):
    """The value of a task, its error on one line, or what the FMU lacks for it.

    ``late`` is a task that failed by its time limit.
    """

    value: T | None = None
    failure: str | None = None
    not_applicable: str | None = None
    late: bool = False


def answer_of(task: Callable[..., T], *arguments: Any) -> Answer[T]:
    """Do a task in this process; what it raises is an answer."""
    try:
        return Answer(task(*arguments))
    except NotApplicableError as error:
        return Answer(not_applicable=str(error))
    except MemoryError:
        return Answer(failure="MemoryError: more memory than --memory gives")
    except (Exception, SystemExit, KeyboardInterrupt) as error:
        # Code that a fault brings along may try to leave; Ctrl-C does not reach this process.
        return Answer(failure=reason(error))


def discard_prints() -> None:
    """Discard what this process prints, and an FMU in it."""
    with Path(os.devnull).open("wb") as nowhere:
        for stream in (1, 2):
            os.dup2(nowhere.fileno(), stream)


def reason(error: BaseException) -> str:
    """Return kind and text of an error on one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"
