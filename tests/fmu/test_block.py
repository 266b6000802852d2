"""The exact block against its closed forms and its invariants."""

import math
import random

import pytest

from fmukit.model import ModelError
from stickslip_fmu.block import Block

from .blocks import log_uniform, make_block, outputs

# Rounding of a handful of operations.
ROUNDING = 4e-15


def cycle_after(block: Block, cycles: int) -> dict[str, float]:
    """Drive the block until so many slips are complete, in steps of one time unit."""
    step = 0.3 / math.sqrt(block.wanted.k / block.wanted.m)
    time = 0.0
    while block.meter.n_slips < cycles:
        block.advance(time, step)
        time += step
    return outputs(block)


def test_first_load_up_lasts_until_the_spring_holds_the_break_away_force() -> None:
    """A relaxed spring loads up for exactly mu_s m g/(k v)."""
    found = cycle_after(make_block(), 1)
    assert found["t_stick"] == pytest.approx(0.5 * 9.81 / (1000.0 * 0.02), rel=ROUNDING)


def test_default_cycle_is_the_closed_form() -> None:
    """The default block's cycle is the table of the design, digit by digit."""
    found = cycle_after(make_block(), 3)
    delta = 0.2 * 9.81 / 1000.0
    w = math.sqrt(1000.0)
    ratio = w * delta / 0.02
    t_slip = 2.0 / w * (math.pi - math.atan(ratio))
    expected = {
        "spring_drop": 2.0 * delta,
        "t_slip": t_slip,
        "t_stick": 2.0 * delta / 0.02,
        "delta_x": 2.0 * delta + 0.02 * t_slip,
        "T": 2.0 * delta / 0.02 + t_slip,
        "x_dot_peak": 0.02 * (1.0 + math.sqrt(1.0 + ratio * ratio)),
    }
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=ROUNDING), name


def test_equality_sticks() -> None:
    """At the very moment when the spring holds the break-away force the mass still rests."""
    block = make_block(k=1024.0, mu_s=0.5, m=1.0, g=8.0, v=0.0078125)
    block.advance(0.0, 0.5)
    assert outputs(block)["F"] == outputs(block)["F_s"]
    assert block.mode == 0
    block.advance(0.5, 1e-9)
    assert outputs(block)["mode"] == 1


def test_a_million_tiny_steps_are_one_step() -> None:
    """A million steps of 1e-13 s lose nothing of their sum."""
    once, often = make_block(z_start=0.004905), make_block(z_start=0.004905)
    count, step = 1_000_000, 1e-13
    for index in range(count):
        often.advance(index * step, step)
    once.advance(0.0, math.fsum([step] * count))
    assert outputs(once)["x_pull"] == pytest.approx(outputs(often)["x_pull"], rel=1e-15)
    assert outputs(once)["x_dot"] == pytest.approx(outputs(often)["x_dot"], rel=1e-12)


def test_the_cycle_repeats_bit_for_bit() -> None:
    """After 20,000 cycles t_slip, t_stick and spring_drop are those of the second."""
    for values in ({}, {"c": 0.7}, {"v": 3.0}):
        block = make_block(**values)
        second = cycle_after(block, 3)
        block.advance(0.0, 20_000 * second["T"])
        later = outputs(block)
        assert later["n_slips"] > 19_990
        for name in ("t_slip", "t_stick", "spring_drop"):
            assert later[name] == second[name]


def test_no_grazing_re_stick_is_missed() -> None:
    """Down to lambda = 1e-7, where the mass barely comes to rest, every cycle is exact."""
    generator = random.Random(15)
    for _ in range(2000):
        k, m = log_uniform(generator, 10.0, 1e8), log_uniform(generator, 1e-2, 1e4)
        ratio = log_uniform(generator, 1e-7, 1e-1)
        delta = 0.2 * m * 9.81 / k
        w = math.sqrt(k / m)
        block = make_block(k=k, m=m, v=w * delta / ratio)
        found = cycle_after(block, 3)
        assert found["t_slip"] == pytest.approx(2.0 / w * (math.pi - math.atan(ratio)), rel=1e-13)
        assert found["spring_drop"] == pytest.approx(2.0 * delta, rel=1e-13)


def test_stick_holds_the_mass_to_the_bit() -> None:
    """In stick x does not change by a single bit, far from the origin too."""
    block = make_block(x_start=1.0 / 3.0, v=1e-5)
    block.advance(0.0, 1.0)
    rest = outputs(block)["x"]
    for index in range(1000):
        block.advance(1.0 + index * 0.01, 0.01)
        assert outputs(block)["x"] == rest


