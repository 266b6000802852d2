"""Blocks for the tests: made from a few values, driven over steps, read as a dictionary."""

import math
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache

from fmi.model import Spec
from stickslip_fmu.block import Block
from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.spec import SPEC, TABLE, spec_of

OUTPUTS = [each for each in TABLE.rows if each.causality == "output"]


@cache
def spec_named(law: str) -> Spec:
    return spec_of(friction_law(law).law)


def make_block(**values: float) -> Block:
    return block_of(SPEC, values)


def block_of(spec: Spec, values: Mapping[str, float]) -> Block:
    block = spec.model(spec.values({**spec.table.start_values(), **values}))
    assert isinstance(block, Block)
    return block


def outputs(block: Block) -> dict[str, float]:
    block.refresh()
    found = {}
    for variable in OUTPUTS:
        value: object = block
        for part in variable.attribute.split("."):
            value = getattr(value, part)
        assert isinstance(value, (int, float))
        found[variable.name] = value
    return found


@dataclass
class Segment:
    length: float
    changes: dict[str, float] = field(default_factory=dict)


Draw = Callable[[random.Random], tuple[dict[str, float], list[Segment]]]


def drive(
    values: Mapping[str, float],
    segments: Sequence[Segment],
    spec: Spec = SPEC,
    start_time: float = 0.0,
) -> list[dict[str, float]]:
    block = block_of(spec, values)
    time = start_time
    record = []
    for segment in segments:
        for name, value in segment.changes.items():
            block.set(name, value)
        block.advance(time, segment.length)
        time += segment.length
        record.append(outputs(block))
    return record


def log_uniform(generator: random.Random, low: float, high: float) -> float:
    return math.exp(generator.uniform(math.log(low), math.log(high)))


def draw(generator: random.Random) -> tuple[dict[str, float], list[Segment]]:
    k = log_uniform(generator, 10.0, 1e8)
    m = log_uniform(generator, 1e-2, 1e4)
    mu_s = log_uniform(generator, 0.01, 1.5)
    v = log_uniform(generator, 1e-6, 10.0) * generator.choice([1.0, 1.0, -1.0])
    w = math.sqrt(k / m)
    weight = m * 9.81
    breakaway = mu_s * weight
    damping = 2.0 * m * w
    values = {
        "m": m,
        "k": k,
        "mu_s": mu_s,
        "mu_k": mu_s * (1.0 - log_uniform(generator, 1e-3, 1.0)),
        "v": v,
        "c": generator.choice([0.0, damping * log_uniform(generator, 1e-4, 30.0)]),
        "z_start": generator.choice([0.0, generator.uniform(-1.5, 1.5) * breakaway / k]),
        "x_dot_start": generator.choice([0.0, 0.0, generator.uniform(-3.0, 3.0) * v]),
    }
    reach = min(2.0 * breakaway / k / abs(v) + 10.0 / w, 1000.0 / w)
    segments = []
    for _ in range(generator.randint(1, 8)):
        offered = {
            "v": v * generator.choice([0.0, 1.0, -1.0, 0.3, 3.0]),
            "load": weight * generator.uniform(-1.0, 1.0),
            "F_ext": breakaway * generator.uniform(-2.0, 2.0),
            "k": k * generator.uniform(0.5, 2.0),
            "c": generator.choice([0.0, damping * log_uniform(generator, 1e-3, 10.0)]),
            "mu_k": mu_s * generator.random(),
        }
        changes = {name: value for name, value in offered.items() if generator.random() < 0.3}
        segments.append(Segment(reach * log_uniform(generator, 1e-3, 3.0), changes))
    return values, segments


def draw_ageing(generator: random.Random) -> tuple[dict[str, float], list[Segment]]:
    values, segments = draw(generator)
    load_up = values["mu_s"] * values["m"] * 9.81 / (values["k"] * abs(values["v"]))
    offered: dict[str, Callable[[], float]] = {
        "tau_s": lambda: generator.choice([0.0, load_up * log_uniform(generator, 1e-3, 1e2)]),
        "B": lambda: values["mu_s"] * generator.choice([0.0, log_uniform(generator, 1e-3, 0.3)]),
        "t_0": lambda: load_up * log_uniform(generator, 1e-4, 10.0),
        "mu_s": lambda: values["mu_s"] * generator.uniform(0.5, 1.5),
    }
    values |= {name: offered[name]() for name in ("tau_s", "B", "t_0")}
    values["age_start"] = generator.choice([0.0, load_up * log_uniform(generator, 1e-3, 1e3)])
    for segment in segments:
        for name, value in offered.items():
            if generator.random() < 0.15:
                segment.changes[name] = value()
    return values, segments
