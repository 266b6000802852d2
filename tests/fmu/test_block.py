"""The exact block where only it can go: any step, any time, any number; no digit lost."""

from __future__ import annotations

import math
import random

import pytest

from .blocks import log_uniform, make_block, outputs

W = math.sqrt(1000.0)


def test_many_tiny_steps_are_one_step() -> None:
    once, often = make_block(z_start=0.004905), make_block(z_start=0.004905)
    for _ in range(50_000):
        often.advance(0.0, 1e-13)
    once.advance(0.0, math.fsum([1e-13] * 50_000))
    assert outputs(once)["x_pull"] == pytest.approx(outputs(often)["x_pull"], rel=1e-15)
    assert outputs(once)["x_dot"] == pytest.approx(outputs(often)["x_dot"], rel=1e-12)


@pytest.mark.parametrize("values", [{}, {"c": 0.7}, {"v": 3.0}])
def test_the_cycle_repeats_bit_for_bit(values: dict[str, float]) -> None:
    block = make_block(**values)
    block.advance(0.0, 4.0)
    early = outputs(block)
    block.advance(0.0, 20_000 * early["T"])
    later = outputs(block)
    assert later["n_slips"] > 19_990
    for name in ("t_slip", "t_stick", "spring_drop"):
        assert later[name] == early[name]


def test_setting_the_same_value_or_one_that_is_not_in_the_slip_changes_no_bit() -> None:
    plain, same, static = make_block(), make_block(), make_block()
    for n in range(60):
        same.set("v", 0.02)
        if n == 27:
            static.set("mu_s", 0.6)
        for block in (plain, same, static):
            block.advance(n * 0.01, 0.01)
        assert outputs(plain) == outputs(same)
        if n == 40:
            assert outputs(static)["t_slip"] == outputs(plain)["t_slip"] > 0.0
            assert outputs(static)["x"] == outputs(plain)["x"]


def test_a_slip_stopped_at_its_last_bit_does_not_jump() -> None:
    generator = random.Random(17)
    for _ in range(300):
        m, v = log_uniform(generator, 0.1, 10.0), log_uniform(generator, 1e-2, 1.0)
        block = make_block(v=v, m=m, z_start=0.5 * 9.81 * m / 1000.0)
        w = math.sqrt(1000.0 / m)
        t_slip = 2.0 / w * (math.pi - math.atan(w * 0.2 * 9.81 * m / 1000.0 / v))
        block.advance(0.0, 1e-9)
        # x_dot has rounded to 0 in the last instant of the slip.
        block.advance(0.0, math.nextafter(t_slip, 0.0) - 1e-9)
        before = outputs(block)
        block.set("load", 0.1)
        block.advance(0.0, 1e-9)
        after = outputs(block)
        assert after["x"] == pytest.approx(before["x"], abs=1e-8 * v)
        assert after["z"] == pytest.approx(before["z"], abs=1e-8 * v)


@pytest.mark.parametrize("c", [1e5, 1e7])
def test_energy_balances_where_a_heavily_damped_slip_has_hardly_begun(c: float) -> None:
    block = make_block(c=c, x_dot_start=0.1, z_start=0.005)
    block.advance(0.0, 1e-3)
    found = outputs(block)
    given = 0.5 * 0.1**2 + 500.0 * 0.005**2 + found["W_pull"]
    left = 0.5 * found["x_dot"] ** 2 + 500.0 * found["z"] ** 2
    assert found["Q_friction"] == pytest.approx(given - left, rel=1e-13)
