"""Makes the calls of random lives; without the project, so that it runs in any process."""

import ctypes as c
from typing import Any

from tests.driver import OK, Fmu, Instance, Refused, loaded

Call = list[Any]
"""Name of a method of `Player`, number of the instance, arguments."""
Outcome = list[Any]
"""Status of a call, its values, the messages: status and text of each."""

SKIPPED = -1
"""Status of a call that was not made: what it needs is not there."""


def play(path: str, lives: list[list[Call]]) -> list[list[Outcome]]:
    return [Player(loaded(path)).lived(calls) for calls in lives]


class Player:
    """Instances, states and serialized states by number; a KeyError says what is not there."""

    def __init__(self, fmu: Fmu) -> None:
        self.fmu = fmu
        self.instances: dict[int, Instance] = {}
        self.states: dict[int, c.c_void_p] = {}
        self.packed: dict[int, bytes] = {}
        # What a pointer still holds after its state was freed, and the instance that freed it.
        self.freed: dict[int, tuple[c.c_void_p, int]] = {}

    def lived(self, calls: list[Call]) -> list[Outcome]:
        outcomes = [self.made(*call) for call in calls]
        keeper = self.fmu.instance("keeper")
        for state in self.states.values():
            keeper.forget(state)
        for instance in (*self.instances.values(), keeper):
            instance.free()
        return outcomes

    def made(self, name: str, i: int, *arguments: Any) -> Outcome:
        self.fmu.messages.clear()
        status, values = OK, None
        try:
            values = getattr(self, name)(i, *arguments)
        except KeyError:
            status = SKIPPED
        except Refused as refused:
            status = refused.status
        return [status, values, [(state, text) for state, _, text in self.fmu.messages]]

    def instantiate(self, i: int, name: str) -> None:
        self.instances[i] = self.fmu.instance(name)

    def free(self, i: int) -> None:
        self.instances.pop(i).free()
        self.freed = {slot: each for slot, each in self.freed.items() if each[1] != i}

    def reset(self, i: int) -> None:
        self.instances[i].reset()

    def set_up(self, i: int, start: float, stop: float | None) -> None:
        if self.fmu.version == 3:
            raise KeyError
        more = (stop is not None, stop or 0.0)
        self.instances[i].call("SetupExperiment", 0, 0.0, start, *more)

    def enter(self, i: int, start: float) -> None:
        given = () if self.fmu.version == 2 else (False, 0.0, start, False, 0.0)
        self.instances[i].call("EnterInitializationMode", *given)

    def exit(self, i: int) -> None:
        self.instances[i].call("ExitInitializationMode")

    def terminate(self, i: int) -> None:
        self.instances[i].terminate()

    def step(self, i: int, time: float, step: float) -> None:
        self.instances[i].time = time
        self.instances[i].step(step)

    def get(self, i: int, kind: str, references: list[int]) -> list[Any]:
        empty = [None if kind == "String" else 0] * len(references)
        return self.instances[i].values("Get", kind, references, empty)

    def set(self, i: int, kind: str, references: list[int], values: list[Any]) -> None:
        given = [str(each).encode() for each in values] if kind == "String" else values
        self.instances[i].values("Set", kind, references, given)

    def save(self, i: int, slot: int) -> None:
        if slot in self.states:
            self.instances[i].forget(self.states.pop(slot))
        self.states[slot] = self.instances[i].save()

    def restore(self, i: int, slot: int) -> None:
        self.instances[i].restore(self.states[slot])

    def forget(self, i: int, slot: int) -> None:
        state = self.states.pop(slot)
        self.freed[slot] = c.c_void_p(state.value), i
        self.instances[i].forget(state)

    def forget_again(self, i: int, slot: int) -> None:
        self.instances[i].forget(self.freed.pop(slot)[0])

    def restore_freed(self, i: int, slot: int) -> None:
        self.instances[i].restore(self.freed[slot][0])

    def pack(self, i: int, slot: int, place: int) -> None:
        self.packed[place] = self.instances[i].pack_state(self.states[slot])

    def unpack(self, i: int, place: int, slot: int, damage: str) -> None:
        data = self.packed[place]
        data = {"": data, "cut": data[:-1], "empty": b"", "garbage": b"\xff{%n"}[damage]
        if slot in self.states:
            self.instances[i].forget(self.states.pop(slot))
        self.states[slot] = self.instances[i].unpack(data)
