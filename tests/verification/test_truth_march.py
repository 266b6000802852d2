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
from tests.facts.coulomb import damped, of_lambda
from tests.fmu.blocks import draw

MP = high_precision(50)
TOLERANCE = MP.mpf("1e-45")
"""Fifty digits are promised; five are left for what a shallow end of a slip amplifies."""


class Marched(FrictionLaw):
    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        return Series(speed.context, [n.F_k])


def assert_equal(one: truth.Run, other: truth.Run, tolerance: Any = TOLERANCE) -> None:
    assert [(e.kind, e.mode) for e in one.events] == [(e.kind, e.mode) for e in other.events]
    for name in one.initial:
        alike = ("x", "x_pull", "z") if name in ("x", "x_pull", "z") else (name,)
        largest = max(abs(sample[each]) for sample in one.samples for each in alike)
        for a, b in zip(one.samples, other.samples, strict=True):
            assert abs(a[name] - b[name]) <= tolerance * largest, name


def any_sequence(seed: int) -> tuple[Mapping[str, float], list[Step]]:
    values, segments = draw(Random(f"march {seed}"))
    w = (values["k"] / values["m"]) ** 0.5
    longest = 6.0 / w / max(1.0, 0.5 * values["c"] / (values["m"] * w))
    return values, [Step(min(each.length, longest), each.changes) for each in segments[:5]]


@pytest.mark.parametrize(
    ("values", "steps"),
    [
        *map(any_sequence, range(16)),
        *(
            (values, [Step(0.37)] * 4)
            for values in [
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
                *(damped(0.1, d) for d in (1e-9, -1e-9)),
            ]
        ),
    ],
    ids=str,
)
def test_march_is_the_closed_form(values: Mapping[str, float], steps: Sequence[Step]) -> None:
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
