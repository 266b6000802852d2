"""Where stick-slip ends under growing static friction: the limit, against the native FMU."""

from __future__ import annotations

import math
from random import Random

from stickslip_ref import COULOMB, Cycle, Parameters, critical_velocity, steady_cycle
from tests.conftest import Sized
from tests.facts.test_cycles import oscillator, w_of
from tests.fmu.blocks import log_uniform
from tests.judge.block_draws import Setting
from tests.judge.blocks import seen
from tests.needs import needs

SETTINGS = 200


def drawn(draw: Random) -> tuple[dict[str, float], dict[str, float]]:
    p = oscillator(draw)
    w, gap = w_of(p), p["mu_s"] - p["mu_k"]
    p["c"] = 2.0 * log_uniform(draw, 1e-4, 0.9) * math.sqrt(p["k"] * p["m"])
    exponential = {"tau_s": log_uniform(draw, 1e-2, 1e3) / w}
    logarithmic = {
        "B": gap * log_uniform(draw, 1e-2, 1.0),
        "t_0": log_uniform(draw, 1e-3, 1e2) / w,
    }
    return p, draw.choice([exponential, logarithmic, {**exponential, **logarithmic}])


def sticks_on(values: dict[str, float], v: float, begin: Cycle) -> bool:
    stop = float(begin.F_s) / values["k"] - float(begin.spring_drop)
    block = Setting(0, "dwell", "coulomb", {**values, "v": v})
    return seen(block, {"z_start": stop}).kind == "sticks"


@needs("cc")
def test_the_block_sticks_below_the_limit_and_not_above(sized: Sized) -> None:
    tried = 0
    for n in range(sized(SETTINGS)):
        p, own = drawn(Random(f"limit {n}"))
        high = 1e6 * w_of(p) * (p["mu_s"] - p["mu_k"]) * p["m"] * p["g"] / p["k"]
        found = critical_velocity(Parameters(**p), own=own, between=(1e-12 * high, high)).cycle
        if not found or found[-1].high >= high:
            continue
        limit = found[-1].high
        cycle = steady_cycle(COULOMB.complete(Parameters(**p, v=(1.0 - 1e-6) * limit), own))
        # Where the slip reverses, the motion has no steady cycle to begin with.
        if not cycle.exists or cycle.t_slip * w_of(p) > 2.0 * math.pi + 1e-3:
            continue
        assert sticks_on({**p, **own}, (1.0 - 1e-3) * limit, cycle), (p, own)
        assert not sticks_on({**p, **own}, (1.0 + 1e-3) * limit, cycle), (p, own)
        tried += 1
    assert tried > sized(SETTINGS) // 5
