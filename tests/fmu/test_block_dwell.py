"""Static friction that grows in stick: the exact block against the law in high precision."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Iterator, Mapping
from typing import Any

import mpmath
import pytest

from fmukit.model import ModelError
from stickslip_fmu.block import Block
from stickslip_fmu.spec import TABLE

from .blocks import (
    draw_ageing,
    drive,
    log_uniform,
    make_block,
    outputs,
    uneven,
)

# Roundings of a handful of operations, in a well conditioned result.
ROUNDING = 1e-14
PRECISION = 40

N = 9.81
"""Normal force at the defaults [N]."""


@pytest.fixture(autouse=True)
def _high_precision() -> Iterator[None]:
    with mpmath.workdps(PRECISION):
        yield


def growth(values: Mapping[str, float], age: Any) -> Any:
    """Return what a stick of this age holds beyond the kinetic friction [N]."""
    p = {name: mpmath.mpf(value) for name, value in {**TABLE.start_values(), **values}.items()}
    normal = p["m"] * p["g"] + p["load"]
    share = -mpmath.expm1(-age / p["tau_s"]) if p["tau_s"] else mpmath.mpf(1)
    return normal * ((p["mu_s"] - p["mu_k"]) * share + p["B"] * mpmath.log1p(age / p["t_0"]))


def kinetic(values: Mapping[str, float]) -> Any:
    """Return the kinetic friction [N]."""
    p = {name: mpmath.mpf(value) for name, value in {**TABLE.start_values(), **values}.items()}
    return p["mu_k"] * (p["m"] * p["g"] + p["load"])


def last_root(function: Any, most: Any) -> Any:
    """Return the last zero of a concave function, from a point beyond it."""
    guess = mpmath.mpf(most)
    while True:
        following = guess - function(guess) / mpmath.diff(function, guess)
        if not following < guess * (1 - mpmath.mpf(10) ** (8 - PRECISION)):
            return guess
        guess = following


def steady_stick(values: Mapping[str, float]) -> tuple[float, float]:
    """Return the stick of the undamped cycle, k v t = 2 g(t), and how it magnifies a rounding."""
    pull = mpmath.mpf(values.get("k", 1000.0)) * mpmath.mpf(values.get("v", 0.02))
    most = 4 * growth(values, mpmath.mpf(1)) / pull + 10
    stick = last_root(lambda t: 2 * growth(values, t) - pull * t, most)
    slope = mpmath.diff(lambda t: 2 * growth(values, t), stick)
    return float(stick), float(pull / (pull - slope))


def to_slip(block: Block, count: int) -> dict[str, float]:
    """Drive the block until it has broken away after so many slips."""
    step = 0.3 / math.sqrt(block.wanted.k / block.wanted.m)
    while block.meter.n_slips < count or block.mode == 0:
        block.advance(0.0, step)
    return outputs(block)


CYCLES = (
    {"tau_s": 0.1},
    {"tau_s": 1e-4},
    {"B": 0.02, "t_0": 1e-3},
    {"tau_s": 0.05, "B": 0.01, "t_0": 0.2, "v": 0.005},
    {"tau_s": 0.3, "mu_s": 0.31, "v": 1e-4},
    {"mu_s": 0.3, "B": 0.05, "t_0": 0.01},
    {"tau_s": 2.0, "load": 7.0, "v": 1e-3},
    {"tau_s": 1e-320, "B": 0.02, "t_0": 1e-3},
)


@pytest.mark.parametrize("values", CYCLES)
def test_the_undamped_cycle_is_the_fixed_point(values: dict[str, float]) -> None:
    """A steady stick restores what two gaps of its age relieve: k v t = 2 g(t)."""
    stick, magnified = steady_stick(values)
    found = to_slip(make_block(**values), 200)
    v = values.get("v", 0.02)
    gap = float(growth(values, stick))
    w = math.sqrt(1000.0)
    slip = 2.0 / w * (math.pi - math.atan(w * gap / 1000.0 / v))
    assert found["t_stick"] == pytest.approx(stick, rel=1e-15 * (10.0 + magnified))
    assert found["spring_drop"] == pytest.approx(2.0 * gap / 1000.0, rel=ROUNDING * magnified)
    assert found["t_slip"] == pytest.approx(slip, rel=ROUNDING * magnified)
    assert found["T"] == pytest.approx(stick + slip, rel=ROUNDING * magnified)
    assert found["delta_x"] == pytest.approx(v * found["T"], rel=ROUNDING)


@pytest.mark.parametrize("values", [{"tau_s": 0.05}, {"mu_s": 0.3, "B": 0.01, "t_0": 0.02}])
@pytest.mark.parametrize("below", [True, False])
def test_the_cycle_sticks_below_its_critical_velocity(
    values: dict[str, float], below: bool
) -> None:
    """Without damping sticks last below v_c = 2 N ((mu_s - mu_k)/tau_s + B/t_0)/k, none above."""
    mu_s, tau_s = values.get("mu_s", 0.5), values.get("tau_s", math.inf)
    rate = (mu_s - 0.3) / tau_s + values.get("B", 0.0) / values.get("t_0", 1.0)
    critical = 2.0 * N * rate / 1000.0
    moving = {**values, "v": critical * (0.99 if below else 1.01)}
    found = to_slip(make_block(**moving), 3000)
    if below:
        stick, magnified = steady_stick(moving)
        assert found["t_stick"] == pytest.approx(stick, rel=1e-14 * magnified)
    else:
        assert found["t_stick"] < 1e-12 / math.sqrt(1000.0)


def test_fast_growth_is_coulomb_but_for_its_rest() -> None:
    """What the steady stick lacks of Coulomb's is exp(-t_stick/tau_s), as a part of it."""
    coulomb = 2.0 * 0.2 * N / 1000.0 / 0.02
    for ratio in (8.0, 12.0, 16.0):
        found = to_slip(make_block(tau_s=coulomb / ratio), 60)["t_stick"]
        rest = math.exp(-ratio)
        # The stick itself is shorter, by this factor to first order; its own rounding remains.
        assert (1.0 - found / coulomb) / rest == pytest.approx(
            1.0, abs=2.0 * ratio * rest + ROUNDING / rest
        )


