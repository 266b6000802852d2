"""States of instances in every phase: taken, restored, written out, read in another process."""

import random
from typing import Any

from tests.fmu.importer import Importer
from tests.fmu.inside.raw import Raw

# A slip from a spring beyond F_s on both sides of it: forward until 0.1 s, then backward.
_FAR = {"z_start": 0.02}

PLACES: dict[str, tuple[dict[str, float], str, float, int]] = {
    "instantiated": ({}, "instantiated", 0.0, 0),
    "instantiated, values set": ({"k": 500.0, "z_start": 0.001}, "instantiated", 0.0, 0),
    "initialization": ({"mu_s": 0.4, **_FAR}, "initialization", 0.0, 1),
    "before the first step": ({"v": 0.05}, "stepping", 0.0, 0),
    "stick": ({}, "stepping", 0.1, 0),
    "slip": ({}, "stepping", 0.3, 1),
    "second slip": ({}, "stepping", 0.6, 1),
    "first slip of two": (_FAR, "stepping", 0.05, 1),
    "reversed slip": (_FAR, "stepping", 0.15, -1),
    "slip from the start": ({"x_dot_start": -0.3}, "stepping", 0.005, -1),
    "damped slip": ({"c": 2.0, **_FAR}, "stepping", 0.05, 1),
    "overdamped slip": ({"c": 100.0, **_FAR}, "stepping", 0.05, 1),
    "stick after damped slips": ({"c": 2.0}, "stepping", 1.0, 0),
    "clamped": ({"mu_k": 0.9}, "stepping", 0.3, 1),
    "terminated": ({}, "terminated", 0.3, 1),
}
"""By name: values set, phase, time reached [s] and the mode there."""

# Steps that meet events anywhere, hold some, and hold next to nothing.
_STEPS = (0.013, 1e-13, 0.0371, 0.25, 3e-5, 0.0111, 1.0, 1.7e-13, 0.09)


class Bench:
    """Brings instances somewhere and reads all that they show."""

    def __init__(self, importer: Importer) -> None:
        self.raw = Raw(importer)
        self.kinds = {
            kind: [
                each.valueReference
                for each in importer.description.modelVariables
                if each.type == kind
            ]
            for kind in ("Real", "Integer", "Boolean")
        }

    def everything(self, instance: Any) -> list[Any]:
        """Return every variable of an instance."""
        shown = []
        for kind, references in self.kinds.items():
            status, values = self.raw.read(instance, kind, references)
            assert status == 0
            shown += values
        return shown

    def mode(self, instance: Any) -> int:
        """Return the mode of an instance."""
        mode: int = self.raw.read(instance, "Integer", [self.raw.references["mode"]])[1][0]
        return mode

    def placed(self, name: str) -> Any:
        """Return an instance at one of `PLACES`."""
        values, phase, reached, mode = PLACES[name]
        if phase in ("instantiated", "initialization"):
            instance = self.raw.instance("placed")
            for each, value in values.items():
                assert self.raw.set(instance, each, value) == 0
            if phase == "initialization":
                assert self.raw.EnterInitializationMode(instance) == 0
        else:
            instance = self.raw.started("placed", **values)
            if reached > 0.0:
                for n in range(7):
                    assert self.raw.DoStep(instance, n * reached / 7.0, reached / 7.0, 1) == 0
            if phase == "terminated":
                assert self.raw.Terminate(instance) == 0
        assert self.mode(instance) == mode, name
        return instance

    def go_on(self, instance: Any, name: str) -> list[list[Any]]:
        """Go on from such a place with uneven steps and other inputs; return all that was shown."""
        _, phase, reached, _ = PLACES[name]
        raw = self.raw
        shown = [self.everything(instance)]
        if phase == "terminated":
            return shown
        if phase == "instantiated":
            assert raw.SetupExperiment(instance, 0, 0.0, 5.0, 0, 0.0) == 0
            shown.append(self.everything(instance))
            assert raw.EnterInitializationMode(instance) == 0
            phase = "initialization"
        if phase == "initialization":
            assert raw.set(instance, "F_ext", 1.5) == 0
            shown.append(self.everything(instance))
            assert raw.ExitInitializationMode(instance) == 0
        for n, step in enumerate(_STEPS):
            if n % 4 == 2:
                assert raw.set(instance, "v", 0.01 * n) == 0
                assert raw.set(instance, "k", 900.0 + 50.0 * n) == 0
            if n % 4 == 3:
                assert raw.set(instance, "load", 0.3 * n) == 0
            assert raw.DoStep(instance, reached, step, 1) == 0
            reached += step
            shown.append(self.everything(instance))
        return shown


