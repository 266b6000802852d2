"""Facts of the model that the truth must state, from ties to the far ends of its range.

Tolerances of 1e-40 leave ten of the fifty digits asked for to the conditioning of a run of some
dozen arcs; where no arithmetic comes between, equality is asked for.
"""

import random
from collections.abc import Mapping
from typing import Any

import mpmath
import pytest

from stickslip_verification import truth
from stickslip_verification.truth import Step, run, steady_cycle
from stickslip_verification.truth.parameters import high_precision

MP = high_precision(50)
CLOSE = 1e-40

# In these every force and time of interest is a binary fraction: m g = 8 N, w = 32 rad/s.
BINARY = {"m": 1.0, "g": 8.0, "k": 1024.0, "mu_s": 0.5, "mu_k": 0.25, "v": 0.5}


def close(got: Any, expected: Any, tolerance: float = CLOSE) -> bool:
    """Return whether two numbers agree to `tolerance`, relative to the expected one."""
    return bool(abs(got - expected) <= tolerance * abs(expected))


def stored(values: Mapping[str, float], sample: Mapping[str, Any]) -> Any:
    """Return spring and kinetic energy of a sample [J]."""
    k, m = MP.mpf(values["k"]), MP.mpf(values.get("m", 1.0))
    return (k * sample["z"] ** 2 + m * sample["x_dot"] ** 2) / 2


def random_steps(rng: random.Random, w: float, F_s: float, v: float) -> list[Step]:
    """Return a dozen steps, most with a change of an input or a tunable parameter."""
    steps = []
    for _ in range(12):
        changes: dict[str, float] = rng.choice(
            [
                {},
                {"v": v * rng.uniform(-2, 2)},
                {"F_ext": F_s * rng.uniform(-2, 2), "load": rng.uniform(-5, 5)},
                {"k": 1000.0 * rng.uniform(0.5, 2)},
                {"c": rng.choice([0.0, 3.0, 200.0]), "mu_k": rng.uniform(0, 0.5)},
            ]
        )
        steps.append(Step(rng.uniform(0.2, 4) / w, changes))
    return steps


def test_default_cycle_is_the_one_of_the_closed_forms() -> None:
    """At the defaults the spring falls by 3.924 mm and the mass jumps 6.305 mm."""
    cycle = steady_cycle({})
    assert cycle is not None
    m, g, k, v = (MP.mpf(truth.START_VALUES[name]) for name in ("m", "g", "k", "v"))
    w, Delta = MP.sqrt(k / m), (MP.mpf(0.5) - MP.mpf(0.3)) * m * g / k
    lambda_ = w * Delta / v
    t_slip = 2 / w * (MP.pi - MP.atan(lambda_))
    assert close(cycle["spring_drop"], 2 * Delta)
    assert close(cycle["t_slip"], t_slip)
    assert close(cycle["t_stick"], 2 * Delta / v)
    assert close(cycle["delta_x"], 2 * Delta + v * t_slip)
    assert close(cycle["delta_x"], v * cycle["T"])
    assert close(cycle["x_dot_peak"], v * (1 + MP.sqrt(1 + lambda_**2)))
    assert float(cycle["spring_drop"]) == pytest.approx(3.924e-3, abs=5e-7)
    assert float(cycle["delta_x"]) == pytest.approx(6.305e-3, abs=5e-7)


@pytest.mark.parametrize("c", [0.0, 2.0, 30.0])
@pytest.mark.parametrize("v", [0.0007, -0.005])
def test_run_settles_in_the_steady_cycle_at_its_second_break_away(c: float, v: float) -> None:
    """From the second break-away on the meter of a run reads the steady cycle."""
    p = {"c": c, "v": v, "load": 1.7, "F_ext": 0.3}
    cycle = steady_cycle(p)
    assert cycle is not None
    result = run(p, [Step(4.0 * float(cycle["T"]) + 0.5 * 5.8 / abs(v) * 2e-3)])
    sample = result.samples[-1]
    assert sample["n_slips"] >= 3
    for name in ("spring_drop", "delta_x", "t_slip", "t_stick", "T", "f", "x_dot_peak"):
        assert close(sample[name], cycle[name]), name


