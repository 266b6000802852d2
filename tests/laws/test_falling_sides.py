"""The falling friction law in reference and truth, against its closed form and each other.

With F_k = (mu_k - slope |x_dot|) N the slip is Coulomb's with the damping c' = c - slope N, which
may be negative: m x_ddot = k z + F_ext - s mu_k N - c' x_dot.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from fmukit.model import ModelError
from stickslip_fmu.laws.named import friction_law as block_law
from stickslip_fmu.spec import spec_of
from stickslip_ref import Change, Parameters, simulate
from stickslip_verification import truth
from stickslip_verification.truth import Step
from stickslip_verification.truth.parameters import high_precision
from tests.fmu.blocks import block_of, outputs

NAME = "tests.laws.falling:FALLING"
MP = high_precision(50)

Real = Any

# Binary fractions, so that slope N is exact in doubles: N = 8 N.
BINARY = {"m": 1.0, "g": 8.0, "k": 1024.0, "mu_s": 0.5, "mu_k": 0.25, "v": 2.0**-6}


class _ClosedForm:
    """The slip from rest at break-away: u = V + rho, rho'' + 2 a rho' + w^2 rho = 0.

    rho(0) = -V, rho'(0) = gap/m, 2 a = (c - slope N)/m. With the roots r of r^2 + 2 a r + w^2,
    rho = A exp(r_1 t) + B exp(r_2 t), complex or real, damped or growing.
    """

    def __init__(self, values: Mapping[str, float]) -> None:
        p = {name: MP.mpf(value) for name, value in values.items()}
        self.N = p["m"] * p["g"]
        self.slope, self.F_k, self.c = p["slope"], p["mu_k"] * self.N, p["c"]
        a = (p["c"] - p["slope"] * self.N) / (2 * p["m"])
        root = MP.sqrt(MP.mpc(a * a - p["k"] / p["m"]))
        self.r1, self.r2 = -a + root, -a - root
        self.V, gap = p["v"], (p["mu_s"] - p["mu_k"]) * self.N / p["m"]
        self.A = (gap + self.r2 * self.V) / (self.r1 - self.r2)
        self.B = -self.V - self.A

    def speed(self, t: Real) -> Real:
        """Return the speed [m/s] at the time t [s] after the break-away."""
        return self.V + MP.re(self.A * MP.exp(self.r1 * t) + self.B * MP.exp(self.r2 * t))

    def way(self, t: Real) -> Real:
        """Return the way [m]."""
        first = self.A * MP.expm1(self.r1 * t) / self.r1
        second = self.B * MP.expm1(self.r2 * t) / self.r2
        return self.V * t + MP.re(first + second)

    def heat(self, t: Real) -> Real:
        """Return the heat [J], by quadrature of ((mu_k - slope u) N + c u) u."""

        def power(time: Real) -> Real:
            u = self.speed(time)
            return (self.F_k + (self.c - self.slope * self.N) * u) * u

        return MP.quad(power, MP.linspace(0, t, 9))


@pytest.mark.parametrize(
    "own",
    [
        {"c": 0.0, "slope": 0.0},
        {"c": 0.5, "slope": 2.0**-5},
        {"c": 0.0, "slope": 2.0**-4},
        {"c": 8.0, "slope": 0.25},
        {"c": 0.0, "slope": 0.5, "v": 2.0**-8},
        # Growing without a swing: c - slope N = -96 N.s/m, beyond 2 sqrt(k m) = 64.
        {"c": 0.0, "slope": 12.0, "v": 2.0**-12, "mu_s": 0.2501},
    ],
)
def test_truth_is_the_closed_form_of_a_slip(own: Mapping[str, float]) -> None:
    """Speed, way and heat on the slip, and its end if it has one: 45 digits."""
    values = {**truth.START_VALUES, **BINARY, **own}
    closed = _ClosedForm(values)
    t_break = values["mu_s"] * values["g"] / (values["k"] * values["v"])
    steps = [Step(t_break), *[Step(2.0**-7)] * 4]
    run = truth.run(values, steps, law=_without_limit())
    for time, sample in zip(run.times[1:], run.samples[1:], strict=True):
        t = time - run.events[0].time
        assert sample["mode"] == 1
        assert abs(sample["x_dot"] / closed.speed(t) - 1) < 1e-45
        assert abs(sample["x"] / closed.way(t) - 1) < 1e-45
    assert abs(run.samples[-1]["Q_friction"] / closed.heat(t) - 1) < 1e-40
    if own["slope"] > 1.0:
        return
    run = truth.run(values, [Step(t_break + 0.5)], law=_without_limit())
    t_slip = run.events[1].time - run.events[0].time
    assert run.events[1].kind == "re-stick"
    assert abs(closed.speed(t_slip)) < 1e-45 * values["v"]
    assert all(closed.speed(t_slip * n / 1000) > 0 for n in range(1, 1000))
    assert abs((run.events[1].x - run.events[0].x) / closed.way(t_slip) - 1) < 1e-45


def _without_limit() -> truth.FrictionLaw:
    """Return the law without its limit, so that the closed form is tried beyond it too."""
    law = truth.friction_law(NAME)

    class Unlimited(type(law)):  # type: ignore[misc]  # the class of the law as it is found
        def speed_limit(self, n: truth.Numbers) -> None:
            return None

    unlimited: truth.FrictionLaw = Unlimited()
    return unlimited


def _draw(rng: random.Random) -> tuple[dict[str, float], list[Step]]:
    """Return a machine whose slips stay far below mu_k/slope, and steps with changes."""
    w = 10 ** rng.uniform(0, 2)
    m = 10 ** rng.uniform(-1, 1)
    mu_s = rng.uniform(0.1, 1.0)
    mu_k = mu_s * rng.uniform(0.5, 0.9)
    k, N = m * w * w, m * 9.81
    fastest = w * (mu_s - mu_k) * N / k
    # Effective damping ratio from -0.1 to 0.05, and the limit beyond 4 times the usual speed.
    slope = min(2 * m * w * rng.uniform(0.0, 0.1) / N, mu_k / (8 * fastest))
    values = {
        "m": m,
        "k": k,
        "mu_s": mu_s,
        "mu_k": mu_k,
        "c": 2 * m * w * rng.choice([0.0, 0.05]),
        "v": fastest * rng.choice([0.1, 0.5, -0.3]),
        "slope": slope,
        "z_start": mu_s * N / k * rng.choice([0.0, 1.2, -0.9]),
    }
    changes: list[dict[str, float]] = [
        {},
        {"slope": slope / 2},
        {"v": -values["v"]},
        {"load": 0.3 * N, "F_ext": 0.1 * mu_s * N},
        {"slope": 0.0, "k": 1.5 * k},
        {"slope": slope, "load": 0.0},
    ]
    return values, [Step(rng.uniform(2, 8) / w, each) for each in changes]


def _own(values: Mapping[str, float]) -> tuple[dict[str, float], dict[str, float]]:
    rest = {name: value for name, value in values.items() if name != "slope"}
    return rest, {"slope": values["slope"]} if "slope" in values else {}


@pytest.mark.parametrize("seed", range(12))
def test_reference_is_the_truth(seed: int) -> None:
    """Every output after every step: 1e-9 of its scale, what a careful integration gives."""
    values, steps = _draw(random.Random(seed))
    exact = truth.run(values, steps, digits=30, law=NAME)
    times, changes, time = [], [], 0.0
    for step in steps:
        changes.append(Change(time, *_own(step.changes)))
        time += step.h
        times.append(time)
    base, own = _own(values)
    run = simulate(Parameters(**base), time, changes=changes, times=times, law=NAME, own=own)
    assert [event.kind for event in run.events] == [event.kind for event in exact.events]
    lengths = max(abs(float(sample[n])) for sample in exact.samples for n in ("x", "x_pull", "z"))
    for name in exact.initial:
        course = np.array([float(sample[name]) for sample in exact.samples])
        scale = lengths if name in ("x", "x_pull", "z", "delta_x") else np.abs(course).max()
        np.testing.assert_allclose(getattr(run, name), course, rtol=0.0, atol=1e-9 * scale)


def test_without_a_slope_the_law_is_coulombs() -> None:
    """At slope = 0 the truth agrees with Coulomb's to 45 digits, the reference to rounding."""
    values = {"c": 2.0, "v": 0.03, "slope": 0.0}
    base, own = _own(values)
    steps = [Step(0.1), Step(0.5, {"F_ext": 1.0}), Step(1.0, {"v": -0.03})]
    one, other = truth.run(values, steps, law=NAME), truth.run(base, steps)
    for a, b in zip(one.samples, other.samples, strict=True):
        assert all(abs(a[name] - b[name]) <= 1e-45 for name in a)
    run = simulate(Parameters(**base), 1.0, law=NAME, own=own)
    coulomb = simulate(Parameters(**base), 1.0)
    assert len(run.events) == len(coulomb.events)
    np.testing.assert_allclose(run.T, coulomb.T, rtol=1e-11)
    np.testing.assert_allclose(run.Q_friction, coulomb.Q_friction, rtol=1e-11, atol=1e-14)


