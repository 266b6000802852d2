"""Random sequences of a block in Python and of its twin in C, compared bit by bit."""

import math
import random
import struct
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from fmukit.model import ModelError, Spec
from stickslip_fmu.block import Block
from tests.native.core import ACCEPTED, Core, NativeBlock

STEPS = 12
_ORDER = ("m", "g", "k", "c", "mu_s", "mu_k", "load", "v", "F_ext")
_CHANGING = _ORDER[2:]
_SIGNED = ("x_start", "x_dot_start", "z_start", "v", "F_ext")

Draw = Callable[[random.Random, str, Mapping[str, float]], float]


def spread(random_: random.Random, low: float, high: float) -> float:
    """Return a number between two, its logarithm evenly spread."""
    return math.exp(random_.uniform(math.log(low), math.log(high)))


def draw(random_: random.Random, name: str, values: Mapping[str, float]) -> float:
    """Return a value of a setting that goes with the others, or now and then an extreme one."""
    if random_.random() < 0.01:
        value = spread(random_, 1e-100, 1e100)
        return random_.choice((-1.0, 1.0)) * value if name in _SIGNED else value
    weight = values["m"] * values["g"]
    sign = random_.choice((-1.0, 1.0))
    critical = 2.0 * math.sqrt(values["k"] * values["m"])
    some = spread(random_, 1e-4, 50.0)
    choices = {
        "m": (spread(random_, 1e-3, 1e3),),
        "g": (spread(random_, 0.1, 100.0),),
        "k": (spread(random_, 1.0, 1e6),),
        "c": (0.0, critical, critical * some),
        "mu_s": (0.0, random_.uniform(0.0, 1.5)),
        "mu_k": (0.0, values["mu_s"], random_.uniform(0.0, 1.5)),
        "v": (0.0, sign * spread(random_, 1e-5, 10.0)),
        "load": (0.0, -weight, weight * random_.uniform(-1.0, 3.0)),
        "F_ext": (0.0, weight * random_.uniform(-2.0, 2.0)),
        "x_start": (0.0, random_.uniform(-1.0, 1.0)),
        "x_dot_start": (0.0, sign * spread(random_, 1e-5, 10.0)),
        "z_start": (0.0, sign * weight / values["k"] * spread(random_, 0.01, 3.0)),
    }
    return random_.choice(choices[name])


def bits(values: list[float]) -> bytes:
    """Return the bytes of doubles."""
    return struct.pack(f"<{len(values)}d", *values)


def sequence(
    core: Core, spec: Spec, seed: int, draw: Draw = draw, own: tuple[str, ...] = ()
) -> Iterator[tuple[list[float] | None, list[float] | None]]:
    """Run one sequence in both blocks.

    Parameters
    ----------
    core, spec
        The compiled core, and the block in Python.
    seed
        Of the random numbers.
    draw
        Draws a value.
    own
        Parameters of the friction law that no other law has.

    Yields
    ------
    tuple
        All outputs of both after a step, None where a block refused.
    """
    random_ = random.Random(seed)
    values = spec.table.start_values()
    for name in (*_ORDER, "x_start", "x_dot_start", "z_start", *own):
        values[name] = draw(random_, name, values)
    time = random_.choice((0.0, 1e3, -5.0))
    native = NativeBlock(core, values, time)
    try:
        block = spec.model(spec.values(values), time)
        assert isinstance(block, Block)
        for _ in range(STEPS):
            if random_.random() < 0.4:
                for name in random_.sample((*_CHANGING, *own), random_.choice((1, 1, 2, 3))):
                    values[name] = draw(random_, name, values)
                    block.set(name, values[name])
                    native.set(name, values[name])
                block.check()
            # A slip takes about this long at least, so a step holds some dozen of them at most.
            period = 2.0 * math.pi * math.sqrt(values["m"] / values["k"])
            step = period * spread(random_, 1e-4, 30.0) if random_.random() < 0.996 else 0.0
            native.advance(time, step)
            given = native.outputs()
            block.advance(time, step)
            expected = _outputs(core, block)
            yield expected, given if native.refused == ACCEPTED else None
            time += step
            if random_.random() < 0.2:
                native.remake()
                block.restore(block.save())
    # The last three are what Python raises where C goes on with infinity or NaN.
    except (ModelError, OverflowError, ValueError, ZeroDivisionError):
        yield None, None if native.refused != ACCEPTED else []


def _outputs(core: Core, block: Block) -> list[float]:
    if block.stale:
        block.refresh()
    found = []
    for reference in core.outputs:
        value: Any = block
        for name in core.table.rows[reference].attribute.split("."):
            value = getattr(value, name)
        found.append(float(value))
    return found