@pytest.mark.parametrize("v", [1e-6, 0.02, 10.0, 1e4])
def test_slip_relieves_the_spring_by_twice_the_gap_at_any_speed(v: float) -> None:
    """An undamped slip takes 2 Delta from the spring, with lambda from 6e4 down to 6e-6."""
    cycle = steady_cycle({"v": v})
    assert cycle is not None
    assert close(cycle["spring_drop"], 2 * cycle["Delta"])
    assert close(
        run({"v": v}, [Step(10.0 + 0.01 / v)]).samples[-1]["spring_drop"], 2 * cycle["Delta"]
    )


def test_slip_time_tends_to_half_and_whole_period() -> None:
    """t_slip is pi/w (1 + 2/(pi lambda)) for slow pull and 2 pi/w for fast pull."""
    w = MP.sqrt(MP.mpf(1000))
    slow, fast = steady_cycle({"v": 1e-9}), steady_cycle({"v": 1e9})
    assert slow is not None
    assert fast is not None
    # The next term of the expansion of the arc tangent is of third order in 1/lambda = 1.6e-8.
    assert close(slow["t_slip"] * w / MP.pi - 1, 2 / (MP.pi * slow["lambda_"]), 1e-14)
    assert close(fast["t_slip"], 2 * MP.pi / w, float(fast["lambda_"]))


@pytest.mark.parametrize("zeta", [1e-4, 0.01, 0.1, 0.5, 0.9, 0.99])
@pytest.mark.parametrize("d", [1e-12, -1e-12])
def test_damped_cycle_exists_exactly_above_lambda_c(zeta: float, d: float) -> None:
    """1e-12 above lambda_c the slip ends, as near its minimum as it should; below it does not."""
    m, k = 1.0, 1024.0
    p = {"m": m, "k": k, "c": 64.0 * zeta}
    critical = truth.critical_lambda(zeta)
    gap = (MP.mpf(0.5) - MP.mpf(0.3)) * MP.mpf(9.81)
    p["v"] = float(32 * gap / 1024 / (critical * (1 + MP.mpf(d))))
    cycle = steady_cycle(p)
    assert (cycle is not None) == (d > 0)
    slips = run(p, [Step(4.905 / (1024.0 * p["v"]) + 100.0)]).samples[-1]["n_slips"]
    assert (slips > 0) == (d > 0)
    if cycle is None:
        return
    nu = MP.sqrt(1 - MP.mpf(zeta) ** 2)
    L = cycle["lambda_"]
    share = L**2 / (1 - 2 * zeta * L + L**2)
    t_min = (2 * MP.pi - MP.atan2(nu * L, 1 - zeta * L)) / (32 * nu)
    expected = MP.sqrt(2 * share * (L / critical - 1)) / 32
    # docs/theory.md (17) is the first order in sqrt(d) = 1e-6, with a factor of order one.
    assert close(t_min - cycle["t_slip"], expected, 1e-5)


def test_critical_lambda_stands_where_the_design_says() -> None:
    """lambda_c is 1667 at zeta 0.9 and 1e10 at 0.99; the first order is 3 % and 31 % off."""
    assert float(truth.critical_lambda(0.9)) == pytest.approx(1667, abs=0.5)
    assert float(truth.critical_lambda(0.99)) == pytest.approx(1.015e10, rel=1e-3)
    for zeta, high in ((0.01, 0.03), (0.1, 0.31)):
        ratio = truth.critical_lambda(zeta) / MP.sqrt(4 * MP.pi * zeta)
        assert float(ratio - 1) == pytest.approx(high, abs=0.005)
    assert truth.critical_lambda(0.0) == 0
    assert truth.critical_lambda(1.0) == MP.inf
    assert float(MP.log(truth.critical_lambda(1.0 - 2.0**-53))) > 1e8


