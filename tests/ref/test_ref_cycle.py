"""The steady cycle and the critical lambda of the reference: closed forms over whole fields."""

from __future__ import annotations

import math
from collections.abc import Mapping
from random import Random
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from stickslip_ref import Parameters, coulomb_limit, critical_lambda, simplified, steady_cycle
from stickslip_verification import truth
from tests.facts import closed
from tests.facts.closed import MP, Exact
from tests.facts.coulomb import of_lambda
from tests.facts.test_cycles import oscillator
from tests.fmu.blocks import log_uniform

EPS = 2.0**-52
QUANTITIES = ("spring_drop", "delta_x", "t_slip", "t_stick", "T", "f", "x_dot_peak")
Field = dict[str, NDArray[np.float64]]


def assert_exact(values: Mapping[str, float], tolerance: float, exact: Mapping[str, Any]) -> None:
    cycle = steady_cycle(Parameters(**values))
    assert cycle.exists is True
    for name in QUANTITIES:
        error = abs(getattr(cycle, name) / exact[name] - 1)
        assert error < tolerance, (name, float(error), values)


@pytest.mark.parametrize("power", range(-7, 8))
def test_an_undamped_cycle_is_exact_to_rounding_at_any_lambda(power: int) -> None:
    values = of_lambda(10.0**power)
    # A dozen roundings, times mu_s / (mu_s - mu_k) = 2.5 for the gap.
    assert_exact(values, 12 * 2.5 * EPS, closed.cycle(Exact(values)))
    exact = truth.steady_cycle(values)
    assert exact is not None
    for name, value in closed.cycle(Exact(values)).items():
        assert abs(exact[name] / value - 1) < 1e-40


def test_damped_cycles_are_exact_and_exist_from_lambda_c_on() -> None:
    draw, seen = Random(11), 0
    for _ in range(60):
        values, zeta = oscillator(draw), log_uniform(draw, 1e-9, 0.95)
        values["c"] = 2.0 * zeta * math.sqrt(values["k"] * values["m"])
        d = log_uniform(draw, 2e-9, 0.9) * draw.choice([-1.0, 1.0, 1.0])
        edge = float(closed.critical_lambda(Exact(values).zeta))
        values = of_lambda(edge * (1.0 + d), **values)
        exact = truth.steady_cycle(values)
        assert (exact is not None) is bool(steady_cycle(Parameters(**values)).exists) is (d > 0.0)
        if exact is None:
            continue
        seen += 1
        # Rounding times the conditioning of the gap and of the nearly tangent root.
        gap = values["mu_s"] / (values["mu_s"] - values["mu_k"])
        expected = closed.cycle(Exact(values))
        assert_exact(values, 20 * EPS * gap * (1.0 + d**-0.5), expected)
        assert all(abs(exact[name] / expected[name] - 1) < 1e-38 for name in QUANTITIES)
    assert seen > 30


@pytest.mark.parametrize("zeta", [1e-12, 1e-8, 1e-4, 0.01, 0.1, 0.5, 0.9, 0.99, 0.9999])
def test_critical_lambda_solves_its_equation(zeta: float) -> None:
    got, exact = float(critical_lambda(zeta)), closed.critical_lambda(MP.mpf(zeta))
    # Solved in the logarithm, whose rounding error is relative to it.
    assert abs(got / exact - 1) < 8 * EPS * max(1.0, abs(math.log(got)))
    assert abs(truth.critical_lambda(zeta) / exact - 1) < 1e-40 * max(1.0, math.log(got) ** 2)


def test_critical_lambda_at_the_ends_of_its_range() -> None:
    got = critical_lambda(np.array([0.0, 0.9, 0.99, 1.0, 7.0]))
    np.testing.assert_allclose(got, [0.0, 1667.2, 1.015e10, np.inf, np.inf], rtol=1e-3)
    assert truth.critical_lambda(0.0) == 0
    assert truth.critical_lambda(1.0) == math.inf
    # The limit of light damping is sqrt(4 pi zeta); the last has eight digits.
    zeta = np.array([1e-17, 1e-21, 1e-300, 1e-315])
    limit = math.sqrt(4.0 * math.pi) * np.sqrt(zeta)
    np.testing.assert_allclose(critical_lambda(zeta), limit, rtol=1e-8)
    for bad in (-0.1, math.nan, math.inf):
        with pytest.raises(ValueError, match=r"zeta = .* is out of range"):
            critical_lambda(bad)


def test_the_critical_velocity_knows_its_limits_and_neither_direction_nor_push() -> None:
    c = np.array([0.0, 1.0, 1e4])
    v_c = np.asarray(coulomb_limit(Parameters(c=c)))
    assert v_c[0] == np.inf
    assert 0.0 < v_c[1] < np.inf
    assert v_c[2] == coulomb_limit(Parameters(c=1.0, mu_s=0.3)) == 0.0
    pulls = {coulomb_limit(Parameters(c=1.0, v=v, F_ext=F)) for v in (-1, 0, 2) for F in (0, 9)}
    assert pulls == {v_c[1]}


def test_pull_load_push_and_light_damping_enter_the_cycle_as_they_should() -> None:
    forward, backward = (steady_cycle(Parameters(c=0.1, v=v)) for v in (0.02, -0.02))
    for name in ("spring_drop", "delta_x", "x_dot_peak"):
        assert getattr(backward, name) == -getattr(forward, name)
    for name in ("t_slip", "t_stick", "T", "f", "F_s", "Delta", "lambda_"):
        assert getattr(backward, name) == getattr(forward, name)
    loaded = steady_cycle(Parameters(load=9.81, F_ext=3.0))
    assert loaded == steady_cycle(Parameters(g=2 * 9.81))
    undamped, light = steady_cycle(Parameters()), steady_cycle(Parameters(c=1e-13))
    for name in QUANTITIES:
        # zeta = 1.6e-15 shifts the cycle by a few zeta times 2 pi.
        assert getattr(light, name) == pytest.approx(getattr(undamped, name), rel=1e-13)


