"""The first stick under growing static friction is exact wherever its end lies."""

import random
from collections.abc import Callable

from tests.facts.closed import Exact

from .blocks import log_uniform, make_block

SLOW = {"m": 1e6, "g": 1e-6, "k": 1.0}
"""N = 1 N, k = 1 N/m, and a slip of an hour: the first stick is what the meter shows."""


def drawn(generator: random.Random) -> dict[str, float]:
    values = {
        **SLOW,
        "mu_k": 0.5,
        "mu_s": 0.5 + generator.choice([0.0, log_uniform(generator, 1e-9, 1e3)]),
        "tau_s": log_uniform(generator, 1e-6, 1e6),
        "B": generator.choice([0.0, 0.1, log_uniform(generator, 1e-9, 1e3)]),
        "t_0": log_uniform(generator, 1e-6, 1e6),
        "v": log_uniform(generator, 1e-6, 1e6),
        "z_start": 0.5 - generator.choice([0.0, 1e-5, log_uniform(generator, 1e-12, 0.5)]),
    }
    rate = (values["mu_s"] - 0.5) / values["tau_s"] + values["B"] / values["t_0"]
    if rate and generator.random() < 0.5:
        off = generator.choice([-1.0, 1.0]) * log_uniform(generator, 1e-9, 1.0)
        values["v"] = rate * (1.0 + 0.999 * off)
    return values


def test_the_first_stick_is_exact_wherever_it_ends(sized: Callable[[int], int]) -> None:
    generator, seen = random.Random(65), 0
    while seen < sized(2_000):
        values = drawn(generator)
        p = Exact(values)
        stick = p.stick(p.z_start)
        if not 1e-9 < stick < 1e9:
            continue
        seen += 1
        passing = 1 - p.growing(stick) / p.v
        # Forces of 1 N are rounded, and the rate at which the pull passes the growth turns them
        # into time; beside a double root four roundings of the rate are its whole value.
        error = 4e-15 * ((1 + p.z_start + p.growth(stick)) / p.v + stick) / max(passing, 1e-15)
        block = make_block(**values)
        block.advance(0.0, float(stick + error) + min(1e-3 * float(stick), 100.0))
        assert abs(block.meter.t_stick - stick) <= error, values


def test_a_pull_just_as_fast_as_the_growth_breaks_away_at_once() -> None:
    # From what a fresh stop holds, friction grows by 2 N/s at first.
    values = {**SLOW, "mu_k": 0.5, "mu_s": 1.5, "tau_s": 1.0, "B": 0.5, "t_0": 0.5, "z_start": 0.5}
    for v, sticks in ((2.0, False), (2.0 + 2.0**-51, False), (1e9, False), (1.999, True)):
        block = make_block(**values, v=v)
        block.advance(0.0, 1e-5)
        assert (block.mode == 0) is sticks