def test_damping_and_slope_act_as_their_difference() -> None:
    """With c larger by slope N everything is that of Coulomb's law, the heat too."""
    steps = [Step(0.1)] * 6
    falling = truth.run({**BINARY, "c": 1.5, "slope": 2.0**-4}, steps, law=NAME)
    coulomb = truth.run({**BINARY, "c": 1.0}, steps)
    for a, b in zip(falling.samples, coulomb.samples, strict=True):
        assert all(abs(a[name] - b[name]) <= 1e-45 for name in a)


def test_mirror_and_scaling_are_exact_in_the_truth() -> None:
    """Turned about, or with all forces times 4, the run is the same but for the factors."""
    steps = [Step(0.3), Step(0.3, {"slope": 0.5}), Step(0.3, {"F_ext": 0.5})]
    plain = truth.run({**BINARY, "slope": 0.25}, steps, law=NAME).samples
    turned = truth.run(
        {**BINARY, "slope": 0.25, "v": -BINARY["v"]},
        [Step(s.h, {n: -x if n == "F_ext" else x for n, x in s.changes.items()}) for s in steps],
        law=NAME,
    ).samples
    heavier = truth.run(
        {**BINARY, "slope": 0.25, "m": 4.0, "k": 4096.0},
        [Step(s.h, {n: 4 * x if n == "F_ext" else x for n, x in s.changes.items()}) for s in steps],
        law=NAME,
    ).samples
    for one, mirrored, heavy in zip(plain, turned, heavier, strict=True):
        assert one["x"] == -mirrored["x"]
        assert one["F_friction"] == -mirrored["F_friction"]
        assert one["Q_friction"] == mirrored["Q_friction"]
        assert one["x"] == heavy["x"]
        assert 4 * one["Q_friction"] == heavy["Q_friction"]


