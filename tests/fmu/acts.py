"""What tests do with FMUs in a process that has them and not the project."""

import contextlib
import ctypes as c
import gc
import json
import os
import random
import shutil
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fmpy

from tests.driver import Fmu, Instance, Refused, loaded

# A slip from a spring beyond F_s on both sides of it: forward until 0.1 s, then backward.
_FAR = {"z_start": 0.02}
PLACES: dict[str, tuple[dict[str, float], str, float]] = {
    "values set": ({"k": 500.0, "z_start": 0.001}, "instantiated", 0.0),
    "initialization": ({"mu_s": 0.4, **_FAR}, "initialization", 0.0),
    "before the first step": ({"v": 0.05}, "stepping", 0.0),
    "stick": ({}, "stepping", 0.1),
    "second slip": ({}, "stepping", 0.6),
    "reversed slip": (_FAR, "stepping", 0.15),
    "slip from the start": ({"x_dot_start": -0.3}, "stepping", 0.005),
    "damped slip": ({"c": 2.0, **_FAR}, "stepping", 0.05),
    "overdamped slip": ({"c": 100.0, **_FAR}, "stepping", 0.05),
    "ageing stick": ({"tau_s": 0.1, "B": 0.02, "age_start": 2.0}, "stepping", 0.1),
    "clamped": ({"mu_k": 0.9}, "stepping", 0.3),
    "terminated": ({}, "terminated", 0.3),
}
"""By name: values set, phase, time reached [s]."""

# Steps that meet events anywhere, hold some, and hold next to nothing.
_STEPS = (0.013, 1e-13, 0.0371, 0.25, 3e-5, 1.0, 1.7e-13, 0.09)


def _placed(fmu: Fmu, name: str) -> Instance:
    values, phase, reached = PLACES[name]
    instance = fmu.instance()
    instance.set(**values)
    if phase != "instantiated":
        instance.enter()
    if phase in ("stepping", "terminated"):
        instance.call("ExitInitializationMode")
    if reached:
        instance.step(reached / 7.0, times=7)
    if phase == "terminated":
        instance.terminate()
    return instance


def _went_on(instance: Instance, name: str) -> list[dict[str, Any]]:
    """Return all that is shown from such a place on."""
    phase = PLACES[name][1]
    shown = [instance.everything()]
    if phase == "terminated":
        return shown
    if phase == "instantiated":
        instance.enter(0.0)
    if phase != "stepping":
        instance.set(F_ext=1.5)
        shown.append(instance.everything())
        instance.call("ExitInitializationMode")
    for n, step in enumerate(_STEPS):
        if n % 3 == 2:
            instance.set(v=0.01 * n, k=900.0 + 50.0 * n, load=0.3 * n)
        instance.step(step)
        shown.append(instance.everything())
    return shown


def written(path: str) -> dict[str, tuple[str, list[Any]]]:
    """Return of each place the state as hexadecimal bytes, and what is shown after it."""
    found = {}
    for name in PLACES:
        instance = _placed(loaded(path), name)
        instance.time = PLACES[name][2]
        found[name] = instance.pack().hex(), _went_on(instance, name)
    return found


def resumed(path: str, states: dict[str, str]) -> dict[str, list[Any]]:
    """Return what instances show that took these states and nothing else."""
    shown = {}
    for name, data in states.items():
        instance = loaded(path).instance()
        instance.resume(bytes.fromhex(data))
        instance.time = PLACES[name][2]
        shown[name] = _went_on(instance, name)
    return shown


def shuffled(path: str) -> tuple[int, int]:
    """Restore and free the states of each step of a run in any order.

    Returns how many were restored, and how many of these showed again what followed.
    """
    chance = random.Random(1)
    instance = loaded(path).started(c=0.5)
    states, shown = [], []
    for _ in range(60):
        states.append((instance.save(), instance.time))
        instance.step(0.034)
        shown.append(instance.everything())
    alive = list(range(len(states)))
    tried = same = 0
    while alive:
        n = chance.choice(alive)
        state, instance.time = states[n]
        instance.restore(state)
        instance.step(0.034)
        tried += 1
        same += instance.everything() == shown[n]
        if chance.random() < 0.5:
            instance.forget(state)
            alive.remove(n)
    return tried, same


