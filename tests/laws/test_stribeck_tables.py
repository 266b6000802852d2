"""The friction law "stribeck" in reference and truth: equal parameters, refusals and values."""

from __future__ import annotations

import math

import pytest

from stickslip_ref import STRIBECK, Change, Parameters, Shape, friction_law, simulate
from stickslip_verification import truth
from stickslip_verification.truth import Kind, Step

CURVE = {"shape": 3.0, "mu_1": 0.4, "u_2": 0.02, "mu_2": 0.3, "u_3": 0.15, "mu_3": 0.45}

REFUSED = [
    ({"shape": 4.0}, "shape = 4.0"),
    ({"shape": 1.5}, "shape = 1.5"),
    ({"shape": 0.0}, "shape = 0.0"),
    ({"n_points": 1.0}, "n_points = 1.0"),
    ({"n_points": 13.0}, "n_points = 13.0"),
    ({"n_points": 2.5}, "n_points = 2.5"),
    ({"v_s": 0.0}, "v_s = 0.0"),
    ({"delta": 0.99}, "delta = 0.99"),
    ({**CURVE, "n_points": 3.0, "u_3": 0.02}, "u_3 = 0.02"),
    ({**CURVE, "u_2": 0.0}, "u_2 = 0.0"),
    ({**CURVE, "mu_2": -0.1}, "mu_2 = -0.1"),
    ({**CURVE, "mu_1": 0.51}, "mu_1 = 0.51"),
]


def test_both_sides_have_the_same_parameters() -> None:
    """Names in the order of the rows, starts, bounds and kinds are equal."""
    reference = [
        (name, each.bound.unit or "1", each.start, each.bound.low, each.bound.strict, each.tunable)
        for name, each in STRIBECK.parameters.items()
    ]
    exact = [
        (each.name, each.unit, each.start, each.low, each.strict, each.kind is Kind.TUNABLE)
        for each in truth.STRIBECK.parameters
    ]
    assert reference == exact
    assert [name for name, *_ in exact[:8]] == [
        *("shape", "v_s", "delta", "n_points", "mu_1", "u_2", "mu_2", "u_3")
    ]
    assert len(exact) == 27


def test_the_name_is_known_on_both_sides() -> None:
    """An unknown name's message lists the built-in ones."""
    assert friction_law("stribeck") is STRIBECK
    assert truth.friction_law("stribeck") is truth.STRIBECK
    for law in (friction_law, truth.friction_law):
        with pytest.raises(ValueError, match="'coulomb', 'stribeck'"):
            law("stribek")


@pytest.mark.parametrize(("own", "message"), REFUSED)
def test_refusals_name_parameter_and_value(own: dict[str, float], message: str) -> None:
    """Both sides refuse what is no shape, no curve or out of range."""
    with pytest.raises(ValueError, match=message):
        simulate(Parameters(), 0.1, law="stribeck", own=own)
    with pytest.raises(ValueError, match=message):
        truth.run(own, [Step(0.1)], law="stribeck")


def test_a_change_is_checked_on_both_sides() -> None:
    """A value out of range is refused on the way too."""
    with pytest.raises(ValueError, match=r"v_s = -1.0 m/s is out of range"):
        simulate(Parameters(), 1.0, law="stribeck", changes=[Change(0.5, {}, {"v_s": -1.0})])
    with pytest.raises(ValueError, match=r"v_s = -1.0 is outside v_s > 0"):
        truth.run({}, [Step(1.0), Step(1.0, {"v_s": -1.0})], law="stribeck")


def test_points_beyond_the_number_of_points_are_not_looked_at() -> None:
    """Neither are the points of a curve where the shape is another."""
    own = {**CURVE, "n_points": 2.0, "u_3": 0.01}
    p = STRIBECK.complete(Parameters(), own)
    assert STRIBECK.slip_friction(p, 1.0) == 0.3 * p.N
    STRIBECK.complete(Parameters(), {**own, "n_points": 3.0, "shape": 2.0, "mu_1": 0.9})


@pytest.mark.parametrize("mu_k", [0.3, 0.6])
def test_mu_k_used_is_the_clamp_or_the_last_point(mu_k: float) -> None:
    """Both sides show the clamped mu_k for the smooth shapes, mu_n for a curve."""
    for own, shown in (({}, min(mu_k, 0.49)), ({**CURVE, "n_points": 3.0}, 0.45)):
        exact = truth.run({"mu_k": mu_k, **own}, [Step(0.01)], law="stribeck")
        if mu_k > 0.5:
            with pytest.warns(UserWarning, match="exceeds"):
                p = Parameters(mu_k=mu_k)
        else:
            p = Parameters(mu_k=mu_k)
        numeric = simulate(p, 0.01, law="stribeck", own=own)
        assert float(exact.samples[0]["mu_k_used"]) == numeric.mu_k_used[-1] == shown


@pytest.mark.parametrize(
    ("own", "speed", "mu"),
    [
        ({"shape": Shape.STRIBECK}, 0.01, 0.3 + 0.2 * math.exp(-1.0)),
        ({"shape": Shape.STRIBECK, "delta": 1.5}, 0.02, 0.3 + 0.2 * math.exp(-(2.0**1.5))),
        ({"shape": Shape.HYPERBOLIC}, 0.03, 0.35),
        ({**CURVE, "n_points": 3.0}, 0.0, 0.4),
        ({**CURVE, "n_points": 3.0}, 0.005, 0.375),
        ({**CURVE, "n_points": 3.0}, 0.085, 0.375),
        ({**CURVE, "n_points": 3.0}, 7.0, 0.45),
    ],
)
def test_coefficient_at_a_speed(own: dict[str, float], speed: float, mu: float) -> None:
    """The friction of the reference is that of the formula, to rounding."""
    p = STRIBECK.complete(Parameters(), own)
    assert STRIBECK.slip_friction(p, speed) / p.N == pytest.approx(mu, rel=1e-15)