def test_energy_of_the_reference_balances() -> None:
    """Work and heat account for the stored energy, negative damping or not."""
    run = simulate(Parameters(F_ext=0.5), 2.0, law=NAME, own={"slope": 1.0})
    stored = 0.5 * (1000.0 * run.z**2 + run.x_dot**2)
    given = run.W_pull + run.W_k + run.W_ext - run.Q_friction
    np.testing.assert_allclose(given, stored, atol=1e-12 * run.Q_friction[-1])


@pytest.mark.parametrize("v", [0.02, -0.02])
def test_a_slip_beyond_the_limit_is_refused_on_both_sides(v: float) -> None:
    """Where the kinetic friction would pass 0 the run is refused with speed and limit."""
    # The slip of the default machine reaches 0.0852 m/s.
    values = {"v": v, "mu_k": 0.3, "slope": 0.3 / 0.08}
    base, own = _own(values)
    message = r"the mass reaches 0\.\d+ m/s, but the friction law holds up to 0.08 m/s"
    with pytest.raises(RuntimeError, match=message):
        simulate(Parameters(**base), 1.0, law=NAME, own=own)
    with pytest.raises(ValueError, match=message):
        truth.run(values, [Step(1.0)], law=NAME)
    before = truth.run(values, [Step(0.25)], law=NAME)
    assert before.samples[0]["mode"] == math.copysign(1, v)
    simulate(Parameters(**base), 0.25, law=NAME, own=own)


def _starts(x_dot: float, **own: float) -> Mapping[str, tuple[type[Exception], Callable[[], Any]]]:
    """Return each side's run of 1/128 s from this velocity, and the error that it may raise."""
    values = {**BINARY, "x_dot_start": x_dot, **own}
    base, law = _own(values)
    h = 2.0**-7

    def of_block() -> float:
        block = block_of(spec_of(block_law(NAME).law), values)
        block.advance(0.0, h)
        return outputs(block)["x_dot"]

    return {
        "block": (ModelError, of_block),
        "reference": (
            RuntimeError,
            lambda: simulate(Parameters(**base), h, times=[h], law=NAME, own=law).x_dot[0],
        ),
        "truth": (
            ValueError,
            lambda: float(truth.run(values, [Step(h)], law=NAME).samples[0]["x_dot"]),
        ),
    }


