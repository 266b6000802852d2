"""Static friction that grows at rest in the reference: its steady cycle and where it ends."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from stickslip_ref import (
    COULOMB,
    Interval,
    Parameters,
    coulomb_limit,
    critical_velocity,
    dwell_attractors,
    simulate,
    steady_cycle,
)
from tests.fmu.blocks import make_block, outputs

AXIS = {"m": 500.0, "k": 40e6, "c": 4000.0, "mu_s": 0.20, "mu_k": 0.15}
"""The axis of docs/feed-axis.md on a rigid drive."""
GROWTH = {"tau_s": 0.05, "B": 0.01, "t_0": 0.1}

REVERSING = {"m": 0.42, "k": 2730.0, "c": 2.5, "mu_s": 0.537, "mu_k": 0.092}
"""With tau_s = 1.2 ms the slips of a cycle reverse, and at some speeds the mass then slides on."""

LASTING: list[dict[str, float]] = [
    {"m": 0.32662007, "k": 847.09208, "mu_s": 1.64072826, "mu_k": 0.21273878, "v": 0.38487393},
    {"m": 0.18733264, "k": 830.73581, "mu_s": 1.23139102, "mu_k": 0.16539834, "v": 0.04931125}
    | {"c": 1.15666985},
]
"""Slips that reverse; of the cycles that a search meets one alone lasts."""


def grown(own: Mapping[str, float], **values: Any) -> Parameters:
    return COULOMB.complete(Parameters(**values), own)


def ranges(
    own: Mapping[str, float], between: tuple[float, float], **values: float
) -> tuple[Interval, ...]:
    return critical_velocity(Parameters(**values), own=own, between=between).cycle


@pytest.mark.parametrize(
    ("own", "values"),
    [
        ({"tau_s": 0.1}, {}),
        ({"tau_s": 0.01}, {"v": -0.02}),
        ({"B": 0.02, "t_0": 1e-3}, {"v": 0.01}),
        (GROWTH, {"load": 5.0, "F_ext": 1.0}),
        ({"tau_s": 0.05}, {"c": 3.0}),
        (GROWTH, {"c": 10.0, "v": 0.005}),
        # With reversals.
        ({"tau_s": 0.05}, {"mu_k": 0.08}),
        ({"tau_s": 0.02}, {"mu_k": 0.03, "v": -0.01}),
        ({"tau_s": 0.02, "B": 0.01, "t_0": 0.01}, {"mu_k": 0.03, "c": 3.0, "v": 0.005}),
        ({"tau_s": 0.02110522}, LASTING[0]),
        ({"tau_s": 0.02705956}, LASTING[1]),
    ],
)
def test_the_block_settles_to_the_steady_cycle(
    own: Mapping[str, float], values: Mapping[str, float]
) -> None:
    p = grown(own, **values)
    cycle: Any = steady_cycle(p)
    block = make_block(**own, **values)
    block.advance(0.0, 60.0)
    while block.mode == 0:
        block.advance(0.0, 0.002)
    while block.mode != 0:
        block.advance(0.0, 0.002)
    found = outputs(block)
    turns = p.mu_k < 0.2 * p.mu_s
    assert cycle.exists
    # A hundred cycles and more; the fixed point is that of a root, to some roundings.
    alone = ("T", "t_stick") if turns else ("t_slip", "delta_x", "spring_drop", "x_dot_peak")
    for name in ("T", "t_stick", *alone):
        assert found[name] == pytest.approx(getattr(cycle, name), rel=1e-10), name
    assert pytest.approx(cycle.t_slip + cycle.t_stick, rel=1e-14) == cycle.T
    assert cycle.delta_x == pytest.approx(float(p.v) * cycle.T, rel=1e-13)
    assert cycle.F_s == pytest.approx(COULOMB.break_away_force(p, cycle.t_stick), rel=1e-13)


def test_after_slips_that_reverse_the_mass_may_slide_on_far_below_the_last_cycle() -> None:
    own = {"tau_s": 1.2e-3}
    found = critical_velocity(Parameters(**REVERSING), own=own, between=(5e-4, 0.1))
    slow, fast = found.cycle
    ends = [1e3 * end for end in (slow.high, fast.low, fast.high)]
    assert ends == pytest.approx([0.81387, 11.48856, 71.64095], rel=1e-5)
    for v, sticks in ((0.99 * slow.high, True), (8.8e-3, False), (1.01 * fast.low, True)):
        cycle = steady_cycle(grown(own, **REVERSING, v=v))
        assert (cycle.exists, cycle.attractors) == (sticks, int(sticks))
        assert ("sticks" in found.motions(v)) is sticks
        block = make_block(**REVERSING, **own, v=v)
        block.advance(0.0, 50.0)
        before = block.meter.n_slips
        block.advance(0.0, 50.0)
        assert (block.meter.n_slips > before) is sticks


def test_of_several_motions_the_first_stick_decides() -> None:
    values = {"m": 0.25753930913916667, "k": 705.2961927509377, "v": 0.042080354610949756}
    values |= {"mu_s": 1.7177791425914826, "mu_k": 0.20054583991135824}
    own = {"tau_s": 0.09421550564456398}
    p = grown(own, **values)
    found = dwell_attractors(p)
    irregular, cycle = found.attractors
    assert found.from_rest == cycle
    assert (irregular.regular, cycle.regular, cycle.reverses) == (False, True, True)
    assert found.resolution == pytest.approx(2.0 * values["mu_k"] * 9.81 * values["m"] / 256)
    for first in found.attractors:
        # Loaded so that the first stick lasts as long.
        age = first.t_stick[0]
        start = COULOMB.break_away_force(p, age) / values["k"] - values["v"] * age
        block = make_block(**values, **own, z_start=start)
        block.advance(0.0, 100.0)
        for _ in range(500):
            block.advance(0.0, 0.05)
            comes_to_cycle = block.meter.t_stick == pytest.approx(cycle.t_stick[0], rel=1e-9)
            assert comes_to_cycle is (first is cycle)


def test_attractors_belong_to_one_speed_that_is_not_0() -> None:
    for v in (0.0, [0.1, 0.2]):
        with pytest.raises(ValueError, match=r"v = .* m/s is out of range"):
            dwell_attractors(grown({"tau_s": 0.1}, v=v))


def test_a_cycle_may_exist_that_a_start_from_rest_does_not_lead_to() -> None:
    values = {"m": 0.2801061211066846, "k": 116.4651030966716, "c": 0.04943790639016641}
    values |= {"mu_s": 1.2813093962507602, "mu_k": 0.23451048069791502, "v": 0.13688157850766663}
    own = {"tau_s": 0.07993576009920819}
    cycle = steady_cycle(grown(own, **values))
    assert (cycle.exists, cycle.attractors) == (False, 1)
    block = make_block(**values, **own)
    block.advance(0.0, 100.0)
    # The swing has decayed by exp(-8.8).
    assert outputs(block)["x_dot"] == pytest.approx(values["v"], rel=2e-4)


def test_without_growth_the_cycle_is_that_of_constant_coefficients() -> None:
    plain = steady_cycle(Parameters(c=1.0))
    assert steady_cycle(grown({"t_0": 5.0, "age_start": 3.0}, c=1.0)) == plain
    no_gap = {"mu_k": 0.5}
    assert steady_cycle(grown({"tau_s": 1.0}, **no_gap)) == steady_cycle(Parameters(**no_gap))


def test_the_cycle_of_a_field_is_that_of_its_points() -> None:
    own = {"tau_s": 0.05}
    field: Any = steady_cycle(grown(own, v=[[0.01], [0.2], [0.0]], mu_k=[0.3, 0.5]))
    assert field.exists.tolist() == [[True, True], [False, True], [False, False]]
    assert field.T[0, 0] == steady_cycle(grown(own, v=0.01)).T
    assert field.t_stick[0, 1] == 0.0
    assert np.isnan(field.T[1, 0])


def test_the_axis_jumps_up_to_a_tenth_of_a_millimetre_a_second() -> None:
    assert 1e3 * coulomb_limit(Parameters(**AXIS)) == pytest.approx(3.95, abs=0.005)
    (found,) = ranges({"tau_s": 0.1}, (1e-6, 0.1), **AXIS)
    assert 1e3 * found.high == pytest.approx(0.11, abs=0.0005)
    assert (found.low, *found[2:]) == (1e-6, "none", "fold")
    assert ranges({"tau_s": 0.1}, (0.12e-3, 0.1), **AXIS) == ()
    assert ranges({"tau_s": 0.1}, (1e-6, 1e-5), **AXIS) == ((1e-6, 1e-5, "none", "none"),)


@pytest.mark.parametrize(
    ("own", "values", "rate"),
    [
        ({"tau_s": 0.05}, {}, 4.0),
        (GROWTH, {}, 4.1),
        ({"B": 0.01, "t_0": 0.1}, {"mu_k": 0.5}, 0.1),
        ({"tau_s": 0.05}, {"load": 9.81}, 8.0),
        ({"B": 0.01, "t_0": 0.1}, {}, math.inf),
    ],
)
def test_without_damping_the_limit_is_twice_the_rate_of_growth_over_k(
    own: Mapping[str, float], values: Mapping[str, float], rate: float
) -> None:
    # theory (20); no limit where a fresh stop holds more than kinetic friction.
    (found,) = critical_velocity(Parameters(**values), own=own).cycle
    if rate == math.inf:
        assert found.high_end == "none"
        return
    assert found.high == pytest.approx(2.0 * 9.81 * rate / 1000.0, rel=1e-15)
    assert found.high_end == "grazing"
    for part, there in ((0.99, True), (1.01, False)):
        assert steady_cycle(grown(own, **values, v=part * found.high)).exists is there


@pytest.mark.parametrize(
    "values", [{"c": 2.0 * math.sqrt(1000.0)}, {"c": 190.0}, {"mu_k": 0.0}], ids=str
)
def test_without_a_swing_or_a_hold_there_is_no_cycle(values: dict[str, float]) -> None:
    assert ranges({"tau_s": 0.1}, (1e-3, 1e-2), **values) == ()
    assert not steady_cycle(grown({"tau_s": 0.1}, **values)).exists


def test_slow_growth_over_weak_kinetic_friction_is_irregular() -> None:
    # A tent map, theory (23): sticks of no one length for ever, so no steady cycle.
    own, values = {"tau_s": 20.0}, {"mu_k": 0.01, "mu_s": 0.9, "v": 5e-4}
    assert not steady_cycle(grown(own, **values)).exists
    (irregular,) = dwell_attractors(grown(own, **values)).attractors
    assert not irregular.regular
    assert ranges(own, (1e-4, 7e-4), **values) == ((1e-4, 7e-4, "none", "none"),)
    run = simulate(Parameters(**values), 60.0, own=own, rtol=1e-9)
    lengths = [each.t_stick for each in run.cycles[-15:]]
    assert max(lengths) > 1.1 * min(lengths)