def test_without_gap_the_mass_never_waits() -> None:
    """With mu_k = mu_s and no damping a slip lasts 2 pi/w, and the next follows at once."""
    found = cycle_after(make_block(mu_k=0.5), 4)
    w = math.sqrt(1000.0)
    assert found["t_stick"] == 0.0
    assert found["t_slip"] == pytest.approx(2.0 * math.pi / w, rel=ROUNDING)
    assert found["T"] == found["t_slip"]


def test_without_gap_damping_ends_the_cycle() -> None:
    """With mu_k = mu_s and damping the first slip never ends."""
    block = make_block(mu_k=0.5, c=0.1)
    block.advance(0.0, 1e4)
    found = outputs(block)
    assert (found["mode"], found["n_slips"]) == (1, 0)
    assert found["x_dot"] == pytest.approx(0.02, rel=1e-12)


@pytest.mark.parametrize("values", [{"mu_s": 0.0, "mu_k": 0.0}, {"load": -9.81}])
def test_without_friction_nothing_chatters(values: dict[str, float]) -> None:
    """A mass without friction swings about the pulled end, one slip a period."""
    block = make_block(**values)
    period = 2.0 * math.pi / math.sqrt(1000.0)
    block.advance(0.0, 100.5 * period)
    assert block.meter.n_slips == 100
    resting = make_block(**values, v=0.0)
    resting.advance(0.0, 100.0)
    assert (resting.mode, resting.meter.n_slips) == (0, 0)


def test_pull_that_stops_arrests_the_mass() -> None:
    """A pull that stops in mid-slip leaves a mass that comes to rest and stays."""
    block = make_block()
    block.advance(0.0, 0.245)
    assert outputs(block)["mode"] == 0
    block.advance(0.245, 0.05)
    assert outputs(block)["mode"] == 1
    block.set("v", 0.0)
    block.advance(0.295, 1e6)
    found = outputs(block)
    assert (found["mode"], found["n_slips"], found["x_dot"]) == (0, 1, 0.0)


def test_reversal_goes_on_without_rest() -> None:
    """A mass let go far from rest swings to and fro, losing 2 mu_k N/k a half swing."""
    block = make_block(v=0.0, z_start=0.05)
    before = 0.05
    for count in range(1, 6):
        # A little more than a half swing each time, so that no end falls on a step's end.
        block.advance(0.0, 1.001 * math.pi / math.sqrt(1000.0))
        found = outputs(block)
        assert found["n_slips"] == count
        assert found["mode"] == (1 if count % 2 == 0 else -1)
    block.advance(0.0, 10.0)
    found = outputs(block)
    loss = 2.0 * 0.3 * 9.81 / 1000.0
    swings = int(found["n_slips"])
    expected = before
    for _ in range(swings):
        expected = math.copysign(abs(expected) - loss, -expected)
    assert abs(expected) <= 0.5 * 9.81 / 1000.0
    assert found["z"] == pytest.approx(expected, rel=1e-13)
    assert (found["T"], found["t_stick"]) == (0.0, 0.0)


def test_moving_start_is_a_slip_but_no_break_away() -> None:
    """A mass that starts moving completes a slip without having broken away."""
    block = make_block(x_dot_start=0.5, v=0.0)
    block.advance(0.0, 5.0)
    found = outputs(block)
    assert found["n_slips"] >= 1
    assert found["t_slip"] > 0.0
    assert found["T"] == 0.0


def test_start_beyond_the_threshold_breaks_away_after_no_stick() -> None:
    """A mass at rest beyond F_s at the start breaks away after a stick of length 0."""
    block = make_block(z_start=0.006)
    assert outputs(block)["mode"] == 1
    block.advance(3.0, 1e-3)
    assert (block.meter.t_stick, block.meter.t_event) == (0.0, 3.0)
    block.advance(3.001, 2.0)
    assert block.meter.T > 0.0


def test_setting_the_same_value_starts_no_arc() -> None:
    """An input set to the value it has changes not a bit."""
    one, other = make_block(), make_block()
    for index in range(200):
        other.set("v", 0.02)
        one.advance(index * 0.01, 0.01)
        other.advance(index * 0.01, 0.01)
    assert outputs(one) == outputs(other)


@pytest.mark.parametrize("step", [0.0, -1.0, math.nan, math.inf, -math.inf])
def test_a_step_that_is_none_is_refused(step: float) -> None:
    """A step must be above zero and finite; the message says so."""
    with pytest.raises(ModelError, match=r"step size h = .* above 0 and finite"):
        make_block().advance(0.0, step)


def test_a_step_without_end_is_refused() -> None:
    """A step that would hold billions of transitions is refused instead of hanging."""
    with pytest.raises(ModelError, match=r"step size h = 1e\+300 s is out of range"):
        make_block().advance(0.0, 1e300)


def test_a_load_that_lifts_the_mass_is_refused() -> None:
    """The load may take off the whole weight and no more."""
    with pytest.raises(ModelError, match=r"load = -9\.82 N is out of range: .* -9\.81 N"):
        make_block(load=-9.82)
    block = make_block()
    block.set("load", -10.0)
    with pytest.raises(ModelError, match="load"):
        block.advance(0.0, 0.1)