@pytest.mark.parametrize("side", ["block", "reference", "truth"])
@pytest.mark.parametrize("direction", [1, -1])
def test_a_start_at_the_limit_runs_unless_it_goes_beyond(side: str, direction: int) -> None:
    """At mu_k/slope = 1/8 m/s no dry friction is left: m x_ddot = k z - c x_dot decides."""
    limit, v = direction * 0.125, direction * 2.0**-6
    own = {"slope": 2.0, "v": v}
    error, slower = _starts(limit, **own)[side]
    # x_dot = v + rho, rho'' - 16 rho' + 1024 rho = 0 with rho(0) = limit - v, rho'(0) = 0.
    b, t = math.sqrt(1024.0 - 64.0), 2.0**-7
    rho = (limit - v) * math.exp(8.0 * t) * (math.cos(b * t) - 8.0 / b * math.sin(b * t))
    assert slower() == pytest.approx(v + rho, rel=1e-11)
    # Steady sliding at the limit itself, its damping c - slope N = 64 N.s/m.
    steady = {"slope": 2.0, "c": 80.0, "v": limit, "z_start": 80.0 * limit / 1024.0}
    assert _starts(limit, **steady)[side][1]() == limit
    for beyond in (
        _starts(limit, **own, z_start=direction * 2.0**-6),
        _starts(math.nextafter(limit, 0.0), **own, z_start=direction * 2.0**-6),
        _starts(math.nextafter(limit, 2.0 * limit), **own),
    ):
        with pytest.raises(error, match=r"0\.125"):
            beyond[side][1]()


@pytest.mark.parametrize("seed", range(20))
def test_no_start_at_the_limit_slips_through_the_reference(seed: int) -> None:
    """A mass that starts at the limit and speeds up is refused, however the speed is scaled."""
    rng = random.Random(seed)
    for _ in range(5):
        mu_k, slope = rng.uniform(0.1, 0.4), rng.uniform(0.5, 5.0)
        p = Parameters(mu_k=mu_k, m=rng.uniform(0.5, 2.0), x_dot_start=mu_k / slope, z_start=0.1)
        with pytest.raises(RuntimeError, match="the friction law holds up to"):
            simulate(p, 1e-3, law=NAME, own={"slope": slope})


@pytest.mark.parametrize("v", [0.02, -0.02])
def test_a_change_to_a_limit_below_the_speed_is_refused_by_the_reference(v: float) -> None:
    """The message gives the mass's own speed at the change, and the new limit."""
    p, change = Parameters(v=v), Change(0.28, {}, {"slope": 0.3 / 0.04})
    speed = abs(simulate(p, 0.28, times=[0.28], law=NAME, own={"slope": 0.1}).x_dot[0])
    assert speed > 0.06
    message = f"the mass reaches {speed:.6g} m/s, but the friction law holds up to 0.04 m/s"
    with pytest.raises(RuntimeError, match=message):
        simulate(p, 1.0, law=NAME, own={"slope": 0.1}, changes=[change])


def test_a_start_beyond_a_limit_of_0_is_refused_by_the_reference() -> None:
    """Without dry friction the limit is 0, also where damping and slope nearly cancel."""
    p = Parameters(
        m=1.7086375004157492, c=1.6761733879078502, mu_s=0.0, mu_k=0.0, v=0.0, x_dot_start=-0.13
    )
    with pytest.raises(RuntimeError, match=r"reaches 0\.13 m/s, but .* holds up to 0 m/s"):
        simulate(p, 10.0, law=NAME, own={"slope": 0.1})


def test_the_slope_is_checked_on_both_sides() -> None:
    """A negative slope is refused with name, value and range, at the start and in a change."""
    with pytest.raises(ValueError, match=r"slope = -1.0 s/m is out of range"):
        simulate(Parameters(), 1.0, law=NAME, own={"slope": -1.0})
    with pytest.raises(ValueError, match=r"slope = -1.0 s/m is out of range"):
        simulate(Parameters(), 1.0, law=NAME, changes=[Change(0.5, {}, {"slope": -1.0})])
    with pytest.raises(ValueError, match=r"slope = -1.0 is outside slope >= 0"):
        truth.run({"slope": -1.0}, [Step(1.0)], law=NAME)
    with pytest.raises(ValueError, match=r"slope = -1.0 is outside slope >= 0"):
        truth.run({}, [Step(1.0), Step(1.0, {"slope": -1.0})], law=NAME)
