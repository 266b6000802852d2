"""The contract of a friction law: what each of its answers does to the motion."""

import math
from collections.abc import Mapping
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm

from stickslip_ref import (
    COULOMB,
    Bound,
    Change,
    Coulomb,
    FrictionLaw,
    OwnParameter,
    Parameters,
    State,
    friction_law,
    simulate,
)

NO_LAW = SimpleNamespace(reference="math:pi")
"""A record that leads to no friction law."""


class _Ageing(Coulomb):
    """Static friction ``mu_s N (1 + growth age)``."""

    parameters: Mapping[str, OwnParameter] = {
        "growth": OwnParameter(0.5, Bound("1/s", 0.0), tunable=False)
    }

    def ages(self, p: Parameters) -> bool:
        return True

    def break_away_force(self, p: Parameters, age: float = 0.0, state: State = ()) -> float:
        return float(p.F_s) * (1.0 + p.own["growth"] * age)


class _Wearing(Coulomb):
    """Kinetic friction that falls by ``loss`` [N/m] along the way; at rest it recovers in 0.1 s."""

    parameters: Mapping[str, OwnParameter] = {"loss": OwnParameter(100.0, Bound("N/m", 0.0))}
    constant_in_slip = False

    def slip_friction(self, p: Parameters, speed: float, state: State = ()) -> float:
        return float(p.mu_k_used * p.N) - p.own["loss"] * state[0]

    def state_start(self, p: Parameters) -> State:
        return (0.0,)

    def state_scale(self, p: Parameters) -> State:
        return (1e-3,)

    def rates(self, p: Parameters, speed: float, state: State) -> State:
        return (speed,)

    def rested(self, p: Parameters, duration: float, state: State) -> State:
        return (state[0] * math.exp(-duration / 0.1),)


class _Lagging(FrictionLaw):
    """A drag of 20 N.s/m on a velocity that lags by 0.05 s; the mass never sticks."""

    sticks = False

    def break_away_force(self, p: Parameters, age: float = 0.0, state: State = ()) -> float:
        return 0.0

    def slip_friction(self, p: Parameters, speed: float, state: State = ()) -> float:
        return 20.0 * state[0]

    def state_start(self, p: Parameters) -> State:
        return (0.0,)

    def state_scale(self, p: Parameters) -> State:
        return (0.01,)

    def rates(self, p: Parameters, speed: float, state: State) -> State:
        return ((speed - state[0]) / 0.05,)


def test_friction_that_grows_at_rest_prolongs_the_stick() -> None:
    """A stick lasts F_s / (k v - growth F_s) from rest, and a change on the way keeps its age."""
    p, growth = Parameters(), 0.5
    F_s = 0.5 * 9.81
    wait = F_s / (20.0 - growth * F_s)
    for changes in ([], [Change(0.1, {"load": 0.0}), Change(0.2, {"c": 0.0})]):
        run = simulate(p, 0.4, law=_Ageing(), changes=changes, times=[0.1, 0.2, 0.35])
        assert run.events[0].time == pytest.approx(wait, rel=1e-14)
        assert run.events[0].z == pytest.approx(0.02 * wait, rel=1e-14)
        assert run.t_stick[-1] == pytest.approx(wait, rel=1e-14)
        expected = [F_s * (1.0 + growth * 0.1), F_s * (1.0 + growth * 0.2), F_s]
        np.testing.assert_allclose(run.F_s, expected, rtol=1e-14)


def test_friction_that_outgrows_the_pull_holds_for_ever() -> None:
    """Where F_s grows faster than k v the mass never breaks away."""
    run = simulate(Parameters(), 5.0, law=_Ageing(), own={"growth": 5.0})
    assert not run.events