def random_stick(generator: random.Random) -> dict[str, float]:
    """Draw a run that begins at rest and breaks away under growing static friction."""
    mu_k = generator.uniform(0.05, 0.5)
    values = {
        "mu_k": mu_k,
        "mu_s": mu_k + generator.choice([0.0, generator.uniform(0.0, 0.5)]),
        "v": log_uniform(generator, 1e-4, 1.0) * generator.choice([1.0, -1.0]),
        "tau_s": generator.choice([0.0, log_uniform(generator, 1e-4, 1e2)]),
        "B": log_uniform(generator, 1e-4, 0.1),
        "t_0": log_uniform(generator, 1e-4, 1e2),
        "age_start": generator.choice([0.0, log_uniform(generator, 1e-4, 1e4)]),
        "F_ext": generator.uniform(-1.0, 1.0),
    }
    values["z_start"] = generator.uniform(-0.99, 0.99) * mu_k * N / 1000.0
    return values


def lack(values: Mapping[str, float], tau: Any) -> Any:
    """Return what the force along the pull lacks of break-away in the first stick [N]."""
    v, age = mpmath.mpf(values["v"]), mpmath.mpf(values["age_start"])
    force = 1000 * (mpmath.mpf(values["z_start"]) + v * tau) + mpmath.mpf(values["F_ext"])
    return kinetic(values) + growth(values, age + tau) - mpmath.sign(v) * force


