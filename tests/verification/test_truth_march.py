"""The truth's march by Taylor series against its closed forms, and what it is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from random import Random
from typing import Any

import mpmath
import pytest

from stickslip_verification import truth
from stickslip_verification.truth import FrictionLaw, Numbers, Series, Step
from stickslip_verification.truth.parameters import high_precision
from stickslip_verification.truth.zeros import polynomial_zeros
from tests.fmu.blocks import draw

MP = high_precision(50)
TOLERANCE = MP.mpf("1e-45")
"""Fifty digits are promised; five are left for what a shallow end of a slip amplifies."""


class Marched(FrictionLaw):
    """Coulomb's law, as one of which only the friction is known."""

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        return Series(speed.context, [n.F_k])


def assert_equal(one: truth.Run, other: truth.Run, tolerance: Any = TOLERANCE) -> None:
    """Assert equal events, and equal outputs to the tolerance of the scale of their kind."""
    assert [(e.kind, e.mode) for e in one.events] == [(e.kind, e.mode) for e in other.events]
    for name in one.initial:
        alike = ("x", "x_pull", "z") if name in ("x", "x_pull", "z") else (name,)
        largest = max(abs(sample[each]) for sample in one.samples for each in alike)
        for a, b in zip(one.samples, other.samples, strict=True):
            assert abs(a[name] - b[name]) <= tolerance * largest, name


@pytest.mark.parametrize("seed", range(16))
def test_march_is_the_closed_form_on_any_sequence(seed: int) -> None:
    values, segments = draw(Random(f"march {seed}"))
    w, zeta = (
        (values["k"] / values["m"]) ** 0.5,
        0.5 * values["c"] / (values["k"] * values["m"]) ** 0.5,
    )
    steps = [
        Step(min(each.length, 6.0 / w / max(1.0, zeta)), each.changes) for each in segments[:5]
    ]
    assert_equal(truth.run(values, steps), truth.run(values, steps, law=Marched()))


def of_lambda(value: float) -> dict[str, float]:
    """Return the coefficients of an undamped cycle of this lambda at the default k, m, v."""
    return {"mu_k": 0.3, "mu_s": 0.3 + value * 0.02 * 1000.0**0.5 / 9.81}


def beside_limit(distance: float) -> dict[str, float]:
    """Return a setting with lambda = lambda_c (1 + distance), zeta 0.1."""
    w = MP.sqrt(1000)
    Delta = (MP.mpf(0.5) - MP.mpf(0.3)) * MP.mpf(9.81) / 1000
    c = 0.2 * float(w)
    critical = truth.critical_lambda(MP.mpf(c) / (2 * w))
    return {"c": c, "v": float(w * Delta / (critical * (1 + MP.mpf(distance))))}


@pytest.mark.parametrize(
    "values",
    [
        {},
        of_lambda(1e-3),
        of_lambda(1e-9),
        {"mu_s": 0.3},
        {"mu_s": 0.3, "c": 1.0},
        {"mu_s": 0.0, "mu_k": 0.0},
        {"mu_k": 0.0, "F_ext": 3.0},
        {"v": 0.0, "x_dot_start": 3.0, "mu_s": 0.1, "mu_k": 0.05},
        {"v": -0.02, "x_dot_start": 0.3},
        # Critical damping exactly.
        {"k": 1024.0, "c": 64.0, "z_start": 0.02},
        {"k": 1024.0, "c": 64.0, "v": 0.0, "x_dot_start": 1.0},
        {"v": 0.0, "x_dot_start": 3.0, "c": 1000.0},
        *map(beside_limit, (1e-9, -1e-9)),
    ],
    ids=str,
)
def test_march_is_the_closed_form_at_the_corners(values: Mapping[str, float]) -> None:
    steps = [Step(0.37)] * 4
    assert_equal(truth.run(values, steps), truth.run(values, steps, law=Marched()))


def test_more_digits_confirm_the_fewer_and_leave_the_global_precision() -> None:
    before = mpmath.mp.prec
    steps = [Step(0.3), Step(0.2, {"v": 0.04, "F_ext": 1.0}), Step(0.2, {"v_s": 0.1, "k": 700.0})]
    values = {"v_s": 0.03, "delta": 1.0, "c": 2.0}
    few, many = (truth.run(values, steps, digits=n, law="stribeck") for n in (20, 32))
    assert len(few.events) > 2
    assert_equal(few, many, MP.mpf("1e-19"))
    plain = [truth.run({"c": 11.0, "v": 0.001}, [Step(9.0)], digits=n) for n in (30, 80)]
    assert_equal(plain[0], plain[1], MP.mpf("1e-29"))
    assert mpmath.mp.prec == before


@pytest.mark.parametrize(
    "roots", [[], [0.6], [0.3, 0.300001], [0.1, 0.2, 0.3, 0.4, 0.6], [0.999], [0.6, 1.5]]
)
def test_zeros_of_a_polynomial_are_isolated(roots: Sequence[float]) -> None:
    # Two complex zeros close to the axis do not count.
    product = Series(MP, [MP.mpf("0.7") ** 2 + MP.mpf("1e-20"), MP.mpf("-1.4"), MP.one])
    for root in roots:
        product = product * Series(MP, [-MP.mpf(root), MP.one])
    found = polynomial_zeros(MP, [product.term(n) for n in range(len(roots) + 3)], MP.one)
    inside = [MP.mpf(root) for root in roots if root < 1]
    assert len(found) == len(inside)
    assert all(abs(a - b) < TOLERANCE for a, b in zip(found, inside, strict=True))


def test_coefficients_of_a_series_are_the_derivatives_over_factorials() -> None:
    def function(x: Any) -> Any:
        exp = x.exp() if isinstance(x, Series) else MP.exp(x)
        inner = 3 - x * x / 4
        log = inner.log() if isinstance(x, Series) else MP.log(inner)
        return (2 / (1 + exp) - log * x) / (x + 5) ** MP.mpf("1.5") + (-x) ** 3

    series = function(Series.variable(MP, MP.mpf("0.7")))
    for n, value in enumerate(MP.taylor(function, MP.mpf("0.7"), 12)):
        # mpmath differentiates numerically, at a precision that it raises itself.
        assert abs(series.term(n) - value) < MP.mpf("1e-40")


@pytest.mark.parametrize("make", [lambda x: x.log(), lambda x: x**0.5, lambda x: 1 / x])
def test_what_has_no_taylor_series_is_refused(make: Any) -> None:
    with pytest.raises(ValueError, match="no Taylor series at the value 0"):
        make(Series.variable(MP, MP.zero))


def test_a_friction_with_a_kink_is_refused() -> None:
    class Kinked(FrictionLaw):
        def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
            friction: Series = speed * (5 if speed.term(0) < 0.01 else 2) + n.F_k
            return friction

    with pytest.raises(ValueError, match="no analytic function of speed near"):
        truth.run({}, [Step(0.5)], law=Kinked())
