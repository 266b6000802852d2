"""The exact block where only it can go: any step, any time, any number; no digit lost."""

from __future__ import annotations

import json
import math
import random

import pytest

from fmukit.model import ModelError

from .blocks import draw_ageing, drive, log_uniform, make_block, outputs, uneven

W = math.sqrt(1000.0)


def test_a_million_tiny_steps_are_one_step() -> None:
    once, often = make_block(z_start=0.004905), make_block(z_start=0.004905)
    for _ in range(1_000_000):
        often.advance(0.0, 1e-13)
    once.advance(0.0, math.fsum([1e-13] * 1_000_000))
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


def test_no_grazing_re_stick_is_missed_and_small_gaps_cost_no_digits() -> None:
    generator = random.Random(15)
    for _ in range(1000):
        k, m = log_uniform(generator, 10.0, 1e8), log_uniform(generator, 1e-2, 1e4)
        mu_k = 0.5 * (1.0 - log_uniform(generator, 1e-9, 1.0))
        delta, w = (0.5 - mu_k) * m * 9.81 / k, math.sqrt(k / m)
        ratio = log_uniform(generator, 1e-7, 1e1)
        v = w * delta / ratio
        block = make_block(k=k, m=m, mu_k=mu_k, v=v)
        t_slip, t_stick = 2.0 / w * (math.pi - math.atan(ratio)), 2.0 * delta / v
        block.advance(0.0, 0.5 * m * 9.81 / k / v + 1.5 * t_slip + t_stick)
        found = outputs(block)
        assert found["n_slips"] == 1
        # A dozen roundings; a step's length rounds the time by 1e-16 of the load-up, not of it.
        assert found["t_slip"] == pytest.approx(t_slip, rel=4e-15)
        assert found["spring_drop"] == pytest.approx(2.0 * delta, rel=4e-15)
        assert found["t_stick"] == pytest.approx(t_stick, rel=4e-15)
        assert found["delta_x"] == pytest.approx(v * found["T"], rel=4e-15)


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


def test_durations_do_not_depend_on_how_steps_cut_them_by_a_bit() -> None:
    generator = random.Random(63)
    names = ("t_stick", "t_slip", "T", "delta_x", "spring_drop", "x_dot_peak", "n_slips")
    for _ in range(60):
        values, segments = draw_ageing(generator)
        for segment in segments:
            segment.changes.clear()
        once, often = drive(values, segments), drive(values, segments, uneven(generator))
        for one, many in zip(once, often, strict=True):
            assert [one[name] for name in names] == [many[name] for name in names]


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


@pytest.mark.parametrize(
    ("values", "changes", "words"),
    [
        ({}, {"load": -10.0}, r"load = -10\.0 N is out of range: .* -9\.81 N"),
        ({}, {"B": 1.7e308}, "range of double-precision"),
        ({"m": 1.7e308}, {}, "range of double-precision"),
        ({"B": 1e307, "age_start": 1e300}, {}, "range of double-precision"),
        ({"v": 1e200}, {}, "range of double-precision"),
    ],
)
def test_what_leaves_the_range_of_numbers_is_refused(
    values: dict[str, float], changes: dict[str, float], words: str
) -> None:
    def run() -> None:
        block = make_block(**values)
        for name, value in changes.items():
            block.set(name, value)
        block.advance(0.0, 1.0)
        outputs(block)

    with pytest.raises(ModelError, match=words):
        run()


def test_a_step_of_more_transitions_than_end_is_refused() -> None:
    with pytest.raises(ModelError, match=r"step size h = 1e\+300 s is out of range"):
        make_block().advance(0.0, 1e300)


def test_growth_that_is_none_changes_no_bit_of_coulombs_outputs() -> None:
    for values in ({"t_0": 1e-3, "age_start": 1e9}, {"tau_s": 0.1, "load": -9.81}):
        plain = {name: value for name, value in values.items() if name == "load"}
        one, other = make_block(**values), make_block(**plain)
        for _ in range(100):
            one.advance(0.0, 0.021)
            other.advance(0.0, 0.021)
            assert outputs(one) == outputs(other)


@pytest.mark.parametrize("tau_s", [5e-324, 1e-200, 1.7e308])
@pytest.mark.parametrize("t_0", [2.3e-308, 1e-200, 1.7e308])
@pytest.mark.parametrize("age_start", [0.0, 5e-324, 1.7e308])
@pytest.mark.parametrize("v", [5e-324, 0.02, 1e10])
def test_at_the_ends_of_the_range_of_numbers_every_output_is_finite(
    tau_s: float, t_0: float, age_start: float, v: float
) -> None:
    block = make_block(tau_s=tau_s, B=0.01, t_0=t_0, age_start=age_start, v=v)
    for step in (1e-300, 1e-3, 0.1, 0.1):
        block.advance(0.0, step)
        assert all(math.isfinite(value) for value in outputs(block).values())


def test_a_state_taken_in_an_ageing_stick_keeps_its_age() -> None:
    block, other = make_block(tau_s=0.2, B=0.02, t_0=0.1, age_start=0.3), make_block()
    block.advance(0.0, 0.1)
    block.set("F_ext", 0.1)
    block.advance(0.1, 1e-6)
    other.restore(json.loads(json.dumps(block.save())))
    for _ in range(20):
        block.advance(0.2, 0.05)
        other.advance(0.2, 0.05)
        assert outputs(block) == outputs(other)