@pytest.mark.parametrize("zeta", [1.0, 1.0 + 2.0**-52, 3.0, 1e3])
def test_no_slip_from_rest_ends_at_or_beyond_critical_damping(zeta: float) -> None:
    """With zeta >= 1 the mass ends in steady sliding at the speed of the pull."""
    p = {**BINARY, "c": 64.0 * zeta, "v": 2.0**-10}
    assert steady_cycle(p) is None
    sample = run(p, [Step(4.0 + 200.0 * zeta)]).samples[-1]
    assert sample["n_slips"] == 0
    assert sample["mode"] == 1
    assert close(sample["x_dot"], MP.mpf(2) ** -10, 1e-30)


@pytest.mark.parametrize("zeta", [1.0 - 2.0**-53, 1.0, 1.0 + 2.0**-52, 1.1, 1e3])
def test_motion_is_continuous_across_critical_damping(zeta: float) -> None:
    """A pull reversed in mid-slip stops the mass whatever the damping; energies close."""
    p = {**BINARY, "c": 64.0 * zeta}
    slipping = 2.0**-7 + 0.01
    result = run(p, [Step(slipping), Step(300.0 * (zeta + 1), {"v": -(2.0**-9)})])
    first = result.samples[0]
    assert first["mode"] == 1
    assert [e.kind for e in result.events[:2]] == ["break-away", "re-stick"]
    if abs(zeta - 1) < 1e-9:
        same = run({**BINARY, "c": 64.0}, [Step(slipping)]).samples[-1]
        # The motion is analytic in zeta, with derivatives of order one.
        assert close(first["x"], same["x"], 4 * abs(zeta - 1) + 1e-40)
    last = result.samples[-1]
    balance = last["W_pull"] - last["Q_friction"] - stored(p, last)
    assert abs(balance) <= CLOSE * last["Q_friction"]


@pytest.mark.parametrize("seed", range(12))
def test_energy_balance_closes_with_everything_changing(seed: int) -> None:
    """W_pull + W_k + work of F_ext - Q_friction is the change of stored energy."""
    rng = random.Random(seed)
    steps = random_steps(rng, 31.6, 4.905, 0.05)
    start = {"z_start": rng.uniform(-0.01, 0.01), "x_dot_start": rng.choice([0.0, 0.2])}
    values: dict[str, float] = {**truth.START_VALUES, **start}
    result = run(values, steps)
    before = result.initial
    stored_at_start = stored(values, before)
    F_ext_work = MP.zero
    for step, sample in zip(steps, result.samples, strict=True):
        values.update(step.changes)
        F_ext_work += MP.mpf(values["F_ext"]) * (sample["x"] - before["x"])
        put_in = sample["W_pull"] + sample["W_k"] + F_ext_work
        now = stored(values, sample)
        scale = max(abs(sample["W_pull"]), sample["Q_friction"], now, stored_at_start)
        assert abs(put_in - sample["Q_friction"] - (now - stored_at_start)) <= CLOSE * scale
        assert sample["Q_friction"] >= before["Q_friction"]
        before = sample


@pytest.mark.parametrize("seed", range(6))
def test_steps_split_unevenly_change_nothing(seed: int) -> None:
    """Steps cut into pieces down to 1e-13 s give the same state, meter and energies."""
    rng = random.Random(seed)
    steps = random_steps(rng, 31.6, 4.905, 0.05)
    whole = run({}, steps)
    split: list[Step] = []
    for step in steps:
        # The pieces must add up exactly: subtractions of a quarter and 2^-43 s lose no bit here.
        h = round(step.h * 2**40) / 2**40
        pieces = [2.0**-43, h / 4, h / 2, h / 4 - 2.0**-43]
        split += [Step(pieces[0], step.changes), *map(Step, pieces[1:])]
    rounded = [Step(round(s.h * 2**40) / 2**40, s.changes) for s in steps]
    whole = run({}, rounded)
    parts = run({}, split)
    assert [e.kind for e in whole.events] == [e.kind for e in parts.events]
    for name, value in whole.samples[-1].items():
        scale = max(abs(s[name]) for s in whole.samples)
        assert abs(parts.samples[-1][name] - value) <= CLOSE * scale, name


