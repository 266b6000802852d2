"""What the reference says of random blocks is what the native FMU does from 20 starts."""

from __future__ import annotations

import pytest

from stickslip_ref import (
    Parameters,
    critical_velocity,
    dwell_attractors,
    friction_law,
    steady_cycle,
)
from tests.judge.block_draws import BLOCKS, Setting, setting
from tests.judge.blocks import judged, seen
from tests.needs import needs

COMMON = {"m", "k", "c", "mu_s", "mu_k", "v"}


def disagreements(drawn: Setting) -> list[str]:
    values = {name: value for name, value in drawn.values.items() if name in COMMON}
    own = {name: float(value) for name, value in drawn.values.items() if name not in COMMON}
    law, v = friction_law(drawn.law), drawn.values["v"]
    p = law.complete(Parameters(**values), own)
    motions = [motion for motion, _ in judged(drawn)]
    limits = critical_velocity(p, law, between=(0.9 * v, 1.1 * v)).motions(v)
    sticks = any(motion.kind == "sticks" for motion in motions)
    if law.ages(p) and not sticks:
        # One that draws in so few starts that none of the 20 was among them.
        sticks = any(stick_seen(drawn, each.t_stick[0]) for each in dwell_attractors(p).attractors)
    wrong = [f"limits: {limits}"] * (sticks != ("sticks" in limits))
    swings = [motion for motion in motions if motion.kind == "swings"]
    # Swings of many sizes: even sliding is neutrally stable, to what can be seen.
    if len(swings) < 2:
        even = any(motion.kind == "even" for motion in motions)
        wrong += [f"limits: {limits}"] * (even != ("even" in limits))
    if drawn.law == "coulomb" and motions[0].kind != "unsettled":
        cycle, rest = steady_cycle(p), motions[0]
        wrong += [f"cycle: {cycle}"] * (cycle.exists != (rest.sticks == 1))
        if cycle.exists and rest.sticks == 1:
            # Two looks agreed to 1e-6; where sticks hardly come nearer, ten times that is left.
            same = (cycle.T, cycle.t_stick) == pytest.approx((rest.period, rest.t_stick), rel=1e-5)
            wrong += [f"cycle: {cycle}"] * (not same)
    return [f"{text}; seen {motions} of {drawn}" for text in wrong]


def stick_seen(drawn: Setting, age: float) -> bool:
    p = drawn.values
    return seen(drawn, {"z_start": drawn.hold(age) / p["k"] - p["v"] * age}).kind == "sticks"


@needs("cc")
@pytest.mark.parametrize(
    "numbers",
    [
        pytest.param(range(0, BLOCKS, 41), marks=pytest.mark.gate, id="sample"),
        *(
            pytest.param(range(first, BLOCKS, 20), marks=pytest.mark.soak, id=f"{first} of 20")
            for first in range(20)
        ),
    ],
)
def test_each_motion_that_is_said_is_seen_and_no_other_one(numbers: range) -> None:
    assert [text for number in numbers for text in disagreements(setting(number))] == []
