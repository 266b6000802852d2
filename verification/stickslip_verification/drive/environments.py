"""Probes that go on in a fresh process: states as bytes, other environments, memory; the table."""

import contextlib
import faulthandler
import gc
import itertools
import locale
import math
import os
import pickle
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Final, TypeVar

from ..model.quantities import OUTPUT_NAMES
from ..suite.invariants import Probe
from ..truth.parameters import START_VALUES
from . import calls, masters
from .calls import Calls, Rows, calling, check_playable, differences, played
from .instance import FmuFile, available
from .processes import Answer, NotApplicableError, answer_of, discard_prints

Environment = Mapping[str, str | bool]
"""Environment variables and their values; False for one that is not set."""
LIMIT: Final = 30.0
"""Seconds that a fresh process may take; alone on its processor most take half of one."""

_COMMAND = "from stickslip_verification.drive.environments import serve; serve()"
_PATIENCE = 4.0  # seconds after which no further environment is tried, to find the one that matters
T = TypeVar("T")
_UNWRITABLE = Path("/proc")  # a folder that even root cannot write to, where there is one


def state_in_a_fresh_process(
    fmu: FmuFile,
    calls: Calls,
    then: Calls,
    environment: Environment,
    tolerance: float | None = None,
) -> list[str]:
    """Complain if the state after `calls`, taken as bytes, goes on otherwise in a fresh process.

    The outputs after the steps of `then` are compared. `environment` differs there from the one of
    this process; `tolerance` is as in `same_motion`.
    """
    able = fmu.can_get_and_set_state and fmu.can_serialize_state
    masters.need_ability(able, "serialize its state")
    check_playable(fmu, chain(calls, then))
    with calling(fmu, calls) as caller:
        state = caller.instance.written(caller.instance.get_state()), math.fsum(caller.steps)
        expected = caller.play(then)
    fresh = _Fresh(fmu, [{"start": caller.start}], then, state)
    return fresh.differences(expected, tolerance, environment)


def elsewhere(
    fmu: FmuFile,
    calls: Calls,
    then: Calls,
    environments: Mapping[str, Environment],
    tolerance: float | None = None,
) -> list[str]:
    """Complain if the FMU moves otherwise in a fresh process with another environment.

    The outputs after the steps of `then` are compared; `tolerance` is as in `same_motion`. All
    environments act at once, with other working folders. Only where the motion differs, they are
    tried one by one, to find the one that matters.
    """
    last = time.monotonic() + _PATIENCE
    check_playable(fmu, chain(calls, then))
    _, expected = played(fmu, calls, then)
    here, away = _Fresh(fmu, calls, then), _Fresh(fmu, calls, then, folders=True)
    together = {name: value for each in environments.values() for name, value in each.items()}
    complaints = away.differences(expected, tolerance, together)
    if not complaints:
        return []
    alone = {name: (here, environment) for name, environment in environments.items()}
    single = {"in a fresh process": (here, {}), **alone, "in another working folder": (away, {})}
    for name, (fresh, environment) in single.items():
        if time.monotonic() > last:
            break
        if by_this := fresh.differences(expected, tolerance, environment):
            return [f"{name}: {each}" for each in by_this]
    _, *names = single
    return [f"{', '.join(names)}: {each}" for each in complaints]


@dataclass(frozen=True)
class _Fresh:
    """Calls for a fresh process; before `then` it takes up a state, at a time since the start [s].

    If the working folder changes, it is an empty one at the instantiation, at `calls` one that
    cannot be written to, at `then` one that was deleted.
    """

    fmu: FmuFile
    calls: Calls
    then: Calls
    state: tuple[bytes, float] | None = None
    folders: bool = False

    def differences(
        self, expected: Rows, tolerance: float | None, environment: Environment
    ) -> list[str]:
        """Play them there; return how the outputs after the steps of `then` differ."""
        answer = in_fresh_process(self.played, environment, self.folders)
        if answer.value is None:
            return [answer.failure or "no answer"]
        return differences(answer.value, expected, tolerance)

    def played(self) -> Rows:
        with calling(self.fmu, ()) as caller:
            if self.folders:
                folder = Path(tempfile.mkdtemp(dir=Path.cwd()))
                folder.chmod(0o555)
                forbidden = not os.access(folder, os.W_OK) or not _UNWRITABLE.is_dir()
                os.chdir(folder if forbidden else _UNWRITABLE)
            caller.play(self.calls)
            if self.state is not None:
                written, since = self.state
                caller.instance.restore(written)
                caller.steps = [since]
            elif self.fmu.can_get_and_set_state and self.fmu.can_serialize_state:
                caller.instance.restore(caller.instance.written(caller.instance.get_state()))
            if self.folders:
                with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as deleted:
                    os.chdir(deleted)
            return caller.play(self.then)