@pytest.mark.parametrize(
    "values", [{"v": 0.0}, {"c": 1e3}, {"c": 30.0, "v": 1.0}, {"mu_k": 0.5, "c": 1e-6}]
)
def test_where_there_is_no_cycle_there_are_no_numbers(values: dict[str, float]) -> None:
    cycle = steady_cycle(Parameters(**values))
    assert cycle.exists is False
    assert all(math.isnan(getattr(cycle, name)) for name in QUANTITIES)
    assert cycle.F_s == pytest.approx(4.905)
    assert truth.steady_cycle(values) is None


def test_without_a_gap_the_cycle_is_all_slip() -> None:
    cycle = steady_cycle(Parameters(mu_s=0.3))
    assert (cycle.exists, cycle.t_stick) == (True, 0.0)
    assert cycle.t_slip == pytest.approx(2.0 * math.pi / math.sqrt(1000.0), rel=2 * EPS)


def test_the_simplified_column_is_what_designers_write() -> None:
    simple, exact = simplified(Parameters()), steady_cycle(Parameters())
    assert simple.delta_x == pytest.approx(3.924e-3, rel=4 * EPS)
    assert exact.delta_x == pytest.approx(6.305e-3, abs=5e-7)  # to the digits written
    assert simple.t_slip == pytest.approx(math.pi / math.sqrt(1000.0), rel=4 * EPS)
    assert simple.t_stick == pytest.approx(4.905 / (1000.0 * 0.02), rel=4 * EPS)
    assert simple.t_stick + simple.t_slip == simple.T


def test_the_slowest_pull_does_not_overflow() -> None:
    cycle = steady_cycle(Parameters(v=np.array([1e-300, 0.02])))
    np.testing.assert_allclose(cycle.x_dot_peak, [math.sqrt(1000.0) * 1.962e-3, 0.0851877596])


def field(count: int) -> Field:
    rng = np.random.default_rng(3)
    k, m = 10.0 ** rng.uniform(1.0, 8.0, count), 10.0 ** rng.uniform(-2.0, 4.0, count)
    mu_s = 10.0 ** rng.uniform(-2.0, 0.17, count)
    mu_k = mu_s * (1.0 - 10.0 ** rng.uniform(-3.0, 0.0, count))
    mu_k[::500] = mu_s[::500]
    v = 10.0 ** rng.uniform(-6.0, 1.0, count) * rng.choice([-1.0, 0.0, 1.0, 1.0], count)
    zeta = 10.0 ** rng.uniform(-4.0, 0.1, count) * rng.choice([0.0, 1.0, 1.0], count)
    # lambda NaN, and beside it lambda^2 beyond the largest double.
    v[::1000], v[1::1000], zeta[1::1000] = 0.0, 1e-250, 0.0
    return {"k": k, "m": m, "mu_s": mu_s, "mu_k": mu_k, "v": v, "c": 2 * zeta * np.sqrt(k * m)}


def results(values: Field) -> list[NDArray[Any]]:
    p = Parameters(**values)
    made = [*vars(steady_cycle(p)).values(), *vars(simplified(p)).values(), coulomb_limit(p)]
    return [np.asarray(each) for each in (*made, critical_lambda(p.zeta))]


def test_a_point_has_no_neighbours() -> None:
    values = field(40_000)
    whole = results(values)
    short = [slice(start, start + length) for start in range(5) for length in (1, 3, 8, 13)]
    long = [slice(7, 20_000), slice(20_000, None), slice(None, None, -1)]
    for part in (*short, *long):
        parts = results({name: each[part] for name, each in values.items()})
        for got, expected in zip(parts, whole, strict=True):
            assert got.tobytes() == expected[part].tobytes(), part
    for i in range(60):
        points = results({name: each[i] for name, each in values.items()})
        for got, expected in zip(points, whole, strict=True):
            assert np.array_equal(got, expected[i], equal_nan=True), i


def test_fields_broadcast() -> None:
    v, k = np.array([-0.1, 0.0, 0.02]), np.array([[100.0], [1e6]])
    made, spread = (
        steady_cycle(Parameters(v=a, k=b, c=0.5)) for a, b in ((v, k), np.broadcast_arrays(v, k))
    )
    for name, value in vars(spread).items():
        np.testing.assert_array_equal(getattr(made, name), value)
    assert np.shape(steady_cycle(Parameters(k=np.array([]))).T) == (0,)


def test_a_slip_may_graze_rest_to_the_last_bit() -> None:
    zeta = np.geomspace(1e-8, 0.9, 1000)[:, None]
    lambda_ = np.asarray(critical_lambda(zeta)) * (1.0 + np.arange(-8, 9) * EPS)
    p = Parameters(m=1.0, k=1.0, g=1.0, c=2.0 * zeta, mu_s=1.0, mu_k=0.0, v=1.0 / lambda_)
    cycle = steady_cycle(p)
    exists, nu = np.asarray(cycle.exists), np.sqrt(1.0 - zeta**2)
    assert 0.1 < np.mean(exists) < 0.9
    assert np.all(np.isfinite(np.asarray(cycle.T)) == exists)
    # The minimum of the velocity, whatever the rounding of its depth: its time goes by the root.
    minimum = (2.0 * np.pi - np.arctan2(lambda_ * nu, 1.0 - zeta * lambda_)) / nu
    assert np.allclose(np.asarray(cycle.t_slip)[exists], minimum[exists], rtol=1e-6)