def rolled_back(importer: Importer, _: Any) -> Any:
    """Restore a state of each place in every way that stays in the process.

    Returns by place all that was shown first, the state as text, and which ways showed it again.
    """
    bench = Bench(importer)
    raw = bench.raw
    found = {}
    for name in PLACES:
        instance = bench.placed(name)
        state = raw.save(instance)
        data = raw.pack(instance, state)
        first = bench.go_on(instance, name)
        again: dict[str, bool] = {}

        def restored(way: str, into: Any, which: Any) -> None:
            assert raw.SetFMUstate(into, which) == 0, (name, way)  # noqa: B023
            again[way] = bench.go_on(into, name) == first  # noqa: B023

        restored("rolled back", instance, state)
        restored("twice", instance, state)
        copy = raw.unpack(instance, data)
        restored("from bytes", instance, copy)
        restored("in a fresh instance", raw.instance("fresh"), state)
        restored("in one elsewhere", bench.placed("reversed slip"), copy)
        assert raw.Reset(instance) == 0
        restored("after a reset", instance, state)
        assert raw.DoStep(instance, 0.0, -1.0, 1) != 0
        assert raw.SetFMUstate(instance, state) != 0
        assert raw.GetFMUstate(instance, raw.unpack(instance, data)) != 0
        assert raw.Reset(instance) == 0
        restored("after a failure and a reset", instance, state)
        again["same bytes"] = raw.pack(instance, copy) == raw.pack(instance, state) == data
        raw.FreeInstance(instance)
        other = raw.instance("other")
        restored("after its instance is gone", other, state)
        raw.forget(other, state)
        restored("after its twin is freed", other, copy)
        raw.forget(other, copy)
        found[name] = {"first": first, "data": data.decode(), "again": again}
    return found


def resumed(importer: Importer, packed: dict[str, str]) -> Any:
    """Return all that instances show which were never set up and took these states."""
    bench = Bench(importer)
    shown = {}
    for name, data in packed.items():
        instance = bench.raw.instance("resumed")
        state = bench.raw.unpack(instance, data.encode())
        assert bench.raw.SetFMUstate(instance, state) == 0
        shown[name] = bench.go_on(instance, name)
    return shown


def shuffled(importer: Importer, seed: int) -> Any:
    """Keep a state of each step of a run, restore and free them in any order.

    Returns how many were restored, and how many of those showed again what followed.
    """
    bench = Bench(importer)
    raw = bench.raw
    generator = random.Random(seed)
    instance = raw.started(c=0.5)
    states, shown = [], []
    for n in range(120):
        states.append(raw.save(instance))
        assert raw.DoStep(instance, 0.017 * n, 0.017, 0) == 0
        shown.append(bench.everything(instance))
    alive = list(range(120))
    tried = same = 0
    while alive:
        n = generator.choice(alive)
        assert raw.SetFMUstate(instance, states[n]) == 0
        assert raw.DoStep(instance, 0.017 * n, 0.017, 0) == 0
        tried += 1
        same += bench.everything(instance) == shown[n]
        if generator.random() < 0.5:
            raw.forget(instance, states[n])
            alive.remove(n)
    return [tried, same]