@pytest.mark.parametrize("seed", range(4))
def test_mirror_and_scaling_leave_the_motion(seed: int) -> None:
    """The mirror negates it; forces times 4 leave it; stiffness times 4 halves its times."""
    rng = random.Random(seed)
    p = {"z_start": 0.003, "x_dot_start": -0.1, "c": 1.5}
    steps = random_steps(rng, 31.6, 4.905, 0.05)
    base = run(p, steps).samples[-1]

    def changed(factors: Mapping[str, float], h: float = 1.0) -> Mapping[str, Any]:
        def scaled(values: Mapping[str, float]) -> dict[str, float]:
            return {name: factors.get(name, 1.0) * value for name, value in values.items()}

        moved = [Step(h * s.h, scaled(s.changes)) for s in steps]
        return run(scaled({**truth.START_VALUES, **p}), moved).samples[-1]

    mirrored = changed(dict.fromkeys(("v", "F_ext", "x_start", "x_dot_start", "z_start"), -1.0))
    assert mirrored["mode"] == -base["mode"]
    for name in ("x", "x_dot", "z", "F", "F_friction", "delta_x", "spring_drop", "x_dot_peak"):
        assert mirrored[name] == -base[name], name
    for name in ("t_slip", "t_stick", "T", "n_slips", "W_pull", "W_k", "Q_friction"):
        assert mirrored[name] == base[name], name

    heavier = changed(dict.fromkeys(("m", "k", "c", "load", "F_ext"), 4.0))
    for name in ("x", "x_dot", "z", "delta_x", "t_slip", "T", "t_event"):
        assert abs(heavier[name] - base[name]) <= CLOSE * abs(base[name]), name
    for name in ("F", "F_friction", "W_pull", "W_k", "Q_friction"):
        assert abs(heavier[name] - 4 * base[name]) <= CLOSE * abs(4 * base[name]), name

    faster = changed(
        {"k": 4.0, "g": 4.0, "load": 4.0, "F_ext": 4.0, "v": 2.0, "c": 2.0, "x_dot_start": 2.0}, 0.5
    )
    for name in ("x", "z", "delta_x", "spring_drop"):
        assert abs(faster[name] - base[name]) <= CLOSE * abs(base[name]), name
    for name in ("t_slip", "T", "t_event"):
        assert abs(2 * faster[name] - base[name]) <= CLOSE * abs(base[name]), name


def test_at_exactly_the_break_away_time_the_mass_still_sticks() -> None:
    """mu_s N/(k v) = 1/128 s: a step of that length ends in stick with |k z| = F_s."""
    result = run(BINARY, [Step(2.0**-7), Step(2.0**-60)])
    at, after = result.samples
    assert at["sticking"]
    assert at["F"] == at["F_s"] == 4
    assert at["t_stick"] == 0
    assert after["mode"] == 1
    assert after["t_stick"] == result.events[0].time == MP.mpf(2) ** -7


def test_equality_sticks_when_an_input_brings_the_force_to_break_away() -> None:
    """A force of exactly F_s, or above it by 4 roundings, sticks; by 64 roundings it slips."""
    resting = {**BINARY, "v": 0.0}
    for excess, mode in ((0.0, 0), (2.0**-50, 0), (2.0**-44, 1)):
        result = run(resting, [Step(1e-3), Step(1e-3, {"F_ext": 4.0 * (1.0 + excess)})])
        assert result.samples[-1]["mode"] == mode
        assert result.samples[0]["mode"] == 0


