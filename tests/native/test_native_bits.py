"""The native block and the Python block are the same arithmetic."""

import math
import random
import struct
from collections.abc import Iterable, Iterator
from typing import Any

import pytest

from fmukit.model import ModelError
from stickslip_fmu.block import Block
from stickslip_fmu.spec import SPEC, TABLE
from tests.native.core import ACCEPTED, OUTPUTS, Core, NativeBlock, compile_core
from tests.needs import needs

SEQUENCES = 5_000
STEPS = 12
_READ = [TABLE.rows[each].attribute for each in OUTPUTS]
_CHANGING = ["v", "load", "F_ext", "k", "c", "mu_s", "mu_k"]


@pytest.fixture(scope="module")
def core(tmp_path_factory: pytest.TempPathFactory) -> Core:
    """Compile the core once."""
    return Core(compile_core(tmp_path_factory.mktemp("core")))


def _draw(random_: random.Random, name: str, values: dict[str, float]) -> float:
    """Return a value of a setting that goes with the others."""

    def spread(low: float, high: float) -> float:
        return math.exp(random_.uniform(math.log(low), math.log(high)))

    if random_.random() < 0.01:
        # Beyond what is refused, and close to it.
        value = spread(1e-100, 1e100)
        signed = name in ("x_start", "x_dot_start", "z_start", "v", "F_ext")
        return random_.choice((-1.0, 1.0)) * value if signed else value
    weight = values["m"] * values["g"]
    sign = random_.choice((-1.0, 1.0))
    critical = 2.0 * math.sqrt(values["k"] * values["m"])
    choices = {
        "m": lambda: spread(1e-3, 1e3),
        "g": lambda: spread(0.1, 100.0),
        "k": lambda: spread(1.0, 1e6),
        "c": lambda: random_.choice((0.0, critical, critical * spread(1e-4, 50.0))),
        "mu_s": lambda: random_.choice((0.0, random_.uniform(0.0, 1.5))),
        "mu_k": lambda: random_.choice((0.0, values["mu_s"], random_.uniform(0.0, 1.5))),
        "v": lambda: random_.choice((0.0, sign * spread(1e-5, 10.0))),
        "load": lambda: random_.choice((0.0, -weight, weight * random_.uniform(-1.0, 3.0))),
        "F_ext": lambda: random_.choice((0.0, weight * random_.uniform(-2.0, 2.0))),
        "x_start": lambda: random_.choice((0.0, random_.uniform(-1.0, 1.0))),
        "x_dot_start": lambda: random_.choice((0.0, sign * spread(1e-5, 10.0))),
        "z_start": lambda: random_.choice((0.0, sign * weight / values["k"] * spread(0.01, 3.0))),
    }
    return choices[name]()


def _bits(values: list[float]) -> bytes:
    return struct.pack(f"<{len(values)}d", *values)


def _python_outputs(block: Block) -> list[float]:
    if block.stale:
        block.refresh()
    found = []
    for attribute in _READ:
        value: Any = block
        for name in attribute.split("."):
            value = getattr(value, name)
        found.append(float(value))
    return found


def _sequence(core: Core, seed: int) -> Iterator[tuple[list[float] | None, list[float] | None]]:
    """Run one sequence in both; give the outputs after each step, None for a refusal."""
    random_ = random.Random(seed)
    values = SPEC.values.table.start_values()
    for name in ("m", "g", *_CHANGING[3:], "load", "v", "F_ext", *TABLE.by_name):
        if name.endswith("_start") or name in ("m", "g", *_CHANGING):
            values[name] = _draw(random_, name, values)
    time = random_.choice((0.0, 1e3, -5.0))
    native = NativeBlock(core, values, time)
    try:
        block = SPEC.model(SPEC.values(values), time)
    except ModelError:
        yield None, None if native.refused != ACCEPTED else []
        return
    assert isinstance(block, Block)
    period = 2.0 * math.pi * math.sqrt(values["m"] / values["k"])
    for _ in range(STEPS):
        try:
            if random_.random() < 0.4:
                for name in random_.sample(_CHANGING, random_.choice((1, 1, 2, 3))):
                    values[name] = _draw(random_, name, values)
                    block.set(name, values[name])
                    native.set(name, values[name])
                block.check()
            step = period * math.exp(random_.uniform(math.log(1e-4), math.log(30.0)))
            if random_.random() < 0.004:
                step = 0.0
            block.advance(time, step)
            expected = _python_outputs(block)
        except (ModelError, OverflowError, ValueError, ZeroDivisionError):
            native.advance(time, step)
            native.outputs()
            yield None, None if native.refused != ACCEPTED else []
            return
        native.advance(time, step)
        given = native.outputs()
        yield expected, given if native.refused == ACCEPTED else None
        time += step
        if random_.random() < 0.2:
            native.remake()
            try:
                block.restore(block.save())
            except ModelError:
                yield None, None if native.refused != ACCEPTED else []
                return


def first_difference(core: Core, seeds: Iterable[int]) -> str | None:
    """Return where native and Python block first differ in sequences of these seeds, or None."""
    for seed in seeds:
        for number, (expected, given) in enumerate(_sequence(core, seed)):
            if expected is None or given is None:
                if expected is not given:
                    return f"seed {seed}, step {number}: {given}, not {expected}"
            elif _bits(expected) != _bits(given):
                return f"seed {seed}, step {number}: {given}, not {expected}"
    return None


@needs("cc")
def test_native_block_gives_the_bits_of_the_python_block(core: Core) -> None:
    """After every step of 5,000 random sequences all outputs of both are equal to the bit."""
    compared = refused = 0
    for seed in range(SEQUENCES):
        for number, (expected, given) in enumerate(_sequence(core, seed)):
            if expected is None or given is None:
                assert expected is given is None, (seed, number, expected, given)
                refused += 1
                continue
            assert _bits(expected) == _bits(given), (seed, number, expected, given)
            compared += len(given)
    assert compared > 1_000_000
    print(f"{compared} values equal, {refused} refusals in both")
