"""Plays sequences of calls on a native library and judges them, in a process of its own.

``python -m tests.native.fuzz.player FOLDER GUID LAW FIRST COUNT`` prints what it found as JSON. The
folder is that of an unpacked FMU. Where the library counts its blocks of memory (counting.c),
none may be left after a sequence. Before a sequence its seed is written to the file ``seed`` in the
folder, so that a process that dies tells on which one.
"""

import ctypes as c
import json
import os
import signal
import sys
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from tests.fmu.fuzz.sequences import Call, sequence
from tests.fmu.fuzz.variables import VARIABLES
from tests.fmu.inside import SKIPPED
from tests.fmu.inside.player import Player
from tests.fmu.inside.raw import Raw
from tests.native.fuzz.model import NativeModel

SECONDS = 2.0
"""Processor time of one sequence [s]; then the process ends by SIGPROF."""


def opened(folder: Path, guid: str, law: str = "coulomb") -> Raw:
    """Return the functions of an unpacked FMU of a friction law."""
    kind = SimpleNamespace(modelIdentifier=VARIABLES[law].spec.name)
    description = SimpleNamespace(coSimulation=kind, guid=guid)
    return Raw(SimpleNamespace(description=description, folder=str(folder), references={}))  # type: ignore[arg-type]


class NativePlayer(Player):
    """Holds instances, states and serialized states by number; nothing outlives a sequence."""

    def __init__(self, raw: Raw, law: str = "coulomb") -> None:
        self.law = law
        errors = sys.stderr
        super().__init__(raw)
        sys.stderr = errors
        self.raw.FreeInstance(self.keeper)
        self.freed_by: dict[int, int] = {}

    def judged(self, calls: list[Call], counts: Counter[tuple[str, int]]) -> str | None:
        """Play one sequence; return the first objection, or None."""
        model = NativeModel(self.law)
        found = None
        self.keeper = self.raw.instance("keeper")
        for position, call in enumerate(calls):
            self.raw.messages.clear()
            status, values = getattr(self, f"_{call[0]}")(*call[1:])
            counts[_counted(call), status] += 1
            objection = model.objection(call, [status, values, list(self.raw.messages)])
            if objection is not None:
                found = f"call {position}, {json.dumps(call)}: {objection}"
                break
        for state in self.states.values():
            self.raw.forget(self.keeper, state)
        for instance in (*self.instances.values(), self.keeper):
            self.raw.FreeInstance(instance)
        for held in (self.states, self.instances, self.packed, self.freed, self.freed_by):
            held.clear()
        return found

    def _free(self, i: int) -> Any:
        for slot in [slot for slot, by in self.freed_by.items() if by == i]:
            self.freed.pop(slot, None)
        return super()._free(i)

    def _free_state(self, i: int, slot: int) -> Any:
        state = self.states.pop(slot, c.c_void_p())
        # The call makes the pointer NULL; a careless master has a copy of it.
        self.freed[slot] = c.c_void_p(state.value)
        self.freed_by[slot] = i
        return self.raw.FreeFMUstate(self.instances[i], c.byref(state)), None

    def _set_null(self, i: int) -> Any:
        return self.raw.SetFMUstate(self.instances[i], None), None

    def _deserialize(self, i: int, packed: int, slot: int, damage: str) -> Any:
        if packed not in self.packed:
            return SKIPPED, None
        data = self.packed[packed]
        data = {"": data, "cut": data[:-1], "empty": b"", "garbage": b"\xff{%n"}[damage]
        if slot in self.states:
            self.raw.forget(self.keeper, self.states.pop(slot))
        state = c.c_void_p()
        buffer = (c.c_char * max(1, len(data))).from_buffer_copy(data or b"\0")
        status = self.raw.DeSerializeFMUstate(self.instances[i], buffer, len(data), c.byref(state))
        if state.value is not None:
            self.states[slot] = state
        return status, None


def _counted(call: Call) -> str:
    return f"{call[0]} {call[2]}" if call[0] in ("get", "set") else str(call[0])


def findings(
    raw: Raw,
    seeds: Iterable[int],
    counts: Counter[tuple[str, int]],
    seed_file: Path | None = None,
    law: str = "coulomb",
) -> list[str]:
    """Play sequences of these seeds; return the first objection with its seed, if there is one."""
    player = NativePlayer(raw, law)
    live = getattr(raw.library, "live_blocks", None)
    noted = None if seed_file is None else os.open(seed_file, os.O_RDWR | os.O_CREAT)
    for seed in seeds:
        if noted is not None:
            os.pwrite(noted, f"{seed:<12}".encode(), 0)
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        found = player.judged(sequence(seed, law), counts)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        if found is None and live is not None and live() != 0:
            found = f"{live()} blocks of memory are left"
        if found is not None:
            return [f"seed {seed}: {found}"]
    return []


class _Collector(NativePlayer):
    """Keeps the states that are serialized."""

    def __init__(self, raw: Raw) -> None:
        super().__init__(raw)
        self.collected: list[bytes] = []

    def _serialize(self, i: int, slot: int, packed: int) -> Any:
        given = super()._serialize(i, slot, packed)
        if given[0] == 0:
            self.collected.append(self.packed[packed])
        return given


def serialized(raw: Raw, seeds: Iterable[int]) -> list[bytes]:
    """Return the states that are serialized in sequences of these seeds."""
    player = _Collector(raw)
    for seed in seeds:
        player.judged(sequence(seed), Counter())
    return player.collected


def main() -> None:
    """Play what the command line asks for."""
    folder, guid, law, first, count = sys.argv[1:]
    counts: Counter[tuple[str, int]] = Counter()
    seeds = range(int(first), int(first) + int(count))
    raw = opened(Path(folder), guid, law)
    found = findings(raw, seeds, counts, Path(folder, "seed"), law)
    told = [[name, status, number] for (name, status), number in counts.items()]
    sys.stdout.write(json.dumps({"found": found, "counts": told}))


if __name__ == "__main__":
    main()
