"""What tests do with FMUs in a process that has them and not the project."""

import contextlib
import ctypes as c
import gc
import json
import os
import random
import shutil
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import fmpy

from tests.driver import Fmu, Instance, Refused, loaded

# Steps that meet events anywhere, hold some, and hold next to nothing.
_STEPS = (0.013, 1e-13, 0.0371, 0.25, 3e-5, 1.0, 1.7e-13, 0.09)
_CHANCE = random.Random(7)


def _went_on(instance: Instance) -> list[dict[str, Any]]:
    shown = [instance.everything()]
    for n, step in enumerate(_STEPS):
        instance.set(v=0.01 * n, k=900.0 + 50.0 * n, load=0.3 * n)
        instance.step(step)
        shown.append(instance.everything())
    return shown


def written(path: str, places: list[tuple[dict[str, float], float]]) -> list[list[Any]]:
    found = []
    for values, reached in places:
        instance = loaded(path).started(**values)
        instance.step(reached / 7.0, times=7)
        state = instance.pack().hex(), instance.time
        found.append([_went_on(instance), state])
    return found


def resumed(path: str, states: list[tuple[str, float]]) -> list[list[Any]]:
    shown = []
    for data, time in states:
        instance = loaded(path).instance()
        instance.resume(bytes.fromhex(data))
        instance.time = time
        shown.append(_went_on(instance))
    return shown


_BAD: tuple[Any, ...] = (None, "x", float("nan"), float("inf"), [], {}, True, 10**400)
_BELOW_ZERO = ("elapsed", "t_slip", "t_stick", "T", "n_slips", "Q_friction", "k", "mu_s")
_GARBAGE = (b"", b"{", b"[]", b"null", b"[" * 100_000, b'{"block": 1}', b"\xff")


def _places(tree: Any, name: str = "") -> Iterator[tuple[Any, Any, str]]:
    for key in list(tree) if isinstance(tree, dict) else range(len(tree)):
        named = key if isinstance(key, str) else name
        if isinstance(tree[key], (dict, list)):
            yield from _places(tree[key], named)
        else:
            yield tree, key, named


def spoilt(path: str) -> tuple[int, list[str]]:
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
    function = c.CDLL(None).mallinfo2
    function.restype = _Mallinfo
    gc.collect()
    return sys.getallocatedblocks(), function().field7


def _iterate(instance: Instance) -> None:
    state = instance.save()
    instance.step(0.01)
    instance.restore(state)
    freed = c.c_void_p(state.value)
    instance.forget(state)
    # The wrapper leaves the pointer as it was, for masters to free again.
    instance.forget(freed)
    # Every state is of another moment.
    instance.step(1e-4)


def _serialize(instance: Instance) -> None:
    instance.resume(instance.pack())
    instance.step(1e-3)


@cache
def _known(instance: Instance) -> dict[str, Any]:
    return instance.everything()


def _ask_ever_other_lists(instance: Instance) -> None:
    types = {n: kind for n, kind in instance.fmu.types.items() if n not in instance.fmu.beside}
    reals = [name for name, kind in types.items() if kind in ("Real", "Float64")]
    names = _CHANCE.sample(reals, 5)
    assert instance.get(*names) == [_known(instance).get(name, 0.0) for name in names]


def _repeat(instance: Instance) -> None:
    instance.reset()
    instance.start()
    instance.step(0.3)
    with contextlib.suppress(Refused):
        instance.step(-1.0)
    with contextlib.suppress(Refused):
        instance.terminate()
    instance.fmu.messages.clear()


def _ask_after_a_failure(instance: Instance) -> None:
    with contextlib.suppress(Refused):
        instance.step(-1.0)
    with contextlib.suppress(Refused):
        instance.save()
    instance.fmu.messages.clear()
    instance.reset()
    instance.start()


def _remake(instance: Instance) -> None:
    other = instance.fmu.started()
    other.step(0.3)
    other.free()


TURNS: dict[str, Callable[[Instance], None]] = {
    "iteration": _iterate,
    "serialization": _serialize,
    "lists of variables": _ask_ever_other_lists,
    "failures and resets": _repeat,
    "states asked for after a failure": _ask_after_a_failure,
    "instances": _remake,
}


def lost(path: str, what: str, times: int) -> list[float]:
    with Path(os.devnull).open("w") as nowhere, contextlib.redirect_stderr(nowhere):
        turn, instance = TURNS[what], loaded(path).started(c=0.5)
        # More turns than the FMU keeps freed states, and lists of variables.
        for _ in range(768):
            turn(instance)
        before = _in_use()
        for _ in range(times):
            turn(instance)
        return [(now - then) / times for now, then in zip(_in_use(), before, strict=True)]


def of_versions(paths: list[str]) -> list[list[Any]]:
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


def modules(path: str) -> tuple[list[str], int]:
    before = set(sys.modules)
    fmu = loaded(path)
    for _ in range(3):
        fmu.instance()
    entries = sum(str(fmu.folder) in each for each in sys.path)
    return sorted({name.partition(".")[0] for name in set(sys.modules) - before}), entries


class _Broken:
    def write(self, text: str) -> int:
        raise OSError("no such terminal")

    flush = write


def without_standard_error(path: str) -> list[Any]:
    found = []
    streams: tuple[Any, ...] = (_Broken(), None)
    for stream in streams:
        sys.stderr = stream
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


def printed_log(path: str) -> list[str]:
    texts: list[str] = []
    fmpy.simulate_fmu(
        path,
        stop_time=0.1,
        debug_logging=True,
        logger=lambda *call: texts.append(call[-1].decode()),
    )
    return texts
