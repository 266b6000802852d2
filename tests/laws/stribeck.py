"""Blocks under Stribeck's law for the tests: made, driven, drawn at random."""

import math
import random
from collections.abc import Sequence

from stickslip_fmu.block import Block
from stickslip_fmu.laws.stribeck.law import STRIBECK
from stickslip_fmu.spec import spec_of
from tests.fmu.blocks import Segment, block_of, draw, log_uniform

SPEC = spec_of(STRIBECK)
Points = list[tuple[float, float]]

FALLS_TWICE: Points = [(0.0, 0.5), (0.02, 0.3), (0.15, 0.45), (0.4, 0.2), (0.6, 0.25)]


def make_block(**values: float) -> Block:
    return block_of(SPEC, values)


def curve(points: Sequence[Sequence[float]]) -> dict[str, float]:
    values: dict[str, float] = {"shape": 3, "n_points": len(points), "mu_1": points[0][1]}
    for number, (speed, mu) in enumerate(points[1:], 2):
        values[f"u_{number}"], values[f"mu_{number}"] = speed, mu
    return values


def draw_curve(generator: random.Random) -> tuple[dict[str, float], list[Segment]]:
    values, segments = draw(generator)
    mu_s, v = values["mu_s"], abs(values["v"])
    w = math.sqrt(values["k"] / values["m"])
    fast = mu_s * 9.81 / w + v
    steepest = 6.0 * w / 9.81
    points = [(0.0, mu_s * generator.choice([1.0, generator.random()]))]
    for _ in range(generator.randint(1, 11)):
        speed, mu = points[-1]
        near = generator.choice([fast, v]) * log_uniform(generator, 1e-3, 1.0)
        width = max(near, speed * 1e-2)
        mu = min(max(mu_s * generator.random(), mu - steepest * width), mu + steepest * width)
        points.append((speed + width, mu))
    for segment in segments:
        segment.changes.pop("mu_k", None)
    del values["mu_k"]
    return {**values, **curve(points)}, segments


def draw_smooth(generator: random.Random) -> tuple[dict[str, float], list[Segment]]:
    values, segments = draw(generator)
    fast = values["mu_s"] * 9.81 / math.sqrt(values["k"] / values["m"]) + abs(values["v"])
    values["shape"] = generator.choice([1, 1, 2])
    values["v_s"] = fast * log_uniform(generator, 1e-4, 10.0)
    values["delta"] = generator.choice([1.0, 2.0, 3.0, 5.0, generator.uniform(1.0, 4.0)])
    for segment in segments:
        # The slips of most draws are short beside the segments: this bounds the time of the test.
        segment.length *= 0.3
        if generator.random() < 0.2:
            segment.changes["v_s"] = values["v_s"] * generator.uniform(0.5, 2.0)
        if generator.random() < 0.1:
            segment.changes["delta"] = generator.choice([1.0, 2.0, 1.7])
    return values, segments