_BAD = (None, "x", float("nan"), float("inf"), [], {}, True, 10**400)
_BELOW_ZERO = ("elapsed", "t_slip", "t_stick", "T", "n_slips", "Q_friction", "k", "mu_s")
_GARBAGE = (b"", b"{", b"[]", b"null", b"[" * 100_000, b'{"block": 1}', b"\xff")


def _places(tree: Any, name: str = "") -> Iterator[tuple[Any, Any, str]]:
    """Give list or dictionary, key there and last name above of every value in a state."""
    for key in list(tree) if isinstance(tree, dict) else range(len(tree)):
        named = key if isinstance(key, str) else name
        if isinstance(tree[key], (dict, list)):
            yield from _places(tree[key], named)
        else:
            yield tree, key, named


def spoilt(path: str) -> tuple[int, list[str]]:
    """Spoil a state in every place; return how often, and which of these were taken.

    One is taken that is refused by an error which was not meant, too.
    """
    instance = loaded(path).started(c=0.5)
    instance.step(0.02, times=30)
    state = json.loads(instance.pack())
    tries = [(text.hex(), text) for text in _GARBAGE]
    met = set()
    for tree, key, name in _places(state):
        good = tree[key]
        bads = [bad for bad in _BAD if not isinstance(good, type(bad)) or isinstance(bad, float)]
        if name in _BELOW_ZERO and good is not None:
            met.add(name)
            bads.append(-1e6)
        for bad in bads:
            tree[key] = bad
            tries.append((f"{name} = {str(bad)[:9]}", json.dumps(state).encode()))
        tree[key] = good
    assert met == set(_BELOW_ZERO)
    taken = []
    for name, data in tries:
        copy = instance.unpack(data)
        try:
            instance.restore(copy)
            taken.append(name)
        except Refused as refused:
            if "internal error" in str(refused):
                taken.append(str(refused))
        instance.reset()
        instance.start()
        instance.step(0.1)
    return len(tries), taken


class _Mallinfo(c.Structure):
    _fields_ = tuple((f"field{n}", c.c_size_t) for n in range(10))


def _in_use() -> tuple[int, int]:
    """Return the blocks of Python's memory in use, and the bytes of the C library's."""
    function = c.CDLL(None).mallinfo2
    function.restype = _Mallinfo
    gc.collect()
    return sys.getallocatedblocks(), function().field7


def _iterate(fmu: Fmu) -> Callable[[], None]:
    """Save, step, restore and free, as a master does that iterates over its steps."""
    instance = fmu.started(c=0.5)

    def do() -> None:
        state = instance.save()
        instance.step(0.01)
        instance.restore(state)
        freed = c.c_void_p(state.value)
        instance.forget(state)
        # The wrapper leaves the pointer as it was, for masters to free again.
        instance.forget(freed)
        # Every state is of another moment.
        instance.step(1e-4)

    return do


def _serialize(fmu: Fmu) -> Callable[[], None]:
    instance = fmu.started(c=0.5)

    def do() -> None:
        instance.resume(instance.pack())
        instance.step(1e-3)

    return do


def _ask_ever_other_lists(fmu: Fmu) -> Callable[[], None]:
    instance, chance = fmu.started(), random.Random(7)
    reals = [name for name, kind in fmu.types.items() if kind in ("Real", "Float64")]
    alone = instance.everything()

    def do() -> None:
        names = chance.sample(reals, 5)
        assert instance.get(*names) == [alone.get(name, 0.0) for name in names]

    return do


def _repeat(fmu: Fmu) -> Callable[[], None]:
    instance = fmu.instance()

    def do() -> None:
        instance.start()
        instance.step(0.3)
        with contextlib.suppress(Refused):
            instance.step(-1.0)
        with contextlib.suppress(Refused):
            instance.terminate()
        fmu.messages.clear()
        instance.reset()

    return do


