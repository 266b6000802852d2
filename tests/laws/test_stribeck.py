"""Stribeck's law in the exact block: published values, limits, long sliding, what it says."""

from __future__ import annotations

import math

import pytest

from stickslip_verification import truth
from tests.fmu.blocks import outputs
from tests.laws.stribeck import SPEC, curve, make_block

W = math.sqrt(1000.0)
LEINE = {"m": 1.0, "g": 1.0, "k": 1.0, "mu_s": 1.0, "mu_k": 0.0, "shape": 2, "v_s": 1.0 / 3.0}
"""F = F_s/(1 + 3 |u|): Leine et al., Nonlinear Dynamics 16 (1998) 41, 10.1023/A:1008289604683."""


def test_leine_s_cycle_has_the_published_displacement() -> None:
    block = make_block(**LEINE, v=0.2)
    block.advance(0.0, 6.0)
    nearest, largest = 1.0, 0.0
    while block.meter.n_slips < 2:
        block.advance(0.0, 2.0**-7)
        found = outputs(block)
        acceleration, lack = found["F"] + found["F_friction"], 0.2 - found["x_dot"]
        if block.mode == 1 and acceleration > 0.0 and abs(lack) < nearest:
            # z is largest where the mass is as fast as the pull; z_ddot = -x_ddot.
            nearest, largest = abs(lack), found["z"] + 0.5 * lack * lack / acceleration
    # The published digits; the parabola is right to the cube of a step of 2^-7.
    assert largest == pytest.approx(1.133944669704, abs=2e-7)


@pytest.mark.gate
@pytest.mark.parametrize("own", [{"shape": 2}, {"delta": 1.0}, {"delta": 2.7}], ids=str)
def test_a_slip_with_hardly_a_fall_of_friction_keeps_its_digits(own: dict[str, float]) -> None:
    # lambda = 1e-6: the slip ends at a least speed of -5e-13 v.
    values = {"mu_k": 0.5 - 1e-6 * 0.02 * W / 9.81, "v_s": 1e-3, **own}
    run = truth.run(values, [truth.Step(0.45)], digits=30, law="stribeck")
    expected = run.samples[-1]
    block = make_block(**values)
    block.advance(0.0, 0.45)
    found = outputs(block)
    assert found["n_slips"] == expected["n_slips"] == 1
    # An error of 1e-16 v in the speed is one of 1e-10 in the root, were it not for its closed form.
    assert found["t_slip"] == pytest.approx(float(expected["t_slip"]), rel=1e-12)
    assert found["delta_x"] == pytest.approx(float(expected["delta_x"]), rel=1e-13)


@pytest.mark.parametrize("own", [{"c": 30.0}, {"c": 20.0, "shape": 2}, {"c": 60.0, "delta": 1.3}])
def test_stable_sliding_is_kept_for_ever_at_once(own: dict[str, float]) -> None:
    fall = 0.25 if own.get("shape") else math.exp(-(3.0 ** own.get("delta", 2.0)))
    force = 9.81 * (0.3 + 0.2 * fall) + own["c"] * 0.03
    values = {"v_s": 0.01, **own, "v": 0.03, "z_start": force / 1000.0, "x_dot_start": 0.027}
    block = make_block(**values)
    block.advance(0.0, 30.0)
    block.advance(30.0, 1e9)
    found = outputs(block)
    assert found["x_dot"] == pytest.approx(0.03, rel=1e-14)
    assert found["F"] == pytest.approx(force, rel=1e-14)


@pytest.mark.parametrize(("off", "slips"), [(0.0, 0), (2.0**-64, 3)])
def test_steady_sliding_on_a_falling_line_is_left_by_the_last_digit_of_the_spring(
    off: float, slips: int
) -> None:
    values = {**curve([(0.0, 0.5), (0.125, 0.25)]), "m": 1.0, "g": 8.0, "k": 8192.0, "v": 0.0625}
    block = make_block(**values, x_dot_start=0.0625, z_start=3 / 8192 + off)
    block.advance(0.0, 10.0)
    found = outputs(block)
    assert found["n_slips"] >= slips
    assert abs(found["x_dot"]) < 0.5
    assert slips or (found["x"], found["x_dot"]) == (0.625, 0.0625)


def test_a_stop_that_grazes_is_decided_to_a_relative_1e_12() -> None:
    def stops(c: float) -> bool:
        block = make_block(v=0.1, v_s=0.05, c=c)
        block.advance(0.0, 0.0491)
        block.advance(0.0, 2.0)
        return bool(block.meter.n_slips >= 1)

    low, high = 0.0, 40.0
    for _ in range(54):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stops(middle) else (low, middle)
    assert 0.1 < low < 39.0
    for lack in (1e-4, 1e-8, 1e-12):
        assert stops(low * (1.0 - lack))
        assert not stops(low * (1.0 + lack))


def test_what_both_models_have_keeps_number_and_name_and_own_rows_follow() -> None:
    numbers = {row.name: row.number for row in SPEC.table.rows}
    first = ("m", "v", "x", "mode", "Q_friction", "mu_k_used")
    assert [numbers[name] for name in first] == [0, 9, 12, 20, 32, 33]
    own = ("shape", "v_s", "delta", "n_points", "mu_1", "u_2", "mu_2", "u_12", "mu_12")
    assert [numbers[name] for name in own] == [34, 35, 36, 37, 38, 39, 40, 59, 60]


def test_the_friction_of_a_slip_depends_on_every_point_of_the_curve() -> None:
    used = next(row for row in SPEC.table.rows if row.name == "mu_k_used")
    assert {f"mu_{point}" for point in range(1, 13)} < set(used.depends)
