"""What `design` says of random axes, against a simulation that knows no events."""

import math
from dataclasses import replace
from typing import Final

import numpy as np
import pytest

from stickslip_design.axis import Friction
from stickslip_design.loop.critical import regime_of
from stickslip_design.loop.stability import is_stable
from stickslip_design.one_thread import one_thread
from tests.conftest import Sized, thinned
from tests.design.axes import RIGID
from tests.design.drawn import random_axis, random_drive
from tests.design.simulated import EVEN, STARTS, Simulation
from tests.needs import needs

pytestmark = needs("cc")

JUMPS_UNSEEN: Final = {
    47: "2 % below the end of an island of jumps; a blow of 1.35 F_s starts them"
}
"""Axes of which no start of the simulation shows the jumps that they are said to have, and why."""
FADING: Final = 1e-6
"""Growth or decay of a swing in 1/w below which its sign is rounding of the finite differences."""


def test_a_simulated_slip_without_damping_has_the_peak_of_the_closed_form() -> None:
    axis, feed = replace(RIGID, c=0.0), 5e-3
    simulation = Simulation(axis, feed, 1e-6)
    simulation.started("rest")
    least, most, stops = simulation.advance(1.0, feed, feed)
    # docs/theory.md (2), (11). The flat top of the friction lengthens the gap by 1e-3.
    gap = (axis.F_s - axis.F_k) / axis.k
    peak = 1.0 + math.hypot(1.0, math.sqrt(axis.k / axis.m) * gap / feed)
    assert most / feed == pytest.approx(peak, rel=1e-3)
    assert abs(least) < 1e-6 * feed
    assert stops > 10


@pytest.mark.gate
@pytest.mark.parametrize("part", thinned(range(10), 10))
@one_thread
def test_where_an_axis_is_called_even_no_start_judders_and_elsewhere_one_does(part: int) -> None:
    numbers = range(20 * part, 20 * part + 20)
    unsaid, unseen, growing = [], [], []
    for number in numbers:
        axis, feed = random_axis(number)
        said = regime_of(axis, feed)
        simulation = Simulation(axis, feed, 1e-6 if number % 10 == 9 else 1e-4)
        growth = simulation.growth() / math.sqrt(axis.k / axis.m)
        if abs(growth) > FADING and (growth > 0.0) is said.even:
            growing.append((axis.name, growth, said.damping))
        even = [simulation.started(start) < EVEN for start in STARTS]
        judders = said.kinds != ("even",) or not said.even
        if not judders and not all(even):
            unsaid.append(number)
        if judders and all(even):
            unseen.append(number)
    assert not growing
    assert not unsaid
    assert set(unseen) <= set(JUMPS_UNSEEN)


@pytest.mark.gate
def test_a_loop_is_called_stable_where_no_small_motion_of_the_simulation_grows(
    sized: Sized,
) -> None:
    stable = []
    for number in range(count := sized(500)):
        rng = np.random.default_rng([36, number])
        axis, feed = random_axis(number)
        axis = replace(
            axis, drive=random_drive(rng, axis.m, axis.F_s),
            friction=Friction(mu_s=axis.friction.mu_s, mu_k=axis.friction.mu_k),
        )  # fmt: skip
        simulation, w = Simulation(axis, feed), math.sqrt(axis.k / axis.m)
        growth = max(simulation.growth(), simulation.growth(stuck=True)) / w
        stable.append(is_stable(axis))
        assert stable[-1] is (growth < FADING), (axis, growth)
    assert 0.1 * count < sum(stable) < 0.9 * count
