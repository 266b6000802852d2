"""Plays calls in a process that has FMUs and not the project."""

import sys
from typing import Any

from tests.driver import Refused, loaded

MARK = "=== calls"


def heard(path: str, lists: list[list[list[Any]]]) -> list[list[Any]]:
    """Make the calls of each list on a new instance, up to the first one that is refused.

    A call is the name of a method of `Instance` and its arguments, a dictionary at the end being
    values by name. Returns of each list how many calls were taken, and the messages in the log;
    standard error has a line MARK before what each list writes there.
    """
    fmu = loaded(path)
    found = []
    for calls in lists:
        fmu.messages.clear()
        print(MARK, file=sys.stderr, flush=True)
        instance, taken = fmu.instance(), 0
        for name, *arguments in calls:
            values = arguments.pop() if arguments and isinstance(arguments[-1], dict) else {}
            try:
                getattr(instance, name)(*arguments, **values)
            except Refused:
                break
            taken += 1
        instance.free()
        found.append([taken, [text for *_, text in fmu.messages]])
    return found


def live_blocks(path: str) -> int:
    return int(loaded(path).library.live_blocks())