def test_own_state_follows_slip_and_stick() -> None:
    """Friction that falls along the way softens the spring; at rest the law's state recovers."""
    p, loss = Parameters(), 100.0
    times = np.linspace(0.26, 0.3, 5)
    run = simulate(p, 1.0, law=_Wearing(), times=[*times, 1.0])
    begin = run.events[0].time
    # m y_ddot = gap + k v t - (k - loss) y for the way y since break-away.
    softened = 1000.0 - loss
    w, gap = math.sqrt(softened), 0.2 * 9.81
    t = times - begin
    y = (gap * (1.0 - np.cos(w * t)) + 20.0 * (t - np.sin(w * t) / w)) / softened
    np.testing.assert_allclose(run.x[:-1], y, rtol=1e-11)
    np.testing.assert_allclose(-run.F_friction[:-1], 0.3 * 9.81 - loss * y, rtol=1e-11)
    first, second, third = (event for event in run.events[:3])
    left = loss * (second.x - first.x) * math.exp(-(third.time - second.time) / 0.1)
    assert left > 0.02
    just_after = simulate(p, third.time + 1e-7, law=_Wearing(), times=[third.time + 1e-7])
    assert -just_after.F_friction[0] == pytest.approx(0.3 * 9.81 - left, rel=1e-6)


def test_a_law_without_a_stick_is_integrated_whole() -> None:
    """A linear drag with a lag is a linear system: motion, energies and signs are its own."""
    p = Parameters(x_dot_start=-0.05)
    times = np.linspace(0.0, 1.0, 21)
    run = simulate(p, 1.0, law=_Lagging(), times=times, changes=[Change(0.5, {"F_ext": 1.0})])

    # State: z, x_dot, lagging velocity, 1.
    def system(F_ext: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        return np.array(
            [[0, -1, 0, 0.02], [1000, 0, -20, F_ext], [0, 20, -20, 0], [0, 0, 0, 0]], float
        )

    state, last = np.array([0.0, -0.05, 0.0, 1.0]), 0.0
    for number, time in enumerate(times):
        state = expm(system(1.0 if time > 0.5 else 0.0) * (time - last)) @ state
        last = time
        assert run.z[number] == pytest.approx(state[0], abs=1e-11)
        assert run.x_dot[number] == pytest.approx(state[1], abs=1e-10)
        assert run.F_friction[number] == pytest.approx(-20.0 * state[2], abs=1e-9)
    assert not run.events
    np.testing.assert_array_equal(run.mode, np.sign(run.x_dot))
    stored = 0.5 * (1000.0 * run.z**2 + run.x_dot**2 - 0.05**2)
    np.testing.assert_allclose(run.W_pull + run.W_ext - run.Q_friction, stored, atol=1e-10)


@pytest.mark.parametrize(
    ("own", "message"),
    [
        ({"growth": -1.0}, r"growth = -1.0 1/s is out of range; it must be finite and >= 0 1/s"),
        ({"slope": 1.0}, r"slope = 1.0 is no parameter of the friction law _Ageing.*growth"),
        ({"growth": math.nan}, r"growth = nan 1/s is out of range"),
    ],
)
def test_own_parameters_are_checked_by_the_law(own: Mapping[str, float], message: str) -> None:
    """An unknown own parameter and one out of range are named with value and range."""
    with pytest.raises(ValueError, match=message):
        simulate(Parameters(), 1.0, law=_Ageing(), own=own)


def test_only_tunable_own_parameters_change() -> None:
    """A change of an own parameter that is not tunable is refused."""
    with pytest.raises(ValueError, match=r"growth = 1.0 at 0.5 s cannot change during a run"):
        simulate(Parameters(), 1.0, law=_Ageing(), changes=[Change(0.5, {}, {"growth": 1.0})])


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("falling", r"'falling' is no friction law: 'coulomb', 'stribeck', or module:NAME such as"),
        ("no_such_module:LAW", r"'no_such_module:LAW' was not found \(No module named"),
        ("math:LAW", r"'math:LAW' was not found \(module 'math' has no attribute 'LAW'\)"),
        ("math:pi", r"'math:pi' has no attribute 'reference'"),
        (f"{__name__}:NO_LAW", r"'math:pi' is a float; the .* an object of a subclass of"),
    ],
)
def test_a_law_that_is_not_found_is_told_with_an_example(name: str, message: str) -> None:
    """The error for a dotted name says what was wrong and shows a good one."""
    with pytest.raises(ValueError, match=message):
        friction_law(name)


def test_coulombs_law_has_a_name_too() -> None:
    """The law that comes along is called coulomb."""
    assert friction_law("coulomb") is COULOMB
