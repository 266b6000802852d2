"""Whole fields of parameters: every point alone, in little memory."""

import math
import tracemalloc
from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from stickslip_ref import (
    Cycle,
    Parameters,
    coulomb_limit,
    critical_lambda,
    simplified,
    steady_cycle,
)

Field = dict[str, NDArray[np.float64]]


@pytest.fixture
def field() -> Callable[[int], Field]:
    """Points of every kind side by side, damped and not, pulled either way, at rest or too fast."""

    def draw(count: int) -> Field:
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

    return draw


def _results(values: Field) -> list[NDArray[Any]]:
    p = Parameters(**values)
    results = [*vars(steady_cycle(p)).values(), *vars(simplified(p)).values(), coulomb_limit(p)]
    return [np.asarray(each) for each in (*results, critical_lambda(p.zeta))]


def test_a_point_has_no_neighbours(field: Callable[[int], Field]) -> None:
    """Any part of a field, in any order and at any place, has the bits of the whole."""
    values = field(40_000)
    whole = _results(values)
    short = [slice(start, start + length) for start in range(9) for length in (1, 2, 3, 5, 8, 13)]
    long = [slice(7, 20_000), slice(20_000, None), slice(3, None, 7), slice(None, None, -1)]
    for part in (*short, *long):
        for got, expected in zip(
            _results({name: each[part] for name, each in values.items()}), whole, strict=True
        ):
            assert got.tobytes() == expected[part].tobytes(), part


def test_a_number_is_a_field_of_one_point(field: Callable[[int], Field]) -> None:
    """Numbers give the bits that the same numbers give within an array."""
    values = field(200)
    whole = _results(values)
    for i in range(200):
        for got, expected in zip(
            _results({name: each[i] for name, each in values.items()}), whole, strict=True
        ):
            assert np.array_equal(got, expected[i], equal_nan=True), i


def test_a_large_field_takes_no_memory_beyond_its_results(field: Callable[[int], Field]) -> None:
    """What is in use besides input and output is a few blocks, fewer bytes than two arrays."""
    count = 1_000_000
    p = Parameters(**field(count))
    tracemalloc.start()
    try:
        results = (steady_cycle(p), coulomb_limit(p))
        kept, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert kept > (len(fields(Cycle)) * 8 - 7) * count
    assert results[0].f is not None
    # Some forty arrays of 16384 doubles, 5 MB, and 8 MB that are never touched: two arrays.
    assert peak - kept < 16 * count


@pytest.mark.parametrize("zeta", [1e-300, 1e-20, 1e-9, 1e-3, 0.3, 0.9, 0.99])
def test_a_slip_ends_where_its_velocity_is_zero(zeta: float) -> None:
    """Whatever the damping, and from grazing rest to a lambda of 1e6 lambda_c."""
    edge = float(critical_lambda(zeta))
    lambda_ = edge * np.geomspace(1.0 + 1e-9, 1e6, 400)
    # w = 1 and N = 1: velocities are those over v, times those over w.
    p = Parameters(m=1.0, k=1.0, g=1.0, c=2.0 * zeta, mu_s=1.0, mu_k=0.0, v=1.0 / lambda_)
    cycle = steady_cycle(p)
    assert np.all(cycle.exists)
    tau, nu = np.asarray(cycle.t_slip), math.sqrt((1.0 - zeta) * (1.0 + zeta))
    wave = (lambda_ - zeta) / nu * np.sin(nu * tau) - np.cos(nu * tau)
    x_dot = 1.0 + np.exp(-zeta * tau) * wave
    # Rounding of the length, 2 pi, times the slope, and of the terms.
    scale = 1.0 + (lambda_ + 1.0) / nu * np.exp(-zeta * tau)
    assert np.max(np.abs(x_dot) / scale) < 4e-15 * (1.0 + 1.0 / nu)


def test_a_slip_may_graze_rest_to_the_last_bit() -> None:
    """Within a few ulp of lambda_c a slip ends at its minimum or not at all, never nowhere."""
    zeta = np.geomspace(1e-8, 0.9, 1000)[:, None]
    ulps = np.arange(-8, 9)
    lambda_ = np.asarray(critical_lambda(zeta)) * (1.0 + ulps * 2.0**-52)
    p = Parameters(m=1.0, k=1.0, g=1.0, c=2.0 * zeta, mu_s=1.0, mu_k=0.0, v=1.0 / lambda_)
    cycle = steady_cycle(p)
    exists = np.asarray(cycle.exists)
    assert 0.1 < np.mean(exists) < 0.9
    assert np.all(np.isfinite(np.asarray(cycle.T)) == exists)
    # The minimum of the velocity, whatever the rounding of its depth: its time goes by the root.
    minimum = (2.0 * np.pi - np.arctan2(lambda_ * np.sqrt(1 - zeta**2), 1 - zeta * lambda_)) / (
        np.sqrt(1 - zeta**2)
    )
    assert np.allclose(np.asarray(cycle.t_slip)[exists], minimum[exists], rtol=1e-6)