def test_the_mass_breaks_away_where_the_forces_meet() -> None:
    """The first stick ends where k z + F_ext meets F_s of its age, and t_stick is its time."""
    generator = random.Random(61)
    for _ in range(200):
        values = random_stick(generator)
        block = make_block(**values)
        if block.mode != 0:
            continue
        pull = 1000.0 * abs(values["v"])
        most = (30.0 + 2.0 * abs(lack(values, mpmath.mpf(1)))) * (1 + 1 / pull) + 1e3 / pull
        stick = last_root(lambda tau, values=values: lack(values, tau), most)
        slope = mpmath.diff(lambda tau, values=values: lack(values, tau), stick)
        # Forces of some N are rounded; the slope turns them into time.
        error = 1e-14 * float((1.0 + pull * stick) / abs(slope))
        duration = block.state.arc.duration
        assert duration == pytest.approx(float(stick), abs=error)
        block.advance(0.0, duration * (1.0 - 1e-9))
        assert block.mode == 0
        block.advance(0.0, duration * 2e-9 + error)
        assert (outputs(block)["mode"], block.meter.t_stick) == (
            math.copysign(1.0, values["v"]),
            duration,
        )


def test_the_slip_begins_with_the_gap_of_that_age() -> None:
    """A slip is that of Coulomb's law with the static friction at which it broke away."""
    generator = random.Random(62)
    for _ in range(100):
        values = random_stick(generator)
        block = make_block(**values)
        if block.mode != 0:
            continue
        duration = block.state.arc.duration
        # Where the pull hardly passes the growth, the gap is small and its time is not exact.
        gap = float(growth(values, mpmath.mpf(values["age_start"]) + mpmath.mpf(duration)))
        found = to_slip(block, 1)
        assert abs(found["spring_drop"]) == pytest.approx(2.0 * gap / 1000.0, rel=ROUNDING)


def test_f_s_is_that_of_now() -> None:
    """In stick F_s is that of the age, through changes of input too; in slip that of age 0."""
    values = {"tau_s": 0.2, "B": 0.02, "t_0": 0.05, "age_start": 0.1, "v": 0.005}
    block = make_block(**values)
    age = 0.1
    for n in range(40):
        assert block.mode == 0
        expected = float(kinetic(values) + growth(values, mpmath.mpf(age)))
        assert outputs(block)["F_s"] == pytest.approx(expected, rel=1e-15 * (n + 4))
        if n % 10 == 5:
            block.set("F_ext", 0.1 * n)
        if n % 10 == 7:
            block.set("v", -block.wanted.v)
        block.advance(0.0, 0.01)
        age += 0.01
    block.set("v", 0.5)
    found = to_slip(block, 0)
    assert found["F_s"] == float(0.3 * N)
    block.set("tau_s", 0.0)
    block.advance(0.0, 1e-6)
    assert outputs(block)["F_s"] == 0.5 * N


def test_changes_of_the_pull_leave_the_age() -> None:
    """Two pulls in one stick: break-away where the broken line of force meets the growth."""
    values = {"tau_s": 0.2, "B": 0.01, "t_0": 0.05, "v": 0.02}
    block = make_block(**values)
    block.advance(0.0, 0.1)
    block.set("v", 0.0)
    block.advance(0.0, 1.0)
    block.set("v", 0.01)
    start = mpmath.mpf(0.02) * mpmath.mpf(0.1)

    def lacking(tau: Any) -> Any:
        force = 1000 * (start + mpmath.mpf(0.01) * tau)
        return kinetic(values) + growth(values, mpmath.mpf(1.1) + tau) - force

    expected = 1.1 + float(last_root(lacking, 10.0))
    block.advance(0.0, 0.35)
    assert block.meter.t_stick == pytest.approx(expected, rel=ROUNDING)


def test_what_is_tuned_acts_on_the_whole_curve_at_the_present_age() -> None:
    """tau_s, B, t_0 and mu_s changed in a stick: F_s is at once that of their present values."""
    block = make_block(tau_s=0.3, v=0.005)
    age = 0.0
    for change in ({"tau_s": 0.6}, {"B": 0.02}, {"t_0": 0.01}, {"mu_s": 0.6}, {"tau_s": 0.0}):
        block.advance(0.0, 0.05)
        age += 0.05
        for name, value in change.items():
            block.set(name, value)
        block.advance(0.0, 1e-9)
        age += 1e-9
        now = {name: getattr(block.wanted, name) for name in ("tau_s", "B", "t_0", "mu_s")}
        expected = float(kinetic(now) + growth(now, mpmath.mpf(age)))
        assert outputs(block)["F_s"] == pytest.approx(expected, rel=ROUNDING)


