"""Plays sequences of calls on instances of the FMU and says what came back from each."""

import ctypes as c
import io
import json
import signal
import sys
from pathlib import Path
from typing import Any

from tests.fmu.inside import SKIPPED
from tests.fmu.inside.raw import Raw

_STATUSES = ("", "Real", "Integer", "Boolean", "String")


def play(importer: Any, order: Any) -> int:
    """Play the sequences of a file, one a line, each within its time; return their number.

    The process ends by SIGPROF where one takes more processor time.

    Parameters
    ----------
    order
        The file of sequences, the file for what comes back, and the time [s] that one may take.
    """
    player = Player(Raw(importer))
    count = 0
    calls, outcomes = Path(order["calls"]), Path(order["outcomes"])
    with calls.open(encoding="utf-8") as source, outcomes.open("w", encoding="utf-8") as target:
        for line in source:
            signal.setitimer(signal.ITIMER_PROF, order["seconds"])
            played = player.play(json.loads(line))
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            target.write(json.dumps(played) + "\n")
            target.flush()
            count += 1
    return count


class Player:
    """Holds instances, states and serialized states by number."""

    def __init__(self, raw: Raw) -> None:
        self.raw = raw
        # Frees what sequences leave behind.
        self.keeper = raw.instance("keeper")
        self.instances: dict[int, Any] = {}
        self.states: dict[int, Any] = {}
        self.packed: dict[int, bytes] = {}
        # What a pointer still holds after its state was freed.
        self.freed: dict[int, Any] = {}
        self.failed_to_get: set[int] = set()
        sys.stderr = self.errors = io.StringIO()

    def play(self, calls: list[list[Any]]) -> list[Any]:
        """Play one sequence from nothing; return what came back from each.

        That is the status, the values, the lines in the log and those on standard error.
        """
        outcomes = []
        for name, *arguments in calls:
            self.raw.messages.clear()
            status, values = getattr(self, f"_{name}")(*arguments)
            outcomes.append([status, values, list(self.raw.messages), self._said()])
        for state in self.states.values():
            self.raw.forget(self.keeper, state)
        for instance in self.instances.values():
            self.raw.FreeInstance(instance)
        self.states.clear()
        self.instances.clear()
        self.packed.clear()
        self.freed.clear()
        self.failed_to_get.clear()
        return outcomes

    def _said(self) -> list[str]:
        """Return the lines on standard error since the last call."""
        lines = self.errors.getvalue().splitlines()
        if lines:
            self.errors.seek(0)
            self.errors.truncate()
        return lines

    def _instantiate(self, i: int, name: str, logging: bool) -> Any:
        self.instances[i] = self.raw.instance(name, logging=logging)
        return 0, None

    def _free(self, i: int) -> Any:
        self.failed_to_get.discard(i)
        self.raw.FreeInstance(self.instances.pop(i))
        return 0, None

    def _set_up(self, i: int, start: float, stop: float | None, tolerance: float | None) -> Any:
        return self.raw.SetupExperiment(
            self.instances[i],
            tolerance is not None,
            tolerance or 0.0,
            start,
            stop is not None,
            stop or 0.0,
        ), None

    def _enter(self, i: int) -> Any:
        return self.raw.EnterInitializationMode(self.instances[i]), None

    def _exit(self, i: int) -> Any:
        return self.raw.ExitInitializationMode(self.instances[i]), None

    def _terminate(self, i: int) -> Any:
        return self.raw.Terminate(self.instances[i]), None

    def _reset(self, i: int) -> Any:
        self.failed_to_get.discard(i)
        return self.raw.Reset(self.instances[i]), None

    def _step(self, i: int, time: float, step: float, no_state_prior: bool) -> Any:
        return self.raw.DoStep(self.instances[i], time, step, no_state_prior), None

    def _get(self, i: int, kind: str, references: list[int]) -> Any:
        status, values = self.raw.read(self.instances[i], kind, references)
        return status, values if status == 0 else None

    def _set(self, i: int, kind: str, references: list[int], values: list[Any]) -> Any:
        if kind == "String":
            values = [value.encode() for value in values]
        return self.raw.write(self.instances[i], kind, references, values), None

    def _get_state(self, i: int, slot: int) -> Any:
        # The wrapper would forget what a pointer that it writes over has pointed to.
        if slot in self.states:
            self.raw.forget(self.keeper, self.states.pop(slot))
        state = c.c_void_p()
        status = self.raw.GetFMUstate(self.instances[i], c.byref(state))
        if state.value is not None:
            self.states[slot] = state
        else:
            self.failed_to_get.add(i)
        return status, None

    def _set_state(self, i: int, slot: int) -> Any:
        if slot not in self.states:
            return SKIPPED, None
        return self.raw.SetFMUstate(self.instances[i], self.states[slot]), None

    def _free_state(self, i: int, slot: int) -> Any:
        state = self.states.pop(slot, c.c_void_p())
        self.freed[slot] = state
        return self.raw.FreeFMUstate(self.instances[i], c.byref(state)), None

    def _free_again(self, i: int, slot: int) -> Any:
        if slot not in self.freed:
            return SKIPPED, None
        state = self.freed.pop(slot)
        return self.raw.FreeFMUstate(self.instances[i], c.byref(state)), None

    def _set_freed(self, i: int, slot: int) -> Any:
        if not self.freed.get(slot):
            return SKIPPED, None
        return self.raw.SetFMUstate(self.instances[i], self.freed[slot]), None

    def _set_null(self, i: int) -> Any:
        if i not in self.failed_to_get:
            return SKIPPED, None
        self.failed_to_get.remove(i)
        return self.raw.SetFMUstate(self.instances[i], None), None

    def _serialize(self, i: int, slot: int, packed: int) -> Any:
        if slot not in self.states:
            return SKIPPED, None
        self.packed[packed] = self.raw.pack(self.instances[i], self.states[slot])
        return 0, None

    def _deserialize(self, i: int, packed: int, slot: int, damage: str) -> Any:
        if packed not in self.packed:
            return SKIPPED, None
        data = self.packed[packed]
        data = {"": data, "cut": data[:-1], "empty": b"", "garbage": b"\xff{%n"}[damage]
        if slot in self.states:
            self.raw.forget(self.keeper, self.states.pop(slot))
        self.states[slot] = self.raw.unpack(self.instances[i], data)
        return 0, None

    def _status(self, i: int, which: int, kind: int) -> Any:
        value = (c.c_double * 1)(0.0)
        status = getattr(self.raw, f"Get{_STATUSES[which]}Status")(self.instances[i], kind, value)
        if status == 0 and _STATUSES[which] == "Boolean":
            return status, [c.cast(value, c.POINTER(c.c_int))[0]]
        return status, list(value) if status == 0 else None

    def _cancel(self, i: int) -> Any:
        return self.raw.CancelStep(self.instances[i]), None

    def _derivatives(self, i: int, which: str, reference: int) -> Any:
        references, order, value = (c.c_uint * 1)(reference), (c.c_int * 1)(1), (c.c_double * 1)()
        instance = self.instances[i]
        if which == "directional":
            return self.raw.GetDirectionalDerivative(
                instance, references, 1, references, 1, value, value
            ), None
        function = getattr(self.raw, which)
        return function(instance, references, 1, order, value), None

    def _debug(self, i: int, on: bool, categories: list[str]) -> Any:
        texts = (c.c_char_p * len(categories))(*(each.encode() for each in categories))
        return self.raw.SetDebugLogging(self.instances[i], on, len(categories), texts), None

    def _version(self) -> Any:
        versions = self.raw.GetVersion(), self.raw.GetTypesPlatform()
        return 0, [each.decode() for each in versions]