def test_no_gap_gives_whole_periods_with_sticks_of_no_length() -> None:
    """mu_k = mu_s without damping: t_slip = T = 2 pi/w, t_stick = 0 exactly, time goes on."""
    result = run({**BINARY, "mu_k": 0.5}, [Step(10.0)])
    sample = result.samples[-1]
    period = 2 * MP.pi / 32
    assert sample["t_stick"] == 0
    assert sample["spring_drop"] == 0
    assert close(sample["t_slip"], period)
    assert close(sample["T"], period)
    assert close(sample["x_dot_peak"], MP.one)
    assert sample["n_slips"] == int((MP.mpf(10) - MP.mpf(2) ** -7) / period)


def test_no_gap_with_damping_slips_for_ever() -> None:
    """mu_k = mu_s with damping: the first slip never ends and the meter stays as it is."""
    p = {**BINARY, "mu_k": 0.5, "c": 0.1}
    assert steady_cycle(p) is None
    sample = run(p, [Step(1000.0)]).samples[-1]
    assert sample["mode"] == 1
    assert sample["n_slips"] == sample["t_slip"] == sample["T"] == 0
    assert close(sample["x_dot"], MP.mpf(0.5), 1e-10)


@pytest.mark.parametrize("frictionless", [{"mu_s": 0.0, "mu_k": 0.0}, {"load": -8.0}])
def test_without_friction_the_pull_carries_the_mass_along(
    frictionless: Mapping[str, float],
) -> None:
    """mu_s = 0 or N = 0: break-away at once in the direction of v, whole periods, no heat."""
    result = run({**BINARY, **frictionless, "v": -0.5}, [Step(1.0)])
    assert result.initial["sticking"]
    sample = result.samples[-1]
    assert sample["mode"] == -1
    assert sample["F_s"] == sample["Q_friction"] == sample["t_stick"] == 0
    assert close(sample["t_slip"], 2 * MP.pi / 32)
    still = run({**BINARY, **frictionless, "v": 0.0}, [Step(1.0)]).samples[-1]
    assert still["sticking"]
    assert still["x"] == 0


def test_load_that_cancels_the_weight_to_a_rounding_means_no_normal_force() -> None:
    """A load of -(m g), the double nearest to it, leaves F_s = 0 exactly."""
    m = 3.7
    assert run({"m": m, "load": -(m * 9.81)}, [Step(0.1)]).samples[-1]["F_s"] == 0


def test_grazing_stop_is_decided_by_equality() -> None:
    """x_dot_start = 2 v at the kinetic balance touches zero once, after half a period."""
    # k z = mu_k m g = 2 N: no acceleration at the start, so x_dot = v (1 + cos w t).
    grazing = {**BINARY, "z_start": 2.0 / 1024.0, "x_dot_start": 1.0}
    result = run(grazing, [Step(1.0)])
    assert result.events[0].kind == "re-stick"
    assert close(result.events[0].time, MP.pi / 32)
    assert result.margin == 0
    above = run({**grazing, "x_dot_start": 1.0 - 2.0**-52}, [Step(100.0)])
    assert not above.events
    assert above.samples[-1]["n_slips"] == 0
    # p_min / (v + swing) = 2^-52 / (1 - 2^-52)
    assert close(above.margin, MP.mpf(2) ** -52, 1e-15)


def test_change_that_does_not_touch_the_slip_keeps_its_grazing_stop() -> None:
    """A change of mu_s in mid-slip leaves an exact graze exact; the margin calls it a near miss."""
    p = {**BINARY, "mu_k": 0.5}
    plain = run(p, [Step(0.3)])
    meddled = run(p, [Step(0.1), Step(0.2, {"mu_s": 0.625})])
    assert plain.events[1] == meddled.events[1]
    assert plain.margin > 0.1
    assert meddled.margin == 0