def test_a_change_in_slip_acts_from_the_stop_on() -> None:
    """Growth is not in the equation of slip: the slip stays whole, the next stick is another."""
    one, other = make_block(tau_s=0.1), make_block(tau_s=0.1)
    for block in (one, other):
        to_slip(block, 1)
    for name, value in {"tau_s": 0.02, "B": 0.05, "t_0": 0.01}.items():
        other.set(name, value)
    here, there = to_slip(one, 2), to_slip(other, 2)
    assert here["t_slip"] == there["t_slip"]
    assert here["spring_drop"] == there["spring_drop"]
    assert here["t_stick"] < there["t_stick"]


def test_the_first_stick_is_as_old_as_the_run_says() -> None:
    """With age_start a start holds that would break away, and t_stick counts from the start."""
    z = 0.4 * N / 1000.0
    assert make_block(tau_s=0.1, z_start=z).mode == 1
    old = make_block(tau_s=0.1, z_start=z, age_start=1e3)
    assert old.mode == 0
    old.advance(0.0, 0.1)
    assert old.meter.t_stick == pytest.approx(0.1 * N / 1000.0 / 0.02, rel=ROUNDING)


def test_the_age_at_the_start_holds_until_the_first_step() -> None:
    """A start beyond F_s has not moved before the first step: a load set then meets its age."""
    values = {"tau_s": 0.1, "z_start": 0.6 * N / 1000.0, "age_start": 1e3, "v": 0.0}
    block = make_block(**values)
    assert block.mode == 1
    block.set("load", 3.0)
    block.advance(0.0, 0.1)
    assert outputs(block)["mode"] == 0
    assert block.F_s == pytest.approx(0.5 * (N + 3.0), rel=ROUNDING)


def test_a_start_at_the_break_away_force_holds_while_growth_is_faster() -> None:
    """At k z = F_s(0) the mass stays if F_s grows faster than k v t, and goes if not."""
    values = {"g": 10.0, "k": 1024.0, "mu_k": 0.25, "tau_s": 0.1, "z_start": 2.5 / 1024.0}
    for v, holds in ((0.01, True), (0.03, False)):
        block = make_block(**values, v=v)
        assert (block.state.arc.duration > 0.0) is holds
    # Beyond it by what the rest test forgives, it holds or goes in the same way.
    values["z_start"] *= 1.0 + 4.0 * 2.0**-52
    assert make_block(**values, v=0.03).state.arc.duration == 0.0
    slow = {**values, "v": 0.01}
    stick = last_root(lambda t: growth(slow, t) - 10.24 * t, 1.0)
    assert make_block(**slow).state.arc.duration == pytest.approx(float(stick), rel=ROUNDING)


def test_a_fresh_stop_beyond_what_it_holds_reverses() -> None:
    """A slip ends mirrored at mu_k N - g: beyond mu_k N on the other side the mass turns round."""
    for mu_k, turns in ((0.08, True), (0.2, False)):
        values = {"mu_k": mu_k, "tau_s": 0.1}
        block = make_block(**values)
        to_slip(block, 0)
        end = block.state.arc.duration
        gap = float(growth(values, mpmath.mpf(block.meter.t_stick)))
        assert (gap > 2.0 * mu_k * N) is turns
        block.advance(0.0, end)
        assert block.mode == (-1 if turns else 0)
        assert block.meter.n_slips == 1
        if turns:
            back = block.state.arc.duration
            block.advance(0.0, 1.0001 * back)
            relief = -2.0 * (gap - 2.0 * mu_k * N) / 1000.0
            assert block.meter.spring_drop == pytest.approx(relief, rel=1e-12)


def test_the_growth_begins_at_the_clamped_coefficient() -> None:
    """With mu_k above mu_s a fresh stick holds mu_k_used N, and an old one mu_s N."""
    found = outputs(make_block(mu_s=0.3, mu_k=0.5, tau_s=0.1))
    assert found["F_s"] == found["mu_k_used"] * N
    old = outputs(make_block(mu_s=0.3, mu_k=0.5, tau_s=0.1, age_start=10.0))
    assert old["F_s"] == pytest.approx(0.3 * N, rel=ROUNDING)