def test_clamp_leaves_a_gap() -> None:
    """A kinetic coefficient above the static one is clamped to 0.01 below it, or to 0."""
    assert outputs(make_block(mu_s=0.3, mu_k=0.5))["mu_k_used"] == 0.3 - 0.01
    assert outputs(make_block(mu_s=0.005, mu_k=0.5))["mu_k_used"] == 0.0
    assert outputs(make_block(mu_s=0.3, mu_k=0.3))["mu_k_used"] == 0.3


def test_changing_the_stiffness_keeps_the_spring_and_is_paid_for() -> None:
    """A change of k keeps z and puts in dk z^2/2."""
    block = make_block()
    block.advance(0.0, 0.1)
    before = outputs(block)
    block.set("k", 1500.0)
    block.advance(0.1, 1e-12)
    after = outputs(block)
    assert after["z"] == pytest.approx(before["z"], rel=1e-9)
    assert after["W_k"] == pytest.approx(0.5 * 500.0 * before["z"] ** 2, rel=ROUNDING)


def test_reversed_pull_slips_backward() -> None:
    """A reversed pull gives a cycle of negative displacement and relief."""
    found = cycle_after(make_block(v=-0.02), 3)
    assert found["delta_x"] == pytest.approx(-0.02 * found["T"], rel=ROUNDING)
    assert found["spring_drop"] == pytest.approx(-2.0 * 0.2 * 9.81 / 1000.0, rel=ROUNDING)


def test_the_rest_test_forgives_rounding_and_no_more() -> None:
    """A force beyond F_s by 4 units in the last place of what is compared rests, by 16 slips."""
    # Powers of two, so that the forces are what they seem: F_s = 0.5 N, k z + F_ext beside it.
    settings = {"m": 1.0, "g": 1.0, "k": 1.0, "mu_s": 0.5, "mu_k": 0.25, "v": 0.0}
    unit = 2.0**-52
    assert make_block(**settings, z_start=0.5 + 4.0 * unit).mode == 0
    assert make_block(**settings, z_start=0.5 + 16.0 * unit).mode == 1
    assert make_block(**settings, z_start=-0.5 - 16.0 * unit).mode == -1


def test_a_change_of_mu_s_leaves_the_slip_whole() -> None:
    """What is not in the equation of slip does not touch it, not by a bit."""
    one, other = make_block(), make_block()
    for block in (one, other):
        block.advance(0.0, 0.27)
        assert outputs(block)["mode"] == 1
    other.set("mu_s", 0.6)
    for block in (one, other):
        block.advance(0.27, 0.2)
    assert outputs(one)["t_slip"] == outputs(other)["t_slip"]
    assert outputs(one)["x"] == outputs(other)["x"]
    assert outputs(one)["F_s"] != outputs(other)["F_s"]


def test_a_slip_stopped_at_its_last_bit_does_not_jump() -> None:
    """A change in the last instant of a slip, where x_dot has rounded to 0, moves nothing."""
    generator = random.Random(17)
    for _ in range(500):
        m = log_uniform(generator, 0.1, 10.0)
        z_start = 0.5 * 9.81 * m / 1000.0
        v = log_uniform(generator, 1e-2, 1.0)
        block = make_block(v=v, m=m, z_start=z_start)
        w = math.sqrt(1000.0 / m)
        t_slip = 2.0 / w * (math.pi - math.atan(w * 0.2 * 9.81 * m / 1000.0 / v))
        block.advance(0.0, 1e-9)
        block.advance(0.0, math.nextafter(t_slip, 0.0) - 1e-9)
        before = outputs(block)
        block.set("load", 0.1)
        block.advance(0.0, 1e-9)
        after = outputs(block)
        assert after["x"] == pytest.approx(before["x"], abs=1e-8 * v)
        assert after["z"] == pytest.approx(before["z"], abs=1e-8 * v)
        assert after["Q_friction"] == pytest.approx(before["Q_friction"], rel=1e-7)


@pytest.mark.parametrize(("c", "end"), [(1e6, None), (1e7, 1.312e-6), (5e7, 2.946e-7)])
def test_no_stop_is_missed_in_heavy_damping(c: float, end: float | None) -> None:
    """Damped by zeta up to 1e6, a mass shot against its spring turns round."""
    block = make_block(c=c, v=1e-9, x_dot_start=1.0, z_start=-0.02, mu_s=0.0, mu_k=0.0)
    block.advance(0.0, 1.0)
    assert block.meter.n_slips == 1
    if end is not None:
        # The figures of the exact solution, to the digits given.
        assert block.meter.t_slip == pytest.approx(end, rel=1e-3)


