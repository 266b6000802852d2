"""Probes that go on in a fresh process: from the bytes of a state, or in another environment."""

import contextlib
import os
import shutil
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.probes import fresh_process
from stickslip_verification.drive.probes.calls import (
    Call,
    Caller,
    Row,
    check_playable,
    differences,
)
from stickslip_verification.drive.probes.fresh_process import Environment, FreshProcessError
from stickslip_verification.drive.stepping import need_ability

_PATIENCE = 4.0
"""Seconds after which no further environment is tried, to find the one that matters."""

_UNWRITABLE = Path("/proc")
"""A folder that even root cannot write to, where there is one."""


@dataclass(frozen=True)
class _Order:
    """What a fresh process is to play.

    Attributes
    ----------
    fmu, names
        The FMU's file and the map to its names.
    calls, then
        Calls, and those whose outputs are wanted.
    state
        A serialized state to go on from between the two, with the time from the start to it [s].
    folders
        Whether the working folder changes: at the instantiation it is an empty one, at `calls` one
        that cannot be written to, at `then` one that was deleted.
    """

    fmu: Path
    names: NameMap
    calls: Sequence[Call]
    then: Sequence[Call]
    state: tuple[bytes, float] | None = None
    folders: bool = False


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
    start = [{"start": caller.start}]
    order = _Order(fmu.path.absolute(), fmu.names, start, then, state)
    return _compared(order, expected, tolerance, environment)


def elsewhere(
    fmu: FmuFile,
    calls: Sequence[Call],
    then: Sequence[Call],
    environments: Mapping[str, Environment],
    tolerance: float | None = None,
) -> list[str]:
    """Complain if the FMU moves otherwise in a fresh process with another environment.

    There its working folder changes, see `_Order`, and between `calls` and `then` its state is
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
    with fmu.instantiate() as instance:
        caller = Caller(fmu, instance)
        caller.play(calls)
        expected = caller.play(then)
    alone = _Order(fmu.path.absolute(), fmu.names, calls, then)
    moved = replace(alone, folders=True)
    together = {name: value for each in environments.values() for name, value in each.items()}
    complaints = _compared(moved, expected, tolerance, together)
    if not complaints:
        return []
    single: list[tuple[str, _Order, Environment]] = [("in a fresh process", alone, {})]
    single += [(name, alone, environment) for name, environment in environments.items()]
    single += [("in another working folder", moved, {})]
    for name, order, environment in single:
        if time.monotonic() > begun + _PATIENCE:
            break
        found = _compared(order, expected, tolerance, environment)
        if found:
            return [f"{name}: {each}" for each in found]
    return [f"{', '.join(name for name, *_ in single[1:])}: {each}" for each in complaints]


def _played(order: _Order) -> list[Row]:
    """Return the outputs after the steps of an order, in this process."""
    fmu = FmuFile(order.fmu, order.names)
    with contextlib.closing(fmu), fmu.instantiate() as instance:
        caller = Caller(fmu, instance)
        if order.folders:
            _go_where_nothing_can_be_written()
        caller.play(order.calls)
        if order.state is not None:
            written, since = order.state
            instance.restore(written)
            caller.resume(since)
        elif _serializes(fmu):
            instance.restore(instance.written(instance.get_state()))
        if order.folders:
            _go_where_nothing_is()
        return caller.play(order.then)


def _serializes(fmu: FmuFile) -> bool:
    return fmu.can_get_and_set_state and fmu.can_serialize_state


def _go_where_nothing_can_be_written() -> None:
    folder = Path(tempfile.mkdtemp(dir=Path.cwd()))
    folder.chmod(0o555)
    os.chdir(_UNWRITABLE if os.access(folder, os.W_OK) and _UNWRITABLE.is_dir() else folder)


def _go_where_nothing_is() -> None:
    folder = Path(tempfile.mkdtemp())
    os.chdir(folder)
    # Windows keeps a working folder.
    with contextlib.suppress(OSError):
        folder.rmdir()


def _compared(
    order: _Order,
    expected: Sequence[Row],
    tolerance: float | None,
    environment: Environment,
) -> list[str]:
    """Have an order played in a fresh process, and tell where the rows are not those expected."""
    folder = Path(tempfile.mkdtemp(prefix="stickslip-there-")) if order.folders else None
    try:
        rows = fresh_process.call(_played, order, environment=environment, folder=folder)
    except FreshProcessError as error:
        return [str(error)]
    finally:
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)
    return differences(rows, expected, tolerance)