def test_growth_beyond_all_numbers_is_refused() -> None:
    """A static friction beyond the range of numbers is not handed out, nor set."""
    with pytest.raises(ModelError, match="range of double-precision"):
        make_block(B=1e307, age_start=1e300)
    block = make_block()
    block.set("B", 1.7e308)
    with pytest.raises(ModelError, match="range of double-precision"):
        block.advance(0.0, 0.1)


def test_a_pull_at_rest_never_breaks_away() -> None:
    """With v = 0 the stick only ages."""
    block = make_block(tau_s=1.0, B=0.1, v=0.0, z_start=0.002)
    block.advance(0.0, 1e9)
    found = outputs(block)
    assert (found["mode"], found["n_slips"]) == (0, 0)
    assert found["F_s"] == pytest.approx(N * (0.5 + 0.1 * math.log1p(1e9)), rel=ROUNDING)


@pytest.mark.parametrize(
    "values",
    [{"t_0": 1e-3, "age_start": 1e9}, {"tau_s": 0.1, "mu_k": 0.5}, {"tau_s": 0.1, "load": -9.81}],
)
def test_without_growth_nothing_is_other_than_coulomb(values: dict[str, float]) -> None:
    """Without tau_s and B, without a gap, without a normal force: Coulomb's outputs to the bit."""
    plain = {name: value for name, value in values.items() if name in ("mu_k", "load")}
    one, other = make_block(**values), make_block(**plain)
    for _ in range(300):
        one.advance(0.0, 0.007)
        other.advance(0.0, 0.007)
        assert outputs(one) == outputs(other)


def test_an_arc_is_one_however_a_stick_is_cut() -> None:
    """Without changes, durations and what follows from them have equal bits in any steps."""
    generator = random.Random(63)
    names = ("t_stick", "t_slip", "T", "delta_x", "spring_drop", "x_dot_peak", "n_slips")
    for _ in range(150):
        values, segments = draw_ageing(generator)
        for segment in segments:
            segment.changes.clear()
        once, often = drive(values, segments), drive(values, segments, uneven(generator))
        for one, many in zip(once, often, strict=True):
            assert [one[name] for name in names] == [many[name] for name in names]
            assert one["F_s"] == pytest.approx(many["F_s"], rel=1e-12)


def test_a_state_keeps_the_age() -> None:
    """A state taken in an ageing stick and restored elsewhere goes on with the same bits."""
    generator = random.Random(64)
    for _ in range(50):
        values = random_stick(generator)
        block = make_block(**values)
        block.advance(0.0, 0.3 * min(block.state.arc.duration, 1.0))
        block.set("F_ext", 0.0)
        block.advance(0.0, 1e-6)
        other = make_block()
        other.restore(json.loads(json.dumps(block.save())))
        for _ in range(20):
            for each in (block, other):
                each.advance(0.0, 0.05)
            assert outputs(block) == outputs(other)


@pytest.mark.parametrize("tau_s", [5e-324, 1e-310, 1e-200, 1e200, 1.7e308])
@pytest.mark.parametrize("t_0", [2.3e-308, 1e-200, 1e200, 1.7e308])
@pytest.mark.parametrize("age_start", [0.0, 5e-324, 1e-200, 1e200, 1.7e308])
@pytest.mark.parametrize("v", [5e-324, 1e-300, 0.02, 1e10])
def test_no_value_is_too_small_or_too_large(
    tau_s: float, t_0: float, age_start: float, v: float
) -> None:
    """At the ends of the range of numbers every output is a finite number."""
    block = make_block(tau_s=tau_s, B=0.01, t_0=t_0, age_start=age_start, v=v)
    for step in (1e-300, 1e-3, 0.1, 0.1, 0.1):
        block.advance(0.0, step)
        assert all(math.isfinite(value) for value in outputs(block).values())
