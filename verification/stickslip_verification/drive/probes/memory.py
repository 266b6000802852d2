"""A probe of memory: what is done over and over must not keep any."""

import gc
import itertools
import statistics
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from functools import partial
from pathlib import Path

from stickslip_verification.drive.fmu.archive import FmuFile, available
from stickslip_verification.drive.processes import in_fresh_process
from stickslip_verification.drive.stepping import (
    NotApplicableError,
    defaults,
    need_ability,
    need_instances,
)
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.truth.parameters import START_VALUES

Doing = Generator[None, None, None]
"""Does something once with each `next` but the first."""

_PAGES, _PAGE = Path("/proc/self/statm"), 4096
"""Pages of this process: all, resident, shared, ... (Linux); size of a page [B]."""

_PARTS, _FEWEST = 10, 4
"""Parts of a measurement, of which the first warms up; with fewer it says nothing."""

_PATIENCE = 4.0
"""How much longer than the time of the processor a measurement may take by the wall clock."""

_NOISE = 12 * _PAGE
"""Growth over a part that counts as no loss: what an allocator may take ahead [B]."""

_STEP = 0.001
"""An ordinary communication step [s]."""

_SLAVE_MODULE, _PER_MODULE = "resources/slavemodule.txt", 16
"""Where pythonfmu's wrapper finds the name of the module that it executes; memory per byte of that
module which it keeps of each execution, 5 with a plain one."""


def keeps_memory(fmu: FmuFile, of: str, count: int, most: float, seconds: float) -> list[str]:
    """Complain if memory grows by more than `most` [B] each time in most parts of a measurement.

    What `of` names is done `count` times, or for so many `seconds` of the processor. A loss grows
    in every part; what an allocator or a cache takes does so in few. The process is a fresh one,
    for memory that was freed earlier would be filled first, and hide a loss.
    """
    if of == "state":
        need_ability(fmu.can_get_and_set_state, "get and set its state")
    elif of == "instance":
        need_instances(fmu)
        most += _PER_MODULE * _module(fmu)
    if not _PAGES.exists():
        raise NotApplicableError("the memory of a process is read on Linux only")
    measured = partial(_measured, fmu, of, count, seconds, _PATIENCE)
    answer = in_fresh_process(measured, seconds=_PATIENCE * seconds)
    if answer.value is None:
        return [answer.failure or "no answer"]
    return judged(answer.value, of, most, seconds)


def _steps(fmu: FmuFile) -> Doing:
    """Step; of four steps, one is after a read of all outputs and one after a set."""
    with fmu.instantiate() as instance:
        instance.start(defaults(fmu))
        read = instance.reader(available(fmu, OUTPUT_NAMES))
        inputs = [name for name in ("v", "F_ext") if fmu.has(name)]
        for number in itertools.count():
            yield
            if number % 4 == 2:
                read()
            elif number % 4 == 0:
                # Every set is to other values.
                instance.set({name: START_VALUES[name] + 1e-9 * number for name in inputs})
            instance.step(number * _STEP, _STEP)
            instance.messages.clear()


def _states(fmu: FmuFile) -> Doing:
    """Take, set and free a state, each of another moment; every fourth is serialized too."""
    with fmu.instantiate() as instance:
        instance.start(defaults(fmu))
        for number in itertools.count():
            yield
            state = instance.get_state()
            instance.step(number * _STEP, _STEP)
            instance.set_state(state)
            if fmu.can_serialize_state and number % 4 == 0:
                instance.restore(instance.written(state))
            else:
                instance.free_state(state)
            instance.step(number * _STEP, _STEP)
            instance.messages.clear()


def _instances(fmu: FmuFile) -> Doing:
    """Make, run and free an instance."""
    while True:
        yield
        with fmu.instantiate() as instance:
            instance.start(defaults(fmu))
            instance.step(0.0, 0.3)


_DOINGS: Mapping[str, Callable[[FmuFile], Doing]] = {
    "step": _steps,
    "state": _states,
    "instance": _instances,
}


def _module(fmu: FmuFile) -> int:
    """Return the size of the module that a wrapper executes for each instance [B], 0 if none."""
    try:
        name = (fmu.folder / _SLAVE_MODULE).read_text(encoding="utf-8").strip()
        return (fmu.folder / "resources" / f"{name}.py").stat().st_size
    except (OSError, ValueError):
        return 0


def judged(parts: Sequence[tuple[int, int]], what: str, most: float, seconds: float) -> list[str]:
    """Complain of a measurement, of which each part is a number of times and a growth [B]."""
    if len(parts) < _FEWEST:
        done = sum(times for times, _ in parts)
        raise NotApplicableError(f"{done} times in {seconds:g} s are too few to see a loss")
    # The first part warms up.
    of, grown = (statistics.median(column) for column in zip(*parts[1:], strict=True))
    if grown <= max(most * of, _NOISE):
        return []
    return [f"each {what} keeps {grown / of:.0f} bytes; {most:g} at most"]


def _measured(
    fmu: FmuFile, of: str, count: int, seconds: float, patience: float
) -> list[tuple[int, int]]:
    """Return how often a thing was done in each part of a measurement, and the growth [B]."""
    over, once = _clock(seconds, patience), _DOINGS[of](fmu)
    parts: list[tuple[int, int]] = []
    next(once)
    before = _resident()
    while sum(times for times, _ in parts) < count and not over():
        done, part_over = 0, _clock(seconds / _PARTS, patience)
        while done < count // _PARTS and not part_over():
            next(once)
            done += 1
        now = _resident()
        parts.append((done, now - before))
        before = now
    once.close()
    return parts


def _clock(seconds: float, patience: float) -> Callable[[], bool]:
    """Return whether so much time of the processor is over, or too much by the wall clock."""
    processor, wall = time.process_time() + seconds, time.monotonic() + patience * seconds
    return lambda: time.process_time() > processor or time.monotonic() > wall


def _resident() -> int:
    """Return the memory of this process that is in use and its own [B]."""
    gc.collect()
    _, resident, shared, *_ = map(int, _PAGES.read_text("ascii").split())
    return (resident - shared) * _PAGE
