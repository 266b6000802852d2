"""What is done over and over, and the memory that it keeps."""

import ctypes
import gc
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.fmu.importer import Importer
from tests.fmu.inside.raw import Raw
from tests.fmu.inside.states import Bench


def grown(importer: Importer, order: dict[str, Any]) -> Any:
    """Do one thing over and over; return how the memory grew.

    Parameters
    ----------
    order
        What to do, a name of `_THINGS`, and how often.

    Returns
    -------
    Any
        Growth of the resident memory over the second half [B].
    """
    bench = Bench(importer)
    do = _THINGS[order["what"]](bench)
    times = order["times"]
    for _ in range(times // 2):
        do()
    half = _resident()
    for _ in range(times - times // 2):
        do()
    return _resident() - half


def _resident() -> int:
    """Return the memory of this process that is in use [B]."""
    return int(Path("/proc/self/statm").read_text("ascii").split()[1]) * 4096


def _iteration(bench: Bench) -> Callable[[], None]:
    """Get, step, set and free, as a master does that iterates over its steps."""
    raw = bench.raw
    instance = raw.started(c=0.5)
    get, step, put, free = raw.GetFMUstate, raw.DoStep, raw.SetFMUstate, raw.FreeFMUstate
    state = ctypes.c_void_p()
    pointer = ctypes.byref(state)

    def do() -> None:
        failed = get(instance, pointer) or step(instance, 0.0, 0.01, 0) or put(instance, state)
        assert not failed
        # Every state is of another moment: the run goes on by a little.
        failed = step(instance, 0.0, 1e-4, 0) or free(instance, pointer)
        assert not failed

    return do


def _serialization(bench: Bench) -> Callable[[], None]:
    raw = bench.raw
    instance = raw.started(c=0.5)

    def do() -> None:
        state = raw.save(instance)
        copy = raw.unpack(instance, raw.pack(instance, state))
        assert raw.SetFMUstate(instance, copy) == 0
        assert raw.DoStep(instance, 0.0, 1e-3, 0) == 0
        raw.forget(instance, state)
        raw.forget(instance, copy)

    return do


def left(importer: Importer, count: int) -> Any:
    """Make, run and free so many instances; return how many objects of the FMU there are after."""
    raw = Raw(importer)
    instances = [raw.started() for _ in range(count)]
    for instance in instances:
        assert raw.DoStep(instance, 0.0, 0.3, 0) == 0
    alive = _objects()
    assert raw.DoStep(instances[0], 0.3, -1.0, 0) == 4
    for instance in instances:
        raw.FreeInstance(instance)
    gc.collect()
    return [alive, _objects()]


def _objects() -> int:
    """Return the number of slaves, blocks and what they are made of."""
    names = ("Packed", "LawBlock", "State", "CycleMeter", "StickArc", "SlipArc")
    return sum(type(each).__name__ in names for each in gc.get_objects())


def _instance(bench: Bench) -> Callable[[], None]:
    def do() -> None:
        instance = bench.raw.started("%s")
        assert bench.raw.DoStep(instance, 0.0, 0.3, 0) == 0
        bench.raw.FreeInstance(instance)

    return do


def _reset(bench: Bench) -> Callable[[], None]:
    instance = bench.raw.instance()

    def do() -> None:
        raw = bench.raw
        assert raw.EnterInitializationMode(instance) == 0
        assert raw.ExitInitializationMode(instance) == 0
        assert raw.DoStep(instance, 0.0, 0.3, 0) == 0
        assert raw.Reset(instance) == 0

    return do


def _failure(bench: Bench) -> Callable[[], None]:
    instance = bench.raw.instance()

    def do() -> None:
        raw = bench.raw
        assert raw.DoStep(instance, 0.0, 0.3, 0) == 4
        assert raw.Terminate(instance) == 4
        assert raw.Reset(instance) == 0

    return do


def _failure_to_get(bench: Bench) -> Callable[[], None]:
    instance = bench.raw.instance()
    state = ctypes.c_void_p()

    def do() -> None:
        raw = bench.raw
        assert raw.DoStep(instance, 0.0, 0.3, 0) == 4
        assert raw.GetFMUstate(instance, ctypes.byref(state)) == 4
        assert raw.Reset(instance) == 0

    return do


_THINGS: dict[str, Callable[[Bench], Callable[[], None]]] = {
    "iteration": _iteration,
    "serialization": _serialization,
    "instance": _instance,
    "reset": _reset,
    "failure": _failure,
    "failure to get": _failure_to_get,
}