def _ask_after_a_failure(fmu: Fmu) -> Callable[[], None]:
    instance = fmu.started()

    def do() -> None:
        with contextlib.suppress(Refused):
            instance.step(-1.0)
        with contextlib.suppress(Refused):
            instance.save()
        fmu.messages.clear()
        instance.reset()
        instance.start()

    return do


def _remake(fmu: Fmu) -> Callable[[], None]:
    def do() -> None:
        instance = fmu.started()
        instance.step(0.3)
        instance.free()

    return do


TURNS = {
    "iteration": _iterate,
    "serialization": _serialize,
    "lists of variables": _ask_ever_other_lists,
    "failures and resets": _repeat,
    "states asked for after a failure": _ask_after_a_failure,
    "instances": _remake,
}


def lost(path: str, what: str, times: int) -> list[float]:
    """Return how many blocks of Python's and bytes of C's memory a turn of something loses."""
    with Path(os.devnull).open("w") as nowhere, contextlib.redirect_stderr(nowhere):
        do = TURNS[what](loaded(path))
        # More turns than the FMU keeps freed states, and lists of variables.
        for _ in range(768):
            do()
        before = _in_use()
        for _ in range(times):
            do()
        return [(now - then) / times for now, then in zip(_in_use(), before, strict=True)]


def _lives(count: int) -> list[dict[str, Any]]:
    """Return so many different lives: values, steps, a later speed."""
    chance = random.Random(5)
    return [
        {
            "values": {
                "k": chance.uniform(200.0, 3000.0),
                "m": chance.uniform(0.5, 2.0),
                "v": chance.uniform(-0.1, 0.1),
                "c": chance.choice([0.0, 0.5, 100.0]),
                "z_start": chance.uniform(-0.02, 0.02),
            },
            "steps": [chance.choice([1e-13, 0.003, 0.05, 0.4]) for _ in range(15)],
            "v": 0.01 * n,
        }
        for n in range(count)
    ]


