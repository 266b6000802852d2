"""Tries what may end a process, each time in a copy of this one.

A probe gets the raw functions and returns what it saw; then the process must still be good for
ordinary runs.
"""

import ctypes as c
import json
import os
import resource
import signal
import traceback
from collections.abc import Callable
from typing import Any

from tests.fmu.importer import Importer
from tests.fmu.inside.raw import Raw

Probe = Callable[[Raw], Any]

PROBES: dict[str, tuple[str, Probe]] = {}
"""By name: what the master does, and how it is tried."""

HUGE = 2**62
"""More than there is memory for."""


def probe(title: str) -> Callable[[Probe], Probe]:
    """Count a function among the probes; the title says what the master does."""

    def count(function: Probe) -> Probe:
        PROBES[function.__name__.strip("_")] = title, function
        return function

    return count


def tried(importer: Importer) -> Any:
    """Return of each probe what it does and saw, or the name of the signal that it died of."""
    raw = Raw(importer)
    _run(raw)
    return {name: [title, _apart(raw, each)] for name, (title, each) in PROBES.items()}


def _apart(raw: Raw, each: Probe) -> Any:
    """Run a probe in a copy of this process."""
    ours, theirs = os.pipe()
    process = os.fork()
    if process == 0:
        # It must not go on as the process it is a copy of, whatever happens.
        try:
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            signal.alarm(30)
            seen = each(raw)
            for _ in range(100):
                _run(raw)
        except BaseException:
            seen = traceback.format_exc()
        finally:
            os.write(theirs, json.dumps(seen).encode())
            os._exit(0)
    os.close(theirs)
    with os.fdopen(ours, "rb") as stream:
        seen = stream.read()
    _, status = os.waitpid(process, 0)
    if os.WIFSIGNALED(status):
        return signal.Signals(os.WTERMSIG(status)).name
    return json.loads(seen)


def _run(raw: Raw) -> None:
    instance = raw.started("run")
    assert raw.DoStep(instance, 0.0, 1.0, 0) == 0
    raw.FreeInstance(instance)


def alive(raw: Raw, instance: Any) -> bool:
    """Whether an instance comes back from whatever was done to it; it is freed."""
    for _ in range(3):
        raw.DoStep(instance, 0.0, 0.1, 0)
        assert raw.Reset(instance) == 0
        assert raw.EnterInitializationMode(instance) == 0
        assert raw.ExitInitializationMode(instance) == 0
        assert raw.DoStep(instance, 0.0, 0.1, 0) == 0
    raw.FreeInstance(instance)
    return True


def made(raw: Raw, **changed: Any) -> Any:
    """Instantiate with other arguments than the right ones; return the instance, or None."""
    right = {
        "name": b"a",
        "kind": 1,
        "guid": raw.guid,
        "resources": raw.resources,
        "callbacks": c.byref(raw.callbacks),
        "visible": 0,
        "logging": 0,
    }
    return raw.Instantiate(*{**right, **changed}.values())