def test_margin_measures_how_near_an_input_came_to_break_away() -> None:
    """A force that stays 1e-10 below F_s leaves half of that as margin: the scale is 2 F_s."""
    held = run({**BINARY, "v": 0.0}, [Step(0.1, {"F_ext": 4.0 - 4e-10})])
    assert held.samples[0]["sticking"]
    assert close(held.margin, MP.mpf(0.5e-10), 1e-5)


def test_pull_that_stops_in_mid_slip_lets_the_mass_come_to_rest() -> None:
    """With v = 0 from mid-slip on, the slip ends and nothing moves thereafter."""
    p = {**BINARY, "c": 4.0, "v": 2.0**-5}
    result = run(p, [Step(2.0**-3 + 0.02), Step(0.5, {"v": 0.0}), Step(100.0)])
    assert result.samples[0]["mode"] == 1
    assert result.samples[1]["sticking"]
    assert result.samples[2]["x"] == result.samples[1]["x"]
    assert result.samples[2]["W_pull"] == result.samples[1]["W_pull"]
    assert result.samples[2]["n_slips"] == 1


def test_free_decay_reverses_without_sticking_until_the_spring_is_too_weak() -> None:
    """A mass let go at 20 F_s swings with amplitudes that fall by 2 F_k/k, then sticks."""
    result = run({**BINARY, "v": 0.0, "z_start": 80.0 / 1024.0}, [Step(10.0)])
    # Turning points of k z: 80, -76, 72, ... lose 2 mu_k m g = 4 N each, stop at |k z| <= 4.
    turning = [round(float(1024 * event.z), 9) for event in result.events]
    assert turning == [(-1) ** n * (80 - 4 * n) for n in range(20)]
    kinds = [event.kind for event in result.events]
    assert kinds == ["break-away", *["reversal"] * 18, "re-stick"]
    sample = result.samples[-1]
    assert sample["n_slips"] == 19
    assert sample["T"] == sample["t_stick"] == 0
    assert close(sample["t_slip"], MP.pi / 32)


def test_start_beyond_break_away_breaks_away_after_a_stick_of_no_length() -> None:
    """At the start the mode shows the slip; the first step records it unless it takes it back."""
    beyond = {**BINARY, "z_start": 5.0 / 1024.0}
    result = run(beyond, [Step(1e-3)], start_time=3.0)
    assert result.initial["mode"] == 1
    assert result.initial["F_friction"] == -2
    assert (result.events[0].kind, result.events[0].time) == ("break-away", 3)
    assert result.samples[0]["t_stick"] == result.samples[0]["T"] == 0
    taken_back = run(beyond, [Step(1e-3, {"mu_s": 0.75})])
    assert not taken_back.events
    assert taken_back.samples[0]["sticking"]


def test_start_in_motion_counts_a_slip_and_no_break_away() -> None:
    """x_dot_start < 0 is a slip backward from the start; T needs two break-aways after it."""
    p = {**BINARY, "x_dot_start": -0.1, "v": 2.0**-5}
    result = run(p, [Step(0.5)])
    assert result.initial["mode"] == -1
    assert [e.kind for e in result.events][:2] == ["re-stick", "break-away"]
    sample = run(p, [Step(float(result.events[1].time) + 1e-6)]).samples[0]
    assert sample["n_slips"] == 1
    assert sample["x_dot_peak"] == MP.mpf(-0.1)
    assert sample["delta_x"] < 0
    assert close(sample["t_stick"], result.events[1].time - result.events[0].time)
    assert sample["T"] == 0


