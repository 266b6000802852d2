"""Random sequences of a block in Python and of its twin in C, compared bit by bit."""

import math
import random
import struct
from collections.abc import Iterable, Iterator, Mapping
from ctypes import c_double
from typing import Any

from fmi.model import ModelError
from stickslip_fmu.block import Block
from tests.fmu.blocks import log_uniform
from tests.native.core import ACCEPTED, Core, NativeBlock
from tests.native.rare import RARE

STEPS = 12
_ORDER = ("m", "g", "k", "c", "mu_s", "mu_k", "load", "v", "F_ext")
_CHANGING = _ORDER[2:]
_DWELL = ("tau_s", "B", "t_0", "age_start")
_SIGNED = ("x_start", "x_dot_start", "z_start", "v", "F_ext")


def draw(random_: random.Random, name: str, values: Mapping[str, float]) -> float:
    """Return a value of a setting that goes with the others, or now and then an extreme one."""
    if random_.random() < 0.01:
        value = log_uniform(random_, 1e-100, 1e100)
        return random_.choice((-1.0, 1.0)) * value if name in _SIGNED else value
    weight = values["m"] * values["g"]
    sign = random_.choice((-1.0, 1.0))
    critical = 2.0 * math.sqrt(values["k"] * values["m"])
    some = log_uniform(random_, 1e-4, 50.0)
    load_up = weight / values["k"] / (abs(values["v"]) or 1.0)
    while_loading = load_up * log_uniform(random_, 1e-3, 1e3)
    tiny, huge = random_.choice((5e-324, 1e-310, 1e-300)), random_.choice((1e200, 1e308))
    choices = {
        "m": (log_uniform(random_, 1e-3, 1e3),),
        "g": (log_uniform(random_, 0.1, 100.0),),
        "k": (log_uniform(random_, 1.0, 1e6),),
        "c": (0.0, critical, critical * some),
        "mu_s": (0.0, random_.uniform(0.0, 1.5)),
        "mu_k": (0.0, values["mu_s"], random_.uniform(0.0, 1.5)),
        "v": (0.0, sign * log_uniform(random_, 1e-5, 10.0)),
        "load": (0.0, -weight, weight * random_.uniform(-1.0, 3.0)),
        "F_ext": (0.0, weight * random_.uniform(-2.0, 2.0)),
        "x_start": (0.0, random_.uniform(-1.0, 1.0)),
        "x_dot_start": (0.0, sign * log_uniform(random_, 1e-5, 10.0)),
        "tau_s": (*(while_loading,) * 6, 0.0, tiny, huge),
        "B": (0.0, values["mu_s"] * log_uniform(random_, 1e-4, 1.0)),
        "t_0": (*(while_loading,) * 6, 1e-307, huge),
        "age_start": (0.0, *(while_loading,) * 3, huge),
        "z_start": (0.0, sign * weight / values["k"] * log_uniform(random_, 0.01, 3.0)),
    }
    return random_.choice(choices[name])


_POINTS = range(2, 13)
_STRIBECK = (
    *("shape", "v_s", "delta", "n_points", "mu_1"),
    *(f"{name}_{point}" for point in _POINTS for name in ("u", "mu")),
)


def _draw_stribeck(random_: random.Random, name: str, values: Mapping[str, float]) -> float:
    """Return a value of a parameter of Stribeck's law; its speeds are about those of the motion.

    Now and then neighbouring lines of a curve have one slope, and a line is level.
    """
    fast = abs(values["v"]) + math.sqrt(values["m"] / values["k"]) * values["g"]
    kind, _, number = name.rpartition("_")
    if name == "shape":
        return random_.choice((1, 1, 2, 3))
    if name == "n_points":
        return random_.choice((2, 3, 4, 5, 12))
    if name == "v_s":
        return fast * log_uniform(random_, 1e-4, 10.0)
    if name == "delta":
        whole = random_.choice((1.0, 1.0, 2.0, 2.0, 3.0, 5.0, 7.0, 8.0))
        return random_.choice(
            (whole, whole, random_.uniform(1.0, 3.0), log_uniform(random_, 1.0, 50.0))
        )
    if name == "mu_1":
        low = random_.uniform(0.0, 1.0) * values["mu_s"]
        return random_.choice((values["mu_s"], low, 0.3, 0.0))
    if kind == "mu":
        before = values[f"mu_{int(number) - 1}"]
        return random_.choice((before, 0.3, random_.uniform(0.0, 1.0)))
    before = 0.0 if name == "u_2" else values[f"u_{int(number) - 1}"]
    return before + fast * random_.choice((0.1, log_uniform(random_, 1e-3, 1.0)))


