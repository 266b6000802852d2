"""Where stick-slip ends under growing static friction: the limit, against the exact block."""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

import pytest

from stickslip_ref import COULOMB, Cycle, Parameters, critical_velocity, steady_cycle
from stickslip_verification.random_sets.draws import log_uniform, oscillator, w_of
from tests.conftest import Sized
from tests.fmu.blocks import make_block, outputs

SETTINGS = 800


@dataclass(frozen=True)
class Grown:
    """A block with a growing static friction, and where its stick-slip ends [m/s]."""

    values: dict[str, float]
    own: dict[str, float]
    limit: float = math.inf

    def cycle(self, part: float) -> Cycle:
        """Return the steady cycle at a part of the limit."""
        p = Parameters(**self.values, v=part * self.limit)
        return steady_cycle(COULOMB.complete(p, self.own))


def drawn(draw: Random, *, damped: bool) -> Grown | None:
    """Draw a block: either growth or both, zeta 1e-4 to 0.9; None where it has no limit."""
    p = oscillator(draw)
    w, gap = w_of(p), p["mu_s"] - p["mu_k"]
    own = {}
    kind = draw.choice(
        ("exponential", "logarithmic", "both") if damped else ("exponential", "both")
    )
    if kind != "logarithmic":
        own["tau_s"] = log_uniform(draw, 1e-2, 1e3) / w
    if kind != "exponential":
        own["B"] = gap * log_uniform(draw, 1e-2, 1.0)
        own["t_0"] = log_uniform(draw, 1e-3, 1e2) / w
    if damped:
        p["c"] = 2.0 * log_uniform(draw, 1e-4, 0.9) * math.sqrt(p["k"] * p["m"])
    high = 1e6 * w * gap * p["m"] * p["g"] / p["k"]
    found = critical_velocity(Parameters(**p), own=own, between=(1e-12 * high, high)).cycle
    return Grown(p, own, found[-1].high) if found and found[-1].high < high else None


def sticks_on(grown: Grown, v: float, begin: Cycle) -> bool:
    """Tell whether the block goes on sticking, from the stop of a cycle at another speed.

    It is followed until it slides on, or its sticks have shrunk to nothing or keep their length.
    """
    stop = float(begin.F_s) / grown.values["k"] - float(begin.spring_drop)
    block = make_block(**grown.values, **grown.own, v=v, z_start=stop)
    before = outputs(block)
    for _ in range(1000):
        block.advance(0.0, 300.0 * 2.0 * math.pi / w_of(grown.values))
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
    raise AssertionError(f"undecided: {grown}")


@pytest.mark.parametrize("damped", [False, True])
def test_the_block_sticks_below_the_limit_and_not_above(sized: Sized, *, damped: bool) -> None:
    tried = 0
    for n in range(sized(SETTINGS) // 4):
        grown = drawn(Random(f"limit {n}"), damped=damped)
        if grown is None:
            continue
        # Without damping the sticks shrink towards the limit, with it the cycle ends whole.
        off, begin = (1e-3, 1.0 - 1e-6) if damped else (1e-2, 0.9)
        cycle = grown.cycle(begin)
        # Where the slip reverses, the motion has no steady cycle to begin with.
        if not cycle.exists or cycle.t_slip * w_of(grown.values) > 2.0 * math.pi + 1e-3:
            continue
        assert sticks_on(grown, (1.0 - off) * grown.limit, cycle), grown
        assert not sticks_on(grown, (1.0 + off) * grown.limit, cycle), grown
        tried += 1
    assert tried > sized(SETTINGS) // 20