def test_changes_end_neither_stick_nor_slip() -> None:
    """A load that changes in stick and in slip leaves t_stick and t_slip whole."""
    steps = [Step(0.004), Step(2.0**-6, {"load": 1.0}), Step(0.01, {"load": 0.5}), Step(1.0)]
    result = run(BINARY, steps)
    break_away, re_stick = result.events[:2]
    assert 0.004 < break_away.time < 0.004 + 2.0**-6 < re_stick.time
    after = run(
        BINARY, [*steps[:3], Step(float(re_stick.time) - float(sum(s.h for s in steps[:3])) + 1e-9)]
    )
    sample = after.samples[-1]
    assert sample["n_slips"] == 1
    assert close(sample["t_stick"], break_away.time)
    assert close(sample["t_slip"], re_stick.time - break_away.time)


def test_setting_a_value_that_is_there_changes_nothing() -> None:
    """The run with every input repeated at every step is the run without, digit for digit."""
    same = {name: truth.START_VALUES[name] for name in ("v", "load", "F_ext", "k", "c", "mu_s")}
    plain = run({}, [Step(0.1)] * 12)
    repeated = run({}, [Step(0.1, same)] * 12)
    assert plain == repeated


def test_stiffness_changed_in_stick_keeps_z_and_books_its_work() -> None:
    """Raising k by dk puts dk z^2/2 into the spring and can break the mass away."""
    result = run(BINARY, [Step(2.0**-8), Step(2.0**-12, {"k": 4096.0})])
    break_away = result.events[0]
    assert break_away.z == MP.mpf(2) ** -9
    assert break_away.time == MP.mpf(2) ** -8
    assert result.samples[-1]["W_k"] == 3072 * MP.mpf(2) ** -19


def test_mu_k_above_mu_s_is_clamped_in_doubles() -> None:
    """mu_k_used is the double max(mu_s - 0.01, 0) and follows a change of mu_s."""
    result = run({"mu_k": 0.7}, [Step(0.1), Step(0.1, {"mu_s": 0.005}), Step(0.1, {"mu_s": 0.9})])
    used = [result.initial, *result.samples]
    assert [sample["mu_k_used"] for sample in used] == [0.5 - 0.01, 0.5 - 0.01, 0.0, 0.7]


def test_ten_thousand_arcs_keep_their_digits() -> None:
    """After 1600 s of the default case, 5,000 cycles on, T is still that of the closed form."""
    cycle = steady_cycle({})
    assert cycle is not None
    result = run({}, [Step(1600.0)])
    assert result.samples[-1]["n_slips"] > 5000
    assert close(result.samples[-1]["T"], cycle["T"])


def test_precision_is_the_runs_own() -> None:
    """The global precision of mpmath is left alone, and more digits confirm the fewer."""
    before = mpmath.mp.prec
    p = {"c": 11.0, "v": 0.001}
    few = run(p, [Step(9.0)], digits=30).samples[-1]
    many = run(p, [Step(9.0)], digits=80).samples[-1]
    assert mpmath.mp.prec == before
    for name in ("x", "z", "t_slip", "T", "Q_friction"):
        assert close(few[name], many[name], 1e-29), name


@pytest.mark.parametrize(
    ("parameters", "steps", "word"),
    [
        ({"k": -1.0}, [], "k = -1.0 is outside k > 0"),
        ({"mu_k": -0.1}, [], "mu_k = -0.1 is outside mu_k >= 0"),
        ({"v": float("nan")}, [], "v = nan"),
        ({"load": -10.0}, [], "load = -10.0 is outside load >= -m g = -9.81"),
        ({"mass": 1.0}, [], "mass"),
        ({}, [Step(0.0)], "h = 0.0 is outside h > 0"),
        ({}, [Step(0.1, {"m": 2.0})], "m cannot change"),
        ({}, [Step(0.1, {"c": -1.0})], "c = -1.0 is outside c >= 0"),
    ],
)
def test_bad_input_is_named_with_its_range(
    parameters: Mapping[str, float], steps: list[Step], word: str
) -> None:
    """What is out of range is refused with name, value and range."""
    with pytest.raises(ValueError, match=word):
        run(parameters, steps)
