"""Where stick-slip ends: closed forms, the exact block just inside and outside of every range."""

import math

import pytest

from stickslip_ref import COULOMB, Interval, Parameters, coulomb_limit, critical_velocity
from stickslip_ref.limits.memoryless import cycle_ranges
from tests.laws.stribeck import FALLS_TWICE, Points, curve, make_block

TWICE = curve(FALLS_TWICE)
UNIT = {"m": 1.0, "k": 1.0, "g": 1.0, "mu_s": 1.0, "mu_k": 0.0}
SETTINGS = {
    "falls twice": ({"c": 2.0}, TWICE),
    "Stribeck": ({"c": 2.0}, {"v_s": 0.01, "delta": 1.0}),
    "not whole": ({"c": 3.0}, {"v_s": 0.03, "delta": 1.6}),
    "hyperbolic": ({"c": 1.0}, {"shape": 2, "v_s": 0.2}),
    "with a gap": ({"c": 2.0, "mu_s": 0.55}, TWICE),
    "overdamped": ({"c": 80.0, "mu_k": 0.05}, {"v_s": 0.02, "delta": 1.0}),
}


def sticks(values: dict[str, float], v: float, slips: int = 1) -> bool:
    p = Parameters(
        **{name: values[name] for name in ("m", "k", "g", "c", "mu_s") if name in values}
    )
    block = make_block(**values, v=v, z_start=float(p.F_s) / float(p.k))
    block.advance(0.0, 1e-9)
    for _ in range(40):
        block.advance(0.0, max(1.0, 2.0 * float(p.zeta)) / float(p.w))
        if block.meter.n_slips and (slips == 1 or block.meter.t_stick > 0.0):
            return True
    return False


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(each, marks=[pytest.mark.gate] * (SETTINGS[each][1] is TWICE))
        for each in SETTINGS
    ],
)
def test_the_exact_block_sticks_inside_of_every_range_and_not_outside(name: str) -> None:
    base, own = SETTINGS[name]
    found = critical_velocity(Parameters(**base), "stribeck", own).cycle
    ends = [(each.low, each.low_end, 1.0 + 1e-6) for each in found]
    ends += [(each.high, each.high_end, 1.0 - 1e-6) for each in found]
    assert any(kind != "none" for _, kind, _ in ends)
    for v, kind, inside in ends:
        if kind != "none":
            assert kind == "grazing"
            assert sticks({**base, **own}, v * inside)
            assert not sticks({**base, **own}, v / inside)


def test_a_curve_that_falls_twice_has_two_ranges() -> None:
    found = critical_velocity(Parameters(c=2.0), "stribeck", TWICE)
    ends = [end for each in found.unstable for end in each[:2]]
    assert ends == pytest.approx([found.between[0], 0.02, 0.15, 0.4])
    first, second = found.cycle
    assert first.high == pytest.approx(0.048921562, rel=1e-8)
    assert (second.low, second.high) == pytest.approx((0.142590582, 0.419507691), rel=1e-8)
    assert [each[2:] for each in found.cycle] == [("none", "grazing"), ("grazing", "grazing")]
    eigenvalues = [("none", "eigenvalue"), ("eigenvalue", "eigenvalue")]
    assert [each[2:] for each in found.unstable] == eigenvalues
    assert found.motions(0.01) == ("sticks",)
    assert found.motions(0.03) == ("sticks", "even")
    assert found.motions(0.1) == ("even",)
    assert found.highest == second.high
    assert not found.proven


@pytest.mark.parametrize("zeta", [1e-7, 1e-2, 0.9])
def test_the_search_finds_the_closed_form_of_coulombs_law(zeta: float) -> None:
    p = Parameters(c=2.0 * zeta * math.sqrt(1000.0))
    limit = float(coulomb_limit(p))
    (found,) = cycle_ranges(COULOMB.complete(p, {}), COULOMB, (limit / 100.0, 100.0 * limit))
    assert found.high == pytest.approx(limit, rel=1e-9 + 1e-12 / (4.0 * math.pi * zeta))
    assert (found.low_end, found.high_end) == ("none", "grazing")
    assert critical_velocity(p).cycle == (Interval(0.0, limit, "none", "grazing"),)
    assert critical_velocity(p).proven