def _lived(fmu: Fmu, life: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Give what an instance shows after each step, with a rollback on the way."""
    instance = fmu.started(**life["values"])
    for n, step in enumerate(life["steps"]):
        if n % 7 == 3:
            instance.set(v=life["v"])
            data, time = instance.pack(), instance.time
            instance.step(1.0)
            instance.resume(data)
            instance.time = time
        instance.step(step)
        yield instance.everything()
    instance.free()


def together(path: str, count: int) -> tuple[int, int, int]:
    """Live lives at once, in random order, while another instance fails and is reset.

    Returns how many lives came out as alone, how many are different, and how often the FMU is on
    the search path.
    """
    fmu, lives = loaded(path), _lives(count)
    alone = [list(_lived(fmu, life)) for life in lives]
    chance, failing = random.Random(6), fmu.started()
    going = [(n, _lived(fmu, life)) for n, life in enumerate(lives)]
    shown: list[list[Any]] = [[] for _ in lives]
    while going:
        n, life = chance.choice(going)
        try:
            shown[n].append(next(life))
        except StopIteration:
            going.remove((n, life))
        if chance.random() < 0.1:
            with contextlib.suppress(Refused):
                failing.step(-1.0)
            failing.reset()
            failing.start()
    same = sum(a == b for a, b in zip(shown, alone, strict=True))
    entries = sum(str(fmu.folder) in each for each in sys.path)
    return same, len({str(each) for each in alone}), entries


def in_threads(path: str, count: int) -> int:
    """Live lives in threads that take turns at any moment; return how many came out as alone."""
    fmu, lives = loaded(path), _lives(8 * count)
    alone = [list(_lived(fmu, life)) for life in lives]
    shown: dict[int, list[Any]] = {}

    def work(first: int) -> None:
        mine = range(first, len(lives), count)
        # All at once, step by step.
        steps = list(zip(*(_lived(fmu, lives[n]) for n in mine), strict=True))
        shown.update(zip(mine, map(list, zip(*steps, strict=True)), strict=True))

    sys.setswitchinterval(1e-5)
    threads = [threading.Thread(target=work, args=(n,)) for n in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return sum(shown.get(n) == alone[n] for n in range(len(lives)))


def of_versions(paths: list[str]) -> list[list[Any]]:
    """Return what each of several FMUs shows, all loaded before, all stepped in turns.

    Then once more of a new instance of each: what was loaded last must not answer for the others.
    """
    fmus = [loaded(path) for path in paths]
    names = [[name for name in ("x", "z") if name in fmu.references] for fmu in fmus]
    running = [fmu.started() for fmu in fmus]
    found: list[list[Any]] = [[] for _ in fmus]
    for _ in range(40):
        for shown, instance, shows in zip(found, running, names, strict=True):
            instance.step(0.01)
            shown += instance.get(*shows)
    for shown, fmu, shows in zip(found, fmus, names, strict=True):
        instance = fmu.started()
        instance.step(0.4)
        shown += instance.get(*shows)
        instance.free()
    return found


def modules(path: str) -> list[str]:
    """Return the packages that a first instance loads."""
    before = set(sys.modules)
    loaded(path).instance()
    return sorted({name.partition(".")[0] for name in set(sys.modules) - before})


class _Broken:
    def write(self, text: str) -> int:
        raise OSError("no such terminal")

    flush = write


def without_standard_error(path: str) -> list[Any]:
    """Warn and fail while standard error cannot be written; return what is shown and refused."""
    found = []
    for stream in (_Broken(), None):
        sys.stderr = stream  # type: ignore[assignment]
        instance = loaded(path).started(mu_s=0.3, mu_k=0.5)
        instance.step(0.1)
        found += instance.get("mu_k_used")
        try:
            instance.step(-1.0)
        except Refused as refused:
            found.append(refused.messages[-1])
        instance.free()
    sys.stderr = sys.__stderr__
    return found


def left_loaded(path: str) -> None:
    """Delete the folder of an FMU that stays loaded, its address having a slash too many."""
    fmu = Fmu(path)
    folder = fmu.folder
    fmu.folder = Path(f"/{folder}")
    fmu.started().free()
    shutil.rmtree(folder)


def flags_of_a_step(path: str, h: float) -> list[Any]:
    """Return of an FMI 3.0 step from 0.1 s on status, terminate, last successful time, the log."""
    fmu = loaded(path)
    instance = fmu.started()
    instance.step(0.1)
    fmu.messages.clear()
    flags, reached = [c.c_bool(True) for _ in range(3)], c.c_double(-7.0)
    status = instance.status("DoStep", 0.1, h, True, *map(c.byref, flags), c.byref(reached))
    return [status, flags[1].value, reached.value, fmu.messages]


def calls_of_other_interfaces(path: str) -> dict[str, int]:
    """Return the status of FMI 3.0's calls that nothing declares, each followed by a reset."""
    instance = loaded(path).started()
    values, none = (c.c_double * 1)(), c.c_size_t(0)
    flags = [c.byref(c.c_bool()) for _ in range(5)]
    found = {}
    for name, arguments in {
        "SetTime": (1.0,),
        "GetContinuousStates": (values, none),
        "SetContinuousStates": (values, none),
        "GetContinuousStateDerivatives": (values, none),
        "GetNominalsOfContinuousStates": (values, none),
        "GetEventIndicators": (values, none),
        "UpdateDiscreteStates": (*flags, c.byref(c.c_double())),
    }.items():
        found[name] = instance.status(name, *arguments)
        instance.reset()
        instance.start()
        instance.step(0.1)
    return found


def printed_log(path: str) -> list[str]:
    """Return the log of a run, its messages read by C's printf as simulators written in C do."""
    texts: list[str] = []
    fmpy.simulate_fmu(
        path,
        stop_time=0.1,
        debug_logging=True,
        logger=lambda *call: texts.append(call[-1].decode()),
    )
    return texts
