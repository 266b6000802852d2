"""Travels in the recording FMU: writes down every call of its slave, and changes none.

One line of JSON for each call, to the file that the environment variable STICKSLIP_CALLS names:
which instance, method, arguments, answer. JSON keeps every digit of a double. It runs on every
Python that the FMU runs on.
"""

from __future__ import annotations

import functools
import itertools
import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

METHODS = (
    "setup_experiment",
    "enter_initialization_mode",
    "exit_initialization_mode",
    "do_step",
    "terminate",
    *(f"{way}_{kind}" for way in ("get", "set") for kind in ("real", "integer", "boolean")),
    "get_string",
    "set_string",
    "_get_fmu_state",
    "_set_fmu_state",
)

_numbers = itertools.count()


def watch(slave: Any) -> None:
    """Watch the methods of a slave's class that the wrapper calls, and the making of instances."""
    if "made_as" in vars(slave):  # the file that calls this is executed at each instantiation
        return
    slave.made_as = None
    make = slave.__init__

    @functools.wraps(make)
    def made(self: Any, **arguments: Any) -> None:
        make(self, **arguments)
        self.made_as = f"{os.getpid()}-{next(_numbers)}"
        _write(self.made_as, "make", [arguments.get("instance_name", "")], None)

    slave.__init__ = made
    for name in METHODS:
        setattr(slave, name, _watched(name, getattr(slave, name)))


def _watched(name: str, method: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(method)
    def called(self: Any, *arguments: Any) -> Any:
        try:
            answer = method(self, *arguments)
        except BaseException:
            _write(self.made_as, name, [], "failed")
            raise
        if name.endswith("fmu_state"):
            _write(self.made_as, name, [], None)
        else:
            _write(self.made_as, name, arguments, answer)
        return answer

    return called


def _write(instance: str, name: str, arguments: Sequence[Any], answer: Any) -> None:
    line = json.dumps([instance, name, list(arguments), answer]) + "\n"
    # One write to a file that is open for appending keeps lines of several processes whole.
    with Path(os.environ["STICKSLIP_CALLS"]).open("ab", buffering=0) as stream:
        stream.write(line.encode())
