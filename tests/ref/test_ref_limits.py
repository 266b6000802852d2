"""Where stick-slip ends: closed forms, the exact block just inside and outside of every range."""

import math
from typing import Any

import pytest

from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.spec import spec_of
from stickslip_ref import COULOMB, Coulomb, Interval, Parameters, coulomb_limit, critical_velocity
from stickslip_ref.limits.memoryless import cycle_ranges

TWICE = {"shape": 3, "n_points": 5, "mu_1": 0.5, "u_2": 0.02, "mu_2": 0.3, "u_3": 0.15} | {
    "mu_3": 0.45, "u_4": 0.4, "mu_4": 0.2, "u_5": 0.6, "mu_5": 0.25
}  # fmt: skip
"""A curve that falls twice."""

SETTINGS = {
    "falls twice": ({"c": 2.0}, TWICE),
    "Stribeck": ({"c": 2.0}, {"v_s": 0.01, "delta": 1.0}),
    "flat at rest": ({"c": 5.0}, {"v_s": 0.1, "delta": 2.0}),
    "not whole": ({"c": 3.0}, {"v_s": 0.03, "delta": 1.6}),
    "hyperbolic": ({"c": 1.0}, {"shape": 2, "v_s": 0.2}),
    "with a gap": ({"c": 2.0, "mu_s": 0.55}, TWICE),
    "overdamped": ({"c": 80.0, "mu_k": 0.05}, {"v_s": 0.02, "delta": 1.0}),
}


def sticks(base: dict[str, float], own: dict[str, float], v: float) -> bool:
    """Tell whether the exact block sticks after the first slip from break-away at `v` [m/s]."""
    spec = spec_of(friction_law("stribeck").law)
    values = {**spec.table.start_values(), **base, **own, "v": v}
    values["z_start"] = values["mu_s"] * values["m"] * values["g"] / values["k"]
    block: Any = spec.model(spec.values(values))
    block.advance(0.0, 1e-9)
    time, slow = 1e-9, max(1.0, values["c"] / math.sqrt(values["k"] * values["m"]))
    for _ in range(40):
        block.advance(time, slow / math.sqrt(values["k"] / values["m"]))
        time += 1.0
        if block.meter.n_slips:
            return True
    return False


@pytest.mark.parametrize("name", SETTINGS)
def test_the_exact_block_sticks_inside_of_every_range_and_not_outside(name: str) -> None:
    base, own = SETTINGS[name]
    found = critical_velocity(Parameters(**base), "stribeck", own)
    assert found.cycle
    ends = 0
    for each in found.cycle:
        for v, kind, inside in (
            (each.low, each.low_end, 1.0 + 1e-6),
            (each.high, each.high_end, 1.0 - 1e-6),
        ):
            if kind != "none":
                assert kind == "grazing"
                assert sticks(base, own, v * inside)
                assert not sticks(base, own, v / inside)
                ends += 1
    assert ends


def test_a_curve_that_falls_twice_has_two_ranges() -> None:
    found = critical_velocity(Parameters(c=2.0), "stribeck", TWICE)
    ends = [end for each in found.unstable for end in each[:2]]
    assert ends == pytest.approx([found.between[0], 0.02, 0.15, 0.4])
    first, second = found.cycle
    assert first.high == pytest.approx(0.048921562, rel=1e-8)
    assert (second.low, second.high) == pytest.approx((0.142590582, 0.419507691), rel=1e-8)
    assert [each[2:] for each in found.cycle] == [("none", "grazing"), ("grazing", "grazing")]
    assert [each[2:] for each in found.unstable] == [
        ("none", "eigenvalue"), ("eigenvalue", "eigenvalue")
    ]  # fmt: skip
    assert found.motions(0.01) == ("sticks",)
    assert found.motions(0.03) == ("sticks", "even")
    assert found.motions(0.1) == ("even",)
    assert found.highest == second.high
    assert not found.proven


@pytest.mark.parametrize("zeta", [1e-7, 1e-4, 1e-2, 0.1, 0.5, 0.9])
def test_the_search_finds_the_closed_form_of_coulombs_law(zeta: float) -> None:
    p = Parameters(c=2.0 * zeta * math.sqrt(1000.0))
    limit = float(coulomb_limit(p))
    (found,) = cycle_ranges(COULOMB.complete(p, {}), COULOMB, (limit / 100.0, 100.0 * limit))
    assert found.high == pytest.approx(limit, rel=1e-9 + 1e-12 / (4.0 * math.pi * zeta))
    assert (found.low_end, found.high_end) == ("none", "grazing")
    assert critical_velocity(p).cycle == (Interval(0.0, limit, "none", "grazing"),)
    assert critical_velocity(p).proven


def test_without_damping_coulombs_law_has_no_end() -> None:
    assert critical_velocity(Parameters()).highest == math.inf
    assert critical_velocity(Parameters(c=100.0)).cycle == ()
    assert critical_velocity(Parameters(), between=(0.1, 0.2)).cycle == (
        Interval(0.1, 0.2, "none", "none"),
    )


def test_without_damping_friction_that_hardly_falls_sticks_too() -> None:
    p = Parameters(mu_s=0.5, mu_k=0.499)
    (only,) = critical_velocity(p, "stribeck", {"v_s": 6.0, "delta": 3.0}, (1e-5, 0.03)).cycle
    assert only[1:] == (0.03, "none", "none")
    w, v = math.sqrt(1000.0), only.low
    assert w * 0.001 * 9.81 / 1000.0 * (2.0 * v / 6.0) ** 3 / v == pytest.approx(1e-12, rel=1e-3)


