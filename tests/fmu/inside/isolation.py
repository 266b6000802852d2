"""Instances, FMUs and threads that share one process."""

import random
import struct
import sys
import threading
from collections.abc import Sequence
from typing import Any

from tests.fmu.importer import Importer
from tests.fmu.inside.states import Bench

# What is set on an instance, and the steps it takes: other inputs from some step on.
Life = dict[str, Any]


def _lives(count: int, steps: int) -> list[Life]:
    """Return so many different lives."""
    generator = random.Random(5)
    lives = []
    for n in range(count):
        values = {
            "k": generator.uniform(200.0, 3000.0),
            "m": generator.uniform(0.5, 2.0),
            "v": generator.uniform(-0.1, 0.1),
            "c": generator.choice([0.0, 0.5, 100.0]),
            "z_start": generator.uniform(-0.02, 0.02),
        }
        moves = [generator.choice([1e-13, 0.003, 0.05, 0.4]) for _ in range(steps)]
        lives.append({"name": f"life {n} %s", "values": values, "moves": moves, "v": 0.01 * n})
    return lives


class _Runner:
    """Lives one life, step by step, and notes everything that is shown as bits."""

    def __init__(self, bench: Bench, life: Life) -> None:
        self.bench = bench
        self.life = life
        self.time = 0.0
        self.count = 0
        self.shown: list[bytes] = []
        self.instance = bench.raw.started(life["name"], **life["values"])

    def step(self) -> bool:
        """Step; now and then set an input, or roll back first; return whether there is more."""
        raw, instance = self.bench.raw, self.instance
        move = self.life["moves"][self.count]
        if self.count == 5:
            assert raw.set(instance, "v", self.life["v"]) == 0
        if self.count % 7 == 3:
            state = raw.save(instance)
            assert raw.DoStep(instance, self.time, 1.0, 0) == 0
            copy = raw.unpack(instance, raw.pack(instance, state))
            assert raw.SetFMUstate(instance, copy if self.count % 2 else state) == 0
            raw.forget(instance, state)
            raw.forget(instance, copy)
        assert raw.DoStep(instance, self.time, move, 0) == 0
        self.time += move
        self.count += 1
        shown = self.bench.everything(instance)
        self.shown.append(struct.pack(f"<{len(shown)}d", *shown))
        return self.count < len(self.life["moves"])

    def end(self) -> list[bytes]:
        """Free the instance and return what was shown."""
        self.bench.raw.FreeInstance(self.instance)
        return self.shown


def _alone(bench: Bench, life: Life) -> list[bytes]:
    runner = _Runner(bench, life)
    while runner.step():
        pass
    return runner.end()


def together(importer: Importer, count: int) -> Any:
    """Live so many lives at once, their steps in random order; return how many came out as alone.

    Another instance fails and is reset all the while. Returned as well: how many lives were
    different, and how often the FMU's folder is on the module search path.
    """
    bench = Bench(importer)
    lives = _lives(count, 30)
    alone = [_alone(bench, life) for life in lives]
    generator = random.Random(6)
    failing = bench.raw.started("failing")
    runners = [_Runner(bench, life) for life in lives]
    going = list(runners)
    while going:
        runner = generator.choice(going)
        if not runner.step():
            going.remove(runner)
        if generator.random() < 0.1:
            assert bench.raw.DoStep(failing, 0.0, 0.1, 0) in (0, 4)
            assert bench.raw.SetupExperiment(failing, 0, 0.0, 0.0, 0, 0.0) == 4
            assert bench.raw.Reset(failing) == 0
    same = sum(runner.end() == shown for runner, shown in zip(runners, alone, strict=True))
    return [
        same,
        len(set(map(tuple, alone))),
        sum(str(importer.folder) in each for each in sys.path),
    ]


def in_threads(importer: Importer, count: int) -> Any:
    """Let each of so many threads live its own share of lives; return how many came out as alone.

    A thread makes its instances and frees those that another has lived.
    """
    bench = Bench(importer)
    lives = _lives(20 * count, 30)
    alone = [_alone(bench, life) for life in lives]
    shown: dict[int, list[bytes]] = {}
    ready: list[tuple[int, _Runner]] = []
    lock = threading.Lock()
    errors: list[BaseException] = []
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)

    def work(thread: int) -> None:
        try:
            for first in range(thread, len(lives), 5 * count):
                mine = range(first, len(lives), count)[:5]
                runners = [_Runner(bench, lives[n]) for n in mine]
                for _ in lives[first]["moves"]:
                    for runner in runners:
                        runner.step()
                with lock:
                    ready.extend(zip(mine, runners, strict=True))
                    given, ready[:] = ready[: len(mine)], ready[len(mine) :]
                for n, runner in given:
                    shown[n] = runner.end()
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=work, args=(thread,)) for thread in range(count)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    sys.setswitchinterval(interval)
    if errors:
        raise errors[0]
    return [sum(shown[n] == alone[n] for n in range(len(lives))), len(lives)]


def versions(importer: Importer, others: Sequence[str]) -> Any:
    """Return what each of several FMUs gives for x and z, loaded after each other and run at once.

    Each steps, then each again: what was loaded last must not answer for the others.
    """
    importers = [importer, *(Importer(other) for other in others)]
    running = []
    for each in importers:
        slave = each.instance(ready=False)
        names = [name for name in ("x", "z") if name in each.references]
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        running.append((each, slave, names))
    found: list[list[float]] = [[] for _ in running]
    for n in range(40):
        for shown, (each, slave, names) in zip(found, running, strict=True):
            slave.doStep(0.01 * n, 0.01)
            shown += each.get(slave, *names)
    again = []
    for each, _, names in running:
        # Of one that was loaded early another instance, once all the others are there.
        slave = each.instance()
        slave.doStep(0.0, 0.4)
        again.append(each.get(slave, *names))
        slave.terminate()
    for _, slave, _ in running:
        slave.terminate()
    return [found, again]
