"""LuGre, rate and state: reference against truth, closed forms, published values, limits."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from stickslip_ref import (
    LUGRE,
    RATE_STATE,
    Change,
    FrictionLaw,
    Parameters,
    critical_velocity,
    friction_law,
    memory_cycle,
    regime,
    simulate,
)
from stickslip_ref.limits.memory import stability
from stickslip_verification import truth
from stickslip_verification.truth import Kind
from tests.facts.sides import parted
from tests.laws.memory import CANUDAS, QDYN, SETTINGS, exact, simulated

GROUPS = (
    {"x", "x_pull", "z", "delta_x", "spring_drop"},
    {"x_dot", "x_dot_peak"},
    {"F", "F_friction", "F_s"},
    {"t_stick", "t_slip", "T", "t_event"},
    {"W_pull", "W_k", "Q_friction", "E_bristles"},
)
QUICK = {"bristles", "contacts", "contacts, load"}


@pytest.mark.parametrize(
    "name",
    [pytest.param(each, marks=[pytest.mark.gate] * (each not in QUICK)) for each in SETTINGS],
)
def test_the_reference_is_right_to_1e_9_of_its_scale(name: str) -> None:
    setting = SETTINGS[name]
    expected, found = exact(setting), simulated(setting)
    length = max(h for h, _ in setting.steps)
    assert [event.kind for event in found.events] == [event.kind for event in expected.events]
    for event, exact_event in zip(found.events, expected.events, strict=True):
        assert event.time == pytest.approx(float(exact_event.time), abs=1e-9 * length)
    for number, row in enumerate(expected.samples):
        columns = {**vars(found), **found.own, "sticking": found.sticking}
        for output, value in row.items():
            group = next((names for names in GROUPS if output in names), {output})
            scale = max(abs(float(row.get(each, 0.0))) for each in group)
            assert columns[output][number] == pytest.approx(float(value), abs=1e-9 * scale), output


@pytest.mark.parametrize("name", ["lugre", "rate_state"])
def test_reference_and_truth_have_the_same_parameters(name: str) -> None:
    own = friction_law(name).parameters
    for each in truth.friction_law(name).parameters:
        there = own[each.name]
        bound = there.bound
        assert (bound.unit or "1", bound.low if bound.low > -math.inf else None, bound.strict) == (
            each.unit,
            each.low,
            each.strict,
        )
        assert (there.start, there.tunable) == (each.start, each.kind is not Kind.FIXED)
    assert len(own) == len(truth.friction_law(name).parameters)


def test_published_lugre_slips_below_f_s_and_its_spring_passes_f_s() -> None:
    base, own = parted(CANUDAS)
    found = simulate(Parameters(**base), 10.0, law="lugre", own=own)
    assert np.max(-found.F_friction) == pytest.approx(1.4765, abs=1e-4)
    assert found.events[0].z * 2.0 == pytest.approx(1.508, abs=5e-4)


@pytest.mark.gate
def test_published_spring_block_of_qdyn_recurs_after_585_48393_s() -> None:
    base, own = parted(QDYN)
    cycle = memory_cycle(Parameters(**base), "rate_state", own)
    assert cycle is not None
    assert pytest.approx(585.48393, rel=1e-7) == cycle.T
    # Newton's cycle is where running in leads.
    found = simulate(Parameters(**base), 1200.0, law="rate_state", own=own).cycles[-1]
    assert pytest.approx(cycle.T, rel=1e-10) == found.T
    assert found.delta_x == pytest.approx(cycle.delta_x, rel=1e-9)


@pytest.mark.parametrize("law", [LUGRE, RATE_STATE], ids=["lugre", "rate_state"])
def test_no_energy_is_lost_and_the_mirror_image_is_one(law: FrictionLaw) -> None:
    p = Parameters(c=2.0, v=0.02, x_dot_start=0.03, z_start=2e-3, F_ext=0.5)
    changes = [Change(0.2, {"v": -0.01}), Change(0.3, {"k": 2000.0, "load": 3.0})]
    found = simulate(p, 0.5, law=law, own={}, changes=changes)
    k = np.where(found.t > 0.3, 2000.0, 1000.0)
    energy = 0.5 * k * found.z**2 + 0.5 * found.x_dot**2 + found.own.get("E_bristles", 0.0)
    put_in = found.W_pull + found.W_k + found.W_ext - found.Q_friction
    assert put_in == pytest.approx(energy - energy[0], abs=1e-9 * np.max(energy))
    back = replace(p, v=-0.02, x_dot_start=-0.03, z_start=-2e-3, F_ext=-0.5)
    turned = [Change(each.time, {**each.values, "v": 0.01}) for each in changes[:1]]
    mirrored = simulate(back, 0.5, law=law, own={}, changes=[*turned, changes[1]], times=found.t)
    assert mirrored.z == pytest.approx(-found.z, abs=1e-12)
    assert mirrored.n_slips.tolist() == found.n_slips.tolist()


@pytest.mark.parametrize("law", ["lugre", "rate_state"])
def test_without_a_normal_force_the_mass_swings_freely_and_at_rest_it_stays(law: str) -> None:
    w = math.sqrt(1000.0)
    swings = simulate(Parameters(load=-9.81), 0.25, law=law)
    assert swings.z == pytest.approx(0.02 / w * np.sin(w * swings.t), abs=1e-9 * 0.02 / w)
    rests = simulate(Parameters(v=0.0), 1.0, law=law)
    assert rests.events == ()
    assert not np.any(rests.x_dot)


def test_an_instability_that_nothing_ends_is_refused_with_the_reason() -> None:
    with pytest.raises(RuntimeError, match="without inertia and damping nothing ends"):
        simulate(Parameters(z_start=5e-3), 1.0, law="rate_state", own={"inertia": 2.0})


def test_bristles_slide_at_g_and_hold_as_a_spring() -> None:
    # v is far above v_s: sliding is stable.
    p = Parameters(v=0.05, c=20.0, x_dot_start=0.05, z_start=3.9e-3)
    slides = simulate(p, 3.0, law="lugre", own={"zeta_start": 0.3 * 9.81 / 1e5})
    force = 0.3 * 9.81 + 20.0 * 0.05
    assert -slides.F_friction[-1] == pytest.approx(force, rel=1e-9)
    # A thousandth of break-away bends sigma_0 and the spring in series.
    way = 1e-6 * 0.5 * 9.81
    holds = simulate(Parameters(v=way), 10.0, law="lugre", changes=[Change(1.0, {"v": 0.0})])
    assert holds.z[-1] == pytest.approx(way * 1e5 / (1e5 + 1000.0), rel=1e-5)


def _breaks_away(p: Parameters, rate: float) -> float:
    """Return the friction at which bristles of a light mass no longer hold a force that grows.

    There ``F' = sigma_0 zeta'``, so ``u (1 - F / g(u)) = F' / sigma_0``: a creep u solves it up to
    the F at which the left side's maximum over u is the right one, which falls with the rate.
    """
    creep = np.geomspace(1e-3, 10.0, 100_000) * p.own["v_s"]
    g = np.array([LUGRE.sliding_friction(p, u) for u in creep.tolist()])
    return float(np.max(g * (1.0 - rate / p.own["sigma_0"] / creep)))


@pytest.mark.parametrize("rate", [0.2, 1.0, 5.0, 15.0])
def test_break_away_falls_with_the_rate_of_the_force(rate: float) -> None:
    # A finding of the paper of 1995, as 10.1007/s11044-023-09909-5 says. Bristles that lag by
    # sigma_1 / sigma_0 pass the fold late by its power 2/3, as any slow passage.
    late = []
    for m in (1e-4, 1e-6):
        base = Parameters(m=m, g=1.0 / m, k=2.0, v=0.5 * rate, mu_s=1.5, mu_k=1.0)
        p = LUGRE.complete(base, {"sigma_1": 2.0 * math.sqrt(1e5 * m)})
        fold = _breaks_away(p, rate)
        times = (fold + np.linspace(-0.01, 0.04, 5001)) / rate
        found = simulate(base, times[-1], times=times, law="lugre", own=p.own)
        late.append(np.max(-found.F_friction) - fold)
    assert 0.0 < late[1] < 1.5e-3
    # The next order is some 10 %.
    assert math.log(late[0] / late[1], 10.0) == pytest.approx(2.0 / 3.0, rel=0.1)


def test_fading_damping_takes_heat_from_no_bristles_up_to_4_g_over_v() -> None:
    # Heat per time over g u is y^2 + r (1 - y), y = sigma_0 zeta / g, r = sigma_1 u / g: least for
    # y = r / 2, where it is r (1 - r / 4).
    u = 0.02
    for r, passive in ((4.0 * (1.0 - 1e-9), True), (4.0 * (1.0 + 1e-9), False)):
        p = LUGRE.complete(Parameters(), {"v_d": 0.01})
        g = LUGRE.sliding_friction(p, u)
        sigma_1 = r * g / u * math.exp((u / 0.01) ** 2)
        p = LUGRE.complete(Parameters(), {"v_d": 0.01, "sigma_1": sigma_1})
        zeta = 0.5 * r * g / p.own["sigma_0"]
        (rate,) = LUGRE.rates(p, u, (zeta,))
        heat = LUGRE.slip_friction(p, u, (zeta,)) * u - p.own["sigma_0"] * zeta * rate
        assert (heat > 0.0) is passive


@pytest.mark.gate
def test_lugre_tends_to_stribeck_with_the_root_of_sigma_0() -> None:
    base, own = parted(CANUDAS)
    p = Parameters(**base)
    curve = {"v_s": own["v_s"]}
    limit = simulate(p, 20.0, law="stribeck", own=curve).cycles[-1].T
    off = []
    for sigma_0 in (1e8, 1e10):
        stiff = {**own, "sigma_0": sigma_0, "sigma_1": math.sqrt(sigma_0)}
        cycle = memory_cycle(p, "lugre", stiff)
        assert cycle is not None
        off.append(limit - cycle.T)
    # Some steeper than the root: take-off passes decades of speed between k v / sigma_0 and v_s.
    for stiff_off, stiffer_off in pairwise(off):
        assert 0.5 < math.log(stiff_off / stiffer_off, 100.0) < 0.57


@pytest.mark.parametrize(("evolution", "D_c"), [(1.0, 1e-5), (2.0, 1e-5), (2.0, 1e5)])
def test_a_velocity_step_shows_a_at_once_and_b_over_d_c(evolution: float, D_c: float) -> None:
    # A spring so stiff that the mass follows the pull.
    V_1, ratio, a, b = 1e-6, 10.0, 0.01, 0.015
    theta = 1e-5 / V_1
    mu = a * math.asinh(0.5 * math.exp((0.6 + b * math.log(1e-6 * theta / D_c)) / a))
    p = Parameters(k=1e9, v=V_1, z_start=mu * 9.81 / 1e9)
    own = {"evolution": evolution, "inertia": 2.0, "D_c": D_c, "theta_start": theta}
    steps = [Change(1.0, {"v": ratio * V_1})]
    ways = np.array([0.02, 0.5, 1.0, 2.0]) * 1e-5
    found = simulate(p, 4.0, law="rate_state", own=own, changes=steps, times=1.0 + ways / 1e-5)
    fall = np.exp(-ways / 1e-5)
    if evolution == 1.0:
        aged = np.log(1.0 / ratio + (1.0 - 1.0 / ratio) * fall)
    else:
        # Frozen where D_c is long.
        aged = np.log(ratio) * (fall - 1.0) * (D_c == 1e-5)
    direct = a * np.log(ratio)
    # The spring gives way by a N / (k D_c).
    assert found.own["mu"] - mu == pytest.approx(direct + b * aged, abs=2e-3 * direct)


def test_a_load_ages_the_contacts_as_linker_and_dieterich_say() -> None:
    p = Parameters(v=1e-6, z_start=0.0058)
    own = {"inertia": 2.0, "alpha": 0.3}
    changes = [Change(2.0, {"load": 0.981})]
    found = simulate(p, 3.0, law="rate_state", own=own, changes=changes, times=[2.0, 2.0 + 1e-9])
    before, after = found.own["theta"]
    assert after / before == pytest.approx((1.0 / 1.1) ** (0.3 / 0.015), rel=1e-8)


@pytest.mark.parametrize(
    ("speed", "v", "kind"), [(0.05, 0.06, "re-stick"), (0.01, 5e-3, "break-away")]
)
def test_a_change_of_the_pull_that_ends_a_phase_is_the_transition(
    speed: float, v: float, kind: str
) -> None:
    p, changes = Parameters(x_dot_start=speed), [Change(1e-4, {"v": v})]
    found = simulate(p, 2e-4, law="lugre", changes=changes)
    assert [(event.kind, event.time) for event in found.events] == [(kind, 1e-4)]
    assert found.n_slips[-1] == (kind == "re-stick")
    expected = truth.run({"x_dot_start": speed}, _steps(v), digits=20, law="lugre")
    assert [(event.kind, float(event.time)) for event in expected.events] == [(kind, 1e-4)]
    assert found.x_dot[-1] == pytest.approx(float(expected.samples[-1]["x_dot"]), rel=1e-9)


def _steps(v: float) -> list[truth.Step]:
    return [truth.Step(1e-4), truth.Step(1e-4, {"v": v})]


@pytest.mark.parametrize("inertia", [1.0, 2.0])
@pytest.mark.parametrize("evolution", [1.0, 2.0])
def test_sliding_turns_stable_at_the_critical_stiffness(inertia: float, evolution: float) -> None:
    m, v, c = 3.0, 1e-3, 7.0 * (inertia == 2.0)
    N, a, b, D_c = m * 9.81, 0.01, 0.015, 1e-5
    k_c = (b - a) * N / D_c * (1.0 + m * v**2 / (a * N * D_c))
    if inertia == 2.0:
        k_c = ((b - a) * N - c * v) / D_c
    for part, sign in ((1.0 - 1e-9, -1.0), (1.0 + 1e-9, 1.0)):
        p = Parameters(m=m, v=v, c=c, k=k_c * part)
        p = RATE_STATE.complete(p, {"inertia": inertia, "evolution": evolution})
        assert math.copysign(1.0, stability(p, RATE_STATE, v)) == sign


@pytest.mark.parametrize(
    ("name", "own"),
    [
        ("lugre", {"v_d": 0.01}),
        ("rate_state", {"evolution": 2.0}),
        ("rate_state", {"inertia": 2.0}),
        ("rate_state", {"inertia": 2.0, "evolution": 2.0}),
    ],
    ids=str,
)
def test_the_jacobian_is_the_derivative(name: str, own: dict[str, float]) -> None:
    law = friction_law(name)
    p = law.complete(Parameters(c=3.0), own)
    state = (2e-5,) if law is LUGRE else (-5.0,)
    q = law.coordinate(p, 2e-3, state)

    def motion(force: float, q: float, own_state: float) -> np.ndarray:
        state = (own_state,)
        u = law.velocity(p, q, state)
        x_ddot = force - law.slip_friction(p, u, state) - 3.0 * u
        return np.array([u, law.coordinate_rate(p, x_ddot, u, q, state), *law.rates(p, u, state)])

    found = law.jacobian(p, 2.9, q, state)
    for column, at in enumerate(np.diag([1e-3, 1e-6 * q, 1e-6 * abs(state[0])])):
        low, high = (np.array([2.9, q, state[0]]) + sign * at for sign in (-1, 1))
        slope = (motion(*high) - motion(*low)) / (2.0 * at[column])
        assert found is not None
        # Differences of 1e-6 leave half of the digits.
        assert found[:, column] == pytest.approx(slope, rel=1e-5, abs=1e-6 * np.max(np.abs(slope)))


def test_friction_that_does_not_fall_has_no_cycle_and_says_why() -> None:
    with pytest.raises(ValueError, match=r"a = 0\.02 is at least b = 0\.015"):
        memory_cycle(Parameters(), "rate_state", {"a": 0.02})
    found = critical_velocity(Parameters(), "rate_state", {"a": 0.02}, (1e-6, 1.0))
    assert (found.unstable, found.cycle, found.proven) == ((), (), True)
    assert "a = 0.02 is at least b = 0.015" in found.reason
    with pytest.raises(ValueError, match="regime needs a friction law with a stick"):
        regime(Parameters(), "lugre")


@pytest.mark.gate
def test_a_cycle_outlasts_the_velocity_at_which_sliding_turns_stable() -> None:
    base, own = parted(CANUDAS)
    found = critical_velocity(Parameters(**base), "lugre", own, (1e-3, 1.0))
    (unstable,), (cycle,) = found.unstable, found.cycle
    assert cycle.high == pytest.approx(0.1751, rel=0.01)
    # g'(v) + c = 0: 2 (F_s - F_c) v / v_s^2 exp(-(v/v_s)^2) = c, but for the bristles.
    assert unstable.high == pytest.approx(2.99e-3, rel=2e-3)
    assert (cycle.high_end, unstable.high_end) == ("fold", "eigenvalue")
    p = Parameters(**base)
    for v, exists in ((0.98 * cycle.high, True), (1.02 * cycle.high, False)):
        assert (memory_cycle(replace(p, v=v), "lugre", own) is not None) is exists
    assert found.motions(0.05) == ("sticks", "even")


def test_without_damping_bristles_slide_neutrally_and_stick_slip_has_no_end() -> None:
    # As under Coulomb's law. Above some v_s the damping is 0, and no rounding of it.
    found = critical_velocity(Parameters(), "lugre", {}, (2e-3, 1.0))
    (unstable,) = found.unstable
    assert 5e-3 < unstable.high < 0.03
    assert [(each.high, each.high_end) for each in found.cycle] == [(1.0, "none")]


def test_a_search_that_begins_beyond_unstable_sliding_finds_the_cycles() -> None:
    base, own = parted(CANUDAS)
    found = critical_velocity(Parameters(**base), "lugre", own, (0.17, 0.2))
    assert found.unstable == ()
    assert found.cycle[0].high == pytest.approx(0.1751, rel=0.01)


@pytest.mark.parametrize("values", [{"sigma_0": 0.0}, {"sigma_1": -1.0}, {"delta": 0.5}], ids=str)
def test_lugre_refuses_what_is_out_of_range_by_name(values: dict[str, float]) -> None:
    (name,) = values
    with pytest.raises(ValueError, match=name):
        simulate(Parameters(), 1.0, law="lugre", own=values)
    with pytest.raises(ValueError, match=name):
        truth.run(values, [truth.Step(1.0)], law="lugre")


@pytest.mark.parametrize("values", [{"a": 0.0}, {"D_c": 0.0}, {"V_0": -1.0}, {"inertia": 3.0}])
def test_rate_and_state_refuses_what_is_out_of_range_by_name(values: dict[str, float]) -> None:
    (name,) = values
    with pytest.raises(ValueError, match=name):
        simulate(Parameters(), 1.0, law="rate_state", own=values)
    with pytest.raises(ValueError, match=name):
        truth.run(values, [truth.Step(1.0)], law="rate_state")
