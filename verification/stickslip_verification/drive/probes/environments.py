"""Probes that go on in a fresh process: from the bytes of a state, or in another environment."""

import contextlib
import os
import tempfile
import time
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import chain
from pathlib import Path

from stickslip_verification.drive import fresh_process
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.fresh_process import Environment
from stickslip_verification.drive.probes.calls import (
    Call,
    Caller,
    Row,
    check_playable,
    differences,
    played,
)
from stickslip_verification.drive.stepping import need_ability

_PATIENCE = 4.0
"""Seconds after which no further environment is tried, to find the one that matters."""

_UNWRITABLE = Path("/proc")
"""A folder that even root cannot write to, where there is one."""


def state_in_a_fresh_process(
    fmu: FmuFile,
    calls: Sequence[Call],
    then: Sequence[Call],
    environment: Environment,
    tolerance: float | None = None,
) -> list[str]:
    """Complain if a state, taken as bytes, goes on otherwise in a fresh process.

    Parameters
    ----------
    fmu
        The FMU.
    calls
        They lead to the state.
    then
        Steps that are made from the state, here and there.
    environment
        What differs from the environment here.
    tolerance
        Of the largest value in the same unit; None for bit for bit.
    """
    need_ability(_serializes(fmu), "serialize its state")
    check_playable(fmu, chain(calls, then))
    with fmu.instantiate() as instance:
        caller = Caller(fmu, instance)
        caller.play(calls)
        state = instance.written(instance.get_state()), caller.since
        expected = caller.play(then)
    play = partial(_played, fmu.path.absolute(), fmu.names, [{"start": caller.start}], then, state)
    return _compared(play, expected, tolerance, environment)


def elsewhere(
    fmu: FmuFile,
    calls: Sequence[Call],
    then: Sequence[Call],
    environments: Mapping[str, Environment],
    tolerance: float | None = None,
) -> list[str]:
    """Complain if the FMU moves otherwise in a fresh process with another environment.

    There its working folder changes, see `_played`, and between `calls` and `then` its state is
    serialized and taken up again, if it can. All environments act at once. Only where the motion
    differs, they are tried one by one, to find the one that matters.

    Parameters
    ----------
    fmu
        The FMU.
    calls, then
        What is played; the outputs after the steps of `then` are compared.
    environments
        What differs from the environment here, by a name for complaints.
    tolerance
        Of the largest value in the same unit; None for bit for bit.
    """
    begun = time.monotonic()
    check_playable(fmu, chain(calls, then))
    _, expected = played(fmu, calls, then)
    alone = partial(_played, fmu.path.absolute(), fmu.names, calls, then)
    moved = partial(alone, folders=True)
    together = {name: value for each in environments.values() for name, value in each.items()}
    complaints = _compared(moved, expected, tolerance, together)
    if not complaints:
        return []
    single = {
        "in a fresh process": (alone, {}),
        **{name: (alone, environment) for name, environment in environments.items()},
        "in another working folder": (moved, {}),
    }
    for name, (play, environment) in single.items():
        if time.monotonic() > begun + _PATIENCE:
            break
        found = _compared(play, expected, tolerance, environment)
        if found:
            return [f"{name}: {each}" for each in found]
    _, *names = single
    return [f"{', '.join(names)}: {each}" for each in complaints]


def _played(
    path: Path,
    names: NameMap,
    calls: Sequence[Call],
    then: Sequence[Call],
    state: tuple[bytes, float] | None = None,
    folders: bool = False,
) -> list[Row]:
    """Play calls in this process; return the outputs after the steps of `then`.

    Parameters
    ----------
    path, names
        The FMU's file and the map to its names.
    calls, then
        What is played.
    state
        A serialized state to go on from between the two, with the time from the start to it [s].
    folders
        Whether the working folder changes: at the instantiation it is an empty one, at `calls` one
        that cannot be written to, at `then` one that was deleted.
    """
    fmu = FmuFile(path, names)
    with contextlib.closing(fmu), fmu.instantiate() as instance:
        caller = Caller(fmu, instance)
        if folders:
            _go_where_nothing_can_be_written()
        caller.play(calls)
        if state is not None:
            written, since = state
            instance.restore(written)
            caller.resume(since)
        elif _serializes(fmu):
            instance.restore(instance.written(instance.get_state()))
        if folders:
            with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
                os.chdir(folder)
        return caller.play(then)


def _serializes(fmu: FmuFile) -> bool:
    return fmu.can_get_and_set_state and fmu.can_serialize_state


def _go_where_nothing_can_be_written() -> None:
    folder = Path(tempfile.mkdtemp(dir=Path.cwd()))
    folder.chmod(0o555)
    os.chdir(_UNWRITABLE if os.access(folder, os.W_OK) and _UNWRITABLE.is_dir() else folder)


def _compared(
    play: "partial[list[Row]]",
    expected: Sequence[Row],
    tolerance: float | None,
    environment: Environment,
) -> list[str]:
    """Have calls played in a fresh process, and say where the rows are not those expected."""
    with tempfile.TemporaryDirectory(prefix="stickslip-there-", ignore_cleanup_errors=True) as new:
        folder = Path(new) if play.keywords else None
        answer = fresh_process.call(play, environment=environment, folder=folder)
    if answer.value is None:
        return [answer.failure or "no answer"]
    return differences(answer.value, expected, tolerance)