def bits(values: list[float] | None) -> bytes | None:
    return None if values is None else struct.pack(f"<{len(values)}d", *values)


Move = float | Mapping[str, float] | None  # a step [s], settings by name, save and restore
Pairs = Iterator[tuple[list[float] | None, list[float] | None]]


def comparisons(core: Core, law: str, count: int) -> Iterator[tuple[object, Pairs]]:
    for settings, *moves in RARE[law]:
        yield settings, compared(core, core.spec.table.start_values() | settings, moves)
    # A sum that its last term alone rounds up, and one whose large terms cancel.
    for terms in ((1.0, 2.0**-53, 2.0**-110), (2.0**60, 1.0, -(2.0**60))):
        in_c = core.calls.exact_sum((c_double * len(terms))(*terms), len(terms))
        yield terms, iter([([math.fsum(terms)], [in_c])])
    for seed in range(count):
        yield seed, sequence(core, seed)


def compared(
    core: Core, values: Mapping[str, float], moves: Iterable[Move], time: float = 0.0
) -> Pairs:
    """Make moves in both blocks: their outputs after each step."""
    native = NativeBlock(core, values, time)
    try:
        block = core.spec.model(core.spec.values(values), time)
        assert isinstance(block, Block)
        for move in moves:
            if move is None:
                native.remake()
                block.restore(block.save())
            elif isinstance(move, float):
                native.advance(time, move)
                in_c = native.outputs()
                block.advance(time, move)
                yield outputs(core, block), in_c if native.refused == ACCEPTED else None
                time += move
            else:
                for name, value in move.items():
                    block.set(name, value)
                    native.set(name, value)
                block.check()
    # The last three are what Python raises where C goes on with infinity or NaN.
    except (ModelError, OverflowError, ValueError, ZeroDivisionError):
        yield None, None if native.refused != ACCEPTED else []


def sequence(core: Core, seed: int) -> Pairs:
    """Run one random sequence in both blocks: their outputs after each step.

    Where the law has sticks that age, they age in half of the sequences.
    """
    random_ = random.Random(seed)
    rows = core.spec.table.by_name
    values = core.spec.table.start_values()
    ages = random_.random() < 0.5
    dwell = [name for name in _DWELL if ages and name in values]
    own = [name for name in _STRIBECK if name in values]
    tunable = [name for name in own if rows[name].variability == "tunable"]
    changing = (*_CHANGING, *dwell[:-1], *tunable)
    for name in (*_ORDER, "x_start", "x_dot_start", "z_start", *dwell, *own):
        values[name] = _draw_any(random_, name, values)

    def moves() -> Iterator[Move]:
        for _ in range(STEPS):
            if random_.random() < 0.4:
                names = random_.sample(changing, random_.choice((1, 1, 2, 3)))
                for name in names:
                    values[name] = _draw_any(random_, name, values)
                yield {name: values[name] for name in names}
            # A slip takes about this long at least, so a step holds some dozen of them at most.
            period = 2.0 * math.pi * math.sqrt(values["m"] / values["k"])
            yield period * log_uniform(random_, 1e-4, 30.0) if random_.random() < 0.996 else 0.0
            if random_.random() < 0.2:
                yield None

    yield from compared(core, values, moves(), random_.choice((0.0, 1e3, -5.0)))


def _draw_any(random_: random.Random, name: str, values: Mapping[str, float]) -> float:
    return (_draw_stribeck if name in _STRIBECK else draw)(random_, name, values)


def outputs(core: Core, block: Any) -> list[float]:
    if block.stale:
        block.refresh()
    found = []
    for reference in core.outputs:
        value = block
        for name in core.spec.table.rows[reference].attribute.split("."):
            value = getattr(value, name)
        found.append(float(value))
    return found
