"""Runs of an FMU of FMI 3.0 with event mode and early return, in any process."""

import random
from typing import Any

from tests.driver import Fmu, loaded

# Times that are multiples of it, from 8 s on, have differences without rounding.
H, BEGIN, STEPS = 1.0 / 128.0, 8.0, 200
Values = dict[str, float]


def course(
    fmu: Fmu, events: bool, early: bool, values: Values, inputs: dict[int, Values]
) -> tuple[list[dict[str, Any]], list[float]]:
    instance, shown, stops = fmu.instance(events=events, early=early), [], []
    instance.start(BEGIN, **values)
    following = instance.handle(enter=False) if events else None
    for n in range(STEPS):
        if n in inputs:
            if events:
                instance.call("EnterEventMode")
            instance.set(**inputs[n])
            if events:
                following = instance.handle(enter=False)
        end = BEGIN + (n + 1) * H
        while instance.time < end:
            before = instance.get("mode", "n_slips", "t_event")
            event, stopped = instance.step_to_event(end - instance.time)
            assert stopped <= early
            assert stopped == (instance.time < end)
            assert event <= events
            if events:
                assert instance.get("mode", "n_slips", "t_event") == before
            if events and early:
                # What was told came true, and nothing came untold.
                assert event == (following is not None and following <= end)
                assert not event or following == instance.time
            stops += [instance.time] if event or stopped else []
            following = instance.handle() if event else following
        shown.append(instance.everything())
    instance.free()
    return shown, stops


def differences(path: str, seed: int) -> list[str]:
    """Return where runs in each mode differ from the plain one, of a random setting with inputs."""
    chance, fmu = random.Random(seed), loaded(path)
    values = {"k": chance.choice([200.0, 1e3, 5e3]), "c": chance.choice([0.0, 0.0, 2.0, 20.0])}
    values |= {"mu_s": chance.uniform(0.3, 0.6), "mu_k": chance.uniform(0.1, 0.3)}
    values |= {"v": chance.uniform(-0.3, 0.5), "z_start": chance.choice([0.0, 0.0, 0.01, -0.02])}
    ranges = {"v": (-1, 2), "F_ext": (-3, 3), "load": (-2, 9), "k": (100, 3e3), "c": (0, 3)}
    inputs = {
        n: {name: chance.uniform(*ranges[name])}
        for n in range(1, STEPS)
        for name in [chance.choice(list(ranges))]
        if chance.random() < 0.03
    }
    plain, _ = course(fmu, False, False, values, inputs)
    found = []
    for events, early in ((True, True), (True, False), (False, True)):
        eventful, _ = course(fmu, events, early, values, inputs)
        for n, (one, other) in enumerate(zip(plain, eventful, strict=True)):
            for name in one:
                slack = 2.0**-48 if name == "t_event" else 0.0
                if abs(one[name] - other[name]) > slack:
                    found.append(f"{events}, {early}, {n}: {name}")
    return found
