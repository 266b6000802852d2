"""Where stick-slip ends under growing static friction: the limit, against the exact block."""

from __future__ import annotations

import math
from random import Random

import pytest

from stickslip_ref import COULOMB, Cycle, Parameters, critical_velocity, steady_cycle
from stickslip_verification.random_sets.draws import log_uniform, oscillator, w_of
from tests.conftest import Sized
from tests.fmu.blocks import make_block, outputs

SETTINGS = 200


def drawn(draw: Random) -> tuple[dict[str, float], dict[str, float]]:
    """Draw a damped block, zeta 1e-4 to 0.9, and the growth of its friction: either or both."""
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
    """Tell whether the block goes on sticking, from the stop of a cycle at another speed.

    It is followed until it slides on, or its sticks have shrunk to nothing or keep their length.
    """
    stop = float(begin.F_s) / values["k"] - float(begin.spring_drop)
    block = make_block(**values, v=v, z_start=stop)
    before = outputs(block)
    for _ in range(1000):
        block.advance(0.0, 300.0 * 2.0 * math.pi / w_of(values))
        got = outputs(block)
        if got["mode"] and got["n_slips"] == before["n_slips"]:
            return False
        if got["t_stick"] < 1e-3 * float(begin.t_stick):
            return False
        # Two sticks of one length, or one that takes longer than this.
        still = got["t_stick"] == pytest.approx(before["t_stick"], rel=1e-7)
        if still and (got["n_slips"] > before["n_slips"] or got["sticking"]):
            return True
        before = got
    raise AssertionError(f"undecided: {values}")


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
