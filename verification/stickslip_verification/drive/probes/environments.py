"""Probes that go on in a fresh process: from the bytes of a state, or in another environment."""

import os
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.probes.calls import (
    Calls,
    Rows,
    calling,
    check_playable,
    differences,
    played,
)
from stickslip_verification.drive.processes import Environment, in_fresh_process
from stickslip_verification.drive.stepping import need_ability

_PATIENCE = 4.0
"""Seconds after which no further environment is tried, to find the one that matters."""

_UNWRITABLE = Path("/proc")
"""A folder that even root cannot write to, where there is one."""


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
    need_ability(fmu.can_get_and_set_state and fmu.can_serialize_state, "serialize its state")
    check_playable(fmu, chain(calls, then))
    with calling(fmu, calls) as caller:
        state = caller.instance.written(caller.instance.get_state()), caller.since
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
        """Play them in this process."""
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