def test_a_slip_that_turns_round_may_stick_later() -> None:
    p = Parameters(m=1.0, k=1.0, g=1.0, mu_s=1.0, mu_k=0.0)
    own = {"shape": 2.0, "v_s": 1.0 / 3.0}
    found = critical_velocity(p, "stribeck", own, between=(0.1, 6.0))
    (only,) = found.cycle
    assert only.high_end == "reversal"
    assert only.high == pytest.approx(4.4237, rel=1e-4)
    assert found.motions(5.0) == ("swings",)


HEAVY: list[tuple[dict[str, float], dict[str, float]]] = [
    ({"c": 1e3}, {}),
    ({"c": 1e4}, {"shape": 2}),
    ({"c": 1e7}, {"delta": 1.0}),
    ({"c": 1e5}, {"delta": 1e4}),
]


@pytest.mark.parametrize(("base", "own"), HEAVY, ids=str)
def test_a_damping_that_no_fall_of_friction_overcomes_leaves_sliding(
    base: dict[str, float], own: dict[str, float]
) -> None:
    found = critical_velocity(Parameters(**base), "stribeck", own)
    assert (found.cycle, found.unstable) == ((), ())


def test_a_slip_that_settles_where_friction_rises_steeply_is_sliding() -> None:
    rises = {"shape": 3, "n_points": 3, "mu_1": 0.1, "u_2": 0.04, "mu_2": 1.3} | {
        "u_3": 0.041, "mu_3": 0.0
    }  # fmt: skip
    base = {"m": 1.0, "k": 1.0, "g": 1.0, "mu_s": 1.0}
    found = critical_velocity(Parameters(**base), "stribeck", rises, (0.03, 0.033))
    assert (found.cycle, found.unstable) == ((), ())
    assert not sticks(base, rises, 0.0314)


def test_the_second_slip_decides_whether_a_motion_that_turns_round_sticks() -> None:
    falls = {"shape": 3, "n_points": 4, "mu_1": 1.0, "u_2": 0.0624, "mu_2": 0.3965} | {
        "u_3": 0.0663, "mu_3": 0.0, "u_4": 0.1327, "mu_4": 0.0
    }  # fmt: skip
    base = {"m": 1.0, "k": 1.0, "g": 1.0, "mu_s": 1.0, "mu_k": 0.0}
    (found,) = critical_velocity(Parameters(**base), "stribeck", falls, (5.0, 5.4)).cycle
    assert found.low_end == "reversal"
    spec = spec_of(friction_law("stribeck").law)
    for v, expected in ((0.9995 * found.low, False), (1.0005 * found.low, True)):
        values = {**spec.table.start_values(), **base, **falls, "v": v, "z_start": 1.0}
        block: Any = spec.model(spec.values(values))
        block.advance(0.0, 1e-9)
        found_stick = False
        for _ in range(60):
            block.advance(1.0, 0.5)
            found_stick = found_stick or block.meter.t_stick > 0.0
        assert found_stick == expected


def test_stribeck_ends_where_eigenvalues_say() -> None:
    p = Parameters(c=5.0)
    for delta in (1.0, 1.5, 2.0):
        found = critical_velocity(p, "stribeck", {"v_s": 0.1, "delta": delta})
        for each in found.unstable:
            for v, kind in ((each.low, each.low_end), (each.high, each.high_end)):
                if kind == "eigenvalue":
                    x = v / 0.1
                    fall = 9.81 * 0.2 * delta * x ** (delta - 1.0) * math.exp(-(x**delta))
                    assert fall == pytest.approx(0.5, rel=1e-11)


def test_a_law_of_ones_own_is_searched_with_differences() -> None:

    class Fall(Coulomb):
        constant_in_slip = False

        def slip_friction(self, p: Parameters, speed: float, state: object = ()) -> float:
            return float(p.N) * max(0.5 - 2.0 * speed, 0.3)

        def knots(self, p: Parameters) -> tuple[float, ...]:
            return (0.1,)

    curve = {"shape": 3, "n_points": 2, "mu_1": 0.5, "u_2": 0.1, "mu_2": 0.3}
    of_curve = critical_velocity(Parameters(c=4.0), "stribeck", curve, (1e-3, 1.0))
    own = critical_velocity(Parameters(c=4.0), Fall(), between=(1e-3, 1.0))
    for one, other in zip(
        own.cycle + own.unstable, of_curve.cycle + of_curve.unstable, strict=True
    ):
        assert one[:2] == pytest.approx(other[:2], rel=1e-7)
        assert one[2:] == other[2:]


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


@pytest.mark.parametrize(
    ("law", "own", "p"),
    [
        ("stribeck", {}, Parameters(mu_s=0.0, mu_k=0.0)),
        ("stribeck", {}, Parameters(load=-9.81)),
        ("coulomb", {"tau_s": 0.1}, Parameters(load=-9.81, c=1.0)),
    ],
)
def test_what_never_holds_has_no_range(law: str, own: dict[str, float], p: Parameters) -> None:
    found = critical_velocity(p, law, own)
    assert found.cycle == ()
    assert 0.0 < found.between[0] < found.between[1]


@pytest.mark.gate
def test_a_slow_layer_is_not_leapt_over() -> None:
    p = Parameters(
        m=0.04160216590251779, k=140.24203687661213, c=0.025903983501884567,
        mu_s=0.4301392888905115, mu_k=0.2551120858119786,
    )  # fmt: skip
    own = {"shape": 1.0, "v_s": 1.9343965346137023e-05, "delta": 5.0}
    found = critical_velocity(p, "stribeck", own, (0.1175, 0.1195)).highest
    assert found == pytest.approx(0.1184685860, rel=1e-6)