def test_a_creep_against_the_pull_ends() -> None:
    """Overdamped and shot against a pull of 1e-16 of its speed, the mass turns in finite time."""
    block = make_block(
        c=151.5169744133138, x_dot_start=1.0, v=-1e-16, mu_s=0.0, mu_k=0.0, z_start=0.1
    )
    block.advance(0.0, 1e3)
    assert block.meter.n_slips == 1


def test_the_account_of_a_long_creep_closes() -> None:
    """The heat of a slip that has long crept out is the energy it began with."""
    block = make_block(c=150.0, mu_s=0.0, mu_k=0.0, v=0.0, x_dot_start=1.3, z_start=0.1)
    heat = 0.5 * 1.3**2 + 0.5 * 1000.0 * 0.1**2
    before = 0.0
    for step in (1.0, 1e3, 1e6, 1e9):
        block.advance(0.0, step)
        found = outputs(block)["Q_friction"]
        assert found >= before
        before = found
    assert before == pytest.approx(heat, rel=1e-12)


def test_work_of_a_short_arc_has_all_its_digits() -> None:
    """Just after the start the pull has worked v times the impulse of a spring hardly moved."""
    block = make_block(m=1000.0, x_dot_start=3.7, v=1e-3, z_start=1e-3, c=10.0)
    step = 7e-8
    block.advance(0.0, step)
    # z falls from z_start by x_dot_start t; what is left out is of second order in w t = 7e-8.
    expected = 1000.0 * 1e-3 * (1e-3 * step - 0.5 * (3.7 - 1e-3) * step**2)
    assert outputs(block)["W_pull"] == pytest.approx(expected, rel=1e-12)


def test_a_nudge_against_the_pull_is_a_short_slip() -> None:
    """A mass nudged backward by 1e-7 of F_s moves by the square over the pull, without noise."""
    block = make_block(z_start=0.0, v=0.2, mu_k=0.5, F_ext=-4.905 * (1.0 + 1e-7))
    block.advance(0.0, 1e-3)
    found = outputs(block)
    reach = 4.905e-7 / 1000.0
    w = math.sqrt(1000.0)
    # To first order in y = w reach/v = 8e-8: t_slip = 2 y/w and delta_x = -2 reach y^2/3.
    y = w * reach / 0.2
    assert found["t_slip"] == pytest.approx(2.0 * y / w, rel=1e-8)
    assert found["delta_x"] == pytest.approx(-2.0 * reach * y * y / 3.0, rel=1e-8)


def test_small_gaps_cost_no_digits() -> None:
    """Gaps down to 1e-9 of mu_s: stick time and relief are exact, not differences of z."""
    generator = random.Random(18)
    for _ in range(200):
        gap = log_uniform(generator, 1e-9, 1e-3)
        mu_k = 0.5 * (1.0 - gap)
        v = log_uniform(generator, 1e-6, 1e-1)
        found = cycle_after(make_block(mu_k=mu_k, v=v), 3)
        delta = (0.5 - mu_k) * 9.81 / 1000.0
        assert found["spring_drop"] == pytest.approx(2.0 * delta, rel=ROUNDING)
        assert found["t_stick"] == pytest.approx(2.0 * delta / v, rel=ROUNDING)
        assert found["delta_x"] == pytest.approx(v * found["T"], rel=ROUNDING)


@pytest.mark.parametrize("time", [math.nan, math.inf])
def test_a_communication_point_that_is_none_is_refused(time: float) -> None:
    """The communication point dates the events, so it must be a number."""
    block = make_block()
    block.advance(0.0, 0.1)
    with pytest.raises(ModelError, match="communication point t = "):
        block.advance(time, 0.1)


def test_forces_beyond_all_numbers_are_refused() -> None:
    """Neither a break-away force nor an energy is ever handed out as infinity."""
    with pytest.raises(ModelError, match="range of double-precision"):
        make_block(m=1.7e308)
    block = make_block(v=1e200)
    block.advance(0.0, 1.0)
    with pytest.raises(ModelError, match="range of double-precision"):
        outputs(block)


def test_a_critically_damped_mass_may_decay_without_end() -> None:
    """With w = a = 1/s and k z = w m x_dot the speed is e^(-w t): no turning point and no rest."""
    frictionless = {"m": 1.0, "k": 1.0, "c": 2.0, "mu_s": 0.0, "mu_k": 0.0, "v": 0.0}
    block = make_block(**frictionless, z_start=1.0, x_dot_start=1.0)
    for step, time in ((0.5, 0.5), (1.5, 2.0), (3.0, 5.0)):
        block.advance(time - step, step)
        found = outputs(block)
        assert found["x_dot"] == pytest.approx(math.exp(-time), rel=1e-14)
        assert found["z"] == pytest.approx(math.exp(-time), rel=1e-14)
        assert found["n_slips"] == 0