def in_fresh_process(
    function: Callable[[], T],
    environment: Environment | None = None,
    elsewhere: bool = False,
    seconds: float = 0.0,
) -> Answer[T]:
    """Return the answer of a function that can be pickled, from a process without a past.

    The environment differs from the one of this process by `environment`, the working folder is an
    empty one if it runs `elsewhere`, and it may take some `seconds` more than `LIMIT`.
    """
    limit = LIMIT + seconds
    # A process that crashes or is ended leaves the files of the FMU there.
    with tempfile.TemporaryDirectory(prefix="stickslip-", ignore_cleanup_errors=True) as scratch:
        variables = {**os.environ, "TMPDIR": scratch, **(environment or {})}
        try:
            ended = subprocess.run(
                [sys.executable, "-P", "-c", _COMMAND, str(limit)],
                input=pickle.dumps(function),
                stdout=subprocess.PIPE,
                env={name: value for name, value in variables.items() if isinstance(value, str)},
                cwd=scratch if elsewhere else None,
                timeout=limit,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Answer(failure=f"no answer within {limit:g} s", late=True)
    try:
        answer: Answer[T] = pickle.loads(ended.stdout)
    except Exception:
        return Answer(failure=f"the process ended with exit code {ended.returncode}")
    return answer


def serve() -> None:
    """Call the function that comes on standard input, and write its answer to standard output."""
    with os.fdopen(os.dup(1), "wb") as out:
        discard_prints()
        # Ends this process even if its parent was ended and the FMU never returns.
        faulthandler.dump_traceback_later(float(sys.argv[1]), exit=True)
        # As a host with a graphical interface does; Python itself leaves numbers in the locale C.
        with contextlib.suppress(locale.Error):
            locale.setlocale(locale.LC_ALL, "")
        pickle.dump(answer_of(lambda: pickle.load(sys.stdin.buffer)()), out)


Doing = Generator[None, None, None]  # does something once with each `next` but the first
_PAGES, _PAGE = Path("/proc/self/statm"), 4096
"""Pages of this process: all, resident, shared, ... (Linux); size of a page [B]."""
_PARTS, _FEWEST = 10, 4
"""Parts of a measurement, of which the first warms up; with fewer it says nothing."""
_SLOWER = 4.0
"""How much longer than the time of the processor a measurement may take by the wall clock."""
_NOISE = 12 * _PAGE
"""Growth over a part that counts as no loss: what an allocator may take ahead [B]."""
_STEP = 0.001  # an ordinary communication step [s]
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
        masters.need_ability(fmu.can_get_and_set_state, "get and set its state")
    elif of == "instance":
        masters.need_instances(fmu)
        # Without a module that a wrapper executes for each instance there is nothing to add.
        with contextlib.suppress(OSError, ValueError):
            name = (fmu.folder / _SLAVE_MODULE).read_text(encoding="utf-8").strip()
            most += _PER_MODULE * (fmu.folder / "resources" / f"{name}.py").stat().st_size
    if not _PAGES.exists():
        raise NotApplicableError("the memory of a process is read on Linux only")
    measured = partial(_measured, fmu, of, count, seconds, _SLOWER)
    answer = in_fresh_process(measured, seconds=_SLOWER * seconds)
    if answer.value is None:
        return [answer.failure or "no answer"]
    return judged(answer.value, of, most, seconds)


def _steps(fmu: FmuFile) -> Doing:
    """Step; of four steps, one is after a read of all outputs and one after a set."""
    with fmu.instantiate() as instance:
        instance.start(masters.defaults(fmu))
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
        instance.start(masters.defaults(fmu))
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
    while True:
        yield
        with fmu.instantiate() as instance:
            instance.start(masters.defaults(fmu))
            instance.step(0.0, 0.3)


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
    once = {"step": _steps, "state": _states, "instance": _instances}[of](fmu)
    over = _clock(seconds, patience)
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
    gc.collect()
    _, resident, shared, *_ = map(int, _PAGES.read_text("ascii").split())
    return (resident - shared) * _PAGE


Probing = Callable[..., list[str]]

_IN_A_FRESH_PROCESS: tuple[Probing, ...] = (state_in_a_fresh_process, elsewhere, keeps_memory)

_PROBES: tuple[Probing, ...] = (
    calls.declared_variables,
    calls.declared,
    calls.refuses,
    calls.warns,
    calls.fails_until_reset,
    calls.starts_at,
    calls.same_motion,
    calls.gives,
    calls.steps_onto_restick,
    calls.keeps_its_cycle,
    *_IN_A_FRESH_PROCESS,
)

PROBES: Mapping[str, Probing] = {probe.__name__: probe for probe in _PROBES}
"""What an invariant can name as ``probe``: a function of the FMU and of the probe's arguments."""
OF_NUMERICAL = frozenset({calls.keeps_its_cycle.__name__})
"""The probes of numerical solutions; the exact block meets long cases in their stead."""
LONG_PROBES = OF_NUMERICAL | {probe.__name__ for probe in _IN_A_FRESH_PROCESS}
"""The probes that take long: a long run, or a process of their own, half a second and more."""


def asked(fmu: FmuFile, probe: Probe) -> list[str]:
    """Try a probe of the suite."""
    return PROBES[probe.probe](fmu, **probe.arguments)