def test_without_damping_friction_that_hardly_falls_sticks_too() -> None:
    p = Parameters(mu_s=0.5, mu_k=0.499)
    (only,) = critical_velocity(p, "stribeck", {"v_s": 6.0, "delta": 3.0}, (1e-5, 0.03)).cycle
    assert only[1:] == (0.03, "none", "none")
    w, v = math.sqrt(1000.0), only.low
    assert w * 0.001 * 9.81 / 1000.0 * (2.0 * v / 6.0) ** 3 / v == pytest.approx(1e-12, rel=1e-3)


def test_a_slip_that_turns_round_may_stick_later() -> None:
    own = {"shape": 2.0, "v_s": 1.0 / 3.0}
    found = critical_velocity(Parameters(**UNIT), "stribeck", own, between=(0.1, 6.0))
    (only,) = found.cycle
    assert only.high_end == "reversal"
    assert only.high == pytest.approx(4.4237, rel=1e-4)
    assert found.motions(5.0) == ("swings",)


RISES: Points = [(0.0, 0.1), (0.04, 1.3), (0.041, 0.0)]
"""A slip settles where friction rises steeply: that is sliding."""


@pytest.mark.parametrize(
    ("values", "own", "between"),
    [
        ({"c": 1e3}, {}, ()),
        ({"c": 1e4}, {"shape": 2}, ()),
        ({"c": 1e7}, {"delta": 1.0}, ()),
        ({"c": 1e5}, {"delta": 1e4}, ()),
        (UNIT, curve(RISES), ((0.03, 0.033),)),
        ({"mu_s": 0.0, "mu_k": 0.0}, {}, ()),
        ({"load": -9.81}, {}, ()),
    ],
    ids=str,
)
def test_where_no_fall_of_friction_overcomes_the_damping_or_nothing_holds_the_mass_slides(
    values: dict[str, float], own: dict[str, float], between: tuple[tuple[float, float], ...]
) -> None:
    found = critical_velocity(Parameters(**values), "stribeck", own, *between)
    assert (found.cycle, found.unstable) == ((), ())
    assert 0.0 < found.between[0] < found.between[1]


def test_the_second_slip_decides_whether_a_motion_that_turns_round_sticks() -> None:
    falls = curve([(0.0, 1.0), (0.0624, 0.3965), (0.0663, 0.0), (0.1327, 0.0)])
    (found,) = critical_velocity(Parameters(**UNIT), "stribeck", falls, (5.0, 5.4)).cycle
    assert found.low_end == "reversal"
    assert not sticks({**UNIT, **falls}, 0.9995 * found.low, slips=2)
    assert sticks({**UNIT, **falls}, 1.0005 * found.low, slips=2)


def test_stribeck_ends_where_eigenvalues_say() -> None:
    for delta in (1.0, 1.5, 2.0):
        own = {"v_s": 0.1, "delta": delta}
        for each in critical_velocity(Parameters(c=5.0), "stribeck", own).unstable:
            for v, kind in ((each.low, each.low_end), (each.high, each.high_end)):
                x = v / 0.1
                fall = 9.81 * 0.2 * delta * x ** (delta - 1.0) * math.exp(-(x**delta))
                assert kind != "eigenvalue" or fall == pytest.approx(0.5, rel=1e-11)


@pytest.mark.parametrize(
    ("between", "told"),
    [((0.0, 1.0), "must rise and be > 0"), ((2.0, 1.0), "2 to 1"), ((-1.0, 1.0), "-1 to 1")],
)
def test_a_range_that_is_none_is_refused(between: tuple[float, float], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        critical_velocity(Parameters(), "stribeck", between=between)


def test_a_velocity_that_was_not_searched_has_no_answer() -> None:
    found = critical_velocity(Parameters(), "stribeck")
    assert found.motions(found.between[0]) == ("sticks",)
    for v in (0.0, 0.5 * found.between[0], -2.0 * found.between[1]):
        with pytest.raises(ValueError, match="m/s is out of range; the velocities searched are"):
            found.motions(v)
